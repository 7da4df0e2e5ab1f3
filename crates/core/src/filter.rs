//! Pixel filters.

use glam::Vec2;
use std::sync::LazyLock;

/// A pixel filter, separable, normalised to integrate to 1; units are pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant over the pixel's square (radius 0.5).
    Box,
    /// Tent of the given radius; Mitsuba's default radius is 1.
    Tent {
        /// Where it reaches zero.
        radius: f32,
    },
    /// Gaussian less its value at the radius `4 stddev`, so that it ends at zero there.
    Gaussian {
        /// Standard deviation; Mitsuba's default is 0.5.
        stddev: f32,
    },
}

impl Filter {
    /// Distance from the pixel's centre, along either axis, beyond which the filter is 0.
    #[inline]
    pub fn radius(&self) -> f32 {
        match *self {
            Filter::Box => 0.5,
            Filter::Tent { radius } => radius,
            Filter::Gaussian { stddev } => GAUSSIAN_END * stddev,
        }
    }

    /// Its value at an offset from the pixel's centre, per square pixel.
    #[inline]
    pub fn evaluate(&self, offset: Vec2) -> f32 {
        self.evaluate_1d(offset.x) * self.evaluate_1d(offset.y)
    }

    /// One of the two factors of [`Filter::evaluate`], per pixel; it integrates to 1 as well.
    #[inline]
    pub fn evaluate_1d(&self, offset: f32) -> f32 {
        match *self {
            Filter::Box => f32::from((-0.5..0.5).contains(&offset)),
            Filter::Tent { radius } => (1.0 - offset.abs() / radius).max(0.0) / radius,
            Filter::Gaussian { stddev } => {
                let z = offset / stddev;
                ((-0.5 * z * z).exp() - GAUSSIAN_AT_END as f32).max(0.0) / (GAUSSIAN_INTEGRAL as f32 * stddev)
            }
        }
    }

    /// An offset from the pixel's centre, distributed as the filter, which makes the weight of every sample 1 and the
    /// samples of a pixel independent of its neighbours' [Ernst, Stamminger and Greiner 2006].
    ///
    /// The filter is positive at the offset, for any `u` in `[0, 1)`.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec2 {
        Vec2::new(self.sample_1d(u.x), self.sample_1d(u.y))
    }

    #[inline]
    fn sample_1d(&self, u: f32) -> f32 {
        // The probability beyond the offset, on its side of the centre. Half a step of the generators' lattice of 2^-24
        // keeps clear of the ends, where the filter is 0, and makes both sides mirror images; neither line rounds.
        const HALF_STEP: f32 = 1.0 / (1 << 25) as f32;
        let (tail, sign) = if u < 0.5 { (u + HALF_STEP, -1.0) } else { (1.0 - u - HALF_STEP, 1.0) };
        match *self {
            Filter::Box => u - 0.5,
            Filter::Tent { radius } => sign * radius * (1.0 - (2.0 * tail).sqrt()),
            Filter::Gaussian { stddev } => sign * stddev * GAUSSIAN_QUANTILES.distance(tail),
        }
    }

    /// Whether its width is one that can be used: positive and finite, its square and the square's inverse too.
    pub fn is_valid(&self) -> bool {
        let radius = self.radius();
        (radius * radius).is_normal() && (1.0 / (radius * radius)).is_normal() && radius > 0.0
    }
}

/// Where the Gaussian ends, in standard deviations.
const GAUSSIAN_END: f32 = 4.0;
/// `exp(-8)`: what is taken off so that it ends at 0.
const GAUSSIAN_AT_END: f64 = 0.000_335_462_627_902_511_85;
/// `sqrt(2 pi) erf(4 / sqrt 2) - 8 exp(-8)`: the integral for standard deviation 1.
const GAUSSIAN_INTEGRAL: f64 = 2.503_785_797_547_237;

/// The truncated Gaussian's quantiles as a cubic Hermite spline.
///
/// With `t` the probability of a greater distance, the distance `z(s)` is smooth in `s = t^(1/4)`: at the filter's end
/// `t` falls with the square of the distance to it, so `4 - z` goes as `s^2`. In `t` itself both ends would need
/// unbounded slopes.
struct Quantiles {
    /// At `s = i / CELLS`: `z`, and its slope per cell.
    knots: [(f32, f32); Quantiles::CELLS + 1],
}

static GAUSSIAN_QUANTILES: LazyLock<Quantiles> = LazyLock::new(Quantiles::new);

impl Quantiles {
    const CELLS: usize = 256;

    fn new() -> Quantiles {
        let end = f64::from(GAUSSIAN_END);
        let mut below = end;
        Quantiles {
            knots: std::array::from_fn(|i| {
                let s = i as f64 / Self::CELLS as f64;
                let z = distance_exceeded_with(s.powi(4), below);
                below = z;
                // From t = s^4 and dt/dz = -2 density(z). At the end both vanish; the slope there is 0.
                let slope = if i == 0 { 0.0 } else { -4.0 * s.powi(3) / (2.0 * density(z)) };
                (z as f32, (slope / Self::CELLS as f64) as f32)
            }),
        }
    }

    /// The distance from the centre, in standard deviations, beyond which there is the probability `tail` on one side.
    #[inline]
    fn distance(&self, tail: f32) -> f32 {
        let s = (2.0 * tail).sqrt().sqrt() * Self::CELLS as f32;
        let cell = (s as usize).min(Self::CELLS - 1);
        let ((z0, d0), (z1, d1)) = (self.knots[cell], self.knots[cell + 1]);
        let s = s - cell as f32;
        let r = 1.0 - s;
        r * r * ((1.0 + 2.0 * s) * z0 + s * d0) + s * s * ((1.0 + 2.0 * r) * z1 - r * d1)
    }
}

/// The truncated Gaussian of standard deviation 1.
fn density(z: f64) -> f64 {
    ((-0.5 * z * z).exp() - GAUSSIAN_AT_END) / GAUSSIAN_INTEGRAL
}

/// The distance that the truncated Gaussian exceeds with probability `t`; it is at most `below`.
fn distance_exceeded_with(t: f64, below: f64) -> f64 {
    let (mut low, mut high) = (0.0, below);
    let mut z = 0.5 * below;
    // Newton's method, by halves where it would leave the bounds. The probability is convex in z, so once below the
    // solution it stays there and doubles its digits.
    for _ in 0..60 {
        let excess = exceeded(z) - t;
        if excess > 0.0 {
            low = z;
        } else {
            high = z;
        }
        let newton = z + excess / (2.0 * density(z));
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - z).abs() <= 1e-14 {
            return next;
        }
        z = next;
    }
    z
}

/// The probability of the truncated Gaussian beyond `z`, on both sides.
fn exceeded(z: f64) -> f64 {
    // In d = 4 - z: exp(-(4 - d)^2 / 2) - exp(-8) = exp(-8) (exp(4 d - d^2 / 2) - 1), integrated over d from 0 by
    // Simpson's rule; differences of the normal distribution's tail would cancel near the end.
    let end = f64::from(GAUSSIAN_END) - z;
    const PANELS: usize = 128;
    let f = |d: f64| (d * (4.0 - 0.5 * d)).exp_m1();
    let h = end / PANELS as f64;
    let inner: f64 = (1..PANELS).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * f(i as f64 * h)).sum();
    2.0 * GAUSSIAN_AT_END * (inner + f(end)) * h / 3.0 / GAUSSIAN_INTEGRAL
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        independent::Independent,
        sampler::{Purpose, Sampler},
        statistics::{chi_square, special::erf},
    };
    use proptest::prelude::*;

    const FILTERS: [Filter; 5] = [
        Filter::Box,
        Filter::Tent { radius: 1.0 },
        Filter::Tent { radius: 0.3 },
        Filter::Gaussian { stddev: 0.5 },
        Filter::Gaussian { stddev: 2.5 },
    ];

    /// Probability of the filter below `x`, in closed form.
    fn cdf(filter: Filter, x: f64) -> f64 {
        match filter {
            Filter::Box => x + 0.5,
            Filter::Tent { radius } => {
                let x = x / f64::from(radius);
                0.5 + x - 0.5 * x * x.abs()
            }
            Filter::Gaussian { stddev } => {
                let z = x / f64::from(stddev);
                let half = (2.0 * std::f64::consts::PI).sqrt() * 0.5;
                0.5 + (half * erf(z / std::f64::consts::SQRT_2) - GAUSSIAN_AT_END * z) / GAUSSIAN_INTEGRAL
            }
        }
    }

    #[test]
    fn the_constants_are_what_they_say() {
        assert!((GAUSSIAN_AT_END - (-8.0_f64).exp()).abs() < 1e-19);
        let end = f64::from(GAUSSIAN_END);
        let integral = (2.0 * std::f64::consts::PI).sqrt() * erf(end / std::f64::consts::SQRT_2);
        assert!((GAUSSIAN_INTEGRAL - (integral - 2.0 * end * GAUSSIAN_AT_END)).abs() < 1e-14);
    }

    #[test]
    fn values_are_the_slope_of_the_cdf_and_integrate_to_1() {
        for filter in FILTERS {
            let r = f64::from(filter.radius());
            assert!((cdf(filter, r) - cdf(filter, -r) - 1.0).abs() < 1e-12, "{filter:?}");
            for i in -99..100 {
                let (x, h) = (f64::from(i) / 100.0 * r, 1e-4 * r);
                let slope = (cdf(filter, x + h) - cdf(filter, x - h)) / (2.0 * h);
                let value = f64::from(filter.evaluate_1d(x as f32));
                // The peak times the rounding of x and of the exponential; the tent's kink is at i = 0.
                let kink = if i == 0 { 1e-4 } else { 0.0 };
                assert!((value - slope).abs() <= (2e-6 + kink) / r, "{filter:?} {x}: {value} {slope}");
            }
            assert_eq!(filter.evaluate_1d(1.001 * filter.radius()), 0.0);
            assert_eq!(filter.evaluate_1d(-1.001 * filter.radius()), 0.0);
            let at = Vec2::new(0.1, -0.2);
            assert_eq!(filter.evaluate(at), filter.evaluate_1d(0.1) * filter.evaluate_1d(-0.2));
        }
    }

    #[test]
    fn quantiles_are_exact_to_the_resolution_of_the_numbers() {
        for filter in FILTERS {
            for i in 0..100_000 {
                let u = (i as f32 + 0.5) / 100_000.0;
                let error = cdf(filter, f64::from(filter.sample_1d(u))) - f64::from(u);
                // The lattice's half step, and the rounding of a coordinate near 1.
                assert!(error.abs() <= 0.5_f64.powi(22), "{filter:?} {u} {error:e}");
            }
            // Into the tails, where the relative error counts.
            for e in 1..24 {
                let u = 0.5_f32.powi(e);
                let exact = f64::from(u) + 0.5_f64.powi(25) * f64::from(u8::from(filter != Filter::Box));
                let x = f64::from(filter.sample_1d(u));
                let relative = cdf(filter, x) / exact - 1.0;
                // The offset is rounded a few times, by 2^-24 of the radius or less; the filter's value there says how much
                // probability that moves.
                let moved = f64::from(filter.evaluate_1d(x as f32) * filter.radius()) * 3.0 * 0.5_f64.powi(24) / exact;
                assert!(relative.abs() <= moved.min(1e-3), "{filter:?} {e} {relative:e} {moved:e}");
            }
        }
    }

    #[test]
    fn offsets_are_distributed_as_the_filter() {
        const BINS: usize = 24;
        const SAMPLES: u32 = 500_000;
        for filter in FILTERS {
            let mut sampler = Independent::new(9);
            let r = filter.radius();
            let mut counts = vec![0; BINS * BINS];
            let bin = |x: f32| ((x / r * 0.5 + 0.5) * BINS as f32) as usize;
            for index in 0..SAMPLES {
                sampler.start_sample(index, 0);
                let p = filter.sample(sampler.get_2d(0, Purpose::Film));
                counts[bin(p.y) * BINS + bin(p.x)] += 1;
            }
            let edge = |i: usize| (2.0 * i as f64 / BINS as f64 - 1.0) * f64::from(r);
            let mass: Vec<f64> = (0..BINS).map(|i| cdf(filter, edge(i + 1)) - cdf(filter, edge(i))).collect();
            let expected: Vec<f64> =
                (0..BINS * BINS).map(|i| (mass[i / BINS] * mass[i % BINS]).max(0.0) * f64::from(SAMPLES)).collect();
            let test = chi_square::test(&counts, &expected, 5.0);
            assert!(test.p_value > chi_square::sidak(1e-4, FILTERS.len()), "{filter:?} {test:?}");
        }
    }

    proptest! {
        #[test]
        fn the_filter_is_positive_where_it_is_sampled(
            u in prop_oneof![Just(0.0), Just(1.0_f32.next_down()), Just(f32::MIN_POSITIVE), 0.0..1.0_f32],
        ) {
            for filter in FILTERS {
                let x = filter.sample_1d(u);
                prop_assert!(x.abs() <= filter.radius() && filter.evaluate_1d(x) > 0.0, "{:?} {}", filter, x);
            }
        }
    }

    #[test]
    fn widths_that_are_none_are_told() {
        assert!(FILTERS.iter().all(Filter::is_valid));
        for width in [0.0, -1.0, f32::NAN, f32::INFINITY, f32::MAX, f32::MIN_POSITIVE] {
            assert!(!Filter::Tent { radius: width }.is_valid(), "{width}");
            assert!(!Filter::Gaussian { stddev: width }.is_valid(), "{width}");
        }
    }
}
