//! A diffuse body under a rough dielectric coat, for directions in front of the surface.
//!
//! The coat reflects by microfacets. What passes it (a quadrature over the microfacets, tabulated over the angle) is
//! scattered by the body, as under a smooth coat. The model is the one that Mitsuba calls `roughplastic`.
//!
//! Single scattering at the coat loses energy on the way in, on the way out and at every reflection inside: over a white
//! body, the directional albedo along the normal is 0.96 at a GGX roughness of 0.05, 0.79 at 0.2 and 0.54 at 0.5; with
//! the Beckmann distribution 0.98, 0.93 and 0.74 (index of refraction 1.5).

use super::{
    Distribution, Roughness, dielectric, flip, fresnel, microfacet,
    plastic::{coat_probability, coated_body, specular_share},
};
use crate::{
    rgb::Rgb,
    warp::{self, sin_cos_turn},
};
use glam::{Vec2, Vec3};
use std::{f32::consts::FRAC_1_PI, sync::OnceLock};

/// Angles in the table of a coat, equally spaced in the cosine.
const NODES: usize = 64;

/// Points of the quadrature over microfacets, and the generator of their lattice: two Fibonacci numbers in sequence.
const LATTICE: (u32, u32) = (2584, 1597);

/// A rough coat of given distribution, roughness and index of refraction.
#[derive(Debug, PartialEq)]
struct Coat {
    roughness: Roughness,
    eta: f32,
    /// Share of the light that passes from outside, at cosines from 0 to 1.
    transmittance: [f32; NODES],
    /// Share of diffuse light from below that is reflected.
    internal_reflectance: f32,
}

/// A link of the chain of coats that fall into the same bucket.
struct Link {
    coat: Coat,
    next: OnceLock<&'static Link>,
}

/// Every coat that was ever asked for, reachable without a lock.
static COATS: [OnceLock<&'static Link>; 64] = [const { OnceLock::new() }; 64];

impl Coat {
    /// The coat with the given parameters. It is made once and then kept as long as the program runs (280 bytes for each
    /// distinct coat), so that a lobe can refer to it by value.
    fn get(distribution: Distribution, alpha: f32, eta: f32) -> &'static Coat {
        let roughness = Roughness { distribution, alpha: Vec2::splat(alpha) };
        // Bits that differ between similar numbers end up on top [Knuth 1998, sec. 6.4].
        let hash = (alpha.to_bits() ^ eta.to_bits().rotate_left(16) ^ distribution as u32).wrapping_mul(0x9e37_79b1);
        let mut slot = &COATS[(hash >> 26) as usize];
        loop {
            let link = *slot.get_or_init(|| {
                Box::leak(Box::new(Link { coat: Coat::new(roughness, eta, LATTICE), next: OnceLock::new() }))
            });
            if link.coat.roughness == roughness && link.coat.eta == eta {
                return &link.coat;
            }
            slot = &link.next;
        }
    }

    fn new(roughness: Roughness, eta: f32, lattice: (u32, u32)) -> Coat {
        // The first node is just above the horizon.
        let cosines: [f32; NODES] = std::array::from_fn(|i| (i as f32 / (NODES - 1) as f32).max(1e-6));
        let transmittance = cosines.map(|cos| scattered(&roughness, cos, eta, lattice).1 as f32);
        let inside = cosines.map(|cos| 2.0 * f64::from(cos) * scattered(&roughness, cos, 1.0 / eta, lattice).0);
        // The plain mean over the nodes, not the trapezoidal rule, which is up to 2 % higher: with it coats agree with
        // Mitsuba's, and lose energy rather than gain it.
        let internal_reflectance = (inside.iter().sum::<f64>() / NODES as f64) as f32;
        Coat { roughness, eta, transmittance, internal_reflectance }
    }

    #[inline]
    fn transmittance(&self, cos: f32) -> f32 {
        let x = cos.min(1.0) * (NODES - 1) as f32;
        let i = (x as usize).min(NODES - 2);
        let w = x - i as f32;
        (1.0 - w) * self.transmittance[i] + w * self.transmittance[i + 1]
    }
}

/// The shares of light from the cosine `cos` that a rough boundary reflects and transmits by single scattering, where
/// the far side has `eta` times the near side's index of refraction.
fn scattered(roughness: &Roughness, cos: f32, eta: f32, (points, generator): (u32, u32)) -> (f64, f64) {
    let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
    let (_, visibility) = roughness.masking_and_visibility_over_cos(wo);
    let (mut reflected, mut transmitted) = (0.0, 0.0);
    // A lattice rule [Sloan and Joe 1994, sec. 4.1]: slopes equally spaced, azimuths one multiple of a step after another.
    for i in 0..points {
        // In p, where the slope is alpha sqrt(1 / (1 - p)² - 1), the density of normals is smooth at both ends.
        let p = (i as f32 + 0.5) / points as f32;
        let slope2 = p * (2.0 - p) / ((1.0 - p) * (1.0 - p));
        // Projected area of the microfacets per interval of p.
        let area = match roughness.distribution {
            Distribution::Ggx => 2.0 * (1.0 - p),
            Distribution::Beckmann => 2.0 * (-slope2).exp() / ((1.0 - p) * (1.0 - p) * (1.0 - p)),
        };
        let (sin, cos) = sin_cos_turn((i * generator % points) as f32 / points as f32);
        let m = (roughness.alpha * slope2.sqrt() * Vec2::new(cos, sin)).extend(1.0).normalize();
        let along = wo.dot(m);
        if along <= 0.0 {
            continue;
        }
        // The density of visible normals [Heitz and d'Eon 2014, eq. 2]: visibility (wo.m) D(m), and D(m) = area / m.z.
        let weight = visibility * along * area / m.z;
        let reflectance = fresnel::dielectric(along, eta);
        let unmasked = |up: Vec3| if up.z > 0.0 { roughness.masking_over_cos(up) * up.z } else { 0.0 };
        reflected += f64::from(weight * reflectance * unmasked(microfacet::reflect(wo, m)));
        if let Some(wi) = dielectric::refract(wo, m, along, eta) {
            transmitted += f64::from(weight * (1.0 - reflectance) * unmasked(flip(wi)));
        }
    }
    let points = f64::from(points);
    // The rational masking of the Beckmann distribution can be too large by 0.35 %.
    ((reflected / points).min(1.0), (transmitted / points).min(1.0))
}

/// A reference that is aligned as numbers are, which keeps lobes small.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(Rust, packed(4))]
struct CoatRef(&'static Coat);

/// A diffuse body under a rough coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughPlastic {
    coat: CoatRef,
    /// Albedo of the body with all reflections under the coat, over the square of the index of refraction.
    body: Rgb,
    specular: Rgb,
    /// Share of the coat in what is sampled, before its reflectance at the angle is taken into account.
    specular_share: f32,
}

impl RoughPlastic {
    /// - `eta`: index of refraction of the coat over that around it, positive;
    /// - `roughness`: distribution and roughness of the coat, the latter in `[1e-4, 1]`;
    /// - `diffuse`: albedo of the body, in `[0, 1]`;
    /// - `specular`: factor on what the coat reflects, in `[0, 1]`;
    /// - `nonlinear`: whether the shift of colours by repeated reflection under the coat is followed.
    ///
    /// The first call with a given `eta` and `roughness` computes a table in some 10 ms, which the process keeps to its
    /// end: 280 bytes for each distinct coat.
    pub fn new(
        eta: f32,
        (distribution, alpha): (Distribution, f32),
        diffuse: Rgb,
        specular: Rgb,
        nonlinear: bool,
    ) -> RoughPlastic {
        let coat = Coat::get(distribution, alpha, eta);
        RoughPlastic {
            coat: CoatRef(coat),
            body: coated_body(eta, diffuse, coat.internal_reflectance, nonlinear),
            specular,
            specular_share: specular_share(diffuse, specular),
        }
    }

    /// The roughness of the widest part: the coat's where the body is black.
    #[inline]
    pub(super) fn width(&self) -> f32 {
        if self.body.is_black() { self.coat.0.roughness.alpha.x } else { 1.0 }
    }

    pub(super) fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let coat = self.coat.0;
        let (transmittance_o, transmittance_i) = (coat.transmittance(wo.z), coat.transmittance(wi.z));
        let body = FRAC_1_PI * transmittance_o * transmittance_i;
        let probability = coat_probability(1.0 - transmittance_o, self.specular_share);
        let mut value = self.body * body;
        let mut pdf_w = (1.0 - probability) * warp::cosine_hemisphere_pdf(wi.z);
        let h = microfacet::half_vector(wo, wi);
        if h.z > 0.0 {
            // As a rough conductor, with the reflectance of a dielectric.
            let quarter_d = 0.25 * coat.roughness.density(h);
            let (masking, visibility) = coat.roughness.masking_and_visibility_over_cos(wo);
            let reflectance = fresnel::dielectric(0.5 * h.length(), coat.eta);
            let shape = quarter_d * masking * coat.roughness.masking_over_cos(wi);
            value += self.specular * (reflectance * shape);
            pdf_w += probability * (quarter_d * visibility);
        }
        (value, pdf_w)
    }

    /// A direction from the coat or the body as `choice` says, unless the coat sends it below the horizon.
    pub(super) fn sample(&self, wo: Vec3, choice: f32, u: Vec2) -> Option<Vec3> {
        let coat = self.coat.0;
        if choice < coat_probability(1.0 - coat.transmittance(wo.z), self.specular_share) {
            let wi = microfacet::reflect(wo, coat.roughness.sample_visible(wo, u));
            (wi.z > 0.0).then_some(wi)
        } else {
            Some(warp::sample_cosine_hemisphere(u))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finer_quadrature_changes_little() {
        for distribution in [Distribution::Ggx, Distribution::Beckmann] {
            for alpha in [1e-4, 0.01, 0.1, 0.3, 1.0] {
                let roughness = Roughness { distribution, alpha: Vec2::splat(alpha) };
                let [coarse, fine] = [LATTICE, (17_711, 10_946)].map(|lattice| Coat::new(roughness, 1.5, lattice));
                for (i, (c, f)) in coarse.transmittance.iter().zip(&fine.transmittance).enumerate() {
                    // The first is at the horizon, where roughness and angle are of the same order.
                    let tolerance = if i == 0 { 6e-4 } else { 3e-4 };
                    assert!((c - f).abs() < tolerance, "{roughness:?} {i}: {c} {f}");
                }
                let (c, f) = (coarse.internal_reflectance, fine.internal_reflectance);
                assert!((c - f).abs() < 2e-4, "{roughness:?}: {c} {f}");
            }
        }
    }

    #[test]
    fn a_coat_is_made_once() {
        // More than there are buckets.
        let eta = |i| 1.0 + 0.01 * i as f32;
        let coats: Vec<&Coat> = (1..=100).map(|i| Coat::get(Distribution::Ggx, 0.5, eta(i))).collect();
        for (i, coat) in (1..=100).zip(coats) {
            assert!(std::ptr::eq(coat, Coat::get(Distribution::Ggx, 0.5, eta(i))));
            assert_eq!(coat.eta, eta(i));
        }
    }
}
