//! A test of the disk that photons are gathered in: is all of it surface?
//!
//! Over an edge, in a corner or under what stands on it a disk has less surface than its area says, and past a wall it has light
//! that does not come here.

use etendue_core::{geometry::Axes, ray::Ray, scene::Scene, warp::sin_cos_turn};
use glam::Vec3;

/// Directions that are probed.
const PROBES: u32 = 8;
/// Height of the probes over the surface, over the radius of the disk.
const HEIGHT: f32 = 0.25;

/// Returns `true` if the surface at `p` with the unit normal `normal` goes on as far as `radius` with nothing standing on it. Rays
/// above it, which start in free space, must pass to the border of the disk, and those down from there must not.
pub fn is_clear<const HAS: u32>(scene: &Scene, p: Vec3, normal: Vec3, radius: f32) -> bool {
    let axes = Axes::about(normal);
    let lift = normal * (HEIGHT * radius);
    (0..PROBES).all(|probe| {
        let (sin, cos) = sin_cos_turn((probe as f32 + 0.5) / PROBES as f32);
        let border = (axes.x * cos + axes.y * sin) * radius;
        !scene.occluded::<HAS>(&Ray::segment(p + lift, border))
            && scene.occluded::<HAS>(&Ray::segment(p + lift + border, lift * -2.0))
    })
}
