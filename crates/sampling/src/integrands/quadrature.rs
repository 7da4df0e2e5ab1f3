//! Gauss-Legendre quadrature over intervals and convex polygons.

use glam::DVec2;
use std::{f64::consts::PI, sync::LazyLock};

/// Points of a rule.
const POINTS: usize = 16;

/// The points `p` with `normal.p <= offset`.
#[derive(Clone, Copy, Debug)]
pub struct HalfPlane {
    pub normal: DVec2,
    pub offset: f64,
}

impl HalfPlane {
    #[inline]
    pub fn contains(&self, p: DVec2) -> bool {
        self.normal.dot(p) <= self.offset
    }
}

pub fn unit_square() -> [DVec2; 4] {
    [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y]
}

/// What of a convex polygon lies in a half-plane [Sutherland and Hodgman 1974].
pub fn clip(polygon: &[DVec2], by: HalfPlane) -> Vec<DVec2> {
    let height = |p: DVec2| by.normal.dot(p) - by.offset;
    let mut result = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (from, to) = (height(a), height(b));
        if from <= 0.0 {
            result.push(a);
        }
        if (from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0) {
            result.push(a.lerp(b, from / (from - to)));
        }
    }
    result
}

pub fn area(polygon: &[DVec2]) -> f64 {
    over_polygon(polygon, |_| 1.0)
}

/// Points in `[0, 1]` and their weights: zeros of Legendre's polynomial by Newton's method.
static RULE: LazyLock<[(f64, f64); POINTS]> = LazyLock::new(|| {
    let n = POINTS as f64;
    std::array::from_fn(|i| {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut derivative = 0.0;
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=POINTS {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            derivative = n * (x * value - before) / (x * x - 1.0);
            x -= value / derivative;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * derivative * derivative))
    })
});

/// The integral of a smooth function over an interval.
pub fn over_interval(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    RULE.iter().map(|(x, w)| w * f(low + (high - low) * x)).sum::<f64>() * (high - low)
}

/// The integral of a smooth function over a convex polygon whose corners go round counterclockwise.
pub fn over_polygon(polygon: &[DVec2], f: impl Fn(DVec2) -> f64) -> f64 {
    let Some((&apex, rest)) = polygon.split_first() else { return 0.0 };
    let triangle = |base: &[DVec2]| {
        let (b, c) = (base[0] - apex, base[1] - apex);
        // A square folded into the triangle [Duffy 1982].
        let row = |&(u, w): &(f64, f64)| {
            let inner: f64 = RULE.iter().map(|(v, w)| w * f(apex + u * b.lerp(c, *v))).sum();
            w * u * inner
        };
        b.perp_dot(c) * RULE.iter().map(row).sum::<f64>()
    };
    rest.windows(2).map(triangle).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for degree in [0, 1, 7, 31] {
            let found = over_interval(-1.0, 2.0, |x| x.powi(degree));
            let exact = (2.0_f64.powi(degree + 1) - (-1.0_f64).powi(degree + 1)) / f64::from(degree + 1);
            assert!((found / exact - 1.0).abs() < 1e-13, "{degree}: {found} against {exact}");
        }
        let pentagon = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 2.0), (0.0, 2.0)].map(DVec2::from);
        assert!((area(&pentagon) - 3.5).abs() < 1e-14);
        // The square less the corner: 8/3 less the integral of x y over the corner.
        let corner = over_interval(1.0, 2.0, |x| x * (4.0 - (3.0 - x).powi(2)) / 2.0);
        assert!((over_polygon(&pentagon, |p| p.x * p.y) - (4.0 - corner)).abs() < 1e-13);
    }

    #[test]
    fn clipping_keeps_what_is_inside() {
        let square = unit_square();
        let cut = |normal: DVec2, offset: f64| area(&clip(&square, HalfPlane { normal, offset }));
        assert!((cut(DVec2::X, 2.0) - 1.0).abs() < 1e-15 && cut(DVec2::X, -1.0) == 0.0);
        assert!((cut(DVec2::X, 0.3) - 0.3).abs() < 1e-15 && (cut(DVec2::ONE, 0.5) - 0.125).abs() < 1e-15);
        // An edge along a side.
        assert!((cut(DVec2::X, 1.0) - 1.0).abs() < 1e-15 && cut(DVec2::X, 0.0) == 0.0);
    }
}
