//! Dielectric boundaries, smooth and rough, from either side, and thin sheets.
//!
//! Inside this module `eta` is relative: the index of refraction on the far side of `wo` over that on its own side, and
//! `wo.z` is positive: for `wo` inside, the caller mirrors directions about the plane and takes [`relative`].

use super::{BsdfSample, Roughness, TransportMode, flip, fresnel, microfacet};
use crate::rgb::Rgb;
use glam::{Vec2, Vec3};

/// The relative index of refraction from that of inside over outside, for `wo` inside (`turned`) or outside.
#[inline]
pub(super) fn relative(eta: f32, turned: bool) -> f32 {
    if turned { 1.0 / eta } else { eta }
}

/// Whether directions in `f32` can resolve the refracted lobe. Its width goes to 0 as `|eta - 1| alpha` does, and at
/// `eta` = 1 light passes straight on whatever the roughness. A boundary below this limit scatters as a smooth one.
#[inline]
pub(super) fn resolves(eta: f32, roughness: &Roughness) -> bool {
    (eta - 1.0).abs() * roughness.alpha.min_element() > 8.0 * f32::EPSILON
}

/// What radiance is scaled by on refraction against its direction of travel: it carries 1 / eta² [Veach 1997, eq. 5.13]
/// because the solid angle is compressed; importance is not scaled.
#[inline]
pub(super) fn refraction_scale(mode: TransportMode, eta: f32) -> f32 {
    match mode {
        TransportMode::Radiance => 1.0 / (eta * eta),
        TransportMode::Importance => 1.0,
    }
}

/// Refracts `wo` at the unit normal `m` with `cos` = wo.m > 0; `None` for total internal reflection.
#[inline]
pub(super) fn refract(wo: Vec3, m: Vec3, cos: f32, eta: f32) -> Option<Vec3> {
    let transmitted2 = fresnel::scaled_transmitted_cos2(cos, eta);
    // [Walter et al. 2007, eq. 40]
    (transmitted2 > 0.0).then(|| (m * (cos - transmitted2.sqrt()) - wo) / eta)
}

/// Reflection with the Fresnel reflectance as its probability, refraction otherwise. `u` chooses; `tints` are the
/// factors on what is reflected and transmitted.
#[inline]
pub(super) fn sample_smooth(wo: Vec3, eta: f32, tints: [Rgb; 2], u: f32, mode: TransportMode) -> Option<BsdfSample> {
    if eta == 1.0 {
        return Some(BsdfSample { wi: -wo, weight: tints[1], pdf_w: 1.0, delta: true, eta });
    }
    let reflectance = fresnel::dielectric(wo.z, eta);
    if u < reflectance {
        let wi = Vec3::new(-wo.x, -wo.y, wo.z);
        return Some(BsdfSample { wi, weight: tints[0], pdf_w: reflectance, delta: true, eta: 1.0 });
    }
    let wi = refract(wo, Vec3::Z, wo.z, eta)?;
    let weight = tints[1] * refraction_scale(mode, eta);
    Some(BsdfSample { wi, weight, pdf_w: 1.0 - reflectance, delta: true, eta })
}

/// Reflection by a thin sheet of index of refraction `eta` over that around it, or passage straight through.
#[inline]
pub(super) fn sample_thin(wo: Vec3, eta: f32, tints: [Rgb; 2], u: f32) -> BsdfSample {
    let once = fresnel::dielectric(wo.z, eta);
    // r + t² r (1 + r² + r⁴ + ...) with t = 1 - r: the light reflected between the faces comes out on both sides
    // [Stokes 1862].
    let reflectance = 2.0 * once / (1.0 + once);
    let (wi, weight, pdf_w) = if u < reflectance {
        (Vec3::new(-wo.x, -wo.y, wo.z), tints[0], reflectance)
    } else {
        (-wo, tints[1], 1.0 - reflectance)
    };
    BsdfSample { wi, weight, pdf_w, delta: true, eta: 1.0 }
}

/// How two directions on different sides of a rough boundary are connected.
pub(super) struct Refraction {
    /// The microfacet normal, on the side of `wo`, not normalised.
    pub h: Vec3,
    /// The cosine of `wo` to it.
    pub cos: f32,
    /// `|wo.m| |wi.m| eta² / (wo.m + eta wi.m)²`
    pub jacobian: f32,
}

/// The microfacet that refracts `wo`, above the surface, to `wi` below it; `None` if it would have to be turned away.
#[inline]
pub(super) fn refraction(wo: Vec3, wi: Vec3, eta: f32) -> Option<Refraction> {
    // [Walter et al. 2007, eq. 16], turned to the upper side.
    let h = wo + eta * wi;
    let h = if h.z < 0.0 { -h } else { h };
    let (along_o, along_i) = (wo.dot(h), wi.dot(h));
    if h.z <= 0.0 || along_o <= 0.0 || along_i >= 0.0 {
        return None;
    }
    let length2 = h.length_squared();
    // [Walter et al. 2007, eq. 17 and 21]: the denominator of the Jacobian is |h|².
    let jacobian = (along_o / length2) * (-along_i / length2) * (eta * eta);
    Some(Refraction { h, cos: along_o / length2.sqrt(), jacobian })
}

/// Value and density of a rough boundary [Walter et al. 2007].
pub(super) fn eval_pdf(roughness: &Roughness, wo: Vec3, wi: Vec3, eta: f32, mode: TransportMode) -> (f32, f32) {
    let (masking, visibility) = roughness.masking_and_visibility_over_cos(wo);
    if wi.z > 0.0 {
        let h = microfacet::half_vector(wo, wi);
        if h.z <= 0.0 {
            return (0.0, 0.0);
        }
        let common = 0.25 * roughness.density(h) * fresnel::dielectric(0.5 * h.length(), eta);
        let value = common * masking * roughness.masking_over_cos(wi);
        return (value, common * visibility);
    }
    let Some(Refraction { h, cos, jacobian }) = refraction(wo, wi, eta) else { return (0.0, 0.0) };
    let transmittance = 1.0 - fresnel::dielectric(cos, eta);
    let common = transmittance * roughness.density(h) * jacobian;
    let value = common * masking * roughness.masking_over_cos(flip(wi));
    (value * refraction_scale(mode, eta), common * visibility)
}

/// A direction by reflection or refraction at a visible microfacet, unless it ends on the wrong side; with the index
/// of refraction on its side over that on the side of `wo`. `choice` chooses as the Fresnel reflectance says.
pub(super) fn sample(roughness: &Roughness, wo: Vec3, eta: f32, choice: f32, u: Vec2) -> Option<(Vec3, f32)> {
    let m = roughness.sample_visible(wo, u);
    let cos = wo.dot(m);
    if choice < fresnel::dielectric(cos, eta) {
        let wi = microfacet::reflect(wo, m);
        (wi.z > 0.0).then_some((wi, 1.0))
    } else {
        let wi = refract(wo, m, cos, eta)?.normalize();
        (wi.z < 0.0).then_some((wi, eta))
    }
}
