//! A diffuse body under a smooth dielectric coat, for directions in front of the surface.
//!
//! The coat reflects as a smooth boundary. What passes it is scattered by the body, is partly thrown back from below the
//! coat to the body, and leaves by refraction; all orders are summed. The model is the one that Mitsuba calls `plastic`.

use super::{BsdfSample, fresnel};
use crate::{rgb::Rgb, warp};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// A diffuse body under a smooth coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    eta: f32,
    /// Albedo of the body with all reflections under the coat, over the square of the index of refraction.
    body: Rgb,
    specular: Rgb,
    /// Share of the coat in what is sampled, before the reflectance at the angle is taken into account.
    specular_share: f32,
}

/// The albedo of a body under a coat that reflects the share `internal` of the light back to it, over `eta²`.
pub(super) fn coated_body(eta: f32, diffuse: Rgb, internal: f32, nonlinear: bool) -> Rgb {
    // The geometric series of the reflections between body and coat. Without the colour shift each of them counts as
    // one at a white body. The radiance that leaves is spread over a solid angle eta² as large.
    let factor = |albedo: f32| albedo / ((1.0 - internal * if nonlinear { albedo } else { 1.0 }) * (eta * eta));
    diffuse.map(factor)
}

/// The share of the coat in what is sampled, before its reflectance at the angle is taken into account.
pub(super) fn specular_share(diffuse: Rgb, specular: Rgb) -> f32 {
    let (s, d) = (specular.mean(), diffuse.mean());
    if s + d > 0.0 { s / (s + d) } else { 0.5 }
}

/// The probability of sampling a coat of the given reflectance.
#[inline]
pub(super) fn coat_probability(reflectance: f32, specular_share: f32) -> f32 {
    let coat = reflectance * specular_share;
    let body = (1.0 - reflectance) * (1.0 - specular_share);
    // Both vanish where all is reflected by a black coat, or nothing by a coat over a black body.
    if coat + body > 0.0 { coat / (coat + body) } else { 0.0 }
}

impl Plastic {
    /// - `eta`: index of refraction of the coat over that around it, positive;
    /// - `diffuse`: albedo of the body, in `[0, 1]`;
    /// - `specular`: factor on what the coat reflects, in `[0, 1]`;
    /// - `nonlinear`: whether the shift of colours by repeated reflection under the coat is followed.
    pub fn new(eta: f32, diffuse: Rgb, specular: Rgb, nonlinear: bool) -> Plastic {
        Plastic {
            eta,
            body: coated_body(eta, diffuse, fresnel::diffuse(1.0 / eta), nonlinear),
            specular,
            specular_share: specular_share(diffuse, specular),
        }
    }

    /// Whether the coat is all there is.
    #[inline]
    pub(super) fn is_delta(&self) -> bool {
        self.body.is_black()
    }

    /// Whether the coat reflects at all.
    #[inline]
    pub(super) fn has_delta(&self) -> bool {
        self.is_delta() || !self.specular.is_black()
    }

    /// The probability of sampling the coat where it has the given reflectance.
    #[inline]
    fn coat_probability(&self, reflectance: f32) -> f32 {
        if self.is_delta() { 1.0 } else { coat_probability(reflectance, self.specular_share) }
    }

    /// Value and density of the body.
    #[inline]
    pub(super) fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let (reflectance_o, reflectance_i) = (fresnel::dielectric(wo.z, self.eta), fresnel::dielectric(wi.z, self.eta));
        let value = FRAC_1_PI * (1.0 - reflectance_o) * (1.0 - reflectance_i);
        let pdf_w = (1.0 - self.coat_probability(reflectance_o)) * warp::cosine_hemisphere_pdf(wi.z);
        (self.body * value, pdf_w)
    }

    /// Reflection by the coat, unless `u` chooses the body.
    #[inline]
    pub(super) fn sample_coat(&self, wo: Vec3, u: f32) -> Option<BsdfSample> {
        let reflectance = fresnel::dielectric(wo.z, self.eta);
        let pdf_w = self.coat_probability(reflectance);
        (u < pdf_w).then(|| {
            let weight = self.specular * (reflectance / pdf_w);
            BsdfSample { wi: Vec3::new(-wo.x, -wo.y, wo.z), weight, pdf_w, delta: true, eta: 1.0 }
        })
    }
}
