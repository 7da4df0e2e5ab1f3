//! Maps from the unit square to where samples are wanted, each with its density.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// The unit disk, uniformly, with little distortion [Shirley and Chiu 1997].
#[inline]
pub fn square_to_uniform_disk_concentric(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (r, phi) =
        if p.x.abs() > p.y.abs() { (p.x, FRAC_PI_4 * (p.y / p.x)) } else { (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y)) };
    let (sin, cos) = phi.sin_cos();
    r * Vec2::new(cos, sin)
}

/// The hemisphere about +z with density `cos / pi` [Malley].
#[inline]
pub fn square_to_cosine_hemisphere(u: Vec2) -> Vec3 {
    let p = square_to_uniform_disk_concentric(u);
    p.extend((1.0 - p.length_squared()).max(0.0).sqrt())
}

/// The unit sphere, uniformly.
#[inline]
pub fn square_to_uniform_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.y;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * u.x).sin_cos();
    Vec3::new(r * cos, r * sin, z)
}
