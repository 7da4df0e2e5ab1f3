//! A floor under a light, half of which a screen hides.

use super::quadrature::{HalfPlane, clip, over_interval, over_polygon};
use etendue_core::warp::sample_disk;
use glam::{DVec2, Vec2};
use std::f64::consts::{FRAC_PI_2, PI};

/// A light one metre above a floor and parallel to it, centred above the floor's origin. Half way up, a screen fills the
/// half-plane on one side of an edge that passes straight above the origin at an odd angle. Where the floor lies within a
/// quarter of a metre of the edge it is in the penumbra.
///
/// The light has radiance 1 towards the floor; irradiance is in its units. A line is a strip whose irradiance is given for
/// each metre of its width.
///
/// ```
/// use etendue_sampling::integrands::LightShape;
/// use glam::DVec2;
/// // An image of 64 samples a pixel would average `sample` over 4 points of a pixel and 16 of the light.
/// let (point, u) = (DVec2::new(0.1, 0.0), DVec2::new(0.2, 0.9));
/// assert!(LightShape::Square.sample(point, u) > 0.0);
/// assert!((LightShape::Square.irradiance(DVec2::new(0.2, 0.4)) - 0.06).abs() < 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LightShape {
    /// A line 0.3 m long.
    Linear,
    /// A square of side 0.3 m.
    Square,
    /// A disk of radius 0.17 m.
    Round,
}

const LENGTH: f64 = 0.3;
const RADIUS: f64 = 0.17;
/// Direction of the line, at an angle of 0.3.
const ALONG: DVec2 = DVec2::new(0.955336489125606, 0.2955202066613396);
/// Direction across the edge to the open side, at an angle of 1.1.
const OPEN: DVec2 = DVec2::new(0.4535961214255773, 0.8912073600614354);

/// What a square metre of the light at `light` sends to the floor at `point`: both cosines over the squared distance.
#[inline]
fn transport(point: DVec2, light: DVec2) -> f64 {
    (1.0 + point.distance_squared(light)).powi(-2)
}

impl LightShape {
    /// The shapes.
    pub const ALL: [LightShape; 3] = [LightShape::Linear, LightShape::Square, LightShape::Round];

    /// Coordinates of a point on it.
    pub const fn dimensions(self) -> usize {
        match self {
            LightShape::Linear => 1,
            LightShape::Square | LightShape::Round => 2,
        }
    }

    /// The estimate of the irradiance at a point of the floor (metres) from one point of the light, `u` in the unit square;
    /// a line does not use `u.y`. The disk is reached by the concentric map [Shirley and Chiu 1997].
    #[inline]
    pub fn sample(self, point: DVec2, u: DVec2) -> f64 {
        let (light, measure) = match self {
            LightShape::Linear => (line(u.x), LENGTH),
            LightShape::Square => (LENGTH * (u - 0.5), LENGTH * LENGTH),
            LightShape::Round => {
                let unit = sample_disk(Vec2::new(u.x as f32, u.y as f32)).as_dvec2();
                (RADIUS * unit, PI * RADIUS * RADIUS)
            }
        };
        if visible(point).contains(light) { measure * transport(point, light) } else { 0.0 }
    }

    /// The irradiance at a point of the floor.
    pub fn irradiance(self, point: DVec2) -> f64 {
        let seen = visible(point);
        let value = |light: DVec2| transport(point, light);
        match self {
            LightShape::Linear => {
                // Where the edge crosses the line, as a part of its length.
                let along = seen.normal.dot(line(1.0) - line(0.0));
                let crossing = ((seen.offset - seen.normal.dot(line(0.0))) / along).clamp(0.0, 1.0);
                let (low, high) = if along > 0.0 { (0.0, crossing) } else { (crossing, 1.0) };
                LENGTH * over_interval(low, high, |u| value(line(u)))
            }
            LightShape::Square => {
                let square = corners(DVec2::splat(-0.5 * LENGTH), LENGTH);
                over_polygon(&clip(&square, seen), value)
            }
            LightShape::Round => {
                // Chords along the edge; the angle takes the root out of their length.
                let highest = (seen.offset / RADIUS).clamp(-1.0, 1.0).asin();
                over_interval(-FRAC_PI_2, highest, |angle| {
                    let (sin, cos) = angle.sin_cos();
                    let middle = RADIUS * sin * seen.normal;
                    let half = RADIUS * cos;
                    let chord = over_interval(-half, half, |t| value(middle + t * seen.normal.perp()));
                    RADIUS * cos * chord
                })
            }
        }
    }

    /// The mean irradiance of a square of the floor with the lowest corner `corner`.
    pub fn pixel_irradiance(self, corner: DVec2, side: f64) -> f64 {
        // Between the lines from which the edge is seen to touch a corner or a side of the light all is smooth.
        let mut borders: Vec<f64> = match self {
            LightShape::Linear => [0.0, 1.0].map(|u| -OPEN.dot(line(u))).to_vec(),
            LightShape::Square => corners(DVec2::splat(-0.5 * LENGTH), LENGTH).map(|p| -OPEN.dot(p)).to_vec(),
            LightShape::Round => vec![-RADIUS, RADIUS],
        };
        borders.sort_by(f64::total_cmp);
        borders.push(f64::INFINITY);
        let mut rest = corners(corner, side).to_vec();
        let mut sum = 0.0;
        for border in borders {
            sum += over_polygon(&clip(&rest, HalfPlane { normal: OPEN, offset: border }), |p| self.irradiance(p));
            rest = clip(&rest, HalfPlane { normal: -OPEN, offset: -border });
        }
        sum / (side * side)
    }
}

/// The part of the light's plane that a point of the floor sees past the screen: the edge is half way.
#[inline]
fn visible(point: DVec2) -> HalfPlane {
    HalfPlane { normal: -OPEN, offset: OPEN.dot(point) }
}

/// A point of the line.
#[inline]
fn line(u: f64) -> DVec2 {
    LENGTH * (u - 0.5) * ALONG
}

fn corners(lowest: DVec2, side: f64) -> [DVec2; 4] {
    super::unit_square().map(|p| lowest + side * p)
}
