//! BSDFs that change or join others.

use super::{Materials, Parts};
use crate::{
    error::LoadError,
    mitsuba::{
        plugin::Plugin,
        texture::{HEIGHT, REFLECTANCE, product, texture},
        tree::Node,
    },
};
use etendue_core::{
    material::{Bitangent, Material, Relief},
    texture::Texture,
};

impl<'d> Materials<'_, 'd> {
    /// The one BSDF in another, with the place where it is nested or referred to.
    fn inner(&mut self, plugin: &Plugin<'_, 'd>) -> Result<(Parts, Node<'d>), LoadError> {
        match plugin.nested("bsdf")[..] {
            [(node, place)] => Ok((self.read(node)?, place)),
            [_, (_, second), ..] => Err(second.error(format!("the bsdf type `{}` takes one bsdf only", plugin.kind))),
            [] => Err(plugin.error(format!("the bsdf type `{}` needs a bsdf", plugin.kind))),
        }
    }

    pub(super) fn two_sided(&mut self, plugin: &Plugin<'_, 'd>) -> Result<Parts, LoadError> {
        let (node, place) = match plugin.nested("bsdf")[..] {
            [inner] => inner,
            [(first, place), (second, _)] if first == second => (first, place),
            [first, (_, second), ..] => {
                let error = second.error("a different BSDF for the back side is not supported");
                self.reader.forgive(error, "the front side's is taken for both")?;
                first
            }
            [] => return Err(plugin.error("the bsdf type `twosided` needs a bsdf")),
        };
        let parts = self.read(node)?;
        if parts.two_sided {
            return Err(place.error("a twosided BSDF inside another"));
        }
        if transmits(&parts.body) {
            let message = "a BSDF that lets light through cannot be twosided: it has both sides already";
            self.reader.forgive(place.error(message), "it is taken as it is")?;
        }
        Ok(Parts { two_sided: true, ..parts })
    }

    pub(super) fn mask(&mut self, plugin: &Plugin<'_, 'd>) -> Result<Parts, LoadError> {
        let opacity = plugin.texture_or("opacity", REFLECTANCE, 0.5)?;
        let (parts, place) = self.inner(plugin)?;
        let inner = match parts.body {
            Material::Mask { opacity: ref inner, ref material } => {
                product(&opacity, inner).map(|opacity| Material::Mask { opacity, material: material.clone() })
            }
            _ => None,
        };
        if let Some(body) = inner {
            return Ok(Parts { body, ..parts });
        }
        if matches!(parts.body, Material::Mask { .. } | Material::Mix { .. }) {
            let error = place.error("a mask over a blend, or over a mask where both are textures, is not supported");
            self.reader.forgive(error, "the outer mask is left out")?;
            return Ok(parts);
        }
        let body = match opacity {
            Texture::Constant(1.0) => parts.body,
            opacity => Material::Mask { opacity, material: Box::new(parts.body) },
        };
        Ok(Parts { body, ..parts })
    }

    pub(super) fn relief(&mut self, plugin: &Plugin<'_, 'd>) -> Result<Parts, LoadError> {
        let (parts, place) = self.inner(plugin)?;
        let relief = if plugin.kind == "bumpmap" {
            let [(map, _)] = plugin.nested("texture")[..] else {
                return Err(plugin.error("the bsdf type `bumpmap` needs one texture"));
            };
            let height = self.reader.forgiven(texture(self.reader, map, HEIGHT, 0), "the bump map is left out")?;
            let scale = plugin.float("scale")?.unwrap_or(1.0) as f32;
            height.map(|height| Relief::Bump { height, scale })
        } else {
            let normals = match plugin.nested("texture")[..] {
                [(map, _)] => {
                    let read = texture(self.reader, map, REFLECTANCE, 0);
                    self.reader.forgiven(read, "the normal map is left out")?
                }
                [] => plugin.reflectance("normalmap")?.map(Texture::Constant),
                _ => return Err(plugin.error("the bsdf type `normalmap` takes one texture only")),
            };
            normals.map(|normals| Relief::NormalMap { normals, bitangent: Bitangent::RightHanded })
        };
        if parts.relief.is_some() && relief.is_some() {
            let error = place.error("a bump or normal map on another is not supported");
            self.reader.forgive(error, "the outer one is left out")?;
            return Ok(parts);
        }
        // Around a twosided BSDF it is one for both sides; inside, the back mirrors it.
        let relief = relief.map(|relief| if parts.two_sided { Relief::Sheet(Box::new(relief)) } else { relief });
        Ok(Parts { relief: relief.or(parts.relief), ..parts })
    }

    pub(super) fn blend(&mut self, plugin: &Plugin<'_, 'd>) -> Result<Parts, LoadError> {
        let weight = plugin.texture("weight", REFLECTANCE)?;
        let weight = weight.ok_or_else(|| plugin.error("the bsdf type `blendbsdf` needs a weight"))?;
        let [(first, _), (second, place)] = plugin.nested("bsdf")[..] else {
            return Err(plugin.error("the bsdf type `blendbsdf` needs two BSDFs"));
        };
        let (first, second) = (self.read(first)?, self.read(second)?);
        let joined = |parts: &Parts| matches!(parts.body, Material::Mix { .. } | Material::Mask { .. });
        let wrong = if joined(&first) || joined(&second) {
            Some("a blend of blends or masks is not supported")
        } else if first.relief != second.relief {
            Some("a blend of which one BSDF has a bump or normal map that the other has not is not supported")
        } else if first.two_sided != second.two_sided && !transmits(&first.body) && !transmits(&second.body) {
            // What lets light through has both sides, whatever is said of the other.
            Some("a blend of a twosided and a one-sided BSDF is not supported")
        } else {
            None
        };
        if let Some(message) = wrong {
            let error = place.error(message);
            let heavier = matches!(weight, Texture::Constant(w) if w > 0.5);
            self.reader.forgive(error, "one of the two is taken")?;
            return Ok(if heavier { second } else { first });
        }
        let two_sided = first.two_sided || second.two_sided;
        let body = Material::Mix { first: Box::new(first.body), second: Box::new(second.body), weight };
        Ok(Parts { relief: first.relief, body, two_sided, vertex_colors: false })
    }
}

/// Whether light passes to the other side.
fn transmits(material: &Material) -> bool {
    match material {
        Material::Dielectric { .. }
        | Material::ThinDielectric { .. }
        | Material::Mask { .. }
        | Material::PrincipledThin(_) => true,
        Material::Principled(p) => p.spec_trans != Texture::Constant(0.0),
        Material::Relief { material, .. } => transmits(material),
        Material::Mix { first, second, .. } => transmits(first) || transmits(second),
        Material::Lambert { .. } | Material::Conductor { .. } | Material::Plastic { .. } => false,
    }
}
