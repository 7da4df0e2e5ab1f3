//! The clear coat of the principled material: a second, weak reflection [Burley 2012, sec. 5.4 and 5.6].

use super::{Distribution, Roughness, burley::fresnel_weight, microfacet};
use crate::warp::sin_cos_turn;
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Reflectance along the normal, of index of refraction 1.5.
const R0: f32 = 0.04;

/// Of the masking; the distribution has its own.
const MASKING: Roughness = Roughness { distribution: Distribution::Ggx, alpha: Vec2::splat(0.25) };

/// Roughness of the distribution of normals at a gloss in `[0, 1]`.
#[inline]
pub(crate) fn alpha(gloss: f32) -> f32 {
    0.1 + (0.001 - 0.1) * gloss
}

/// Reflectance at the cosine to the microfacet, over a base of index of refraction `eta`; Schlick's approximation.
#[inline]
pub(super) fn reflectance(cos: f32, eta: f32) -> f32 {
    R0 + (1.0 - R0) * fresnel_weight(cos, eta)
}

/// Value of a coat of strength 1, and density: `h` is the half vector, not normalised.
#[inline]
pub(super) fn eval_pdf(gloss: f32, eta: f32, wo: Vec3, wi: Vec3, h: Vec3) -> (f32, f32) {
    let alpha = alpha(gloss);
    let length = h.length();
    // Two subnormal cosines can make the half vector vanish.
    let m = if length > 0.0 { h / length } else { Vec3::Z };
    // The distribution with the long tail, gamma = 1 [Burley 2012, eq. 4], its denominator without a cancellation.
    let alpha2 = alpha * alpha;
    let spread2 = m.truncate().length_squared() + alpha2 * m.z * m.z;
    let density = FRAC_1_PI * (alpha2 - 1.0) / (alpha2.ln() * spread2);
    // Masking as for GGX, over both cosines already; the model has the cosines themselves.
    let masking = MASKING.masking_over_cos(wo) * MASKING.masking_over_cos(wi) * (wo.z * wi.z);
    let value = 0.25 * reflectance(0.5 * length, eta) * density * masking;
    // Normals with the density D cos, reflection with the Jacobian 1 / (4 wo.m). Where both directions are within
    // 1e-30 of the horizon the latter overflows.
    let pdf_w = (density * m.z / (2.0 * length)).min(f32::MAX);
    (value, pdf_w)
}

/// A direction by reflection at a microfacet, unless that is turned away or reflects below the horizon.
#[inline]
pub(super) fn sample(gloss: f32, wo: Vec3, u: Vec2) -> Option<Vec3> {
    let alpha2 = alpha(gloss) * alpha(gloss);
    // [Burley 2012, eq. 5 and 6], the sine without a cancellation: alpha² (alpha^(-2 u) - 1) / (1 - alpha²).
    let sin2 = (alpha2 * (-u.y * alpha2.ln()).exp_m1() / (1.0 - alpha2)).min(1.0);
    let (sin_phi, cos_phi) = sin_cos_turn(u.x);
    let sin = sin2.sqrt();
    let m = Vec3::new(sin * cos_phi, sin * sin_phi, (1.0 - sin2).sqrt());
    if wo.dot(m) <= 0.0 {
        return None;
    }
    let wi = microfacet::reflect(wo, m);
    (wi.z > 0.0).then_some(wi)
}
