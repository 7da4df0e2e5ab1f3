//! Random numbers, moments and chi-square tests for sampling routines.
#![allow(dead_code)] // Every test binary uses its own part.

use glam::{DVec3, Vec2};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

pub struct Random(Pcg64Mcg);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(Pcg64Mcg::seed_from_u64(seed))
    }

    /// In [0, 1), 24 bits.
    pub fn f32(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 * 2f32.powi(-24)
    }

    pub fn vec2(&mut self) -> Vec2 {
        Vec2::new(self.f32(), self.f32())
    }
}

/// Mean and standard error of what is added.
#[derive(Default)]
pub struct Moments {
    n: f64,
    mean: f64,
    m2: f64,
}

impl Moments {
    pub fn add(&mut self, x: f64) {
        self.n += 1.0;
        let d = x - self.mean;
        self.mean += d / self.n;
        self.m2 += d * (x - self.mean);
    }

    pub fn mean(&self) -> f64 {
        self.mean
    }

    pub fn standard_error(&self) -> f64 {
        (self.m2 / (self.n * (self.n - 1.0))).sqrt()
    }

    /// Within 4 standard errors, or within the rounding of `f32` where an estimator has no variance to speak of.
    #[track_caller]
    pub fn assert_mean(&self, what: &str, expected: f64) {
        let (deviation, error) = ((self.mean - expected).abs(), self.standard_error());
        let rounding = 2e-6 * expected.abs();
        let sigmas = deviation / error;
        assert!(deviation <= 4.0 * error + rounding, "{what}: {} instead of {expected}, {sigmas} sigmas", self.mean);
    }
}

/// Pearson's test of counts against expected counts; fails at a significance below 3e-5 (4 sigmas, one-sided). Cells
/// that expect fewer than 5 are pooled.
#[track_caller]
pub fn chi_square(what: &str, counts: &[f64], expected: &[f64]) {
    let (mut pooled, mut pooled_expected) = (0.0, 0.0);
    let (mut statistic, mut cells) = (0.0, 0.0);
    let mut add = |count: f64, expected: f64| {
        statistic += (count - expected) * (count - expected) / expected;
        cells += 1.0;
    };
    for (&count, &expected) in counts.iter().zip(expected) {
        if expected >= 5.0 {
            add(count, expected);
        } else {
            pooled += count;
            pooled_expected += expected;
        }
    }
    if pooled_expected >= 5.0 {
        add(pooled, pooled_expected);
    } else {
        assert!(pooled <= pooled_expected + 5.0 * pooled_expected.sqrt() + 5.0, "{what}: {pooled} strays");
    }
    assert!(cells >= 4.0, "{what}: the test has {cells} cells only");
    // [Wilson and Hilferty 1931]: the cube root of chi-square over its freedom is nearly normal.
    let k = cells - 1.0;
    let spread = 2.0 / (9.0 * k);
    let z = ((statistic / k).cbrt() - (1.0 - spread)) / spread.sqrt();
    assert!(z < 4.0, "{what}: chi-square {statistic:.1} with {k} degrees of freedom, z = {z:.2}");
}

/// A cap of directions about an axis, cut into rings of equal solid angle and those into sectors.
pub struct Cap {
    pub axis: DVec3,
    /// One minus the cosine of its half-angle; 2 is the sphere.
    pub height: f64,
    pub rings: usize,
    pub sectors: usize,
}

impl Cap {
    /// The half-angle's one minus cosine, without cancellation.
    pub fn of_angle(axis: DVec3, half_angle: f64, rings: usize, sectors: usize) -> Cap {
        Cap { axis, height: 2.0 * (0.5 * half_angle).sin().powi(2), rings, sectors }
    }

    pub fn sphere(axis: DVec3) -> Cap {
        Cap { axis, height: 2.0, rings: 24, sectors: 48 }
    }

    fn axes(&self) -> (DVec3, DVec3) {
        let s = self.axis.any_orthonormal_vector();
        (s, self.axis.cross(s))
    }

    fn cell(&self, w: DVec3) -> Option<usize> {
        let (s, t) = self.axes();
        let (x, y, z) = (w.dot(s), w.dot(t), w.dot(self.axis));
        let height = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
        let ring = (height / self.height * self.rings as f64) as usize;
        let turn = (y.atan2(x) / std::f64::consts::TAU).rem_euclid(1.0);
        let sector = ((turn * self.sectors as f64) as usize).min(self.sectors - 1);
        (ring < self.rings).then_some(ring * self.sectors + sector)
    }

    /// Tests a sampling routine of directions against its density: `n` samples, and the density integrated by the
    /// midpoint rule with `fine` x `fine` points a cell. What falls outside of the cap or fails is a cell of its own.
    #[track_caller]
    pub fn chi_square(
        &self,
        what: &str,
        n: usize,
        fine: usize,
        mut sample: impl FnMut() -> Option<DVec3>,
        pdf: impl Fn(DVec3) -> f64,
    ) {
        let cells = self.rings * self.sectors;
        let mut counts = vec![0.0; cells + 1];
        for _ in 0..n {
            counts[sample().and_then(|w| self.cell(w.normalize())).unwrap_or(cells)] += 1.0;
        }
        let (s, t) = self.axes();
        let point_area = std::f64::consts::TAU * self.height / (cells * fine * fine) as f64;
        let mut expected = vec![0.0; cells + 1];
        for ring in 0..self.rings * fine {
            let height = (ring as f64 + 0.5) / (self.rings * fine) as f64 * self.height;
            let r = (height * (2.0 - height)).sqrt();
            for sector in 0..self.sectors * fine {
                let phi = (sector as f64 + 0.5) / (self.sectors * fine) as f64 * std::f64::consts::TAU;
                let w = s * (r * phi.cos()) + t * (r * phi.sin()) + self.axis * (1.0 - height);
                expected[ring / fine * self.sectors + sector / fine] += pdf(w) * point_area * n as f64;
            }
        }
        let inside: f64 = expected.iter().sum();
        // The integral may exceed 1 by the error of the midpoint rule alone.
        assert!(inside < n as f64 * 1.01, "{what}: the density integrates to {}", inside / n as f64);
        expected[cells] = (n as f64 - inside).max(0.0);
        if counts[cells] == 0.0 || expected[cells] < 0.003 * n as f64 {
            assert!(counts[cells] + expected[cells] < 0.01 * n as f64, "{what}: {} left the cap", counts[cells]);
            counts.pop();
            expected.pop();
        }
        chi_square(what, &counts, &expected);
    }
}
