//! Scattering at surfaces.
//!
//! Rough lobes follow light to one microfacet and no further: what would leave after a second reflection is lost. The
//! masking function is separable, as in [Walter et al. 2007]. For a rough conductor that absorbs nothing, the directional
//! albedo falls short of 1 by so many per cent, by quadrature; angles are between `wo` and the normal:
//!
//! | distribution | alpha | 0° | 45° | 60° | 80° | 89° |
//! | --- | --- | --- | --- | --- | --- | --- |
//! | Ggx | 0.05 | 0.3 | 0.4 | 0.7 | 4.7 | 9.7 |
//! | Ggx | 0.1 | 1.2 | 1.8 | 3.1 | 10.8 | 8.8 |
//! | Ggx | 0.2 | 5.2 | 7.6 | 10.6 | 15.2 | 9.9 |
//! | Ggx | 0.3 | 12.3 | 15.6 | 18.2 | 17.9 | 12.4 |
//! | Ggx | 0.5 | 31.2 | 32.2 | 31.4 | 25.3 | 19.3 |
//! | Ggx | 0.7 | 49.6 | 46.8 | 43.4 | 34.3 | 27.5 |
//! | Ggx | 1 | 69.3 | 64.0 | 59.1 | 47.7 | 39.7 |
//! | Beckmann | 0.05 | 0.0 | 0.0 | 0.0 | 0.6 | 6.5 |
//! | Beckmann | 0.1 | 0.0 | 0.0 | 0.0 | 6.1 | 4.7 |
//! | Beckmann | 0.2 | 0.0 | 0.3 | 2.7 | 9.1 | 4.0 |
//! | Beckmann | 0.3 | 0.0 | 3.3 | 7.6 | 9.0 | 3.9 |
//! | Beckmann | 0.5 | 5.7 | 12.5 | 12.9 | 8.2 | 4.3 |
//! | Beckmann | 0.7 | 25.1 | 20.5 | 16.5 | 8.6 | 5.2 |
//! | Beckmann | 1 | 53.8 | 35.1 | 24.6 | 11.7 | 7.7 |
//!
//! The masking of the Beckmann distribution is the rational approximation of [Walter et al. 2007, eq. 27], within 0.35 %
//! of the exact one; so far can the albedo exceed what conserves energy.

mod beckmann;
mod conductor;
mod dielectric;
pub mod fresnel;
mod lambert;
mod microfacet;
mod shading;

pub use shading::shading_correction;

use crate::{has, rgb::Rgb, warp::ONE_MINUS_EPSILON};
use glam::{Vec2, Vec3};

/// What a path carries: it decides the scaling at a refracting boundary [Veach 1997, sec. 5.2].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// The path started at the camera; radiance flows against it.
    Radiance,
    /// The path started at a light; importance flows against it.
    Importance,
}

/// Microfacet distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Trowbridge-Reitz [Walter et al. 2007].
    Ggx,
    /// Beckmann [Walter et al. 2007].
    Beckmann,
}

/// Roughness of a microfacet surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Shape of the distribution.
    pub distribution: Distribution,
    /// Roughness along the tangent and the bitangent, each in `[1e-4, 1]`.
    pub alpha: Vec2,
}

/// Reflectance of a conductor at its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConductorFresnel {
    /// The same at every angle: an ideal mirror is `Constant(Rgb::WHITE)`.
    Constant(Rgb),
    /// Complex index of refraction `eta + i k` relative to the outside, times a tint.
    Complex {
        /// Real part.
        eta: Rgb,
        /// Imaginary part (extinction), positive.
        k: Rgb,
        /// Factor on the reflectance.
        tint: Rgb,
    },
}

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
    },
    /// Rough dielectric boundary [Walter et al. 2007].
    RoughDielectric {
        /// Index of refraction inside over outside.
        eta: f32,
        /// Microfacet distribution.
        roughness: Roughness,
    },
}

/// How a surface scatters at a point: one lobe, or two mixed. Directions are in the local shading frame: `z` is the
/// shading normal, `wo` points to where the path came from, `wi` to where it goes, both away from the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bsdf {
    /// The first lobe.
    pub first: Lobe,
    /// The second lobe and its share in `[0, 1]`; the first has the rest.
    pub second: Option<(Lobe, f32)>,
    /// Whether the back side scatters as the front side does (opaque lobes only; a dielectric has both sides anyway).
    pub two_sided: bool,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The direction, unit length, local.
    pub wi: Vec3,
    /// `f(wo, wi) |cos wi| / pdf`.
    pub weight: Rgb,
    /// Density per steradian of all lobes together; for a delta lobe the probability of choosing it.
    pub pdf_w: f32,
    /// Whether the direction comes from a delta lobe.
    pub delta: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: 1 for a reflection.
    pub eta: f32,
}

/// Value and density where a surface does not connect two directions.
const NOTHING: (Rgb, f32) = (Rgb::BLACK, 0.0);

/// Mirrors a direction about the surface's plane.
#[inline]
fn flip(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, -w.z)
}

/// Both directions in front of an opaque surface, if the surface reflects between them.
#[inline]
fn in_front(wo: Vec3, wi: Vec3, two_sided: bool) -> Option<(Vec3, Vec3)> {
    if wo.z > 0.0 && wi.z > 0.0 {
        Some((wo, wi))
    } else if two_sided && wo.z < 0.0 && wi.z < 0.0 {
        Some((flip(wo), flip(wi)))
    } else {
        None
    }
}

impl Lobe {
    /// Whether the lobe scatters into single directions only. So does a rough dielectric with `eta` so near to 1 that
    /// `|eta - 1| alpha` is below the resolution of directions: it counts as smooth.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Lobe::Lambert { .. } | Lobe::RoughConductor { .. } => false,
            Lobe::Conductor { .. } | Lobe::Dielectric { .. } => true,
            Lobe::RoughDielectric { eta, roughness } => !dielectric::resolves(*eta, roughness),
        }
    }

    /// Whether it changes when the surface is turned about its normal.
    #[inline]
    pub fn is_anisotropic(&self) -> bool {
        match self {
            Lobe::Lambert { .. } | Lobe::Conductor { .. } | Lobe::Dielectric { .. } => false,
            Lobe::RoughConductor { roughness, .. } | Lobe::RoughDielectric { roughness, .. } => {
                roughness.alpha.x != roughness.alpha.y
            }
        }
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode, two_sided: bool) -> (Rgb, f32) {
        match self {
            Lobe::Lambert { reflectance } => match in_front(wo, wi, two_sided) {
                Some((_, wi)) => lambert::eval_pdf(*reflectance, wi.z),
                None => NOTHING,
            },
            Lobe::RoughConductor { fresnel, roughness } => match in_front(wo, wi, two_sided) {
                Some((wo, wi)) => conductor::eval_pdf(fresnel, roughness, wo, wi),
                None => NOTHING,
            },
            Lobe::RoughDielectric { eta, roughness } => {
                if wo.z == 0.0 || wi.z == 0.0 || !dielectric::resolves(*eta, roughness) {
                    return NOTHING;
                }
                let turned = wo.z < 0.0;
                let (wo, wi) = if turned { (flip(wo), flip(wi)) } else { (wo, wi) };
                let eta = dielectric::relative(*eta, turned);
                let (value, pdf_w) = dielectric::eval_pdf(roughness, wo, wi, eta, mode);
                (Rgb::splat(value), pdf_w)
            }
            Lobe::Conductor { .. } | Lobe::Dielectric { .. } => NOTHING,
        }
    }

    /// A proposal of this lobe alone.
    #[inline]
    fn propose(&self, wo: Vec3, choice: f32, u: Vec2, mode: TransportMode, two_sided: bool) -> Option<Proposal> {
        let turned = wo.z < 0.0;
        let opaque = !matches!(self, Lobe::Dielectric { .. } | Lobe::RoughDielectric { .. });
        // Neither side, or the black back; a NaN as well.
        if !(wo.z > 0.0 || turned) || (opaque && turned && !two_sided) {
            return None;
        }
        let up = if turned { flip(wo) } else { wo };
        let proposal = match self {
            Lobe::Lambert { .. } => Proposal::Direction(lambert::sample(u), 1.0),
            Lobe::Conductor { fresnel } => Proposal::Delta(conductor::sample_smooth(fresnel, up)),
            Lobe::RoughConductor { roughness, .. } => Proposal::Direction(conductor::sample(roughness, up, u)?, 1.0),
            Lobe::Dielectric { eta } => {
                let eta = dielectric::relative(*eta, turned);
                Proposal::Delta(dielectric::sample_smooth(up, eta, choice, mode)?)
            }
            Lobe::RoughDielectric { eta, roughness } => {
                let smooth = !dielectric::resolves(*eta, roughness);
                let eta = dielectric::relative(*eta, turned);
                if smooth {
                    Proposal::Delta(dielectric::sample_smooth(up, eta, choice, mode)?)
                } else {
                    let (wi, eta) = dielectric::sample(roughness, up, eta, choice, u)?;
                    Proposal::Direction(wi, eta)
                }
            }
        };
        Some(if turned { proposal.flipped() } else { proposal })
    }
}

/// What a lobe proposes.
enum Proposal {
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

/// The methods that take `HAS` are compiled for the features of a scene ([`crate::has`]). Without [`has::LOBES`] the
/// caller knows that every BSDF is a single Lambert lobe, and nothing branches on the kind of lobe; with other lobes
/// the result would then be black.
impl Bsdf {
    /// A single lobe.
    #[inline]
    pub const fn single(lobe: Lobe, two_sided: bool) -> Bsdf {
        Bsdf { first: lobe, second: None, two_sided }
    }

    /// Constant diffuse reflection with an albedo in `[0, 1]`.
    #[inline]
    pub const fn lambert(reflectance: Rgb, two_sided: bool) -> Bsdf {
        Bsdf::single(Lobe::Lambert { reflectance }, two_sided)
    }

    /// Whether every lobe scatters into single directions only, so that no connection to a given point is possible.
    #[inline]
    pub fn is_delta(&self) -> bool {
        self.first.is_delta() && self.second.is_none_or(|(lobe, _)| lobe.is_delta())
    }

    /// Whether some lobe scatters into single directions.
    #[inline]
    pub fn has_delta(&self) -> bool {
        self.first.is_delta() || self.second.is_some_and(|(lobe, _)| lobe.is_delta())
    }

    /// Whether some lobe changes when the surface is turned about its normal.
    #[inline]
    pub fn is_anisotropic(&self) -> bool {
        self.first.is_anisotropic() || self.second.is_some_and(|(lobe, _)| lobe.is_anisotropic())
    }

    /// The BSDF `f(wo, wi)` in 1/sr, without the cosine; delta lobes count nothing.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        self.eval_pdf::<{ has::ALL }>(wo, wi, mode).0
    }

    /// The density per steradian with which [`Bsdf::sample`] chooses `wi`; delta lobes count nothing.
    #[inline]
    pub fn pdf_w(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval_pdf::<{ has::ALL }>(wo, wi, TransportMode::Radiance).1
    }

    /// [`Bsdf::eval`] and [`Bsdf::pdf_w`] at once.
    #[inline]
    pub fn eval_pdf<const HAS: u32>(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        if HAS & has::LOBES == 0 {
            return match in_front(wo, wi, self.two_sided) {
                Some((_, wi)) => lambert::eval_pdf(self.lambert_reflectance(), wi.z),
                None => NOTHING,
            };
        }
        let (value, pdf_w) = self.first.eval_pdf(wo, wi, mode, self.two_sided);
        match &self.second {
            None => (value, pdf_w),
            Some((lobe, share)) => {
                let (second_value, second_pdf_w) = lobe.eval_pdf(wo, wi, mode, self.two_sided);
                let rest = 1.0 - share;
                (value * rest + second_value * *share, pdf_w * rest + second_pdf_w * share)
            }
        }
    }

    /// Chooses a direction. `u_lobe` chooses among lobes and between reflection and refraction, `u` the direction.
    ///
    /// `None` where nothing is scattered: on the black back of an opaque surface, or where a microfacet sends light
    /// below the horizon.
    #[inline]
    pub fn sample<const HAS: u32>(&self, wo: Vec3, u_lobe: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if HAS & has::LOBES == 0 {
            return self.sample_lambert(self.lambert_reflectance(), wo, u);
        }
        let (lobe, share, choice) = match &self.second {
            None => match &self.first {
                Lobe::Lambert { reflectance } => return self.sample_lambert(*reflectance, wo, u),
                first => (first, 1.0, u_lobe),
            },
            // The rest of u_lobe, stretched to the unit interval, chooses inside the lobe.
            Some((second, share)) if u_lobe < *share => (second, *share, u_lobe / share),
            Some((_, share)) => (&self.first, 1.0 - share, (u_lobe - share) / (1.0 - share)),
        };
        match lobe.propose(wo, choice.min(ONE_MINUS_EPSILON), u, mode, self.two_sided)? {
            Proposal::Delta(sample) => Some(BsdfSample { pdf_w: sample.pdf_w * share, ..sample }),
            Proposal::Direction(wi, eta) => {
                let (value, pdf_w) = self.eval_pdf::<HAS>(wo, wi, mode);
                // Rounding can leave a direction on the border of the support outside it.
                (pdf_w > 0.0).then(|| {
                    let weight = value * (wi.z.abs() / pdf_w);
                    BsdfSample { wi, weight, pdf_w, delta: false, eta }
                })
            }
        }
    }

    /// Sampling of a single Lambert lobe: the weight is the albedo exactly.
    #[inline]
    fn sample_lambert(&self, reflectance: Rgb, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        let wi = lambert::sample(u);
        let wi = if wo.z > 0.0 {
            wi
        } else if self.two_sided && wo.z < 0.0 {
            flip(wi)
        } else {
            return None;
        };
        let (_, pdf_w) = lambert::eval_pdf(reflectance, wi.z.abs());
        Some(BsdfSample { wi, weight: reflectance, pdf_w, delta: false, eta: 1.0 })
    }

    /// The albedo of the first lobe where it is known to be Lambert.
    #[inline]
    fn lambert_reflectance(&self) -> Rgb {
        match self.first {
            Lobe::Lambert { reflectance } => reflectance,
            _ => Rgb::BLACK,
        }
    }
}
