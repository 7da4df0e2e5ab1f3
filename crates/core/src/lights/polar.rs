//! Densities in the polar angle: a linear function times the sine.

/// A band of polar angles `theta = start + width * t` for `t` in `[0, 1]`, within `[0, pi]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Band {
    pub start: f64,
    pub width: f64,
    /// Sine and cosine at the start.
    at_start: (f64, f64),
    /// Sine at the end.
    sin_end: f64,
}

/// Terms of the sine's Taylor series that are kept in bands narrower than [`NARROW`]: its error is below 2e-9.
const TERMS: usize = 6;
const NARROW: f64 = 0.1;
/// `1 / (k + 1)`: divisions would take most of the time.
const RECIPROCALS: [f64; TERMS + 1] = [1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 5.0, 1.0 / 6.0, 1.0 / 7.0];

impl Band {
    pub fn new(start: f64, width: f64) -> Band {
        Band { start, width, at_start: start.sin_cos(), sin_end: (start + width).sin() }
    }

    /// Integrals over `t` of `(1 - t) sin(theta)` and of `t sin(theta)`.
    pub fn weights(self) -> (f64, f64) {
        let at_end = |a: f64, c: f64| Product::new(self, a, c).integral(1.0).max(0.0);
        (at_end(1.0, -1.0), at_end(0.0, 1.0))
    }

    /// Samples `t` with density proportional to `((1 - t) a + t b) sin(theta)`; `a` and `b` are not negative.
    pub fn sample(self, a: f64, b: f64, u: f64) -> f64 {
        let product = Product::new(self, a, b - a);
        let target = u * product.integral(1.0);
        // Newton's method from the solution for a linear density, kept between bounds that close in.
        let (first, last) = (a * self.at_start.0.max(0.0), b * self.sin_end.max(0.0));
        let (mut low, mut high) = (0.0, 1.0);
        let mut t = if first + last > 0.0 { sample_linear(first, last, u) } else { 0.5 };
        for _ in 0..48 {
            let error = product.integral(t) - target;
            if error > 0.0 {
                high = t;
            } else {
                low = t;
            }
            let next = t - error / product.density(t);
            let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
            let step = (next - t).abs();
            t = next;
            // Convergence is quadratic: what is left is far below the resolution of an f32.
            if step < 1e-5 {
                break;
            }
        }
        t
    }
}

/// `(a + c t) sin(theta)` as a function of `t`.
enum Product {
    /// The coefficients of its Taylor polynomial, for a narrow band: its integral does not cancel.
    Narrow([f64; TERMS + 1]),
    Wide {
        band: Band,
        a: f64,
        c: f64,
    },
}

impl Product {
    fn new(band: Band, a: f64, c: f64) -> Product {
        if band.width >= NARROW {
            return Product::Wide { band, a, c };
        }
        let (sin, cos) = band.at_start;
        let derivatives = [sin, cos, -sin, -cos];
        let mut q = [0.0; TERMS + 1];
        let mut scale = 1.0;
        for k in 0..TERMS {
            let s = derivatives[k % 4] * scale;
            q[k] += a * s;
            q[k + 1] += c * s;
            scale *= band.width * RECIPROCALS[k];
        }
        Product::Narrow(q)
    }

    fn density(&self, t: f64) -> f64 {
        match self {
            Product::Narrow(q) => q.iter().rev().fold(0.0, |sum, q| sum * t + q),
            Product::Wide { band, a, c } => (a + c * t) * (band.start + band.width * t).sin(),
        }
    }

    /// The integral from 0 to `t`.
    fn integral(&self, t: f64) -> f64 {
        match self {
            Product::Narrow(q) => (0..=TERMS).rev().fold(0.0, |sum, k| sum * t + q[k] * RECIPROCALS[k]) * t,
            Product::Wide { band: Band { start, width, at_start: (sin0, cos0), .. }, a, c } => {
                let (sin, cos) = (start + width * t).sin_cos();
                (a * cos0 - (a + c * t) * cos) / width + c * (sin - sin0) / (width * width)
            }
        }
    }
}

/// Samples `x` in `[0, 1]` with density proportional to `(1 - x) a + x b`; not both are zero.
#[inline]
pub(super) fn sample_linear(a: f64, b: f64, u: f64) -> f64 {
    // The root of (1 - u) a² + u b² with the sign that does not cancel.
    let root = a + ((1.0 - u) * a * a + u * b * b).sqrt();
    if root > 0.0 { (u * (a + b) / root).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against Simpson's rule, in bands of every kind, beside a pole, in the middle, and at the other pole.
    #[test]
    fn sampling_inverts_the_integral() {
        for width in [0.002, 0.013, 0.015, 0.09, 0.11, 1.0] {
            for start in [0.0, 0.7, std::f64::consts::PI - width] {
                let band = Band::new(start, width);
                for (a, b) in [(1.0, 1.0), (0.0, 2.0), (3.0, 0.0), (1.0, 1e4)] {
                    let density = |t: f64| ((1.0 - t) * a + t * b) * (start + width * t).sin();
                    let integral = |end: f64| {
                        let (n, mut sum) = (200, 0.0);
                        for i in 0..=n {
                            let weight = if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                            sum += weight * density(end * f64::from(i) / f64::from(n));
                        }
                        sum * end / f64::from(3 * n)
                    };
                    let all = integral(1.0);
                    for i in 0..=20 {
                        let u = f64::from(i) / 20.0;
                        let found = integral(band.sample(a, b, u)) / all;
                        assert!((found - u).abs() < 1e-7, "{width} {start} {a} {b}: {u} became {found}");
                    }
                }
            }
        }
    }
}
