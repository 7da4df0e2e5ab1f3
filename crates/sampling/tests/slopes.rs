//! How fast the variance of patterns falls, against theory.
//!
//! The points of a logarithmic plot scatter by the trials alone where a law holds exactly. The intervals are of 99 %.

use etendue_core::statistics::{
    moments::Moments,
    slope::{Slope, fit},
};
use etendue_sampling::{
    integrands::Integrand,
    pattern::Pattern,
    strata::{Stratum, estimate, proportional},
};
use glam::Vec2;

const PLANAR: [Integrand; 6] =
    [Integrand::Smooth1, Integrand::Smooth2, Integrand::Gaussian, Integrand::Edge, Integrand::Corner, Integrand::Disk];

/// Numbers are multiples of 2^-24: the middle of their step is meant, or rounding down shows as a bias of 2^-25, which the
/// Sobol points' error falls below at some ten thousand points.
fn coordinates(p: Vec2) -> [f64; 2] {
    p.to_array().map(|x| f64::from(x) + 2.0_f64.powi(-25))
}

/// Squared errors of `trials` patterns on integrands.
fn all_squared_errors<const K: usize>(
    pattern: Pattern,
    integrands: [Integrand; K],
    count: u32,
    trials: u64,
) -> [Moments; K] {
    let mut errors = [Moments::default(); K];
    for trial in 0..trials {
        let points = pattern.points(count, 1 + trial + (u64::from(count) << 32));
        for (errors, integrand) in errors.iter_mut().zip(integrands) {
            let sum: f64 = points.iter().map(|p| integrand.evaluate(&coordinates(*p))).sum();
            errors.push((sum / f64::from(count) - integrand.exact()).powi(2));
        }
    }
    errors
}

fn squared_errors(pattern: Pattern, integrand: Integrand, count: u32, trials: u64) -> Moments {
    all_squared_errors(pattern, [integrand], count, trials)[0]
}

/// Slopes of the variance on integrands.
fn slopes<const K: usize>(pattern: Pattern, integrands: [Integrand; K], counts: &[u32], trials: u64) -> [Slope; K] {
    let levels: Vec<[Moments; K]> =
        counts.iter().map(|&n| all_squared_errors(pattern, integrands, n, trials)).collect();
    std::array::from_fn(|k| {
        let points: Vec<(f64, f64)> = counts.iter().zip(&levels).map(|(&n, l)| (n.into(), l[k].mean())).collect();
        fit(&points, 0.99).unwrap()
    })
}

fn assert_holds(pattern: Pattern, integrand: Integrand, found: Slope, theory: f64) {
    let (name, on) = (pattern.name(), integrand.name());
    assert!((found.slope - theory).abs() <= found.half_width, "{name} on {on}: {found:?} does not hold {theory}");
    assert!(found.half_width < 0.15, "{name} on {on}: {found:?} says nothing");
}

#[test]
fn independent_points_fall_as_one_over_their_number() {
    let found = slopes(Pattern::Independent, PLANAR, &[4, 8, 16, 32, 64, 128, 256, 512], 3000);
    for (integrand, found) in PLANAR.into_iter().zip(found) {
        assert_holds(Pattern::Independent, integrand, found, -1.0);
    }
}

/// Of N strata, of side `N^(-1/2)`, about `N^(1/2)` meet an edge, and only they have variance: `N^(1/2) / N^2`. In a
/// smooth integrand all do, in proportion to their side squared: `N N^-1 / N^2`.
#[test]
fn jittered_points_fall_as_an_edge_or_a_smooth_integrand_lets_them() {
    let laws = [
        (Integrand::Edge, -1.5),
        (Integrand::Corner, -1.5),
        (Integrand::Disk, -1.5),
        (Integrand::Smooth2, -2.0),
        (Integrand::Gaussian, -2.0),
    ];
    // Squares, whose strata are squares.
    let counts = [64, 100, 196, 324, 576, 1024, 1600, 2500];
    let found = slopes(Pattern::Jittered, laws.map(|law| law.0), &counts, 800);
    for ((integrand, theory), found) in laws.into_iter().zip(found) {
        assert_holds(Pattern::Jittered, integrand, found, theory);
    }
}

/// `N^-3` up to a logarithm for each further dimension [Owen 1997].
#[test]
fn scrambled_sobol_points_fall_nearly_with_the_cube() {
    let counts = [32, 64, 128, 256, 512, 1024, 2048, 4096];
    let integrands = [Integrand::Smooth1, Integrand::Smooth2, Integrand::Edge];
    let [line, square, edge] = slopes(Pattern::Sobol, integrands, &counts, 600);
    assert_holds(Pattern::Sobol, Integrand::Smooth1, line, -3.0);
    let beyond = |found: Slope, low: f64, high: f64| {
        assert!(found.slope - found.half_width > low && found.slope + found.half_width < high, "{found:?}");
    };
    beyond(square, -3.1, -2.6);
    // An edge leaves them what it leaves jittered points.
    beyond(edge, -1.7, -1.35);
}

#[test]
fn best_candidates_start_lower_and_fall_as_independent_points_in_the_end() {
    let integrands = [Integrand::Smooth2, Integrand::Gaussian, Integrand::Edge];
    let at = |count, trials| all_squared_errors(Pattern::BestCandidate, integrands, count, trials).map(|m| m.mean());
    let (first, second, third) = (at(64, 2000), at(256, 400), at(1024, 40));
    for (k, integrand) in integrands.into_iter().enumerate() {
        let one = squared_errors(Pattern::Independent, integrand, 1, 40_000).mean();
        let name = integrand.name();
        let share = 64.0 * first[k] / one;
        assert!(share < 0.5, "{name}: {share} of independent points' variance");
        let early = (second[k] / first[k]).ln() / 4.0_f64.ln();
        let late = (third[k] / second[k]).ln() / 4.0_f64.ln();
        assert!(early < -0.85 && late < -0.7 && late > -1.45, "{name}: slopes {early}, then {late}");
    }
}

#[test]
fn one_sample_a_stratum_is_never_worse_than_independent_samples() {
    for integrand in PLANAR {
        for count in [4, 16, 64, 256] {
            let strata = squared_errors(Pattern::Jittered, integrand, count, 3000);
            let independent = squared_errors(Pattern::Independent, integrand, count, 3000);
            let z = (strata.mean() - independent.mean()) / strata.standard_error().hypot(independent.standard_error());
            assert!(z < 4.0, "{} with {count}: z = {z}", integrand.name());
        }
    }
}

#[test]
fn proportional_allocation_is_never_worse_than_independent_samples() {
    let measures = [0.125, 0.375, 0.25, 0.25];
    for integrand in PLANAR {
        for total in [16, 64] {
            let counts = proportional(&measures, total).unwrap();
            let error = |trial: u64| {
                let points = Pattern::Independent.points(total, trial ^ (77 << 40));
                let mut low = 0.0;
                let mut rest = points.as_slice();
                let mut strata = Vec::new();
                for (measure, count) in measures.iter().zip(&counts) {
                    let (mine, others) = rest.split_at(*count as usize);
                    let value = |p: &Vec2| {
                        let [x, y] = coordinates(*p);
                        integrand.evaluate(&[low + measure * x, y])
                    };
                    strata.push(Stratum { measure: *measure, samples: mine.iter().map(value).collect() });
                    (low, rest) = (low + measure, others);
                }
                (estimate(&strata).unwrap().mean - integrand.exact()).powi(2)
            };
            let strata: Moments = (0..3000).map(error).collect();
            let independent = squared_errors(Pattern::Independent, integrand, total, 3000);
            let z = (strata.mean() - independent.mean()) / strata.standard_error().hypot(independent.standard_error());
            assert!(z < 4.0, "{} with {total}: z = {z}", integrand.name());
        }
    }
}
