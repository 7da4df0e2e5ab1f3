//! The principled material: a base that is a blend of diffuse, metal and glass, under sheen and a clear coat
//! [Burley 2012, 2015]. Value for value the model that Mitsuba calls `principled`; what is sampled how often is not.
//!
//! The model does not conserve energy: specular reflection is added to the body without being taken from it. The
//! directional albedo of a white body of index of refraction 1.5, without sheen or coat, is by quadrature:
//!
//! | roughness | 0° | 45° | 60° | 80° | 89° |
//! | --- | --- | --- | --- | --- | --- |
//! | 0.2 | 1.03 | 1.04 | 1.07 | 1.23 | 1.26 |
//! | 0.5 | 1.04 | 1.05 | 1.07 | 1.16 | 1.19 |
//! | 1 | 1.05 | 1.05 | 1.08 | 1.31 | 1.57 |
//!
//! Inside this module `wo.z` is positive; for `wo` inside, the caller mirrors directions about the plane and says so.

use super::{
    Distribution, Roughness, TransportMode,
    burley::{self, schlick},
    choice::{choose, shares},
    clearcoat,
    dielectric::{Refraction, refract, refraction, refraction_scale, relative},
    flip, fresnel, microfacet,
};
use crate::{rgb::Rgb, warp};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Parameters of the principled material at a point, all in `[0, 1]` where not said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// Colour of the body.
    pub base_color: Rgb,
    /// Roughness; the square of it is the microfacet roughness, of at least 0.001.
    pub roughness: f32,
    /// Stretch of the highlights.
    pub anisotropic: f32,
    /// Share of a metal.
    pub metallic: f32,
    /// Share of specular transmission in what is not metal.
    pub spec_trans: f32,
    /// Index of refraction inside over outside, positive. Within 0.1 % of 1 it counts as 0.1 % off 1, because a boundary
    /// that refracts nothing has no microfacets.
    pub eta: f32,
    /// How far specular reflection takes the base colour.
    pub spec_tint: f32,
    /// Sheen, as of cloth.
    pub sheen: f32,
    /// How far sheen takes the base colour.
    pub sheen_tint: f32,
    /// How much of the diffuse reflection follows an approximation of subsurface scattering.
    pub flatness: f32,
    /// A second, clear coat.
    pub clearcoat: f32,
    /// Its gloss.
    pub clearcoat_gloss: f32,
}

/// Least distance of an index of refraction from 1.
const LEAST_CONTRAST: f32 = 1e-3;

impl Principled {
    /// Whether nothing passes: the back is then black, unless the surface has two sides.
    #[inline]
    pub(super) fn is_opaque(&self) -> bool {
        self.glass() == 0.0
    }

    /// The roughness of the widest part: the diffuse one, or the wider of microfacets and clear coat.
    #[inline]
    pub(super) fn width(&self) -> f32 {
        let sheen = self.sheen * (1.0 - self.metallic);
        if sheen > 0.0 || self.body() > 0.0 && !self.base_color.is_black() {
            return 1.0;
        }
        let coat = if self.clearcoat > 0.0 { clearcoat::alpha(self.clearcoat_gloss) } else { 0.0 };
        self.distribution().alpha.min_element().max(coat)
    }

    /// Share of the lobe of a rough dielectric.
    #[inline]
    fn glass(&self) -> f32 {
        (1.0 - self.metallic) * self.spec_trans
    }

    /// Share of the diffuse lobe.
    #[inline]
    fn body(&self) -> f32 {
        (1.0 - self.metallic) * (1.0 - self.spec_trans)
    }

    #[inline]
    fn distribution(&self) -> Roughness {
        Roughness { distribution: Distribution::Ggx, alpha: burley::principled_alpha(self.roughness, self.anisotropic) }
    }

    /// The index of refraction on the far side over that on the side of `wo`.
    #[inline]
    fn relative_eta(&self, front: bool) -> f32 {
        let off = self.eta - 1.0;
        let eta = if off.abs() < LEAST_CONTRAST { 1.0 + LEAST_CONTRAST.copysign(off) } else { self.eta };
        relative(eta, !front)
    }

    /// The colour of what the microfacets reflect at the cosine `cos`, given the reflectance of a dielectric there.
    #[inline]
    fn reflected(&self, dielectric: f32, cos: f32, eta: f32, front: bool) -> Rgb {
        if !front {
            return Rgb::splat(self.glass() * dielectric);
        }
        // [Burley 2015, sec. 5.1]: metal by Schlick's approximation, glass by Fresnel's formulas where it has no tint.
        let mut value = Rgb::splat((1.0 - self.metallic) * (1.0 - self.spec_tint) * dielectric);
        if self.metallic > 0.0 {
            value += schlick(self.base_color, cos, eta) * self.metallic;
        }
        if self.spec_tint > 0.0 {
            let r0 = burley::tinted_r0(self.base_color, eta);
            value += schlick(r0, cos, eta) * ((1.0 - self.metallic) * self.spec_tint);
        }
        value
    }

    /// The colour of what the microfacets transmit. A ray passes two boundaries, hence the root [Burley 2015, sec. 5.1].
    #[inline]
    fn transmitted(&self, dielectric: f32) -> Rgb {
        let glass = self.glass();
        // A root for each channel is worth sparing.
        if glass > 0.0 { self.base_color.map(f32::sqrt) * (glass * (1.0 - dielectric)) } else { Rgb::BLACK }
    }

    /// Probabilities of sampling the microfacets, the diffuse lobe with the sheen, and the clear coat.
    #[inline]
    fn shares(&self, cos: f32, eta: f32, front: bool) -> [f32; 3] {
        if !front {
            return [1.0, 0.0, 0.0];
        }
        let sheen = self.sheen * (1.0 - self.metallic);
        let body = self.body();
        let active = [true, body > 0.0 || sheen > 0.0, self.clearcoat > 0.0];
        if !active[1] && !active[2] {
            return [1.0, 0.0, 0.0];
        }
        // The cosine to the normal stands for those to the microfacets.
        let dielectric = fresnel::dielectric(cos, eta);
        let specular = self.reflected(dielectric, cos, eta, front) + self.transmitted(dielectric);
        let diffuse = body * self.base_color.mean() + sheen * burley::sheen_energy(cos);
        let coat = self.clearcoat * clearcoat::reflectance(cos, eta) * cos;
        shares([specular.mean(), diffuse, coat], active)
    }

    /// Value and density; `wo` is above the surface, and `front` says whether that is outside.
    pub(super) fn eval_pdf(&self, wo: Vec3, wi: Vec3, front: bool, mode: TransportMode) -> (Rgb, f32) {
        let eta = self.relative_eta(front);
        if wi.z < 0.0 {
            return self.eval_pdf_transmission(wo, wi, eta, front, mode);
        }
        let h = microfacet::half_vector(wo, wi);
        if h.z <= 0.0 {
            return super::NOTHING;
        }
        let shares = self.shares(wo.z, eta, front);
        let cos_d = 0.5 * h.length();
        let dielectric = fresnel::dielectric(cos_d, eta);
        let reflected = self.reflected(dielectric, cos_d, eta, front);
        let chosen = probability(reflected, self.transmitted(dielectric));
        let distribution = self.distribution();
        let quarter_d = 0.25 * distribution.density(h);
        let masking = distribution.masking_over_cos(wo);
        let mut value = reflected * (quarter_d * masking * distribution.masking_over_cos(wi));
        let mut pdf_w = shares[0] * chosen * (quarter_d * masking);
        if !front {
            return (value, pdf_w);
        }
        if shares[1] > 0.0 {
            let diffuse = burley::diffuse(self.roughness, self.flatness, wo.z, wi.z, cos_d);
            value += self.base_color * (self.body() * FRAC_1_PI * diffuse);
            if self.sheen > 0.0 {
                let strength = self.sheen * (1.0 - self.metallic);
                value += burley::sheen(strength, self.sheen_tint, self.base_color, cos_d);
            }
            pdf_w += shares[1] * warp::cosine_hemisphere_pdf(wi.z);
        }
        if shares[2] > 0.0 {
            let (coat, coat_pdf_w) = clearcoat::eval_pdf(self.clearcoat_gloss, eta, wo, wi, h);
            value += Rgb::splat(self.clearcoat * coat);
            pdf_w += shares[2] * coat_pdf_w;
        }
        (value, pdf_w)
    }

    fn eval_pdf_transmission(&self, wo: Vec3, wi: Vec3, eta: f32, front: bool, mode: TransportMode) -> (Rgb, f32) {
        if self.is_opaque() {
            return super::NOTHING;
        }
        let Some(Refraction { h, cos, jacobian }) = refraction(wo, wi, eta) else { return super::NOTHING };
        let dielectric = fresnel::dielectric(cos, eta);
        let transmitted = self.transmitted(dielectric);
        let chosen = 1.0 - probability(self.reflected(dielectric, cos, eta, front), transmitted);
        let distribution = self.distribution();
        let common = distribution.density(h) * jacobian * distribution.masking_over_cos(wo);
        // [Walter et al. 2007, eq. 21]
        let value = common * distribution.masking_over_cos(flip(wi)) * refraction_scale(mode, eta);
        (transmitted * value, self.shares(wo.z, eta, front)[0] * chosen * common)
    }

    /// A direction with the index of refraction on its side over that on the side of `wo`, unless a microfacet sends
    /// light to the wrong side.
    pub(super) fn sample(&self, wo: Vec3, front: bool, choice: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let eta = self.relative_eta(front);
        match choose(self.shares(wo.z, eta, front), choice) {
            (0, choice) => {
                let m = self.distribution().sample_visible(wo, u);
                let cos = wo.dot(m);
                let dielectric = fresnel::dielectric(cos, eta);
                let reflected = self.reflected(dielectric, cos, eta, front);
                if choice < probability(reflected, self.transmitted(dielectric)) {
                    let wi = microfacet::reflect(wo, m);
                    (wi.z > 0.0).then_some((wi, 1.0))
                } else {
                    let wi = refract(wo, m, cos, eta)?.normalize();
                    (wi.z < 0.0).then_some((wi, eta))
                }
            }
            (1, _) => Some((warp::sample_cosine_hemisphere(u), 1.0)),
            _ => clearcoat::sample(self.clearcoat_gloss, wo, u).map(|wi| (wi, 1.0)),
        }
    }
}

/// The probability of reflection at a microfacet, given what it reflects and transmits.
#[inline]
fn probability(reflected: Rgb, transmitted: Rgb) -> f32 {
    let (r, t) = (reflected.mean(), transmitted.mean());
    if t > 0.0 { r / (r + t) } else { 1.0 }
}
