//! The ways of scattering, and which code each is.

use super::{
    BsdfSample, ConductorFresnel, NOTHING, Plastic, Principled, PrincipledThin, RoughPlastic, Roughness, TransportMode,
    conductor, dielectric, flip, in_front, lambert,
};
use crate::rgb::Rgb;
use glam::{Vec2, Vec3};

/// One way of scattering, by value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// Constant diffuse reflection.
    Lambert {
        /// Albedo.
        reflectance: Rgb,
    },
    /// Smooth conductor: a mirror.
    Conductor {
        /// Reflectance.
        fresnel: ConductorFresnel,
    },
    /// Rough conductor (Torrance-Sparrow with separable Smith masking).
    RoughConductor {
        /// Reflectance at the microfacets.
        fresnel: ConductorFresnel,
        /// Microfacet distribution.
        roughness: Roughness,
    },
    /// Smooth dielectric boundary: reflects and refracts.
    Dielectric {
        /// Index of refraction inside over outside; outside is where the normal points.
        eta: f32,
        /// Factor on what is reflected.
        reflectance: Rgb,
        /// Factor on what is transmitted.
        transmittance: Rgb,
    },
    /// Rough dielectric boundary [Walter et al. 2007].
    RoughDielectric {
        /// Index of refraction inside over outside.
        eta: f32,
        /// Microfacet distribution.
        roughness: Roughness,
        /// Factor on what is reflected.
        reflectance: Rgb,
        /// Factor on what is transmitted.
        transmittance: Rgb,
    },
    /// Thin sheet of a dielectric: reflects, and lets light straight through, reflections between its faces included.
    ThinDielectric {
        /// Index of refraction of the sheet over that around it.
        eta: f32,
        /// Factor on what is reflected.
        reflectance: Rgb,
        /// Factor on what is transmitted.
        transmittance: Rgb,
    },
    /// Nothing at all: light passes straight through.
    Null,
    /// Diffuse body under a smooth coat.
    Plastic(Plastic),
    /// Diffuse body under a rough coat.
    RoughPlastic(RoughPlastic),
    /// The principled material.
    Principled(Principled),
    /// The principled material of a thin sheet.
    PrincipledThin(PrincipledThin),
}

impl Lobe {
    /// A smooth, clear dielectric boundary; `eta` is the index of refraction inside over outside.
    #[inline]
    pub const fn dielectric(eta: f32) -> Lobe {
        Lobe::Dielectric { eta, reflectance: Rgb::WHITE, transmittance: Rgb::WHITE }
    }

    /// A rough, clear dielectric boundary.
    #[inline]
    pub const fn rough_dielectric(eta: f32, roughness: Roughness) -> Lobe {
        Lobe::RoughDielectric { eta, roughness, reflectance: Rgb::WHITE, transmittance: Rgb::WHITE }
    }

    /// Whether the lobe scatters into single directions only. So does a rough dielectric with `eta` so near to 1 that
    /// `|eta - 1| alpha` is below the resolution of directions: it counts as smooth.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Lobe::Lambert { .. }
            | Lobe::RoughConductor { .. }
            | Lobe::RoughPlastic(_)
            | Lobe::Principled(_)
            | Lobe::PrincipledThin(_) => false,
            Lobe::Conductor { .. } | Lobe::Dielectric { .. } | Lobe::ThinDielectric { .. } | Lobe::Null => true,
            Lobe::RoughDielectric { eta, roughness, .. } => !dielectric::resolves(*eta, roughness),
            Lobe::Plastic(plastic) => plastic.is_delta(),
        }
    }

    /// Whether the lobe or a part of it scatters into single directions.
    #[inline]
    pub fn has_delta(&self) -> bool {
        match self {
            Lobe::Plastic(plastic) => plastic.has_delta(),
            other => other.is_delta(),
        }
    }

    /// Returns `true` if the lobe or a part of it is diffuse.
    #[inline]
    pub(super) fn has_diffuse(&self) -> bool {
        match self {
            Lobe::Lambert { .. }
            | Lobe::Plastic(_)
            | Lobe::RoughPlastic(_)
            | Lobe::Principled(_)
            | Lobe::PrincipledThin(_) => true,
            Lobe::Conductor { .. }
            | Lobe::RoughConductor { .. }
            | Lobe::Dielectric { .. }
            | Lobe::RoughDielectric { .. }
            | Lobe::ThinDielectric { .. }
            | Lobe::Null => false,
        }
    }

    /// The microfacet roughness of the widest part, along the narrower axis: 0 for single directions, 1 for diffuse scattering.
    #[inline]
    pub fn width(&self) -> f32 {
        match self {
            _ if self.is_delta() => 0.0,
            Lobe::RoughConductor { roughness, .. } | Lobe::RoughDielectric { roughness, .. } => {
                roughness.alpha.min_element()
            }
            Lobe::Principled(principled) => principled.width(),
            Lobe::PrincipledThin(principled) => principled.width(),
            Lobe::RoughPlastic(plastic) => plastic.width(),
            _ => 1.0,
        }
    }

    /// Whether it changes when the surface is turned about its normal.
    #[inline]
    pub fn is_anisotropic(&self) -> bool {
        match self {
            Lobe::Lambert { .. }
            | Lobe::Conductor { .. }
            | Lobe::Dielectric { .. }
            | Lobe::ThinDielectric { .. }
            | Lobe::Null
            | Lobe::Plastic(_)
            | Lobe::RoughPlastic(_) => false,
            Lobe::RoughConductor { roughness, .. } | Lobe::RoughDielectric { roughness, .. } => {
                roughness.alpha.x != roughness.alpha.y
            }
            Lobe::Principled(principled) => principled.anisotropic != 0.0,
            Lobe::PrincipledThin(principled) => principled.anisotropic != 0.0,
        }
    }

    /// Whether no light passes, so that there is only what the front reflects, and the back if it has two sides.
    #[inline]
    pub(super) fn is_opaque(&self) -> bool {
        match self {
            Lobe::Lambert { .. }
            | Lobe::Conductor { .. }
            | Lobe::RoughConductor { .. }
            | Lobe::Plastic(_)
            | Lobe::RoughPlastic(_) => true,
            Lobe::Dielectric { .. }
            | Lobe::RoughDielectric { .. }
            | Lobe::ThinDielectric { .. }
            | Lobe::Null
            | Lobe::PrincipledThin(_) => false,
            Lobe::Principled(principled) => principled.is_opaque(),
        }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode, two_sided: bool) -> (Rgb, f32) {
        match self {
            Lobe::Lambert { reflectance } => match in_front(wo, wi, two_sided) {
                Some((_, wi)) => lambert::eval_pdf(*reflectance, wi.z),
                None => NOTHING,
            },
            Lobe::RoughConductor { fresnel, roughness } => match in_front(wo, wi, two_sided) {
                Some((wo, wi)) => conductor::eval_pdf(fresnel, roughness, wo, wi),
                None => NOTHING,
            },
            Lobe::RoughDielectric { eta, roughness, reflectance, transmittance } => {
                if wo.z == 0.0 || wi.z == 0.0 || !dielectric::resolves(*eta, roughness) {
                    return NOTHING;
                }
                let turned = wo.z < 0.0;
                let (wo, wi) = if turned { (flip(wo), flip(wi)) } else { (wo, wi) };
                let eta = dielectric::relative(*eta, turned);
                let (value, pdf_w) = dielectric::eval_pdf(roughness, wo, wi, eta, mode);
                (if wi.z > 0.0 { *reflectance } else { *transmittance } * value, pdf_w)
            }
            Lobe::Conductor { .. } | Lobe::Dielectric { .. } | Lobe::ThinDielectric { .. } | Lobe::Null => NOTHING,
            Lobe::Plastic(plastic) => match in_front(wo, wi, two_sided) {
                Some((wo, wi)) => plastic.eval_pdf(wo, wi),
                None => NOTHING,
            },
            Lobe::RoughPlastic(plastic) => match in_front(wo, wi, two_sided) {
                Some((wo, wi)) => plastic.eval_pdf(wo, wi),
                None => NOTHING,
            },
            Lobe::Principled(principled) => {
                if principled.is_opaque() {
                    return match in_front(wo, wi, two_sided) {
                        Some((wo, wi)) => principled.eval_pdf(wo, wi, true, mode),
                        None => NOTHING,
                    };
                }
                if wo.z == 0.0 || wi.z == 0.0 {
                    return NOTHING;
                }
                let turned = wo.z < 0.0;
                let (wo, wi) = if turned { (flip(wo), flip(wi)) } else { (wo, wi) };
                principled.eval_pdf(wo, wi, !turned, mode)
            }
            Lobe::PrincipledThin(principled) => {
                if wo.z == 0.0 || wi.z == 0.0 {
                    return NOTHING;
                }
                let (wo, wi) = if wo.z < 0.0 { (flip(wo), flip(wi)) } else { (wo, wi) };
                principled.eval_pdf(wo, wi)
            }
        }
    }

    /// A proposal of this lobe alone.
    #[inline]
    pub(super) fn propose(
        &self,
        wo: Vec3,
        choice: f32,
        u: Vec2,
        mode: TransportMode,
        two_sided: bool,
    ) -> Option<Proposal> {
        let turned = wo.z < 0.0;
        let opaque = self.is_opaque();
        // Neither side, or the black back; a NaN as well.
        if !(wo.z > 0.0 || turned) || (opaque && turned && !two_sided) {
            return None;
        }
        let up = if turned { flip(wo) } else { wo };
        let proposal = match self {
            Lobe::Lambert { .. } => Proposal::Direction(lambert::sample(u), 1.0),
            Lobe::Conductor { fresnel } => Proposal::Delta(conductor::sample_smooth(fresnel, up)),
            Lobe::RoughConductor { roughness, .. } => Proposal::Direction(conductor::sample(roughness, up, u)?, 1.0),
            Lobe::Dielectric { eta, reflectance, transmittance } => {
                let eta = dielectric::relative(*eta, turned);
                let tints = [*reflectance, *transmittance];
                Proposal::Delta(dielectric::sample_smooth(up, eta, tints, choice, mode)?)
            }
            Lobe::RoughDielectric { eta, roughness, reflectance, transmittance } => {
                let smooth = !dielectric::resolves(*eta, roughness);
                let eta = dielectric::relative(*eta, turned);
                if smooth {
                    let tints = [*reflectance, *transmittance];
                    Proposal::Delta(dielectric::sample_smooth(up, eta, tints, choice, mode)?)
                } else {
                    let (wi, eta) = dielectric::sample(roughness, up, eta, choice, u)?;
                    Proposal::Direction(wi, eta)
                }
            }
            Lobe::ThinDielectric { eta, reflectance, transmittance } => {
                Proposal::Delta(dielectric::sample_thin(up, *eta, [*reflectance, *transmittance], choice))
            }
            Lobe::Null => {
                Proposal::Delta(BsdfSample { wi: -up, weight: Rgb::WHITE, pdf_w: 1.0, delta: true, eta: 1.0 })
            }
            Lobe::Plastic(plastic) => match plastic.sample_coat(up, choice) {
                Some(sample) => Proposal::Delta(sample),
                None => Proposal::Direction(lambert::sample(u), 1.0),
            },
            Lobe::RoughPlastic(plastic) => Proposal::Direction(plastic.sample(up, choice, u)?, 1.0),
            Lobe::Principled(principled) => {
                let (wi, eta) = principled.sample(up, opaque || !turned, choice, u)?;
                Proposal::Direction(wi, eta)
            }
            Lobe::PrincipledThin(principled) => Proposal::Direction(principled.sample(up, choice, u)?, 1.0),
        };
        Some(if turned { proposal.flipped() } else { proposal })
    }
}

/// What a lobe proposes.
pub(super) enum Proposal {
    /// A whole sample of a delta lobe.
    Delta(BsdfSample),
    /// A direction, whose density depends on the other lobes too, and the quotient of the indices of refraction.
    Direction(Vec3, f32),
}

impl Proposal {
    #[inline]
    fn flipped(self) -> Proposal {
        match self {
            Proposal::Delta(sample) => Proposal::Delta(BsdfSample { wi: flip(sample.wi), ..sample }),
            Proposal::Direction(wi, eta) => Proposal::Direction(flip(wi), eta),
        }
    }
}
