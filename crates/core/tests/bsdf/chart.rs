//! Charts of the sphere of directions: grids that follow a lobe however narrow it is, in double precision.

use etendue_core::{
    bsdf::{Bsdf, TransportMode},
    has,
};
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::TAU;

/// A map from the unit square to directions `wi`, given `wo` above the surface.
#[derive(Clone, Copy, Debug)]
pub enum Chart {
    /// All directions, uniform by area.
    Sphere,
    /// Reflection about the normal whose slopes, divided by alpha, have `1 / (1 - p)² - 1` as their squared length: in
    /// `p` the density of visible normals is smooth at both ends.
    Reflect(DVec2),
    /// Refraction at that normal, with the far index of refraction over the near one.
    Refract(DVec2, f64),
    /// Reflection continued to the other side.
    Through(DVec2),
}

/// The unit vector that the single precision `w` stands for: its largest component, which holds the rounding error,
/// from the two others.
pub(crate) fn precise(w: Vec3) -> DVec3 {
    let w = w.as_dvec3();
    let a = w.abs();
    let largest = if a.x >= a.y && a.x >= a.z { 0 } else { 1 + usize::from(a.z > a.y) };
    let mut result = w;
    result[largest] = 0.0;
    result[largest] = (1.0 - result.length_squared()).sqrt().copysign(w[largest]);
    result
}

fn normal(alpha: DVec2, p: f64, turn: f64) -> DVec3 {
    let r = (p * (2.0 - p)).sqrt() / (1.0 - p);
    let (sin, cos) = (TAU * turn).sin_cos();
    DVec3::new(-alpha.x * r * cos, -alpha.y * r * sin, 1.0).normalize()
}

impl Chart {
    /// The direction at a point of the square, and whether the chart is valid there. Smooth across the border of its
    /// validity.
    fn direction(&self, wo: DVec3, p: DVec2) -> (DVec3, bool) {
        match *self {
            Chart::Sphere => {
                let z = 2.0 * p.x - 1.0;
                let (sin, cos) = (TAU * p.y).sin_cos();
                let r = (1.0 - z * z).sqrt();
                (DVec3::new(r * cos, r * sin, z), true)
            }
            Chart::Reflect(alpha) => {
                let m = normal(alpha, p.x, p.y);
                let wi = m * (2.0 * wo.dot(m)) - wo;
                (wi, wo.dot(m) > 0.0 && wi.z > 0.0)
            }
            Chart::Through(alpha) => {
                let (wi, valid) = Chart::Reflect(alpha).direction(wo, p);
                (DVec3::new(wi.x, wi.y, -wi.z), valid)
            }
            Chart::Refract(alpha, eta) => {
                let m = normal(alpha, p.x, p.y);
                let c = wo.dot(m);
                let squared = eta * eta - 1.0 + c * c;
                let wi = (m * (c - squared.max(0.0).sqrt()) - wo) / eta;
                (wi, c > 0.0 && squared > 0.0 && wi.z < 0.0)
            }
        }
    }

    /// The point of the square that maps to `wi`.
    pub fn locate(&self, wo: DVec3, wi: DVec3) -> Option<DVec2> {
        let (alpha, h) = match *self {
            Chart::Sphere => {
                return Some(DVec2::new(0.5 * (wi.z + 1.0), (wi.y.atan2(wi.x) / TAU).rem_euclid(1.0)));
            }
            Chart::Reflect(alpha) if wi.z > 0.0 => (alpha, wo + wi),
            Chart::Through(alpha) if wi.z < 0.0 => (alpha, wo + DVec3::new(wi.x, wi.y, -wi.z)),
            Chart::Refract(alpha, eta) if wi.z < 0.0 => (alpha, (wo + eta * wi) * (1.0 - eta).signum()),
            _ => return None,
        };
        let slopes = -h.truncate() / h.z / alpha;
        let p = 1.0 - 1.0 / (1.0 + slopes.length_squared()).sqrt();
        (h.z > 0.0).then(|| DVec2::new(p, (slopes.y.atan2(slopes.x) / TAU).rem_euclid(1.0)))
    }

    /// Solid angle per area of the square around `p`, which maps to `wi`, by differences: nothing of the code under test is in it.
    fn jacobian(&self, wo: DVec3, p: DVec2, wi: DVec3) -> f64 {
        if let Chart::Sphere = self {
            return 2.0 * TAU;
        }
        let h = 1e-6;
        let difference = |d: DVec2| (self.direction(wo, p + h * d).0 - wi) / h;
        difference(DVec2::X).cross(difference(DVec2::Y)).length()
    }
}

/// A situation to be tested.
#[derive(Clone, Debug)]
pub struct Case {
    pub name: String,
    pub bsdf: Bsdf,
    /// May be below the surface; charts then are of the situation mirrored to the upper side.
    pub wo: Vec3,
    pub charts: Vec<Chart>,
}

/// Integrals over a part of a chart.
#[derive(Clone, Copy, Debug, Default)]
pub struct Integral {
    /// Of the density.
    pub pdf: f64,
    /// Of the value (red) times the cosine, for radiance.
    pub albedo: f64,
    /// How far off either may be.
    pub error: f64,
}

impl Integral {
    pub(crate) fn plus(self, o: Integral) -> Integral {
        Integral { pdf: self.pdf + o.pdf, albedo: self.albedo + o.albedo, error: self.error + o.error }
    }
}

impl Case {
    /// Mirrors to the upper side, or back.
    fn upright(&self, w: DVec3) -> DVec3 {
        if self.wo.z < 0.0 { DVec3::new(w.x, w.y, -w.z) } else { w }
    }

    /// Integrals over `n` by `n` cells of each chart.
    pub fn integrate(&self, n: usize) -> Vec<Integral> {
        let wo = self.upright(precise(self.wo));
        let size = 1.0 / n as f64;
        let mut cells = Vec::new();
        for chart in &self.charts {
            for i in 0..n {
                for j in 0..n {
                    let corner = DVec2::new(i as f64, j as f64) * size;
                    let coarse = self.midpoints(chart, wo, corner, size);
                    cells.push(self.refine(chart, wo, corner, size, coarse, 5));
                }
            }
        }
        cells
    }

    /// Splits a square in four until that changes nothing any more.
    fn refine(&self, chart: &Chart, wo: DVec3, corner: DVec2, size: f64, coarse: Integral, depth: u32) -> Integral {
        let half = 0.5 * size;
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|d| corner + half * d);
        let parts = corners.map(|c| self.midpoints(chart, wo, c, half));
        let fine = parts.into_iter().fold(Integral::default(), Integral::plus);
        let error = (fine.pdf - coarse.pdf).abs().max((fine.albedo - coarse.albedo).abs());
        // A strip too thin for either grid shows in a corner on the other side of the border.
        let inside = |c: DVec2| chart.direction(wo, c.min(DVec2::splat(1.0 - 1e-9))).1;
        let valid = inside(corner);
        let uncut = [DVec2::X, DVec2::Y, DVec2::ONE].iter().all(|d| inside(corner + size * d) == valid);
        if depth == 0 || (uncut && error < 5e-6) {
            return Integral { error, ..fine };
        }
        let parts = corners.into_iter().zip(parts).map(|(c, part)| self.refine(chart, wo, c, half, part, depth - 1));
        parts.fold(Integral::default(), Integral::plus)
    }

    /// The midpoint rule with 4 by 4 points.
    fn midpoints(&self, chart: &Chart, wo: DVec3, corner: DVec2, size: f64) -> Integral {
        let step = size / 4.0;
        let mut sum = Integral::default();
        for i in 0..16 {
            let p = corner + DVec2::new(f64::from(i / 4) + 0.5, f64::from(i % 4) + 0.5) * step;
            let (wi, valid) = chart.direction(wo, p);
            if valid {
                let area = chart.jacobian(wo, p, wi) * step * step;
                let local = self.upright(wi).as_vec3();
                let (value, pdf) = self.bsdf.eval_pdf::<{ has::ALL }>(self.wo, local, TransportMode::Radiance);
                sum.pdf += f64::from(pdf) * area;
                sum.albedo += f64::from(value.r) * wi.z.abs() * area;
            }
        }
        sum
    }

    /// The cell in which a sampled direction lies.
    pub fn cell(&self, wi: Vec3, n: usize) -> Option<usize> {
        let (wo, wi) = (self.upright(precise(self.wo)), self.upright(precise(wi)));
        self.charts.iter().enumerate().find_map(|(c, chart)| {
            let p = chart.locate(wo, wi)? * n as f64;
            Some((c * n + (p.x as usize).min(n - 1)) * n + (p.y as usize).min(n - 1))
        })
    }
}
