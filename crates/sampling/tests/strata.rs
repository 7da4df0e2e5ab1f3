//! Stratified estimates: their variance as measured, and how samples are shared among strata.

use etendue_core::{
    independent::Independent,
    sampler::{Purpose, Sampler},
    statistics::{moments::Moments, special::gamma_q},
};
use etendue_sampling::strata::{Estimate, Stratum, apportion, estimate, optimal, proportional};
use proptest::prelude::*;

/// An uneven integrand on `[0, 1)`: `x^8`, of integral 1/9.
fn f(x: f64) -> f64 {
    x.powi(8)
}

/// Mean and variance of the integrand over an interval.
fn exact(low: f64, high: f64) -> (f64, f64) {
    let mean_power = |n: i32| (high.powi(n + 1) - low.powi(n + 1)) / (f64::from(n + 1) * (high - low));
    (mean_power(8), mean_power(16) - mean_power(8).powi(2))
}

fn intervals(cuts: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    cuts.windows(2).map(|w| (w[0], w[1]))
}

/// `sum m_i^2 V_i / N_i` from the exact variances.
fn exact_variance(cuts: &[f64], counts: &[u32]) -> f64 {
    intervals(cuts).zip(counts).map(|((a, b), n)| (b - a).powi(2) * exact(a, b).1 / f64::from(*n)).sum()
}

fn sampled(cuts: &[f64], counts: &[u32], sampler: &mut Independent, trial: u32) -> Vec<Stratum> {
    sampler.start_sample(trial, 0);
    let mut next = 0;
    let mut random = || {
        next += 1;
        f64::from(sampler.get_1d(next, Purpose::Lobe))
    };
    let mut stratum = |(a, b): (f64, f64), n: u32| Stratum {
        measure: b - a,
        samples: (0..n).map(|_| f(a + (b - a) * random())).collect(),
    };
    intervals(cuts).zip(counts).map(|(interval, n)| stratum(interval, *n)).collect()
}

/// The variance that many trials scatter with is `variance`, and they say so themselves on average.
fn assert_measured(name: &str, cuts: &[f64], counts: &[u32], variance: f64) {
    const TRIALS: u32 = 20_000;
    let mut sampler = Independent::new(17);
    let estimates: Vec<Estimate> =
        (0..TRIALS).map(|trial| estimate(&sampled(cuts, counts, &mut sampler, trial)).unwrap()).collect();
    let means: Moments = estimates.iter().map(|e| e.mean).collect();
    let z = (means.mean() - 1.0 / 9.0) / means.standard_error();
    assert!(z.abs() < 4.0, "{name}: mean {}, z = {z}", means.mean());
    // Sums of many samples are nearly normal, so that their variance follows a chi-square distribution.
    let degrees = f64::from(TRIALS - 1);
    let p = gamma_q(0.5 * degrees, 0.5 * degrees * means.variance() / variance);
    assert!((5e-5..1.0 - 5e-5).contains(&p), "{name}: variance {} against {variance}, p = {p}", means.variance());
    if counts.contains(&1) {
        // One sample says nothing of its stratum's variance.
        assert!(estimates.iter().all(|e| e.variance == f64::INFINITY));
        return;
    }
    let said: Moments = estimates.iter().map(|e| e.variance).collect();
    let z = (said.mean() - variance) / said.standard_error();
    assert!(z.abs() < 4.0, "{name}: {} said against {variance}, z = {z}", said.mean());
}

const CUTS: [f64; 6] = [0.0, 0.1, 0.4, 0.5, 0.8, 1.0];
const TOTAL: u32 = 60;

fn measures() -> Vec<f64> {
    intervals(&CUTS).map(|(a, b)| b - a).collect()
}

#[test]
fn proportional_allocation_has_the_lectures_variance() {
    let counts = proportional(&measures(), TOTAL).unwrap();
    assert_eq!(counts, [6, 18, 6, 18, 12]);
    let total = f64::from(TOTAL);
    let lecture: f64 = intervals(&CUTS).zip(&counts).map(|((a, b), n)| f64::from(*n) * exact(a, b).1).sum();
    assert_measured("proportional", &CUTS, &counts, lecture / total.powi(2));
    // F = sum N_i F_i / N
    let strata = sampled(&CUTS, &counts, &mut Independent::new(1), 0);
    let mean: f64 = strata.iter().map(|s| s.samples.count() as f64 * s.samples.mean()).sum();
    assert!((estimate(&strata).unwrap().mean - mean / total).abs() < 1e-15);
}

#[test]
fn any_allocation_has_the_general_variance() {
    let counts = [30, 10, 2, 11, 7];
    assert_measured("any", &CUTS, &counts, exact_variance(&CUTS, &counts));
}

#[test]
fn the_optimal_allocation_is_better_than_the_proportional_on_an_uneven_integrand() {
    let pilot = sampled(&CUTS, &[50; 5], &mut Independent::new(5), 0);
    let counts = optimal(&pilot, TOTAL).unwrap();
    assert_eq!(counts.iter().sum::<u32>(), TOTAL);
    let variance = exact_variance(&CUTS, &counts);
    assert_measured("optimal", &CUTS, &counts, variance);
    let proportional = exact_variance(&CUTS, &proportional(&measures(), TOTAL).unwrap());
    assert!(variance < 0.5 * proportional, "{variance:e} against {proportional:e}");
    // It is next to the least there is: (sum m_i sqrt V_i)^2 / N.
    let least = intervals(&CUTS).map(|(a, b)| (b - a) * exact(a, b).1.sqrt()).sum::<f64>().powi(2) / f64::from(TOTAL);
    assert!(variance > least && variance < 1.2 * least, "{variance:e} against {least:e}");
}

#[test]
fn a_stratum_without_samples_is_unknown_and_one_without_measure_is_nothing() {
    let stratum = |measure: f64, values: &[f64]| Stratum { measure, samples: values.iter().copied().collect() };
    assert_eq!(estimate(&[]), Some(Estimate { mean: 0.0, variance: 0.0 }));
    assert_eq!(estimate(&[stratum(0.5, &[1.0]), stratum(0.5, &[])]), None);
    let one = estimate(&[stratum(1.0, &[3.0]), stratum(0.0, &[]), stratum(0.0, &[1e300])]).unwrap();
    assert_eq!(one, Estimate { mean: 3.0, variance: f64::INFINITY });
    let two = estimate(&[stratum(0.5, &[1.0, 3.0]), stratum(1.5, &[2.0, 2.0])]).unwrap();
    assert_eq!(two, Estimate { mean: 4.0, variance: 0.25 });
}

#[test]
fn allocations_of_few_samples() {
    for total in [0, 1, 2, 3, 5, 7, 11, 13, 101, 65_537, u32::MAX] {
        for weights in [vec![1.0], vec![0.2, 0.3, 0.5], vec![1.0; 7], vec![1e-300, 1.0, 3.0], vec![f64::MAX; 3]] {
            let counts = apportion(&weights, &weights, total).unwrap();
            assert_eq!(counts.iter().map(|n| u64::from(*n)).sum::<u64>(), u64::from(total), "{weights:?}");
            assert!(counts.iter().all(|n| *n > 0) || (total as usize) < weights.len(), "{weights:?}: {counts:?}");
        }
    }
    // Too few for all: the largest come first.
    assert_eq!(proportional(&[0.2, 0.5, 0.3], 2), Some(vec![0, 1, 1]));
    assert_eq!(proportional(&[0.25; 4], 3), Some(vec![1, 1, 1, 0]));
    assert_eq!(proportional(&[0.25; 4], 7), Some(vec![2, 2, 2, 1]));
    // One each for the small, and the rest in proportion.
    assert_eq!(proportional(&[1e-9, 2.0, 1e-9, 1.0], 11), Some(vec![1, 6, 1, 3]));
}

#[test]
fn strata_of_zero_measure_get_nothing() {
    assert_eq!(proportional(&[0.0, 1.0, 0.0, 1.0], 5), Some(vec![0, 3, 0, 2]));
    assert_eq!(proportional(&[0.0, 0.0], 5), Some(vec![0, 0]));
    assert_eq!(proportional(&[], 5), Some(vec![]));
    // Whatever their variance.
    assert_eq!(apportion(&[0.0, 1.0, 1.0], &[9.0, 1.0, 0.0], 5), Some(vec![0, 4, 1]));
}

#[test]
fn what_is_no_measure_is_refused() {
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(proportional(&[1.0, bad], 5), None);
        assert_eq!(apportion(&[1.0, 1.0], &[1.0, bad], 5), None);
    }
    assert_eq!(apportion(&[1.0], &[1.0, 1.0], 5), None);
}

#[test]
fn pilots_without_variance_or_without_enough_samples() {
    let stratum = |measure: f64, values: &[f64]| Stratum { measure, samples: values.iter().copied().collect() };
    let flat = [stratum(0.75, &[1.0; 4]), stratum(0.25, &[2.0; 4])];
    assert_eq!(optimal(&flat, 8), Some(vec![6, 2]));
    let half = [stratum(0.5, &[1.0; 4]), stratum(0.5, &[2.0, 3.0]), stratum(0.0, &[])];
    assert_eq!(optimal(&half, 8), Some(vec![1, 7, 0]));
    assert_eq!(optimal(&[stratum(0.5, &[1.0]), stratum(0.5, &[2.0, 3.0])], 8), None);
}

proptest! {
    /// In expectation: the difference is the scatter of the strata's means.
    #[test]
    fn proportional_allocation_is_never_worse_than_none(counts in prop::collection::vec(1..40_u32, 1..12)) {
        let total = f64::from(counts.iter().sum::<u32>());
        let mut cuts = vec![0.0];
        for count in &counts {
            cuts.push(cuts[cuts.len() - 1] + f64::from(*count) / total);
        }
        let independent = exact(0.0, 1.0).1 / total;
        let stratified = exact_variance(&cuts, &counts);
        let scatter: f64 = intervals(&cuts).map(|(a, b)| (b - a) * (exact(a, b).0 - 1.0 / 9.0).powi(2)).sum();
        prop_assert!((independent - stratified - scatter / total).abs() <= 1e-13 * independent);
        prop_assert!(stratified <= independent * (1.0 + 1e-13));
    }

    #[test]
    fn shares_are_less_than_one_from_the_exact_ones(weights in prop::collection::vec(1.0..10.0_f64, 1..50), total in 500..5000_u32) {
        let counts = apportion(&weights, &weights, total).unwrap();
        prop_assert_eq!(counts.iter().sum::<u32>(), total);
        let sum: f64 = weights.iter().sum();
        for (w, n) in weights.iter().zip(counts) {
            prop_assert!((f64::from(n) - w / sum * f64::from(total)).abs() < 1.0);
        }
    }

    #[test]
    fn a_larger_weight_has_no_fewer_samples_and_all_have_one(
        weights in prop::collection::vec(prop_oneof![Just(0.0), 1e-6..1e3_f64], 1..50), total in 0..5000_u32,
    ) {
        let counts = apportion(&vec![1.0; weights.len()], &weights, total).unwrap();
        prop_assert_eq!(counts.iter().sum::<u32>(), total);
        let enough = total as usize >= weights.len();
        prop_assert!(!enough || counts.iter().all(|n| *n >= 1));
        for (i, j) in (0..weights.len()).flat_map(|i| (0..weights.len()).map(move |j| (i, j))) {
            prop_assert!(weights[i] <= weights[j] || counts[i] >= counts[j]);
        }
    }
}
