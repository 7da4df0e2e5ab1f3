//! Microfacet distributions: density, masking, visible normals.
//!
//! All quantities are computed from the components of directions, never from `1 - cos²`, so that they keep their
//! precision for roughness down to 1e-4 and for grazing directions.

use super::{Distribution, Roughness, beckmann};
use crate::warp::sin_cos_turn;
use glam::{Vec2, Vec2Swizzles, Vec3, Vec3Swizzles};
use std::f32::consts::FRAC_1_PI;

/// The half vector `wo + wi` of two directions above the surface, not normalised.
///
/// Where both graze from opposite sides, the horizontal components cancel and only their rounding errors would remain.
/// There the component along their difference `d` comes from the heights instead: for unit vectors
/// `(wo + wi).d = wi.z² - wo.z²`.
#[inline]
pub(super) fn half_vector(wo: Vec3, wi: Vec3) -> Vec3 {
    let sum = wo + wi;
    let d = wo.xy() - wi.xy();
    let d2 = d.length_squared();
    if sum.xy().length_squared() >= d2 {
        return sum;
    }
    let along = (wi.z - wo.z) * sum.z / d2;
    let across = sum.xy().perp_dot(d) / d2;
    (d * along - d.perp() * across).extend(sum.z)
}

/// Reflects `wo` at the unit normal `m`.
#[inline]
pub(super) fn reflect(wo: Vec3, m: Vec3) -> Vec3 {
    let wi = m * (2.0 * wo.dot(m)) - wo;
    // The length is 1 but for rounding: one step towards it, which needs no square root.
    wi * (1.5 - 0.5 * wi.length_squared())
}

impl Roughness {
    /// The density of microfacet normals per steradian at the direction of `h`, which need not be normalised; 0 below
    /// the surface.
    #[inline]
    pub(super) fn density(&self, h: Vec3) -> f32 {
        // A common scale drops out; it matters only where squares would vanish.
        let size = h.abs().max_element();
        let h = if size < 1e-9 { h / size } else { h };
        let length2 = h.length_squared();
        // The components over alpha, and 1, all times alpha.x alpha.y: one quotient instead of four.
        let area = self.alpha.x * self.alpha.y;
        let stretched2 = (h.xy() * self.alpha.yx()).length_squared();
        let z2 = h.z * h.z;
        match self.distribution {
            Distribution::Ggx => {
                // [Walter et al. 2007, eq. 33], anisotropic as in [Heitz 2014, eq. 85].
                let q = area * length2 / (stretched2 + area * area * z2);
                FRAC_1_PI * area * q * q
            }
            Distribution::Beckmann => {
                // [Walter et al. 2007, eq. 25], anisotropic as in [Heitz 2014, eq. 81].
                let tail = (-stretched2 / (area * area * z2)).exp();
                // Far out the tail vanishes before the quotient can overflow.
                if tail > 0.0 { FRAC_1_PI * tail * (length2 / z2) * (length2 / z2) / area } else { 0.0 }
            }
        }
    }

    /// Smith's masking of the direction `w`, above the surface, over its cosine. The quotient stays finite at the
    /// horizon. For the Beckmann distribution it is the rational approximation of Walter et al., as in other renderers.
    #[inline]
    pub(super) fn masking_over_cos(&self, w: Vec3) -> f32 {
        let spread = (self.alpha * w.xy()).length();
        match self.distribution {
            Distribution::Ggx => ggx_masking_over_cos(w.z, spread),
            Distribution::Beckmann => beckmann::approximate_masking_over_cos(w.z, spread),
        }
    }

    /// [`Roughness::masking_over_cos`], and the same exactly: what normalises the distribution of visible normals.
    #[inline]
    pub(super) fn masking_and_visibility_over_cos(&self, w: Vec3) -> (f32, f32) {
        let spread = (self.alpha * w.xy()).length();
        match self.distribution {
            Distribution::Ggx => {
                let masking = ggx_masking_over_cos(w.z, spread);
                (masking, masking)
            }
            Distribution::Beckmann => {
                (beckmann::approximate_masking_over_cos(w.z, spread), beckmann::masking_over_cos(w.z, spread))
            }
        }
    }

    /// A microfacet normal, unit length, with the density of normals visible from `wo`:
    /// the exact masking of `wo` over its cosine times `(wo.m) density(m)`.
    #[inline]
    pub(super) fn sample_visible(&self, wo: Vec3, u: Vec2) -> Vec3 {
        // Stretched, the distribution has roughness 1 in both directions [Heitz and d'Eon 2014, sec. 4].
        let stretched = (self.alpha * wo.xy()).extend(wo.z).normalize();
        let m = match self.distribution {
            Distribution::Ggx => sample_visible_ggx(stretched, u),
            Distribution::Beckmann => beckmann::sample_visible(stretched, u),
        };
        (self.alpha * m.xy()).extend(m.z).normalize()
    }
}

/// [Walter et al. 2007, eq. 34] over the cosine; `spread` is alpha times the sine.
#[inline]
fn ggx_masking_over_cos(cos: f32, spread: f32) -> f32 {
    2.0 / (cos + (cos * cos + spread * spread).sqrt())
}

/// A visible normal for roughness 1, not normalised, by a spherical cap [Dupuy and Benyoub 2023, listing 3].
#[inline]
fn sample_visible_ggx(wo: Vec3, u: Vec2) -> Vec3 {
    let (sin, cos) = sin_cos_turn(u.x);
    // The cap is the part of the sphere above -wo.z; `depth` is the distance of its point from the pole.
    let depth = u.y * (1.0 + wo.z);
    let radius = (depth * (2.0 - depth)).max(0.0).sqrt();
    // The point plus wo; its height (1 - depth) + wo.z without the cancellation.
    Vec3::new(radius * cos + wo.x, radius * sin + wo.y, (1.0 - u.y) * (1.0 + wo.z))
}
