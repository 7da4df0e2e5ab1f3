//! Pearson's chi-square test, and what many tests at once need.

use super::special::gamma_q;

/// Outcome of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquare {
    /// Sum over pooled cells of `(observed - expected)^2 / expected`.
    pub statistic: f64,
    /// Pooled cells less one.
    pub degrees: usize,
    /// Probability of a statistic at least this large if the expectation is right.
    pub p_value: f64,
}

/// Tests counts against expected counts, which must have the same total.
///
/// Cells are pooled, those of lowest expectation first, until every pool is expected to hold at least `smallest` (5 is
/// customary), for the statistic follows its distribution only then. A count in a cell of expectation 0 gives p-value 0.
///
/// # Panics
/// If the lengths differ, or an expectation is negative or not finite.
pub fn test(observed: &[u64], expected: &[f64], smallest: f64) -> ChiSquare {
    assert_eq!(observed.len(), expected.len());
    assert!(expected.iter().all(|e| e.is_finite() && *e >= 0.0), "an expected count is no number");
    let mut cells: Vec<(f64, f64)> = Vec::with_capacity(expected.len());
    for (&o, &e) in observed.iter().zip(expected) {
        if e > 0.0 {
            cells.push((e, o as f64));
        } else if o > 0 {
            return ChiSquare { statistic: f64::INFINITY, degrees: expected.len() - 1, p_value: 0.0 };
        }
    }
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));

    let mut pools: Vec<(f64, f64)> = Vec::new();
    let mut open = (0.0, 0.0);
    for (e, o) in cells {
        open = (open.0 + e, open.1 + o);
        if open.0 >= smallest {
            pools.push(std::mem::take(&mut open));
        }
    }
    match pools.last_mut() {
        Some(last) => *last = (last.0 + open.0, last.1 + open.1),
        None => pools.push(open),
    }
    let degrees = pools.len() - 1;
    if degrees == 0 {
        return ChiSquare { statistic: 0.0, degrees, p_value: 1.0 };
    }
    let statistic = pools.iter().map(|(e, o)| (o - e).powi(2) / e).sum();
    ChiSquare { statistic, degrees, p_value: gamma_q(0.5 * degrees as f64, 0.5 * statistic) }
}

/// The significance of each of `tests` independent tests such that one of them fails by chance with probability
/// `significance` [Šidák 1967].
pub fn sidak(significance: f64, tests: usize) -> f64 {
    // 1 - (1 - significance)^(1 / tests), without its cancellation.
    -((-significance).ln_1p() / tests as f64).exp_m1()
}

/// The p-value of `tests` independent tests together, of which the smallest is `smallest`: the inverse of [`sidak`].
pub fn sidak_p_value(smallest: f64, tests: usize) -> f64 {
    -((-smallest).ln_1p() * tests as f64).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        independent::Independent,
        sampler::{Purpose, Sampler},
    };

    #[test]
    fn known_values() {
        // A die thrown 60 times; p computed with 25 digits.
        let outcome = test(&[5, 8, 9, 8, 10, 20], &[10.0; 6], 5.0);
        assert_eq!((outcome.statistic, outcome.degrees), (13.4, 5));
        assert!((outcome.p_value - 0.01990522033477438).abs() < 1e-12, "{outcome:?}");
    }

    #[test]
    fn cells_are_pooled_to_the_smallest_expectation() {
        let outcome = test(&[1, 1, 2, 1, 45, 50], &[1.0, 1.0, 1.0, 2.0, 45.0, 50.0], 5.0);
        assert_eq!((outcome.statistic, outcome.degrees, outcome.p_value), (0.0, 2, 1.0));
        let outcome = test(&[3, 0], &[1.0, 2.0], 5.0);
        assert_eq!((outcome.degrees, outcome.p_value), (0, 1.0));
        assert_eq!(test(&[], &[], 5.0).p_value, 1.0);
    }

    #[test]
    fn the_impossible_fails() {
        assert_eq!(test(&[99, 1], &[100.0, 0.0], 5.0).p_value, 0.0);
        assert_eq!(test(&[100, 0], &[100.0, 0.0], 5.0).p_value, 1.0);
    }

    #[test]
    fn p_values_of_a_true_hypothesis_are_uniform_and_of_a_false_one_small() {
        let run = |index: u32, skew: f32| {
            let mut sampler = Independent::new(2);
            let mut counts = [0; 10];
            for sample in 0..1000 {
                sampler.start_sample(index, sample);
                counts[(sampler.get_1d(0, Purpose::Lobe).powf(skew) * 10.0) as usize] += 1;
            }
            test(&counts, &[100.0; 10], 5.0).p_value
        };
        let mut deciles = [0; 10];
        for index in 0..2000 {
            deciles[((run(index, 1.0) * 10.0) as usize).min(9)] += 1;
        }
        assert!(test(&deciles, &[200.0; 10], 5.0).p_value > 1e-4, "{deciles:?}");
        assert!((0..20).all(|index| run(index, 1.3) < 1e-4));
    }

    #[test]
    fn sidak_is_its_own_inverse() {
        assert!((sidak(0.05, 10) - 0.005116196891823743).abs() < 1e-16);
        assert!((sidak_p_value(sidak(1e-4, 100_000), 100_000) - 1e-4).abs() < 1e-15);
        assert_eq!(sidak(0.01, 1), 0.01);
    }
}
