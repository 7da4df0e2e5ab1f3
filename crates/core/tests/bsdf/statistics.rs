//! Samples against densities, and energy.

use crate::{
    Uniform,
    chart::{Case, Chart, Integral},
    chi_square, conductor, direction, rough_cases, wide_cases,
};
use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, TransportMode},
    has,
    rgb::Rgb,
};

/// Cells along each side of a chart.
pub(crate) const CELLS: usize = 12;
const SAMPLES: usize = 100_000;

/// For each case: sampled directions follow `pdf_w` (chi-square), it integrates to the probability of scattering at
/// all, and weights average to the directional albedo.
pub(crate) fn check(cases: &[Case], seed: u64) {
    // The chance that one of the cases fails by bad luck is 1e-3 [Sidak 1967].
    let significance = 1.0 - (1.0 - 1e-3f64).powf(1.0 / cases.len() as f64);
    let failures: Vec<String> =
        cases.iter().zip(seed..).flat_map(|(c, seed)| check_case(c, seed, significance)).collect();
    assert!(failures.is_empty(), "{} in {} cases:\n{}", failures.len(), cases.len(), failures.join("\n"));
}

fn check_case(case: &Case, seed: u64, significance: f64) -> Vec<String> {
    let cells = case.integrate(CELLS);
    let total = cells.iter().copied().fold(Integral::default(), Integral::plus);
    let n = SAMPLES as f64;

    let mut uniform = Uniform::new(seed);
    let (mut counts, mut outside, mut scattered) = (vec![0.0; cells.len()], 0.0, 0.0);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..SAMPLES {
        let sample = case.bsdf.sample::<{ has::ALL }>(case.wo, uniform.one(), uniform.two(), TransportMode::Radiance);
        let Some(sample) = sample.filter(|s| !s.delta) else { continue };
        match case.cell(sample.wi, CELLS) {
            Some(cell) => counts[cell] += 1.0,
            None => outside += 1.0,
        }
        scattered += 1.0;
        sum += f64::from(sample.weight.r);
        squares += f64::from(sample.weight.r).powi(2);
    }

    let mut failures = Vec::new();
    if total.pdf == 0.0 {
        if scattered > 0.0 {
            failures.push(format!("{}: scatters where the density is 0", case.name));
        }
        return failures;
    }
    let mut expected: Vec<f64> = cells.iter().map(|c| c.pdf * n).collect();
    // In no chart; and not scattered: below the horizon, or taken by a delta lobe.
    expected.extend([0.0, (1.0 - total.pdf).max(0.0) * n]);
    counts.extend([outside, n - scattered]);
    let p = chi_square::p_value(&counts, &expected);
    if p < significance {
        failures.push(format!("{}: p = {p:e}", case.name));
    }
    let fraction = scattered / n;
    // Standard errors, with room for an event too rare to be among the samples.
    let error = ((total.pdf * (1.0 - total.pdf)).max(0.0) / n + 1.0 / (n * n)).sqrt();
    if (fraction - total.pdf).abs() > 4.0 * error + total.error {
        failures.push(format!("{}: density integrates to {total:?}, {fraction} scattered", case.name));
    }
    let mean = sum / n;
    let error = ((squares / n - mean * mean).max(0.0) / n + 1.0 / (n * n)).sqrt();
    if (mean - total.albedo).abs() > 4.0 * error + total.error {
        failures.push(format!("{}: {total:?}, sampled {mean} +- {error}", case.name));
    }
    failures
}

#[test]
fn ggx_conductors_scatter_as_their_density_says() {
    check(&select("Ggx", "conductor"), 1000);
}

#[test]
fn beckmann_conductors_scatter_as_their_density_says() {
    check(&select("Beckmann", "conductor"), 2000);
}

#[test]
fn ggx_dielectrics_scatter_as_their_density_says() {
    check(&select("Ggx", "dielectric"), 3000);
}

#[test]
fn beckmann_dielectrics_scatter_as_their_density_says() {
    check(&select("Beckmann", "dielectric"), 4000);
}

fn select(distribution: &str, lobe: &str) -> Vec<Case> {
    rough_cases().into_iter().filter(|c| c.name.contains(distribution) && c.name.contains(lobe)).collect()
}

#[test]
fn wide_lobes_and_mixtures_scatter_as_their_density_says() {
    check(&wide_cases(), 5000);
}

/// Directional albedo of a rough conductor that absorbs nothing; what is missing from 1 is what the single-scattering
/// model loses. The documentation of the module quotes this table.
#[test]
fn single_scattering_loses_what_the_documentation_says() {
    let table = include_str!("../../src/bsdf/mod.rs");
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for alpha in [0.05f32, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0] {
            let mut row = format!("| {distribution:?} | {alpha} |");
            for theta in [0.0, 45.0, 60.0, 80.0, 89.0] {
                let case = Case {
                    name: String::new(),
                    bsdf: conductor(distribution, alpha, alpha, ConductorFresnel::Constant(Rgb::WHITE)),
                    wo: direction(theta, 25.0),
                    charts: vec![Chart::Reflect(glam::DVec2::splat(f64::from(alpha)))],
                };
                let albedo: f64 = case.integrate(CELLS).iter().map(|c| c.albedo).sum();
                // The rational masking of the Beckmann distribution is up to 0.35 % off.
                let most = if distribution == Distribution::Ggx { 1.00001 } else { 1.0035 };
                assert!(albedo <= most, "{distribution:?} {alpha} {theta}: {albedo}");
                // Rounded, and 0 without a sign.
                row += &format!(" {:.1} |", (1000.0 * (1.0 - albedo)).round() / 10.0 + 0.0);
            }
            assert!(table.contains(&row), "not in the documentation: {row}");
        }
    }
}
