//! The principled material of a thin sheet: glass or a diffuse body that lets light through, both without refraction, and
//! sheen [Burley 2015, sec. 5.3 and 6]. The model that Mitsuba calls `principledthin`; what is sampled how often is not.
//!
//! In one point it differs. For transmission Mitsuba asks whether the outgoing direction is below the microfacet whose
//! mirror image of it makes the half vector, which cuts off slanted outgoing directions but not the same path
//! backwards. Here nothing is cut off, so that both ways see the same. Of the specular transmission along the normal that
//! is 0.05 % at a roughness of 0.2, 1.7 % at 0.5 and 9 % at 0.8 (index of refraction 1.5).

use super::{
    Distribution, Roughness,
    burley::{self, schlick},
    choice::{choose, shares},
    flip, fresnel, microfacet,
};
use crate::{rgb::Rgb, warp};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Parameters of the thin principled material at a point, all in `[0, 1]` where not said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipledThin {
    /// Colour of the body.
    pub base_color: Rgb,
    /// Roughness; the square of it is the microfacet roughness, of at least 0.001.
    pub roughness: f32,
    /// Stretch of the highlights.
    pub anisotropic: f32,
    /// Share of the specular lobes.
    pub spec_trans: f32,
    /// Index of refraction of the sheet over that around it, positive.
    pub eta: f32,
    /// How far specular reflection takes the base colour.
    pub spec_tint: f32,
    /// Sheen, as of cloth.
    pub sheen: f32,
    /// How far sheen takes the base colour.
    pub sheen_tint: f32,
    /// How much of the diffuse reflection follows an approximation of subsurface scattering.
    pub flatness: f32,
    /// Diffuse transmission, in `[0, 2]`: 1 shares evenly between both sides, 2 transmits all.
    pub diff_trans: f32,
}

impl PrincipledThin {
    #[inline]
    fn reflecting(&self) -> Roughness {
        Roughness { distribution: Distribution::Ggx, alpha: burley::principled_alpha(self.roughness, self.anisotropic) }
    }

    /// Passing two boundaries that bend light less than reflection does blurs less.
    #[inline]
    fn transmitting(&self) -> Roughness {
        let roughness = thin_roughness(self.eta, self.roughness);
        Roughness { distribution: Distribution::Ggx, alpha: burley::principled_alpha(roughness, self.anisotropic) }
    }

    /// The roughness of the widest part: the diffuse one, or the wider of reflection and transmission.
    #[inline]
    pub(super) fn width(&self) -> f32 {
        if self.spec_trans < 1.0 {
            return 1.0;
        }
        self.reflecting().alpha.min_element().max(self.transmitting().alpha.min_element())
    }

    /// The colour of what microfacets reflect at the cosine `cos`, given the reflectance of a dielectric there.
    #[inline]
    fn reflected(&self, dielectric: f32, cos: f32) -> Rgb {
        let plain = Rgb::splat(dielectric * (1.0 - self.spec_tint));
        let color = if self.spec_tint > 0.0 {
            plain + schlick(burley::tinted_r0(self.base_color, self.eta), cos, self.eta) * self.spec_tint
        } else {
            plain
        };
        color * self.spec_trans
    }

    /// The colour of what microfacets transmit.
    #[inline]
    fn transmitted(&self, dielectric: f32) -> Rgb {
        self.base_color * (self.spec_trans * (1.0 - dielectric))
    }

    /// Shares of diffuse reflection and transmission.
    #[inline]
    fn body(&self) -> [f32; 2] {
        let (body, through) = (1.0 - self.spec_trans, 0.5 * self.diff_trans);
        [body * (1.0 - through), body * through]
    }

    /// Probabilities of sampling specular reflection and transmission, diffuse reflection with the sheen, and diffuse
    /// transmission.
    #[inline]
    fn shares(&self, cos: f32) -> [f32; 4] {
        let base = self.base_color.mean();
        let body = self.body();
        // The cosine to the normal stands for those to the microfacets.
        let dielectric = fresnel::dielectric(cos, self.eta);
        let specular = [self.reflected(dielectric, cos).mean(), self.transmitted(dielectric).mean()];
        let diffuse = [body[0] * (base + self.sheen * burley::sheen_energy(cos)), body[1] * base];
        let colored = base > 0.0;
        let glass = self.spec_trans > 0.0;
        let active =
            [glass, glass && colored, body[0] > 0.0 && (colored || self.sheen > 0.0), body[1] > 0.0 && colored];
        shares([specular[0], specular[1], diffuse[0], diffuse[1]], active)
    }

    /// Value and density; `wo` is above the surface.
    pub(super) fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let through = wi.z < 0.0;
        // Transmission is reflection continued to the other side [Burley 2015, sec. 5.3].
        let up = if through { flip(wi) } else { wi };
        let h = microfacet::half_vector(wo, up);
        if h.z <= 0.0 {
            return super::NOTHING;
        }
        let shares = self.shares(wo.z);
        let cos_d = 0.5 * h.length();
        let (mut value, mut pdf_w) = super::NOTHING;
        let (specular, diffuse) = if through { (shares[1], shares[3]) } else { (shares[0], shares[2]) };
        if specular > 0.0 {
            let dielectric = fresnel::dielectric(cos_d, self.eta);
            let (color, distribution) = if through {
                (self.transmitted(dielectric), self.transmitting())
            } else {
                (self.reflected(dielectric, cos_d), self.reflecting())
            };
            let common = 0.25 * distribution.density(h) * distribution.masking_over_cos(wo);
            value += color * (common * distribution.masking_over_cos(up));
            pdf_w += specular * common;
        }
        if diffuse > 0.0 {
            let body = self.body();
            pdf_w += diffuse * warp::cosine_hemisphere_pdf(up.z);
            if through {
                value += self.base_color * (body[1] * FRAC_1_PI);
            } else {
                let factor = burley::diffuse(self.roughness, self.flatness, wo.z, up.z, cos_d);
                value += self.base_color * (body[0] * FRAC_1_PI * factor);
                if self.sheen > 0.0 {
                    value += burley::sheen(self.sheen * body[0], self.sheen_tint, self.base_color, cos_d);
                }
            }
        }
        (value, pdf_w)
    }

    /// A direction, unless a microfacet sends light to the wrong side.
    pub(super) fn sample(&self, wo: Vec3, choice: f32, u: Vec2) -> Option<Vec3> {
        let (part, _) = choose(self.shares(wo.z), choice);
        let up = match part {
            0 => microfacet::reflect(wo, self.reflecting().sample_visible(wo, u)),
            1 => microfacet::reflect(wo, self.transmitting().sample_visible(wo, u)),
            _ => warp::sample_cosine_hemisphere(u),
        };
        (up.z > 0.0).then(|| if part % 2 == 1 { flip(up) } else { up })
    }
}

/// The roughness that transmission by a sheet of the given index of refraction and roughness has [Burley 2015, fig. 15].
#[inline]
pub(crate) fn thin_roughness(eta: f32, roughness: f32) -> f32 {
    (0.65 * eta - 0.35) * roughness
}
