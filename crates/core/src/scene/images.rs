//! The images that a scene's textures and lights hold, each counted once.

use super::description::{DeltaLight, SceneDescription};
use crate::{
    lights::environment::Environment,
    material::{Material, Principled, PrincipledThin, Relief},
    rgb::Rgb,
    texture::{Raster, Texel, Texture},
};
use std::collections::HashSet;

/// How many images there are and what they take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Images {
    /// Images.
    pub count: usize,
    /// Their texels.
    pub texels: u64,
    /// Bytes that these take.
    pub bytes: u64,
}

impl Images {
    /// Counts the images of a scene.
    pub fn of(scene: &SceneDescription) -> Images {
        let mut counter = Counter::default();
        scene.materials.iter().for_each(|m| counter.material(&m.material));
        let objects = scene.objects.iter().chain(scene.groups.iter().flat_map(|g| &g.objects));
        objects.filter_map(|o| o.emission.as_ref()).for_each(|e| counter.texture(e));
        for light in &scene.lights {
            match &light.kind {
                DeltaLight::Spot { image: Some((image, _)), .. } => counter.texture(image),
                DeltaLight::Projector { irradiance, .. } => counter.texture(irradiance),
                DeltaLight::Spot { .. } | DeltaLight::Point { .. } | DeltaLight::Directional { .. } => {}
            }
        }
        if let Some(Environment::LatLong { image, .. }) = &scene.environment {
            counter.raster(&Raster::from(image.clone()));
        }
        counter.images
    }
}

#[derive(Default)]
struct Counter {
    images: Images,
    /// Where those that are counted lie.
    met: HashSet<usize>,
}

impl Counter {
    fn raster<T: Texel>(&mut self, raster: &Raster<T>) {
        if self.met.insert(raster.address()) {
            self.images.count += 1;
            self.images.texels += raster.len() as u64;
            self.images.bytes += raster.bytes() as u64;
        }
    }

    fn texture<T: Texel>(&mut self, texture: &Texture<T>) {
        if let Texture::Bitmap { bitmap, .. } = texture {
            self.raster(bitmap);
        }
    }

    fn textures<T: Texel>(&mut self, textures: &[&Texture<T>]) {
        textures.iter().for_each(|t| self.texture(t));
    }

    fn material(&mut self, material: &Material) {
        match material {
            Material::Lambert { reflectance } => self.texture(reflectance),
            Material::Conductor { tint, roughness, .. } => {
                self.texture(tint);
                roughness.iter().for_each(|r| self.textures(&[&r.alpha_u, &r.alpha_v]));
            }
            Material::Dielectric { reflectance, transmittance, roughness, .. } => {
                self.textures::<Rgb>(&[reflectance, transmittance]);
                roughness.iter().for_each(|r| self.textures(&[&r.alpha_u, &r.alpha_v]));
            }
            Material::ThinDielectric { reflectance, transmittance, .. } => self.textures(&[reflectance, transmittance]),
            Material::Plastic { diffuse, specular, .. } => self.textures(&[diffuse, specular]),
            Material::Principled(p) => self.principled(p),
            Material::PrincipledThin(p) => self.principled_thin(p),
            Material::Mix { first, second, weight } => {
                self.texture(weight);
                self.material(first);
                self.material(second);
            }
            Material::Mask { opacity, material } => {
                self.texture(opacity);
                self.material(material);
            }
            Material::Relief { relief, material } => {
                self.relief(relief);
                self.material(material);
            }
        }
    }

    fn relief(&mut self, relief: &Relief) {
        match relief {
            Relief::Bump { height, .. } => self.texture(height),
            Relief::NormalMap { normals, .. } => self.texture(normals),
            Relief::Sheet(relief) => self.relief(relief),
        }
    }

    fn principled(&mut self, p: &Principled) {
        self.texture(&p.base_color);
        self.textures(&[&p.roughness, &p.anisotropic, &p.metallic, &p.spec_trans, &p.spec_tint, &p.sheen]);
        self.textures(&[&p.sheen_tint, &p.flatness, &p.clearcoat, &p.clearcoat_gloss]);
    }

    fn principled_thin(&mut self, p: &PrincipledThin) {
        self.texture(&p.base_color);
        self.textures(&[&p.roughness, &p.anisotropic, &p.spec_trans, &p.spec_tint, &p.sheen]);
        self.textures(&[&p.sheen_tint, &p.flatness, &p.diff_trans]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::NamedMaterial;
    use crate::texture::Bitmap;
    use std::sync::Arc;

    #[test]
    fn a_shared_image_counts_once() {
        let bitmap = Arc::new(Bitmap { width: 2, height: 3, texels: vec![Rgb::WHITE; 6] });
        let other = Arc::new(Bitmap { width: 1, height: 1, texels: vec![0.5f32] });
        let lambert = || Material::Lambert { reflectance: Texture::bitmap(bitmap.clone()) };
        let mask = Material::Mask { opacity: Texture::bitmap(other), material: Box::new(lambert()) };
        let named = |material| NamedMaterial { name: String::new(), material, two_sided: false };
        let scene = SceneDescription { materials: vec![named(lambert()), named(mask)], ..SceneDescription::default() };
        assert_eq!(Images::of(&scene), Images { count: 2, texels: 7, bytes: 76 });
    }
}
