//! Materials: what a scene's surfaces are made of, before they are hit.

pub use crate::relief::{Bitangent, Relief};

use crate::{
    bsdf::{self, Bsdf, ConductorFresnel, Distribution, Lobe, Plastic, RoughPlastic, Roughness},
    rgb::Rgb,
    texture::{Texture, TexturePoint},
};
use glam::Vec2;

/// Roughness of a microfacet surface that may vary over it.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughnessTexture {
    /// Shape of the distribution.
    pub distribution: Distribution,
    /// Roughness along the tangent, each value in `[1e-4, 1]`.
    pub alpha_u: Texture<f32>,
    /// Roughness along the bitangent, each value in `[1e-4, 1]`.
    pub alpha_v: Texture<f32>,
}

impl RoughnessTexture {
    /// The same everywhere.
    pub fn constant(roughness: Roughness) -> RoughnessTexture {
        let Roughness { distribution, alpha } = roughness;
        RoughnessTexture { distribution, alpha_u: alpha.x.into(), alpha_v: alpha.y.into() }
    }

    fn at(&self, point: &TexturePoint) -> Roughness {
        let alpha = Vec2::new(self.alpha_u.at(point), self.alpha_v.at(point));
        Roughness { distribution: self.distribution, alpha }
    }

    fn is_constant(&self) -> bool {
        self.alpha_u.is_constant() && self.alpha_v.is_constant()
    }
}

/// A surface's scattering as a scene describes it; [`Material::bsdf`] gives it at a point.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Diffuse reflection.
    Lambert {
        /// Albedo in `[0, 1]`.
        reflectance: Texture<Rgb>,
    },
    /// Conductor, smooth without a roughness.
    Conductor {
        /// Reflectance.
        fresnel: ConductorFresnel,
        /// Factor on the reflectance, in `[0, 1]`.
        tint: Texture<Rgb>,
        /// Microfacet roughness.
        roughness: Option<RoughnessTexture>,
    },
    /// Dielectric boundary, smooth without a roughness.
    Dielectric {
        /// Index of refraction inside over outside, positive; outside is where the normal points.
        eta: f32,
        /// Factor on what is reflected, in `[0, 1]`.
        reflectance: Texture<Rgb>,
        /// Factor on what is transmitted, in `[0, 1]`.
        transmittance: Texture<Rgb>,
        /// Microfacet roughness.
        roughness: Option<RoughnessTexture>,
    },
    /// A thin sheet of a dielectric: light passes straight through, all reflections between its faces included.
    ThinDielectric {
        /// Index of refraction of the sheet over that around it, positive.
        eta: f32,
        /// Factor on what is reflected, in `[0, 1]`.
        reflectance: Texture<Rgb>,
        /// Factor on what is transmitted, in `[0, 1]`.
        transmittance: Texture<Rgb>,
    },
    /// A diffuse body under a dielectric coat, smooth without a roughness.
    Plastic {
        /// Index of refraction of the coat over that around it, positive.
        eta: f32,
        /// Albedo of the body, in `[0, 1]`.
        diffuse: Texture<Rgb>,
        /// Factor on what the coat reflects, in `[0, 1]`.
        specular: Texture<Rgb>,
        /// Whether colour shifts by reflections under the coat are followed.
        nonlinear: bool,
        /// Microfacet roughness of the coat, the same in each direction and everywhere.
        roughness: Option<(Distribution, f32)>,
    },
    /// The principled material of [Burley 2012, 2015].
    Principled(Box<Principled>),
    /// The thin-walled principled material of [Burley 2015].
    PrincipledThin(Box<PrincipledThin>),
    /// Two materials, neither of them a mixture, side by side.
    Mix {
        /// Has the share `1 - weight`.
        first: Box<Material>,
        /// Has the share `weight`.
        second: Box<Material>,
        /// In `[0, 1]`.
        weight: Texture<f32>,
    },
    /// A material with holes: the rest of the light passes straight through. No mixture inside.
    Mask {
        /// Share of what is there, in `[0, 1]`.
        opacity: Texture<f32>,
        /// What is there.
        material: Box<Material>,
    },
    /// A material whose shading normals a texture changes.
    Relief {
        /// How.
        relief: Relief,
        /// The material.
        material: Box<Material>,
    },
}

/// Parameters of the principled material, all in `[0, 1]` where not said otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Principled {
    /// Colour of the body.
    pub base_color: Texture<Rgb>,
    /// Roughness; the square of it is the microfacet roughness.
    pub roughness: Texture<f32>,
    /// Stretch of the highlights.
    pub anisotropic: Texture<f32>,
    /// Share of a metal.
    pub metallic: Texture<f32>,
    /// Share of specular transmission.
    pub spec_trans: Texture<f32>,
    /// Index of refraction inside over outside, positive.
    pub eta: f32,
    /// How far specular reflection takes the base colour.
    pub spec_tint: Texture<f32>,
    /// Sheen, as of cloth.
    pub sheen: Texture<f32>,
    /// How far sheen takes the base colour.
    pub sheen_tint: Texture<f32>,
    /// How much of the diffuse reflection follows an approximation of subsurface scattering.
    pub flatness: Texture<f32>,
    /// A second, clear coat.
    pub clearcoat: Texture<f32>,
    /// Its gloss.
    pub clearcoat_gloss: Texture<f32>,
}

/// Parameters of the thin principled material, all in `[0, 1]` where not said otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct PrincipledThin {
    /// Colour of the body.
    pub base_color: Texture<Rgb>,
    /// Roughness; the square of it is the microfacet roughness.
    pub roughness: Texture<f32>,
    /// Stretch of the highlights.
    pub anisotropic: Texture<f32>,
    /// Share of specular transmission.
    pub spec_trans: Texture<f32>,
    /// Index of refraction of the sheet over that around it, positive.
    pub eta: f32,
    /// How far specular reflection takes the base colour.
    pub spec_tint: Texture<f32>,
    /// Sheen, as of cloth.
    pub sheen: Texture<f32>,
    /// How far sheen takes the base colour.
    pub sheen_tint: Texture<f32>,
    /// How much of the diffuse reflection follows an approximation of subsurface scattering.
    pub flatness: Texture<f32>,
    /// Diffuse transmission, in `[0, 2]`: 1 shares evenly between both sides, 2 transmits all.
    pub diff_trans: Texture<f32>,
}

impl Material {
    /// A constant diffuse material.
    pub fn lambert(reflectance: Rgb) -> Material {
        Material::Lambert { reflectance: reflectance.into() }
    }

    /// A conductor without a tint, the same everywhere.
    pub fn conductor(fresnel: ConductorFresnel, roughness: Option<Roughness>) -> Material {
        Material::Conductor { fresnel, tint: Rgb::WHITE.into(), roughness: roughness.map(RoughnessTexture::constant) }
    }

    /// A clear dielectric, the same everywhere.
    pub fn dielectric(eta: f32, roughness: Option<Roughness>) -> Material {
        Material::Dielectric {
            eta,
            reflectance: Rgb::WHITE.into(),
            transmittance: Rgb::WHITE.into(),
            roughness: roughness.map(RoughnessTexture::constant),
        }
    }

    /// The scattering at a point, in the frame that the relief, if any, makes there.
    ///
    /// Of a mask the first lobe is [`Lobe::Null`] and the second what is there; where it has no hole or is nothing but a
    /// hole, there is one lobe. What [`crate::scene::Scene::new`] refuses (mixtures inside mixtures or masks) counts its
    /// first member alone.
    pub fn bsdf(&self, point: &TexturePoint, two_sided: bool) -> Bsdf {
        match self {
            Material::Mix { first, second, weight } => {
                Bsdf { first: first.lobe(point), second: Some((second.lobe(point), weight.at(point))), two_sided }
            }
            Material::Mask { opacity, material } => {
                let opacity = opacity.at(point);
                if opacity >= 1.0 {
                    Bsdf::single(material.lobe(point), two_sided)
                } else if opacity <= 0.0 {
                    Bsdf::single(Lobe::Null, two_sided)
                } else {
                    Bsdf { first: Lobe::Null, second: Some((material.lobe(point), opacity)), two_sided }
                }
            }
            Material::Relief { material, .. } => material.bsdf(point, two_sided),
            single => Bsdf::single(single.lobe(point), two_sided),
        }
    }

    /// Whether its scattering depends on the texture coordinates.
    pub fn is_textured(&self) -> bool {
        let rough = |r: &Option<RoughnessTexture>| r.as_ref().is_some_and(|r| !r.is_constant());
        match self {
            Material::Lambert { reflectance } => !reflectance.is_constant(),
            Material::Conductor { tint, roughness, .. } => !tint.is_constant() || rough(roughness),
            Material::Dielectric { reflectance, transmittance, roughness, .. } => {
                !reflectance.is_constant() || !transmittance.is_constant() || rough(roughness)
            }
            Material::ThinDielectric { reflectance, transmittance, .. } => {
                !reflectance.is_constant() || !transmittance.is_constant()
            }
            Material::Plastic { diffuse, specular, .. } => !diffuse.is_constant() || !specular.is_constant(),
            Material::Principled(p) => {
                let numbers = [
                    &p.roughness,
                    &p.anisotropic,
                    &p.metallic,
                    &p.spec_trans,
                    &p.spec_tint,
                    &p.sheen,
                    &p.sheen_tint,
                    &p.flatness,
                    &p.clearcoat,
                    &p.clearcoat_gloss,
                ];
                !p.base_color.is_constant() || numbers.iter().any(|t| !t.is_constant())
            }
            Material::PrincipledThin(p) => {
                let numbers = [
                    &p.roughness,
                    &p.anisotropic,
                    &p.spec_trans,
                    &p.spec_tint,
                    &p.sheen,
                    &p.sheen_tint,
                    &p.flatness,
                    &p.diff_trans,
                ];
                !p.base_color.is_constant() || numbers.iter().any(|t| !t.is_constant())
            }
            Material::Mix { first, second, weight } => {
                !weight.is_constant() || first.is_textured() || second.is_textured()
            }
            Material::Mask { opacity, material } => !opacity.is_constant() || material.is_textured(),
            // The normal depends on where it is hit.
            Material::Relief { .. } => true,
        }
    }

    fn lobe(&self, point: &TexturePoint) -> Lobe {
        match self {
            Material::Lambert { reflectance } => Lobe::Lambert { reflectance: reflectance.at(point) },
            Material::Conductor { fresnel, tint, roughness } => {
                let fresnel = fresnel.tinted(tint.at(point));
                match roughness {
                    None => Lobe::Conductor { fresnel },
                    Some(r) => Lobe::RoughConductor { fresnel, roughness: r.at(point) },
                }
            }
            Material::Dielectric { eta, reflectance, transmittance, roughness } => {
                let (eta, reflectance, transmittance) = (*eta, reflectance.at(point), transmittance.at(point));
                match roughness {
                    None => Lobe::Dielectric { eta, reflectance, transmittance },
                    Some(r) => Lobe::RoughDielectric { eta, roughness: r.at(point), reflectance, transmittance },
                }
            }
            Material::ThinDielectric { eta, reflectance, transmittance } => Lobe::ThinDielectric {
                eta: *eta,
                reflectance: reflectance.at(point),
                transmittance: transmittance.at(point),
            },
            Material::Plastic { eta, diffuse, specular, nonlinear, roughness } => {
                let (diffuse, specular) = (diffuse.at(point), specular.at(point));
                match roughness {
                    None => Lobe::Plastic(Plastic::new(*eta, diffuse, specular, *nonlinear)),
                    Some(r) => Lobe::RoughPlastic(RoughPlastic::new(*eta, *r, diffuse, specular, *nonlinear)),
                }
            }
            Material::Principled(p) => Lobe::Principled(p.at(point)),
            Material::PrincipledThin(p) => Lobe::PrincipledThin(p.at(point)),
            Material::Mix { first, .. } => first.lobe(point),
            Material::Mask { material, .. } | Material::Relief { material, .. } => material.lobe(point),
        }
    }
}

impl Principled {
    fn at(&self, point: &TexturePoint) -> bsdf::Principled {
        bsdf::Principled {
            base_color: self.base_color.at(point),
            roughness: self.roughness.at(point),
            anisotropic: self.anisotropic.at(point),
            metallic: self.metallic.at(point),
            spec_trans: self.spec_trans.at(point),
            eta: self.eta,
            spec_tint: self.spec_tint.at(point),
            sheen: self.sheen.at(point),
            sheen_tint: self.sheen_tint.at(point),
            flatness: self.flatness.at(point),
            clearcoat: self.clearcoat.at(point),
            clearcoat_gloss: self.clearcoat_gloss.at(point),
        }
    }
}

impl PrincipledThin {
    fn at(&self, point: &TexturePoint) -> bsdf::PrincipledThin {
        bsdf::PrincipledThin {
            base_color: self.base_color.at(point),
            roughness: self.roughness.at(point),
            anisotropic: self.anisotropic.at(point),
            spec_trans: self.spec_trans.at(point),
            eta: self.eta,
            spec_tint: self.spec_tint.at(point),
            sheen: self.sheen.at(point),
            sheen_tint: self.sheen_tint.at(point),
            flatness: self.flatness.at(point),
            diff_trans: self.diff_trans.at(point),
        }
    }
}
