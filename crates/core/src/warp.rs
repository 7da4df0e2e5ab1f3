//! Maps from the unit square to directions and points, each with its density and its inverse.
//!
//! Every map accepts `u = 0` and returns a point inside its support, where the density is positive. Small distances
//! (to a pole, to the horizon) are computed from `u` and never as a difference from 1, so they keep their precision.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, PI};

/// The largest `f32` below 1.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// Half of the spacing `2^-24` of uniform numbers: what stands for 0 where 0 would fall on the border of a support.
pub const HALF_STEP: f32 = f32::EPSILON / 4.0;

/// Sine and cosine of an angle in `[-pi/4, pi/4]`: Taylor's series as far as single precision sees it.
#[inline]
fn small_sin_cos(angle: f32) -> (f32, f32) {
    let a = angle * angle;
    let sin = angle * (1.0 + a * (-1.0 / 6.0 + a * (1.0 / 120.0 + a * (-1.0 / 5040.0 + a * (1.0 / 362_880.0)))));
    let cos = 1.0 + a * (-0.5 + a * (1.0 / 24.0 + a * (-1.0 / 720.0 + a * (1.0 / 40_320.0))));
    (sin, cos)
}

/// Sine and cosine of a fraction of a turn in `[0, 1]`; several times faster than reducing an angle in radians.
#[inline]
pub fn sin_cos_turn(fraction: f32) -> (f32, f32) {
    let quarters = 4.0 * fraction;
    let nearest = (quarters + 0.5) as i32;
    let (sin, cos) = small_sin_cos(2.0 * FRAC_PI_4 * (quarters - nearest as f32));
    // The rest is a rotation by whole quarters; random quarters would make branches costly. Its entries are floats, not
    // operations on bits: vectorised, those leave integers in unused lanes, which are subnormal numbers to the
    // multiplications that follow, and cost a hundred cycles each.
    const ROTATIONS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]];
    let [s, c] = ROTATIONS[(nearest & 3) as usize];
    (s * cos + c * sin, c * cos - s * sin)
}

/// The concentric map [Shirley and Chiu 1997, sec. 2]: the point, and one minus its distance from the centre.
#[inline]
fn concentric(u: Vec2) -> (Vec2, f32) {
    // The larger offset from the centre is the (signed) radius, its quotient with the other the angle.
    let offset = 2.0 * u - 1.0;
    let wide = offset.x.abs() > offset.y.abs();
    let (radius, other, along) = if wide { (offset.x, offset.y, u.x) } else { (offset.y, offset.x, u.y) };
    if radius == 0.0 {
        return (Vec2::ZERO, 1.0);
    }
    let (sin, cos) = small_sin_cos(FRAC_PI_4 * (other / radius));
    let point = radius * if wide { Vec2::new(cos, sin) } else { Vec2::new(sin, cos) };
    let along = along.max(HALF_STEP);
    (point, 2.0 * along.min(1.0 - along))
}

/// A point of the unit disk, uniform by area [Shirley and Chiu 1997].
#[inline]
pub fn sample_disk(u: Vec2) -> Vec2 {
    concentric(u).0
}

/// Density of [`sample_disk`] per unit area of the unit disk.
#[inline]
pub fn disk_pdf() -> f32 {
    FRAC_1_PI
}

/// The `u` that [`sample_disk`] maps to `point`.
pub fn invert_disk(point: Vec2) -> Vec2 {
    let radius = point.length();
    if radius == 0.0 {
        return Vec2::splat(0.5);
    }
    let offset = if point.x.abs() > point.y.abs() {
        // The angle from the x axis, in (-pi/4, pi/4) for either sign of the radius.
        let radius = radius.copysign(point.x);
        Vec2::new(radius, radius * (point.y / point.x).atan() / FRAC_PI_4)
    } else {
        let radius = radius.copysign(point.y);
        Vec2::new(radius * (point.x / point.y).atan() / FRAC_PI_4, radius)
    };
    unit((offset + 1.0) * 0.5)
}

/// A direction around +z with density `cos / pi` per steradian.
#[inline]
pub fn sample_cosine_hemisphere(u: Vec2) -> Vec3 {
    let (point, one_minus_radius) = concentric(u);
    point.extend((one_minus_radius * (2.0 - one_minus_radius)).sqrt())
}

/// Density of [`sample_cosine_hemisphere`] per steradian at a direction with `z = cos`.
#[inline]
pub fn cosine_hemisphere_pdf(cos: f32) -> f32 {
    cos.max(0.0) * FRAC_1_PI
}

/// The `u` that [`sample_cosine_hemisphere`] maps to `w`.
pub fn invert_cosine_hemisphere(w: Vec3) -> Vec2 {
    invert_disk(w.truncate())
}

/// A direction with distance `1 - z = depth` from the pole, `turn` of the way around it.
#[inline]
fn below_pole(depth: f32, turn: f32) -> Vec3 {
    let (sin, cos) = sin_cos_turn(turn);
    let radius = (depth * (2.0 - depth)).max(0.0).sqrt();
    Vec3::new(radius * cos, radius * sin, 1.0 - depth)
}

/// The azimuth of `w` as a fraction of the circle.
fn azimuth_fraction(w: Vec3) -> f32 {
    let turn = w.y.atan2(w.x) / (2.0 * PI);
    if turn < 0.0 { turn + 1.0 } else { turn }
}

/// Into `[0, 1)`, against rounding.
fn unit(u: Vec2) -> Vec2 {
    u.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
}

/// A direction, uniform over the sphere.
#[inline]
pub fn sample_sphere(u: Vec2) -> Vec3 {
    below_pole(2.0 * u.x, u.y)
}

/// Density of [`sample_sphere`] per steradian.
#[inline]
pub fn sphere_pdf() -> f32 {
    0.25 * FRAC_1_PI
}

/// The `u` that [`sample_sphere`] maps to `w`.
pub fn invert_sphere(w: Vec3) -> Vec2 {
    unit(Vec2::new(0.5 * (1.0 - w.z), azimuth_fraction(w)))
}

/// A direction around +z, uniform over the hemisphere.
#[inline]
pub fn sample_hemisphere(u: Vec2) -> Vec3 {
    below_pole(u.x, u.y)
}

/// Density of [`sample_hemisphere`] per steradian, for directions with `z > 0`.
#[inline]
pub fn hemisphere_pdf() -> f32 {
    0.5 * FRAC_1_PI
}

/// The `u` that [`sample_hemisphere`] maps to `w`.
pub fn invert_hemisphere(w: Vec3) -> Vec2 {
    unit(Vec2::new(1.0 - w.z, azimuth_fraction(w)))
}

/// A direction around +z, uniform over the cone `1 - z <= one_minus_cos`.
///
/// The cone is given by one minus the cosine of its half angle, in `(0, 2]`, because that number keeps its precision
/// for narrow cones: for half angle `a` with known sine it is `sin² / (1 + cos)`.
#[inline]
pub fn sample_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    below_pole(u.x * one_minus_cos, u.y)
}

/// Density of [`sample_cone`] per steradian, inside the cone.
#[inline]
pub fn cone_pdf(one_minus_cos: f32) -> f32 {
    0.5 * FRAC_1_PI / one_minus_cos
}

/// The `u` that [`sample_cone`] maps to `w`.
pub fn invert_cone(w: Vec3, one_minus_cos: f32) -> Vec2 {
    // 1 - z without cancellation near the pole.
    let height = if w.z > 0.0 { w.truncate().length_squared() / (1.0 + w.z) } else { 1.0 - w.z };
    unit(Vec2::new(height / one_minus_cos, azimuth_fraction(w)))
}

/// Barycentric coordinates of a point of a triangle, uniform by area, with low distortion of the square [Heitz 2019].
#[inline]
pub fn sample_triangle(u: Vec2) -> Vec3 {
    if u.y > u.x {
        let x = 0.5 * u.x;
        Vec3::new(x, u.y - x, 1.0 - u.y)
    } else {
        let y = 0.5 * u.y;
        Vec3::new(u.x - y, y, 1.0 - u.x)
    }
}

/// Density of [`sample_triangle`] per unit area of a triangle with the given area.
#[inline]
pub fn triangle_pdf(area: f32) -> f32 {
    1.0 / area
}

/// The `u` that [`sample_triangle`] maps to the barycentric coordinates `b`.
pub fn invert_triangle(b: Vec3) -> Vec2 {
    unit(if b.y > b.x { Vec2::new(2.0 * b.x, b.y + b.x) } else { Vec2::new(b.x + b.y, 2.0 * b.y) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of the square as a sampler can return them, and a grid inside it.
    fn squares() -> Vec<Vec2> {
        let mut axis = vec![0.0, f32::MIN_POSITIVE, 2.0f32.powi(-32), f32::EPSILON / 2.0, 0.5, ONE_MINUS_EPSILON];
        axis.extend((0..37).map(|i| (i as f32 + 0.5) / 37.0));
        axis.iter().flat_map(|&x| axis.iter().map(move |&y| Vec2::new(x, y))).collect()
    }

    #[test]
    fn directions_are_unit_and_inside_their_support_even_at_the_border() {
        for u in squares() {
            let cosine = sample_cosine_hemisphere(u);
            assert!(cosine_hemisphere_pdf(cosine.z) > 0.0, "{u} -> {cosine}");
            let hemisphere = sample_hemisphere(u);
            assert!(hemisphere.z > 0.0, "{u} -> {hemisphere}");
            let cone = sample_cone(u, 1e-6);
            assert!(1.0 - cone.z <= 1.1e-6 && cone.truncate().length_squared() <= 2.001e-6, "{u} -> {cone}");
            for w in [cosine, hemisphere, cone, sample_sphere(u)] {
                assert!((w.length() - 1.0).abs() < 4.0 * f32::EPSILON, "{u} -> {w}");
            }
            assert!(sample_disk(u).length() <= 1.0 + f32::EPSILON);
            let b = sample_triangle(u);
            assert!(b.min_element() >= 0.0 && (b.element_sum() - 1.0).abs() <= 2.0 * f32::EPSILON, "{u} -> {b}");
        }
    }

    #[test]
    fn turns_match_angles() {
        for i in 0..=100_000 {
            let fraction = i as f32 / 100_000.0;
            let (sin, cos) = sin_cos_turn(fraction);
            let (exact_sin, exact_cos) = (2.0 * std::f64::consts::PI * f64::from(fraction)).sin_cos();
            assert!(
                (f64::from(sin) - exact_sin).abs() < 2e-7 && (f64::from(cos) - exact_cos).abs() < 2e-7,
                "{fraction}"
            );
        }
    }

    #[test]
    fn inverses_return_to_the_start() {
        // Points well inside the square: at its border a map folds or closes and several starts share one image.
        for u in squares().into_iter().filter(|u| u.min_element() > 0.01 && u.max_element() < 0.99) {
            let close = |name: &str, v: Vec2| assert!((v - u).length() < 1e-4, "{name}: {u} came back as {v}");
            close("disk", invert_disk(sample_disk(u)));
            close("cosine hemisphere", invert_cosine_hemisphere(sample_cosine_hemisphere(u)));
            close("sphere", invert_sphere(sample_sphere(u)));
            close("hemisphere", invert_hemisphere(sample_hemisphere(u)));
            close("cone", invert_cone(sample_cone(u, 1e-6), 1e-6));
            close("wide cone", invert_cone(sample_cone(u, 1.7), 1.7));
            close("triangle", invert_triangle(sample_triangle(u)));
        }
    }

    /// The Jacobian of each map by central differences is one over its density.
    #[test]
    fn densities_are_the_jacobians_of_the_maps() {
        let h = 1e-2;
        for u in squares().into_iter().filter(|u| u.min_element() > 0.05 && u.max_element() < 0.95) {
            // The concentric map has a crease along the diagonals, where differences straddle two pieces.
            let offset = (2.0 * u - 1.0).abs();
            if (offset.x - offset.y).abs() < 4.0 * h || (u.x - u.y).abs() < 4.0 * h {
                continue;
            }
            let area = |map: &dyn Fn(Vec2) -> Vec3| {
                let dx = (map(u + Vec2::new(h, 0.0)) - map(u - Vec2::new(h, 0.0))) / (2.0 * h);
                let dy = (map(u + Vec2::new(0.0, h)) - map(u - Vec2::new(0.0, h))) / (2.0 * h);
                dx.cross(dy).length()
            };
            let one = |name: &str, product: f32| assert!((product - 1.0).abs() < 0.02, "{name} at {u}: {product}");
            one("disk", area(&|u| sample_disk(u).extend(0.0)) * disk_pdf());
            let cos = sample_cosine_hemisphere(u).z;
            if cos > 0.3 {
                one("cosine hemisphere", area(&sample_cosine_hemisphere) * cosine_hemisphere_pdf(cos));
            }
            one("sphere", area(&sample_sphere) * sphere_pdf());
            one("hemisphere", area(&sample_hemisphere) * hemisphere_pdf());
            one("cone", area(&|u| sample_cone(u, 0.3)) * cone_pdf(0.3));
            // The triangle (0,0), (2,0), (0,1) of area 1.
            one(
                "triangle",
                area(&|u| (sample_triangle(u).truncate() * Vec2::new(2.0, 1.0)).extend(0.0)) * triangle_pdf(1.0),
            );
        }
    }
}
