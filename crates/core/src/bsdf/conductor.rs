//! Conductors, smooth and rough, for directions in front of the surface.

use super::{BsdfSample, ConductorFresnel, NOTHING, Roughness, microfacet};
use crate::rgb::Rgb;
use glam::{Vec2, Vec3};

/// Reflection at the plane.
#[inline]
pub(super) fn sample_smooth(fresnel: &ConductorFresnel, wo: Vec3) -> BsdfSample {
    let wi = Vec3::new(-wo.x, -wo.y, wo.z);
    BsdfSample { wi, weight: fresnel.reflectance(wo.z), pdf_w: 1.0, delta: true, eta: 1.0 }
}

/// Value and density of the Torrance-Sparrow model.
pub(super) fn eval_pdf(fresnel: &ConductorFresnel, roughness: &Roughness, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
    let h = microfacet::half_vector(wo, wi);
    if h.z <= 0.0 {
        return NOTHING;
    }
    let quarter_d = 0.25 * roughness.density(h);
    // f = F G D / (4 cos_o cos_i) [Walter et al. 2007, eq. 20], the cosines inside the masking.
    let (masking, visibility) = roughness.masking_and_visibility_over_cos(wo);
    let value = quarter_d * masking * roughness.masking_over_cos(wi);
    // The density of visible normals times the Jacobian 1 / (4 wo.m) [Heitz and d'Eon 2014, eq. 2 and 17].
    let pdf_w = quarter_d * visibility;
    // Half the length of the half vector is the cosine to it, even where wo and wi nearly cancel.
    (fresnel.reflectance(0.5 * h.length()) * value, pdf_w)
}

/// A direction by reflection at a visible microfacet, unless it ends below the horizon.
pub(super) fn sample(roughness: &Roughness, wo: Vec3, u: Vec2) -> Option<Vec3> {
    let wi = microfacet::reflect(wo, roughness.sample_visible(wo, u));
    (wi.z > 0.0).then_some(wi)
}
