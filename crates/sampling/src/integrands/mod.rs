//! Integrands over the unit cube whose integrals are known: what patterns are held against.
//!
//! ```
//! use etendue_sampling::integrands::Integrand;
//! let edge = Integrand::Edge;
//! let n = 512;
//! let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
//! let sum: f64 = (0..n * n).map(|i| edge.evaluate(&[at(i % n), at(i / n)])).sum();
//! assert!((sum / f64::from(n * n) - edge.exact()).abs() < 1e-4);
//! ```

mod penumbra;
mod quadrature;

pub use penumbra::LightShape;

use etendue_core::statistics::special::erf;
use glam::DVec2;
use quadrature::{HalfPlane, area, clip, unit_square};
use std::f64::consts::{E, PI};

/// An integrand over a unit cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Integrand {
    /// `e^x` over its integral: smooth, and different at the two ends.
    Smooth1,
    /// The product of two of them.
    Smooth2,
    /// A Gaussian bump off the middle.
    Gaussian,
    /// 1 on one side of an edge at an odd angle: a pixel at a silhouette.
    Edge,
    /// 1 in a turned quadrant: a pixel at a corner.
    Corner,
    /// 1 in a disk.
    Disk,
    /// The product of `e^x` over its integral in four dimensions.
    Product4,
    /// In six dimensions.
    Product6,
    /// In eight dimensions.
    Product8,
    /// Light on a point of a floor in the penumbra of an edge, over the light's points.
    Light(LightShape),
    /// The same averaged over a pixel: two dimensions of the pixel, then those of the light.
    PixelAndLight(LightShape),
}

const GAUSSIAN_CENTRE: [f64; 2] = [0.37, 0.58];
const GAUSSIAN_WIDTH: f64 = 0.2;
/// Across the edge, at an angle of 1, and a point of it.
const EDGE: (DVec2, DVec2) = (DVec2::new(0.5403023058681398, 0.8414709848078965), DVec2::new(0.47, 0.53));
/// Across one of its sides, at an angle of 0.4, and the corner.
const CORNER: (DVec2, DVec2) = (DVec2::new(0.9210609940028851, 0.3894183423086505), DVec2::new(0.41, 0.44));
const DISK: (DVec2, f64) = (DVec2::new(0.52, 0.47), 0.38);
/// The point and the pixel in the penumbra.
const POINT: DVec2 = DVec2::new(0.04, -0.02);
const PIXEL: (DVec2, f64) = (DVec2::new(0.02, -0.05), 0.0625);

/// The half-plane whose border goes through a point, and from which `normal` leads away.
#[inline]
fn half_plane(normal: DVec2, through: DVec2) -> HalfPlane {
    HalfPlane { normal, offset: normal.dot(through) }
}

#[inline]
fn corner() -> [HalfPlane; 2] {
    [half_plane(CORNER.0, CORNER.1), half_plane(CORNER.0.perp(), CORNER.1)]
}

impl Integrand {
    /// All of them.
    pub const ALL: [Integrand; 15] = [
        Integrand::Smooth1,
        Integrand::Smooth2,
        Integrand::Gaussian,
        Integrand::Edge,
        Integrand::Corner,
        Integrand::Disk,
        Integrand::Product4,
        Integrand::Product6,
        Integrand::Product8,
        Integrand::Light(LightShape::Linear),
        Integrand::Light(LightShape::Square),
        Integrand::Light(LightShape::Round),
        Integrand::PixelAndLight(LightShape::Linear),
        Integrand::PixelAndLight(LightShape::Square),
        Integrand::PixelAndLight(LightShape::Round),
    ];

    /// Its name in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Integrand::Smooth1 => "smooth-1d",
            Integrand::Smooth2 => "smooth-2d",
            Integrand::Gaussian => "gaussian",
            Integrand::Edge => "edge",
            Integrand::Corner => "corner",
            Integrand::Disk => "disk",
            Integrand::Product4 => "product-4d",
            Integrand::Product6 => "product-6d",
            Integrand::Product8 => "product-8d",
            Integrand::Light(LightShape::Linear) => "linear-light",
            Integrand::Light(LightShape::Square) => "square-light",
            Integrand::Light(LightShape::Round) => "round-light",
            Integrand::PixelAndLight(LightShape::Linear) => "pixel-and-linear-light",
            Integrand::PixelAndLight(LightShape::Square) => "pixel-and-square-light",
            Integrand::PixelAndLight(LightShape::Round) => "pixel-and-round-light",
        }
    }

    /// Number of coordinates.
    pub const fn dimensions(self) -> usize {
        match self {
            Integrand::Smooth1 => 1,
            Integrand::Smooth2 | Integrand::Gaussian | Integrand::Edge | Integrand::Corner | Integrand::Disk => 2,
            Integrand::Product4 => 4,
            Integrand::Product6 => 6,
            Integrand::Product8 => 8,
            Integrand::Light(shape) => shape.dimensions(),
            Integrand::PixelAndLight(shape) => 2 + shape.dimensions(),
        }
    }

    /// Its value at a point of the unit cube. Coordinates beyond its dimensions are ignored.
    ///
    /// # Panics
    /// With fewer coordinates than dimensions.
    #[inline]
    pub fn evaluate(self, x: &[f64]) -> f64 {
        let x = &x[..self.dimensions()];
        let inside = |half_planes: &[HalfPlane]| {
            let p = DVec2::new(x[0], x[1]);
            f64::from(u8::from(half_planes.iter().all(|h| h.contains(p))))
        };
        match self {
            Integrand::Gaussian => {
                let squared: f64 = x.iter().zip(GAUSSIAN_CENTRE).map(|(x, c)| (x - c).powi(2)).sum();
                (-0.5 * squared / (GAUSSIAN_WIDTH * GAUSSIAN_WIDTH)).exp()
            }
            Integrand::Edge => inside(&[half_plane(EDGE.0, EDGE.1)]),
            Integrand::Corner => inside(&corner()),
            Integrand::Disk => {
                let apart = DVec2::new(x[0], x[1]).distance_squared(DISK.0);
                f64::from(u8::from(apart <= DISK.1 * DISK.1))
            }
            Integrand::Smooth1
            | Integrand::Smooth2
            | Integrand::Product4
            | Integrand::Product6
            | Integrand::Product8 => x.iter().sum::<f64>().exp() / (E - 1.0).powi(x.len() as i32),
            Integrand::Light(shape) => shape.sample(POINT, light_point(x)),
            Integrand::PixelAndLight(shape) => {
                let point = PIXEL.0 + PIXEL.1 * DVec2::new(x[0], x[1]);
                shape.sample(point, light_point(&x[2..]))
            }
        }
    }

    /// Its integral: in closed form, or for light by quadrature to eight digits and more.
    pub fn exact(self) -> f64 {
        match self {
            Integrand::Smooth1
            | Integrand::Smooth2
            | Integrand::Product4
            | Integrand::Product6
            | Integrand::Product8 => 1.0,
            Integrand::Gaussian => {
                let scale = GAUSSIAN_WIDTH * 2.0_f64.sqrt();
                let part = |c: f64| 0.5 * PI.sqrt() * scale * (erf((1.0 - c) / scale) + erf(c / scale));
                GAUSSIAN_CENTRE.map(part).iter().product()
            }
            Integrand::Edge => area(&clip(&unit_square(), half_plane(EDGE.0, EDGE.1))),
            Integrand::Corner => {
                let [first, second] = corner();
                area(&clip(&clip(&unit_square(), first), second))
            }
            Integrand::Disk => PI * DISK.1 * DISK.1,
            Integrand::Light(shape) => shape.irradiance(POINT),
            Integrand::PixelAndLight(shape) => shape.pixel_irradiance(PIXEL.0, PIXEL.1),
        }
    }
}

/// The coordinates on a light; a line has one.
#[inline]
fn light_point(x: &[f64]) -> DVec2 {
    DVec2::new(x[0], x.get(1).copied().unwrap_or(0.0))
}
