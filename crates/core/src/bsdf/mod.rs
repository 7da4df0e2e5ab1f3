//! Scattering at surfaces.
//!
//! A [`Bsdf`] is one [`Lobe`] or two mixed; one of the two may be [`Lobe::Null`], which makes the other a material with
//! holes. A lobe is rough, or scatters into single directions, or does both in parts (smooth [`Plastic`]); see
//! [`Bsdf::is_delta`] and [`Bsdf::has_delta`].
//!
//! The coats and the principled materials have the values that Mitsuba 3.9.1 gives them; their modules say where not.
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
mod burley;
mod choice;
mod clearcoat;
mod conductor;
mod dielectric;
pub mod fresnel;
mod lambert;
mod lobe;
mod microfacet;
mod plastic;
mod principled;
mod principled_thin;
mod rough_plastic;
mod shading;

pub(crate) use burley::principled_alpha;
pub(crate) use clearcoat::alpha as clearcoat_alpha;
pub use lobe::Lobe;
pub use plastic::Plastic;
pub use principled::Principled;
pub use principled_thin::PrincipledThin;
pub(crate) use principled_thin::thin_roughness;
pub use rough_plastic::RoughPlastic;
pub use shading::shading_correction;

use crate::{has, rgb::Rgb, warp::ONE_MINUS_EPSILON};
use glam::{Vec2, Vec3};
use lobe::Proposal;

/// What a path carries: it decides the scaling at a refracting boundary [Veach 1997, sec. 5.2].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// The path started at the camera; radiance flows against it.
    Radiance,
    /// The path started at a light; importance flows against it.
    Importance,
}

impl TransportMode {
    /// The mode of a path in the other direction.
    #[inline]
    pub const fn reversed(self) -> TransportMode {
        match self {
            TransportMode::Radiance => TransportMode::Importance,
            TransportMode::Importance => TransportMode::Radiance,
        }
    }
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

/// How a surface scatters at a point: one lobe, or two mixed. Directions are in the local shading frame: `z` is the
/// shading normal, `wo` points to where the path came from, `wi` to where it goes, both away from the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bsdf {
    /// The first lobe.
    pub first: Lobe,
    /// The second lobe and its share in `[0, 1]`; the first has the rest.
    pub second: Option<(Lobe, f32)>,
    /// Whether the back side scatters as the front side does (opaque lobes only; what light passes has both sides
    /// anyway).
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

    /// Whether every lobe scatters into single directions only, so that no connection to a given point is possible:
    /// [`Bsdf::eval`] and [`Bsdf::pdf_w`] are 0 everywhere, and every sample says [`BsdfSample::delta`].
    #[inline]
    pub fn is_delta(&self) -> bool {
        self.first.is_delta() && self.second.is_none_or(|(lobe, _)| lobe.is_delta())
    }

    /// Whether some lobe, or a part of one as the coat of smooth plastic, scatters into single directions: a sample may
    /// say [`BsdfSample::delta`]. Where this holds and [`Bsdf::is_delta`] does not, connections find a part of the light
    /// and samples the rest.
    #[inline]
    pub fn has_delta(&self) -> bool {
        self.first.has_delta() || self.second.is_some_and(|(lobe, _)| lobe.has_delta())
    }

    /// Returns `true` for a single Lambert lobe.
    #[inline]
    pub(crate) fn is_lambert(&self) -> bool {
        matches!((&self.first, &self.second), (Lobe::Lambert { .. }, None))
    }

    /// Returns `true` if a lobe has a diffuse part, whose value does not vanish towards the horizon.
    #[inline]
    pub(crate) fn has_diffuse(&self) -> bool {
        self.first.has_diffuse() || self.second.is_some_and(|(lobe, _)| lobe.has_diffuse())
    }

    /// Whether some lobe changes when the surface is turned about its normal.
    #[inline]
    pub fn is_anisotropic(&self) -> bool {
        self.first.is_anisotropic() || self.second.is_some_and(|(lobe, _)| lobe.is_anisotropic())
    }

    /// Whether there is a back that scatters as the front does: it has two sides, and but for holes lets nothing through.
    #[inline]
    pub fn has_opaque_back(&self) -> bool {
        let opaque = |lobe: &Lobe| lobe.is_opaque() || matches!(lobe, Lobe::Null);
        self.two_sided && opaque(&self.first) && self.second.as_ref().is_none_or(|(lobe, _)| opaque(lobe))
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
        // Most surfaces of most scenes: not worth the way through all kinds of lobe.
        let plain = match (&self.first, &self.second) {
            _ if HAS & has::LOBES == 0 => Some(self.lambert_reflectance()),
            (Lobe::Lambert { reflectance }, None) => Some(*reflectance),
            _ => None,
        };
        if let Some(reflectance) = plain {
            return match in_front(wo, wi, self.two_sided) {
                Some((_, wi)) => lambert::eval_pdf(reflectance, wi.z),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_vertex_carries_two_cache_lines_of_scattering() {
        assert_eq!((size_of::<Lobe>(), size_of::<Bsdf>()), (60, 128));
    }
}
