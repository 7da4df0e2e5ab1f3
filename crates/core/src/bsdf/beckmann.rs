//! Masking and visible normals of the Beckmann distribution.

use crate::warp::HALF_STEP;
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_2_SQRT_PI;

/// One over the square root of pi.
const FRAC_1_SQRT_PI: f32 = 0.5 * FRAC_2_SQRT_PI;

/// Slopes beyond this have a probability below 1e-11, which 24-bit uniform numbers do not reach.
const STEEPEST: f32 = 5.0;

/// `(erfc(-x), exp(-x²))`, the first with an absolute error below 1.5e-7 [Abramowitz and Stegun 1964, eq. 7.1.26].
#[inline]
fn one_plus_erf(x: f32) -> (f32, f32) {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let exp = (-x * x).exp();
    let polynomial = t * (0.254_829_6 + t * (-0.284_496_74 + t * (1.421_413_7 + t * (-1.453_152 + t * 1.061_405_4))));
    let tail = polynomial * exp;
    (if x < 0.0 { tail } else { 2.0 - tail }, exp)
}

/// The `x` with `(1 + erf x) / 2 = u` for `u` in (0, 1): single precision approximation of [Giles 2010, table 5].
#[inline]
fn inverse_cdf(u: f32) -> f32 {
    let horner = |w: f32, c: [f32; 9]| c.iter().fold(0.0, |sum, c| sum * w + c);
    let w = -(4.0 * u * (1.0 - u)).ln();
    let p = if w < 5.0 {
        horner(
            w - 2.5,
            [
                2.810_226_4e-8,
                3.432_739_4e-7,
                -3.523_387_7e-6,
                -4.391_506_5e-6,
                2.185_808_7e-4,
                -1.253_725e-3,
                -4.177_681_6e-3,
                0.246_640_73,
                1.501_409_4,
            ],
        )
    } else {
        horner(
            w.sqrt() - 3.0,
            [
                -2.002_142_6e-4,
                1.009_505_6e-4,
                1.349_343_2e-3,
                -3.673_428_4e-3,
                5.739_508e-3,
                -7.622_461_3e-3,
                9.438_870_5e-3,
                1.001_674,
                2.832_976_8,
            ],
        )
    };
    p * (2.0 * u - 1.0)
}

/// Smith's masking over the cosine, exact. `spread` is alpha times the sine.
#[inline]
pub(super) fn masking_over_cos(cos: f32, spread: f32) -> f32 {
    // [Walter et al. 2007, eq. 26] times 1 / cos, with a = cos / spread, infinite for light along the normal.
    let (one_plus_erf, exp) = one_plus_erf(cos / spread);
    2.0 / (cos * one_plus_erf + spread * exp * FRAC_1_SQRT_PI)
}

/// Smith's masking over the cosine in the rational approximation of [Walter et al. 2007, eq. 27], relative error
/// below 0.35 %.
#[inline]
pub(super) fn approximate_masking_over_cos(cos: f32, spread: f32) -> f32 {
    let a = cos / spread;
    if a < 1.6 { (3.535 + 2.181 * a) / ((1.0 + a * (2.276 + 2.577 * a)) * spread) } else { 1.0 / cos }
}

/// A visible normal for roughness 1 seen from the unit vector `wo`, not normalised.
#[inline]
pub(super) fn sample_visible(wo: Vec3, u: Vec2) -> Vec3 {
    let sin = wo.truncate().length();
    let forward = if sin > 0.0 { wo.truncate() / sin } else { Vec2::X };
    let along = visible_slope(wo.z, sin, u.x);
    // Across the plane of incidence visibility does not depend on the slope.
    let across = inverse_cdf(u.y.max(HALF_STEP));
    // The normal of slopes (x, y) is (-x, -y, 1).
    (-along * forward - across * forward.perp()).extend(1.0)
}

/// The slope along the plane of incidence at the quantile `u` among those visible under the angle with the given
/// cosine and sine: density `(cos - x sin) exp(-x²)` up to a factor, for `x < cos / sin` [Heitz and d'Eon 2014, sec. 4].
#[inline]
fn visible_slope(cos: f32, sin: f32, u: f32) -> f32 {
    let cumulated = |x: f32| {
        let (one_plus_erf, exp) = one_plus_erf(x);
        (cos * one_plus_erf + sin * FRAC_1_SQRT_PI * exp, exp)
    };
    let (mut low, mut high) = (-STEEPEST, (cos / sin).min(STEEPEST));
    let goal = u.max(HALF_STEP) * cumulated(high).0;
    // Halley's method, kept inside a shrinking bracket; the start is exact for light along the normal.
    let mut x = inverse_cdf(u.max(HALF_STEP) * 0.5 * one_plus_erf(high).0);
    for _ in 0..16 {
        if !(x > low && x < high) {
            x = 0.5 * (low + high);
        }
        let (value, exp) = cumulated(x);
        let error = value - goal;
        if error > 0.0 {
            high = x;
        } else {
            low = x;
        }
        // Newton's step, and the second derivative over the first.
        let visible = cos - x * sin;
        let step = error / (FRAC_2_SQRT_PI * exp * visible);
        let bend = -2.0 * x - sin / visible;
        let step = step / (1.0 - 0.5 * step * bend);
        x -= step;
        // The next step would be about as large as the cube of this one, in units of the distance to the steepest slope.
        if step.abs() * sin.max(visible) < 2e-3 * visible {
            break;
        }
    }
    x.clamp(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_cdf_inverts_the_error_function() {
        for i in 1..4096 {
            let u = i as f32 / 4096.0;
            let (one_plus_erf, _) = one_plus_erf(inverse_cdf(u));
            assert!((0.5 * one_plus_erf - u).abs() < 4e-7, "{u}");
        }
    }

    #[test]
    fn the_rational_masking_is_within_its_stated_error() {
        for i in 1..=2000 {
            let theta = i as f32 / 2000.0 * std::f32::consts::FRAC_PI_2;
            for alpha in [1e-4, 0.01, 0.3, 1.0] {
                let exact = masking_over_cos(theta.cos(), alpha * theta.sin());
                let rational = approximate_masking_over_cos(theta.cos(), alpha * theta.sin());
                assert!((rational / exact - 1.0).abs() < 3.5e-3, "{theta} {alpha}: {rational} against {exact}");
            }
        }
    }

    #[test]
    fn visible_slopes_are_at_their_quantiles() {
        for i in 0..=200 {
            let theta = i as f32 / 200.0 * std::f32::consts::FRAC_PI_2;
            let (sin, cos) = theta.sin_cos();
            let cumulated = |x: f32| {
                let (e, exp) = one_plus_erf(x);
                cos * e + sin * FRAC_1_SQRT_PI * exp
            };
            for j in 0..=256 {
                let u = (j as f32 / 256.0).min(1.0 - f32::EPSILON / 2.0);
                let x = visible_slope(cos, sin, u);
                assert!(x.is_finite() && x * sin <= cos * (1.0 + 1e-5), "{theta} {u}: {x}");
                let quantile = cumulated(x) / cumulated((cos / sin).min(STEEPEST));
                assert!((quantile - u).abs() < 1e-6, "{theta} {u}: {x} is at {quantile}");
            }
        }
    }
}
