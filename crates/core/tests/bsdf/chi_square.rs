//! Pearson's chi-square test.

/// The probability of a statistic at least as large if `observed` counts have the `expected` means. Cells that expect
/// fewer than 5 are pooled.
pub(crate) fn p_value(observed: &[f64], expected: &[f64]) -> f64 {
    let (mut statistic, mut cells) = (0.0, 0u32);
    let (mut pooled_observed, mut pooled_expected) = (0.0, 0.0);
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 5.0 {
            pooled_observed += o;
            pooled_expected += e;
        } else {
            statistic += (o - e) * (o - e) / e;
            cells += 1;
        }
    }
    if pooled_expected >= 5.0 {
        statistic += (pooled_observed - pooled_expected).powi(2) / pooled_expected;
        cells += 1;
    } else if pooled_observed > 0.0 {
        // Too few are expected for the normal approximation: a bound on the Poisson tail [Mitzenmacher and Upfal 2005,
        // thm. 5.4] rejects a crowd where next to nothing should be.
        let (o, e) = (pooled_observed, pooled_expected.max(1e-6));
        if o > e && (o - e - o * (o / e).ln()).exp() < 1e-12 {
            return 0.0;
        }
    }
    assert!(cells >= 2, "a test needs at least two cells");
    upper_gamma(0.5 * f64::from(cells - 1), 0.5 * statistic)
}

/// The regularised upper incomplete gamma function [Abramowitz and Stegun 1964, eq. 6.5.29 and 6.5.31].
fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-15 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        1.0 - front * sum
    } else {
        // The continued fraction 1 / (x + (1 - a) / (1 + 1 / (x + (2 - a) / ...))), from its far end.
        let mut tail = x;
        for i in (1..=2000).rev() {
            let i = f64::from(i);
            tail = x + (i - a) / (1.0 + i / tail);
        }
        front / tail
    }
}

/// The logarithm of the gamma function: Stirling's series after shifting the argument up.
fn ln_gamma(mut a: f64) -> f64 {
    let mut shift = 0.0;
    while a < 20.0 {
        shift += a.ln();
        a += 1.0;
    }
    let r = 1.0 / (a * a);
    let series = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r / 1680.0))) / a;
    (a - 0.5) * a.ln() - a + 0.5 * std::f64::consts::TAU.ln() + series - shift
}

#[test]
fn upper_gamma_matches_tables() {
    // Quantiles of chi-square: 3.841 at 1 degree of freedom, 124.342 at 100 (5 %); 267.541 at 200 (0.1 %).
    for (freedom, x, p) in [(1.0, 3.841_459, 0.05), (100.0, 124.342_113, 0.05), (200.0, 267.540_528, 0.001)] {
        let got = upper_gamma(freedom / 2.0, x / 2.0);
        assert!((got / p - 1.0).abs() < 1e-4, "{freedom}: {got}");
    }
    assert!((upper_gamma(1.0, 7.0) / (-7f64).exp() - 1.0).abs() < 1e-12);
}

#[test]
fn a_wrong_density_is_rejected() {
    // Counts of a slightly tilted density against a flat one.
    let observed: Vec<f64> = (0..100).map(|i| 1000.0 + (f64::from(i) - 49.5) * 4.0).collect();
    assert!(p_value(&observed, &[1000.0; 100]) < 1e-9);
    assert!(p_value(&[1000.0; 100], &[1000.0; 100]) > 0.999);
    assert_eq!(p_value(&[1000.0, 1000.0, 50.0], &[1000.0, 1000.0, 0.01]), 0.0);
}
