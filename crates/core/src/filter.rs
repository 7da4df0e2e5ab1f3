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
