//! Special functions and the distributions that the tests need, in double precision.

use std::f64::consts::{PI, SQRT_2};

/// Terms after which a series or a continued fraction is taken to have converged whatever its last step.
const TERMS_LIMIT: u32 = 100_000;

/// `ln |Gamma(x)|` for `x > 0`; absolute error about 1e-14, relative to the value where that is large.
pub fn ln_gamma(x: f64) -> f64 {
    // Gamma(x) = Gamma(x + n) / (x (x + 1) ... (x + n - 1)), up to where Stirling's series is exact to a double.
    let mut shifted = x;
    let mut product = 1.0;
    while shifted < 12.0 {
        product *= shifted;
        shifted += 1.0;
    }
    // [DLMF 5.11.1], B_2k / (2k (2k - 1)).
    const SERIES: [f64; 7] =
        [1.0 / 12.0, -1.0 / 360.0, 1.0 / 1260.0, -1.0 / 1680.0, 1.0 / 1188.0, -691.0 / 360_360.0, 1.0 / 156.0];
    let inverse = 1.0 / shifted;
    let series = SERIES.iter().rev().fold(0.0, |sum, b| sum * inverse * inverse + b) * inverse;
    (shifted - 0.5) * shifted.ln() - shifted + 0.5 * (2.0 * PI).ln() + series - product.ln()
}

/// Regularised lower incomplete gamma function `P(a, x)`, `a > 0`, `x >= 0`.
pub fn gamma_p(a: f64, x: f64) -> f64 {
    if x < a + 1.0 { gamma_series(a, x) } else { 1.0 - gamma_fraction(a, x) }
}

/// Regularised upper incomplete gamma function `Q(a, x) = 1 - P(a, x)`, accurate where it is small.
pub fn gamma_q(a: f64, x: f64) -> f64 {
    if x < a + 1.0 { 1.0 - gamma_series(a, x) } else { gamma_fraction(a, x) }
}

fn gamma_scale(a: f64, x: f64) -> f64 {
    (a * x.ln() - x - ln_gamma(a)).exp()
}

/// `P(a, x)` by its power series [DLMF 8.11.4].
fn gamma_series(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let mut term = 1.0 / a;
    let mut sum = term;
    for n in 1..TERMS_LIMIT {
        term *= x / (a + f64::from(n));
        sum += term;
        if term <= sum * f64::EPSILON {
            break;
        }
    }
    sum * gamma_scale(a, x)
}

/// `Q(a, x)` by its continued fraction [DLMF 8.9.2].
fn gamma_fraction(a: f64, x: f64) -> f64 {
    if x.is_infinite() {
        return 0.0;
    }
    let fraction = continued_fraction(x + 1.0 - a, |n| {
        let n = f64::from(n);
        (-n * (n - a), x + 2.0 * n + 1.0 - a)
    });
    gamma_scale(a, x) / fraction
}

/// `b0 + a1 / (b1 + a2 / (b2 + ...))` by the modified Lentz method [Thompson and Barnett 1986, sec. 4]; `terms(n)` gives
/// `(a_n, b_n)`.
fn continued_fraction(b0: f64, terms: impl Fn(u32) -> (f64, f64)) -> f64 {
    // A number so small that it stands for 0 without harm beside any other here.
    const TINY: f64 = 1e-300;
    let nonzero = |v: f64| if v == 0.0 { TINY } else { v };
    let mut f = nonzero(b0);
    let (mut c, mut d) = (f, 0.0);
    for n in 1..TERMS_LIMIT {
        let (a, b) = terms(n);
        d = 1.0 / nonzero(b + a * d);
        c = nonzero(b + a / c);
        let step = c * d;
        f *= step;
        if (step - 1.0).abs() <= f64::EPSILON {
            break;
        }
    }
    f
}

/// Regularised incomplete beta function `I_x(a, b)`, `a, b > 0`, `x` in `[0, 1]`.
pub fn beta_i(a: f64, b: f64, x: f64) -> f64 {
    beta_i_with_complement(a, b, x, 1.0 - x)
}

/// `I_x(a, b)` given `y = 1 - x` as well, which may be known more exactly.
fn beta_i_with_complement(a: f64, b: f64, x: f64, y: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if y <= 0.0 {
        return 1.0;
    }
    // The fraction converges fast below the mean; above it the complement is below its own [DLMF 8.17.4].
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta_i_with_complement(b, a, y, x);
    }
    // [DLMF 8.17.22]
    let fraction = continued_fraction(1.0, |n| {
        let m = f64::from(n / 2);
        let numerator = if n % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        (numerator, 1.0)
    });
    let ln_scale = a * x.ln() + b * y.ln() + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b);
    ln_scale.exp() / (a * fraction)
}

/// Error function.
pub fn erf(x: f64) -> f64 {
    gamma_p(0.5, x * x).copysign(x) // [DLMF 7.11.1]
}

/// Complementary error function `1 - erf(x)`, accurate where it is small.
pub fn erfc(x: f64) -> f64 {
    if x >= 0.0 { gamma_q(0.5, x * x) } else { 1.0 + gamma_p(0.5, x * x) }
}

/// Probability that a standard normal variable is at most `x`.
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * erfc(-x / SQRT_2)
}

/// The `x` that a standard normal variable exceeds with probability `1 - p`; infinite at 0 and 1.
pub fn normal_quantile(p: f64) -> f64 {
    quantile(p, normal_cdf)
}

/// Probability that a variable of Student's t distribution with `degrees` degrees of freedom is at most `t`. Infinite
/// degrees give the normal distribution.
pub fn student_t_cdf(t: f64, degrees: f64) -> f64 {
    let tail = 0.5 * student_t_two_sided(t, degrees);
    if t > 0.0 { 1.0 - tail } else { tail }
}

/// Probability that the magnitude of such a variable is at least that of `t`, accurate where it is small.
pub fn student_t_two_sided(t: f64, degrees: f64) -> f64 {
    if degrees.is_infinite() {
        return erfc(t.abs() / SQRT_2);
    }
    if t.is_infinite() {
        return 0.0;
    }
    // [DLMF 8.17; Abramowitz and Stegun 26.7.1]
    let square = t * t;
    beta_i_with_complement(0.5 * degrees, 0.5, degrees / (degrees + square), square / (degrees + square))
}

/// The `t` that such a variable exceeds with probability `1 - p`; infinite at 0 and 1.
pub fn student_t_quantile(p: f64, degrees: f64) -> f64 {
    quantile(p, |t| student_t_cdf(t, degrees))
}

/// Quantile of a distribution that is symmetric about 0, by bisection.
fn quantile(p: f64, cdf: impl Fn(f64) -> f64) -> f64 {
    if p.is_nan() || !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    // On the lower side, where probabilities keep their digits.
    if p > 0.5 {
        return -quantile(1.0 - p, cdf);
    }
    if p == 0.5 {
        return 0.0;
    }
    if p == 0.0 {
        return f64::NEG_INFINITY;
    }
    let mut low = -1.0;
    while cdf(low) > p {
        low *= 2.0;
    }
    let mut high = 0.0;
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if cdf(middle) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::LN_2;

    fn close(value: f64, expected: f64, relative: f64) {
        assert!((value - expected).abs() <= relative * expected.abs(), "{value:e} is not {expected:e}");
    }

    // Expected values computed with 25 digits.

    #[test]
    fn gamma_functions() {
        for (x, expected) in [
            (0.1, 2.252712651734206),
            (1.5, -0.12078223763524522),
            (3.0, LN_2),
            (10.0, 12.801827480081469),
            (100.5, 361.4355404677776),
            (1e6, 12815504.569147613),
        ] {
            close(ln_gamma(x), expected, 1e-13);
        }
        assert!(ln_gamma(1.0).abs() < 1e-14 && ln_gamma(2.0).abs() < 1e-14);
        for (a, x, p, q) in [
            (0.5, 0.1, 0.345279153981423, 0.654720846018577),
            (3.0, 2.0, 0.32332358381693654, 0.6766764161830635),
            (50.0, 60.0, 0.9155933189063081, 0.08440668109369183),
            (1000.0, 900.0, 0.0005499022657117829, 0.9994500977342882),
            (0.01, 1e-5, 0.8963367982671973, 0.1036632017328028),
        ] {
            close(gamma_p(a, x), p, 1e-11);
            close(gamma_q(a, x), q, 1e-11);
        }
        assert_eq!((gamma_p(2.0, 0.0), gamma_q(2.0, 0.0), gamma_q(2.0, f64::INFINITY)), (0.0, 1.0, 0.0));
    }

    #[test]
    fn beta_function() {
        for (a, b, x, expected) in [
            (0.5, 0.5, 0.3, 0.36901011956554536),
            (2.0, 3.0, 0.4, 0.5248),
            (50.0, 0.5, 0.99, 0.3173043978741974),
            (100.0, 200.0, 0.3, 0.10884306564490975),
            (1e4, 0.5, 0.9999, 0.15729401776333515),
        ] {
            close(beta_i(a, b, x), expected, 1e-10);
            close(beta_i(b, a, 1.0 - x), 1.0 - expected, 1e-10);
        }
        assert_eq!((beta_i(2.0, 3.0, 0.0), beta_i(2.0, 3.0, 1.0)), (0.0, 1.0));
    }

    #[test]
    fn normal_distribution() {
        for (x, f, c) in [
            (0.1, 0.11246291601828488, 0.887537083981715),
            (1.0, 0.8427007929497149, 0.15729920705028513),
            (4.0, 0.9999999845827421, 1.541725790028002e-8),
            (6.0, 1.0, 2.1519736712498913e-17),
        ] {
            close(erf(x), f, 1e-13);
            close(erf(-x), -f, 1e-13);
            close(erfc(x), c, 1e-12);
            close(erfc(-x), 2.0 - c, 1e-13);
        }
        for (x, p) in [
            (-8.0, 6.220960574271784e-16),
            (-6.0, 9.86587645037698e-10),
            (-1.5, 0.06680720126885807),
            (0.3, 0.6179114221889527),
            (2.0, 0.9772498680518208),
        ] {
            close(normal_cdf(x), p, 1e-12);
        }
        for (p, x) in [(1e-10, -6.361340902404057), (0.025, -1.9599639845400543), (0.3, -0.5244005127080408)] {
            close(normal_quantile(p), x, 1e-12);
            close(normal_quantile(1.0 - p), -x, 1e-7);
        }
        assert_eq!(normal_quantile(0.5), 0.0);
        assert_eq!((normal_quantile(0.0), normal_quantile(1.0)), (f64::NEG_INFINITY, f64::INFINITY));
        assert!(normal_quantile(f64::NAN).is_nan() && normal_quantile(1.1).is_nan());
    }

    #[test]
    fn student_t_distribution() {
        for (degrees, p, t, at_2) in [
            (7.0, 0.975, 2.3646242515927853, 0.957190335718512),
            (1.0, 0.99, 31.82051595377396, 0.8524163823495667),
            (3.5, 0.6, 0.2732654540557797, 0.9369307387120432),
            (30.0, 0.0005, -3.645958635042022, 0.9726874775185085),
            (1000.0, 0.975, 1.9623390808264085, 0.9771148267533741),
        ] {
            close(student_t_quantile(p, degrees), t, 1e-9);
            close(student_t_cdf(2.0, degrees), at_2, 1e-12);
            close(student_t_cdf(-2.0, degrees), 1.0 - at_2, 1e-11);
            close(student_t_two_sided(2.0, degrees), 2.0 * (1.0 - at_2), 1e-11);
        }
        close(student_t_cdf(1.5, f64::INFINITY), normal_cdf(1.5), 1e-15);
        assert_eq!(student_t_cdf(0.0, 3.0), 0.5);
        assert_eq!(student_t_two_sided(f64::INFINITY, 3.0), 0.0);
        // One degree is Cauchy's distribution, whose tail is about 1 / (pi t).
        close(student_t_two_sided(1e8, 1.0), 2.0 / (PI * 1e8), 1e-9);
    }
}
