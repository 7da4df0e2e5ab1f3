//! What is refused before anything is placed: references, colours, materials, lights.

use super::{
    description::{DeltaLight, Object, SceneDescription},
    error::{Kind, Problem, SceneError},
    place::{check_transform, object_error},
};
use crate::{
    bsdf::ConductorFresnel,
    camera::unit_axes,
    lights::Lights,
    material::{Material, RoughnessTexture},
    relief::Relief,
    rgb::Rgb,
    texture::{Texel, Texture},
};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Refuses what is wrong; the camera and the shapes are checked where they are placed.
pub(super) fn check(scene: &SceneDescription) -> Result<(), SceneError> {
    let item = |kind: Kind, name: &str| {
        let name = name.to_string();
        move |problem| SceneError::Item { kind, name, problem }
    };
    for material in &scene.materials {
        check_material(&material.material).map_err(item(Kind::Material, &material.name))?;
    }
    for object in &scene.objects {
        check_object(object, scene.materials.len()).map_err(|problem| object_error(object, problem))?;
    }
    for group in &scene.groups {
        for object in &group.objects {
            check_object(object, scene.materials.len()).map_err(|problem| object_error(object, problem))?;
            if emits(object) {
                return Err(item(Kind::Group, &group.name)(Problem::EmitterInGroup(object.name.clone())));
            }
        }
    }
    for (index, instance) in scene.instances.iter().enumerate() {
        let error = item(Kind::Instance, &index.to_string());
        check_index("instance", index, "group", instance.group, scene.groups.len())
            .and_then(|()| check_transform(&instance.to_world))
            .map_err(error)?;
    }
    for light in &scene.lights {
        check_light(&light.kind).map_err(item(Kind::Light, &light.name))?;
    }
    if let Some(environment) = &scene.environment {
        environment.check().map_err(|e| item(Kind::Environment, &scene.name)(Problem::Other(e)))?;
    }
    let all = scene.objects.iter().chain(scene.groups.iter().flat_map(|g| &g.objects));
    let emitting = scene.objects.iter().filter(|o| emits(o));
    let (primitives, lights) = (all.map(elements).sum(), emitting.map(elements).sum::<usize>() + scene.lights.len());
    // The hierarchy keeps three bits to tell leaves from nodes, and one for triangles that are cut in parts; one light may be
    // the environment.
    for (count, limit) in [(primitives, 1 << 28), (lights, Lights::LIMIT)] {
        if count >= limit {
            return Err(item(Kind::Object, &scene.name)(Problem::TooMany(count)));
        }
    }
    Ok(())
}

/// Whether a shape sends out any light.
fn emits(object: &Object) -> bool {
    object.emission.as_ref().is_some_and(|t| !matches!(t, Texture::Constant(Rgb::BLACK)))
}

fn elements(object: &Object) -> usize {
    match &object.shape {
        super::ObjectShape::Mesh(mesh) => mesh.triangles.len(),
        super::ObjectShape::Cube => 12,
        super::ObjectShape::Rectangle => 2,
        super::ObjectShape::Sphere { .. } | super::ObjectShape::Disk | super::ObjectShape::Cylinder { .. } => 1,
    }
}

fn check_index(what: &'static str, index: usize, target: &str, value: usize, count: usize) -> Result<(), Problem> {
    if value < count {
        Ok(())
    } else {
        Err(Problem::IndexOutOfRange { what, index, target: format!("{target} {value}"), count })
    }
}

fn check_object(object: &Object, materials: usize) -> Result<(), Problem> {
    check_index("it", 0, "material", object.material, materials)?;
    object.emission.iter().try_for_each(|t| check_texture("emission", t, f32::MAX))?;
    object.absorption.iter().try_for_each(|c| check_colour("absorption", *c, f32::MAX))
}

/// A colour is finite, not negative, and at most `most` in each component.
fn check_colour(what: &'static str, c: Rgb, most: f32) -> Result<(), Problem> {
    Rgb::check(what, c, 0.0, most)
}

fn check_material(material: &Material) -> Result<(), Problem> {
    match material {
        Material::Lambert { reflectance } => check_texture("reflectance", reflectance, 1.0),
        Material::Conductor { fresnel, tint, roughness } => {
            check_roughness(roughness)?;
            check_texture("tint", tint, 1.0)?;
            match fresnel {
                ConductorFresnel::Constant(c) => check_colour("reflectance", *c, 1.0),
                ConductorFresnel::Complex { eta, k, tint } => {
                    check_colour("index of refraction", *eta, f32::MAX)?;
                    check_colour("extinction", *k, f32::MAX)?;
                    check_colour("tint", *tint, 1.0)
                }
            }
        }
        Material::Dielectric { eta, reflectance, transmittance, roughness } => {
            check_roughness(roughness)?;
            check_eta(*eta)?;
            check_texture("reflectance", reflectance, 1.0)?;
            check_texture("transmittance", transmittance, 1.0)
        }
        Material::ThinDielectric { eta, reflectance, transmittance } => {
            check_eta(*eta)?;
            check_texture("reflectance", reflectance, 1.0)?;
            check_texture("transmittance", transmittance, 1.0)
        }
        Material::Plastic { eta, diffuse, specular, nonlinear: _, roughness } => {
            check_eta(*eta)?;
            check_texture("diffuse reflectance", diffuse, 1.0)?;
            check_texture("specular reflectance", specular, 1.0)?;
            roughness.iter().try_for_each(|(_, alpha)| check_texture_between("roughness", &(*alpha).into(), ALPHA))
        }
        Material::Principled(p) => {
            check_eta(p.eta)?;
            check_texture("base colour", &p.base_color, 1.0)?;
            for (what, texture) in [
                ("roughness", &p.roughness),
                ("anisotropy", &p.anisotropic),
                ("metallic share", &p.metallic),
                ("specular transmission", &p.spec_trans),
                ("specular tint", &p.spec_tint),
                ("sheen", &p.sheen),
                ("sheen tint", &p.sheen_tint),
                ("flatness", &p.flatness),
                ("clear coat", &p.clearcoat),
                ("gloss of the clear coat", &p.clearcoat_gloss),
            ] {
                check_texture(what, texture, 1.0)?;
            }
            Ok(())
        }
        Material::PrincipledThin(p) => {
            check_eta(p.eta)?;
            check_texture("base colour", &p.base_color, 1.0)?;
            for (what, texture) in [
                ("roughness", &p.roughness),
                ("anisotropy", &p.anisotropic),
                ("specular transmission", &p.spec_trans),
                ("specular tint", &p.spec_tint),
                ("sheen", &p.sheen),
                ("sheen tint", &p.sheen_tint),
                ("flatness", &p.flatness),
            ] {
                check_texture(what, texture, 1.0)?;
            }
            check_texture("diffuse transmission", &p.diff_trans, 2.0)
        }
        Material::Mix { first, second, weight } => {
            check_texture("weight", weight, 1.0)?;
            [first, second].into_iter().try_for_each(|member| check_member(member))
        }
        Material::Mask { opacity, material } => {
            check_texture("opacity", opacity, 1.0)?;
            check_member(material)
        }
        Material::Relief { relief, material } => {
            check_relief(relief)?;
            // Of what a relief is on, the frame is one; so it stands outside everything else.
            if matches!(**material, Material::Relief { .. }) {
                return Err(Problem::NestedRelief);
            }
            check_material(material)
        }
    }
}

fn check_relief(relief: &Relief) -> Result<(), Problem> {
    match relief {
        Relief::Bump { height, scale } => {
            check_texture_between("height", height, (f32::MIN, f32::MAX))?;
            check_texture_between("scale of the height", &(*scale).into(), (f32::MIN, f32::MAX))
        }
        Relief::NormalMap { normals, .. } => check_texture("normal", normals, 1.0),
        Relief::Sheet(relief) => check_relief(relief),
    }
}

/// A member of a mixture or mask: neither of these again, and the relief is the whole's.
fn check_member(material: &Material) -> Result<(), Problem> {
    match material {
        Material::Mix { .. } | Material::Mask { .. } => Err(Problem::NestedMixture),
        Material::Relief { .. } => Err(Problem::NestedRelief),
        other => check_material(other),
    }
}

fn check_eta(eta: f32) -> Result<(), Problem> {
    if eta.is_finite() && eta > 0.0 {
        Ok(())
    } else {
        let value = f64::from(eta);
        Err(Problem::OutOfRange { what: "index of refraction", value, expected: "positive and finite" })
    }
}

/// Values that can be held against bounds.
trait Bounded: Texel {
    fn check(what: &'static str, value: Self, least: f32, most: f32) -> Result<(), Problem>;
}

impl Bounded for f32 {
    fn check(what: &'static str, value: f32, least: f32, most: f32) -> Result<(), Problem> {
        if !value.is_finite() {
            return Err(Problem::NotFinite { what, index: 0 });
        }
        if (least..=most).contains(&value) { Ok(()) } else { Err(out_of_range(what, value, least, most)) }
    }
}

impl Bounded for Rgb {
    fn check(what: &'static str, value: Rgb, least: f32, most: f32) -> Result<(), Problem> {
        for (index, v) in value.to_array().into_iter().enumerate() {
            if !v.is_finite() {
                return Err(Problem::NotFinite { what, index });
            }
            if !(least..=most).contains(&v) {
                return Err(out_of_range(what, v, least, most));
            }
        }
        Ok(())
    }
}

fn out_of_range(what: &'static str, value: f32, least: f32, most: f32) -> Problem {
    let expected = match (least, most) {
        (0.0, 1.0) => "in [0, 1]",
        (0.0, 2.0) => "in [0, 2]",
        ALPHA => "in [0.0001, 1] (a smooth surface has no roughness)",
        _ => "zero or positive",
    };
    Problem::OutOfRange { what, value: f64::from(value), expected }
}

/// Roughness of microfacets.
const ALPHA: (f32, f32) = (1e-4, 1.0);

/// Every value is finite, not negative, and at most `most`.
fn check_texture<T: Bounded>(what: &'static str, texture: &Texture<T>, most: f32) -> Result<(), Problem> {
    check_texture_between(what, texture, (0.0, most))
}

fn check_texture_between<T: Bounded>(
    what: &'static str,
    texture: &Texture<T>,
    (least, most): (f32, f32),
) -> Result<(), Problem> {
    let check = |value: T| T::check(what, value, least, most);
    let to_uv = match texture {
        Texture::Constant(value) => return check(*value),
        // Vertex colours are checked with their meshes.
        Texture::VertexColor => return Ok(()),
        Texture::Checkerboard { even, odd, to_uv } => {
            check(*even)?;
            check(*odd)?;
            to_uv
        }
        Texture::Bitmap { bitmap, to_uv, .. } => {
            let [width, height] = bitmap.size();
            let (texels, expected) = (bitmap.len(), width as usize * height as usize);
            if expected == 0 || texels != expected {
                return Err(Problem::Other(format!("its bitmap of {width}x{height} has {texels} texels")));
            }
            // One by one only for what to say of the first that is wrong.
            if !bitmap.is_within(least, most) {
                bitmap.values().into_iter().try_for_each(check)?;
            }
            to_uv
        }
    };
    if to_uv.is_finite() { Ok(()) } else { Err(Problem::NotFinite { what: "transform of a texture", index: 0 }) }
}

fn check_roughness(roughness: &Option<RoughnessTexture>) -> Result<(), Problem> {
    roughness
        .iter()
        .flat_map(|r| [&r.alpha_u, &r.alpha_v])
        .try_for_each(|t| check_texture_between("roughness", t, ALPHA))
}

fn check_vector(what: &'static str, v: DVec3) -> Result<(), Problem> {
    if v.is_finite() { Ok(()) } else { Err(Problem::NotFinite { what, index: 0 }) }
}

fn check_direction(v: DVec3) -> Result<(), Problem> {
    check_vector("direction", v)?;
    let value = v.length();
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Problem::OutOfRange { what: "length of the direction", value, expected: "positive and finite" })
    }
}

/// A texture that is on no mesh.
fn check_picture(what: &'static str, texture: &Texture<Rgb>, most: f32) -> Result<(), Problem> {
    if matches!(texture, Texture::VertexColor) {
        return Err(Problem::Other(format!("its {what} is that of a mesh's vertices, and it has no mesh")));
    }
    check_texture(what, texture, most)
}

fn check_light(light: &DeltaLight) -> Result<(), Problem> {
    match light {
        DeltaLight::Point { position, intensity } => {
            check_vector("position", *position)?;
            check_colour("intensity", *intensity, f32::MAX)
        }
        DeltaLight::Projector { to_world, fov_x, aspect, irradiance } => {
            check_transform(to_world)?;
            unit_axes(to_world.matrix3).map_err(|e| Problem::Other(e.to_string()))?;
            if !(*fov_x > 0.0 && *fov_x < PI) {
                let what = "horizontal field of view";
                return Err(Problem::OutOfRange { what, value: *fov_x, expected: "between 0 and pi" });
            }
            // Its reciprocal is a height: neither may be lost in single precision.
            if ![*aspect as f32, (1.0 / *aspect) as f32].iter().all(|a| a.is_normal() && *a > 0.0) {
                let (value, expected) = (*aspect, "positive and finite");
                return Err(Problem::OutOfRange { what: "width over its height", value, expected });
            }
            check_picture("irradiance", irradiance, f32::MAX)
        }
        DeltaLight::Spot { position, direction, intensity, beam, cutoff, image } => {
            check_vector("position", *position)?;
            check_direction(*direction)?;
            check_colour("intensity", *intensity, f32::MAX)?;
            if !(*cutoff > 0.0 && *cutoff <= PI) {
                return Err(Problem::OutOfRange { what: "cutoff angle", value: *cutoff, expected: "in (0, pi]" });
            }
            if !(0.0..=*cutoff).contains(beam) {
                return Err(Problem::OutOfRange { what: "beam angle", value: *beam, expected: "in [0, cutoff]" });
            }
            let Some((image, up)) = image else { return Ok(()) };
            if *cutoff >= FRAC_PI_2 {
                let expected = "below pi / 2, as it must be with an image";
                return Err(Problem::OutOfRange { what: "cutoff angle", value: *cutoff, expected });
            }
            check_vector("direction up in the image", *up)?;
            // Judged against the lengths: no absolute threshold.
            let across = up.normalize_or_zero().cross(direction.normalize_or_zero()).length();
            if across < 1e-6 {
                return Err(Problem::Other("the direction up in its image is zero or along its axis".into()));
            }
            check_picture("image", image, f32::MAX)
        }
        DeltaLight::Directional { direction, irradiance } => {
            check_direction(*direction)?;
            check_colour("irradiance", *irradiance, f32::MAX)
        }
    }
}
