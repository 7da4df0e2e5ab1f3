//! Statistics and invariants of scattering, from outside.

mod agreement;
mod chart;
mod chi_square;
mod compound;
mod figures;
mod invariants;
mod statistics;

use chart::{Case, Chart};
use etendue_core::{
    bsdf::{Bsdf, ConductorFresnel, Distribution, Lobe, Roughness},
    rgb::Rgb,
};
use glam::{Vec2, Vec3};
use rand_pcg::{Pcg32, rand_core::Rng};

/// Gold-like, with a different value in each channel.
pub const METAL: ConductorFresnel =
    ConductorFresnel::Complex { eta: Rgb::new(0.2, 0.92, 1.1), k: Rgb::new(3.9, 2.45, 2.14), tint: Rgb::WHITE };

/// 24-bit uniform numbers in `[0, 1)`.
pub struct Uniform(Pcg32);

impl Uniform {
    pub(crate) fn new(seed: u64) -> Uniform {
        Uniform(Pcg32::new(seed, 0x0a02_bdbf_7bb3_c0a7))
    }

    pub(crate) fn one(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 * (f32::EPSILON / 2.0)
    }

    pub(crate) fn two(&mut self) -> Vec2 {
        Vec2::new(self.one(), self.one())
    }
}

/// A unit vector from degrees.
pub(crate) fn direction(theta: f64, phi: f64) -> Vec3 {
    let ((sin, cos), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    Vec3::new((sin * x) as f32, (sin * y) as f32, cos as f32)
}

pub(crate) fn conductor(distribution: Distribution, x: f32, y: f32, fresnel: ConductorFresnel) -> Bsdf {
    let roughness = Roughness { distribution, alpha: Vec2::new(x, y) };
    Bsdf::single(Lobe::RoughConductor { fresnel, roughness }, false)
}

pub(crate) fn dielectric(distribution: Distribution, x: f32, y: f32, eta: f32) -> Bsdf {
    let roughness = Roughness { distribution, alpha: Vec2::new(x, y) };
    Bsdf::single(Lobe::rough_dielectric(eta, roughness), false)
}

/// Every rough lobe at roughness from 1e-4 to 1, isotropic and not, seen from the normal to a tenth of a degree above
/// the horizon; dielectrics from both sides; in charts that follow the lobe.
pub(crate) fn rough_cases() -> Vec<Case> {
    let alphas: [(f32, f32); 8] =
        [(1e-4, 1e-4), (1e-3, 1e-3), (0.01, 0.01), (0.05, 0.05), (0.3, 0.3), (1.0, 1.0), (0.02, 0.5), (1e-4, 0.1)];
    let mut cases = Vec::new();
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for (x, y) in alphas {
            for theta in [0.0, 45.0, 80.0, 89.9] {
                // Two grazing directions whose azimuths need the digits that single precision gives to the height are
                // only distinct along an axis.
                let phi = if theta > 89.0 && x.min(y) < 0.01 { 0.0 } else { 25.0 };
                let wo = direction(theta, phi);
                let alpha = Vec2::new(x, y).as_dvec2();
                let name = format!("{distribution:?} alpha {x} {y} theta {theta}");
                cases.push(Case {
                    name: format!("{name} conductor"),
                    bsdf: conductor(distribution, x, y, METAL),
                    wo,
                    charts: vec![Chart::Reflect(alpha)],
                });
                for (inside, eta) in [(false, 1.5f32), (true, 1.5)] {
                    let relative = if inside { 1.0 / f64::from(eta) } else { f64::from(eta) };
                    cases.push(Case {
                        name: format!("{name} dielectric inside {inside}"),
                        bsdf: dielectric(distribution, x, y, eta),
                        wo: if inside { Vec3::new(wo.x, wo.y, -wo.z) } else { wo },
                        charts: vec![Chart::Reflect(alpha), Chart::Refract(alpha, relative)],
                    });
                }
            }
        }
    }
    cases
}

/// Wide lobes and mixtures, on a plain grid over all directions that knows nothing of half vectors.
pub(crate) fn wide_cases() -> Vec<Case> {
    let lambert = Lobe::Lambert { reflectance: Rgb::new(0.8, 0.5, 0.2) };
    let rough = |x, y| Roughness { distribution: Distribution::Ggx, alpha: Vec2::new(x, y) };
    let metal = Lobe::RoughConductor { fresnel: METAL, roughness: rough(0.4, 0.8) };
    let glass = Lobe::rough_dielectric(1.5, rough(0.6, 0.6));
    let mirror = Lobe::Conductor { fresnel: METAL };
    let mix = |first, second, share, two_sided| Bsdf { first, second: Some((second, share)), two_sided };
    let bsdfs = [
        ("lambert", Bsdf::single(lambert, false)),
        ("lambert, two sides", Bsdf::single(lambert, true)),
        ("metal, two sides", Bsdf::single(metal, true)),
        ("lambert and metal", mix(lambert, metal, 0.3, false)),
        ("metal and lambert, two sides", mix(metal, lambert, 0.9, true)),
        ("lambert and glass", mix(lambert, glass, 0.5, true)),
        ("mirror and lambert", mix(mirror, lambert, 0.6, true)),
        ("glass alone", Bsdf::single(glass, false)),
    ];
    let mut cases = Vec::new();
    for (name, bsdf) in bsdfs {
        for theta in [0.0, 45.0, 80.0, 89.9] {
            // Glass seen at a grazing angle has peaks too sharp for a plain grid.
            if theta > 89.0 && name.contains("glass") {
                continue;
            }
            for wo in [direction(theta, 25.0), direction(180.0 - theta, 25.0)] {
                let name = format!("{name} theta {theta} z {}", wo.z);
                cases.push(Case { name, bsdf, wo, charts: vec![Chart::Sphere] });
            }
        }
    }
    cases
}
