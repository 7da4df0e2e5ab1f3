//! Materials: what a scene's surfaces are made of, before they are hit.

use crate::{
    bsdf::{Bsdf, ConductorFresnel, Lobe, Roughness},
    rgb::Rgb,
    texture::Texture,
};
use glam::Vec2;

/// A surface's scattering as a scene describes it; [`Material::bsdf`] gives it at a point.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Diffuse reflection.
    Lambert {
        /// Albedo in `[0, 1]`.
        reflectance: Texture,
    },
    /// Conductor, smooth without a roughness.
    Conductor {
        /// Reflectance.
        fresnel: ConductorFresnel,
        /// Microfacet roughness.
        roughness: Option<Roughness>,
    },
    /// Dielectric boundary, smooth without a roughness.
    Dielectric {
        /// Index of refraction inside over outside, positive; outside is where the normal points.
        eta: f32,
        /// Microfacet roughness.
        roughness: Option<Roughness>,
    },
    /// Two materials, neither of them a mixture, side by side in fixed shares.
    Mix {
        /// Has the share `1 - weight`.
        first: Box<Material>,
        /// Has the share `weight`.
        second: Box<Material>,
        /// In `[0, 1]`.
        weight: f32,
    },
}

impl Material {
    /// A constant diffuse material.
    pub fn lambert(reflectance: Rgb) -> Material {
        Material::Lambert { reflectance: Texture::Constant(reflectance) }
    }

    /// The scattering at texture coordinates `uv`.
    ///
    /// A mixture of mixtures, which [`crate::scene::Scene::new`] refuses, counts its first member's first lobe alone.
    pub fn bsdf(&self, uv: Vec2, two_sided: bool) -> Bsdf {
        match self {
            Material::Mix { first, second, weight } => {
                Bsdf { first: first.lobe(uv), second: Some((second.lobe(uv), *weight)), two_sided }
            }
            single => Bsdf { first: single.lobe(uv), second: None, two_sided },
        }
    }

    /// Whether its scattering depends on the texture coordinates.
    pub fn is_textured(&self) -> bool {
        match self {
            Material::Lambert { reflectance } => !matches!(reflectance, Texture::Constant(_)),
            Material::Conductor { .. } | Material::Dielectric { .. } => false,
            Material::Mix { first, second, .. } => first.is_textured() || second.is_textured(),
        }
    }

    fn lobe(&self, uv: Vec2) -> Lobe {
        match self {
            Material::Lambert { reflectance } => Lobe::Lambert { reflectance: reflectance.at(uv) },
            Material::Conductor { fresnel, roughness: None } => Lobe::Conductor { fresnel: *fresnel },
            Material::Conductor { fresnel, roughness: Some(r) } => {
                Lobe::RoughConductor { fresnel: *fresnel, roughness: *r }
            }
            Material::Dielectric { eta, roughness: None } => Lobe::Dielectric { eta: *eta },
            Material::Dielectric { eta, roughness: Some(r) } => Lobe::RoughDielectric { eta: *eta, roughness: *r },
            Material::Mix { first, .. } => first.lobe(uv),
        }
    }
}
