//! Where rays start and end: the one place that moves points off surfaces.
//!
//! A computed point lies within `p_error` of its surface. Moved along the geometric normal by just that much, it lies on
//! the wanted side in exact arithmetic; the intersection tests, which decide doubtful cases in double precision, then
//! never find the surface that the ray leaves or ends on. No absolute epsilon is involved, so nothing depends on the
//! scale of a scene.

use super::Surface;
use crate::ray::{PrimitiveId, Ray};
use glam::Vec3;

/// Unit roundoff of `f32`.
pub(crate) const ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Bound of the relative error of `n` roundings in a row. [Higham 2002, lemma 3.1]
#[inline]
pub(crate) const fn gamma(n: u32) -> f32 {
    let e = n as f32 * ROUNDOFF;
    e / (1.0 - e)
}

/// Moves `p`, known within `p_error`, off the surface with unit normal `ng`, to the side that `towards` points to.
///
/// [Pharr et al. 2023, sec. 6.8.6]
#[inline]
pub fn offset_origin(p: Vec3, p_error: Vec3, ng: Vec3, towards: Vec3) -> Vec3 {
    // The factor covers the roundings of the dot product and of the product with the normal.
    let distance = ng.abs().dot(p_error) * (1.0 + gamma(8));
    let offset = if towards.dot(ng) < 0.0 { ng * -distance } else { ng * distance };
    let moved = p + offset;
    Vec3::new(round_along(moved.x, offset.x), round_along(moved.y, offset.y), round_along(moved.z, offset.z))
}

/// At least one float further in the direction of `offset`, so that rounding never takes back what was added.
#[inline]
fn round_along(x: f32, offset: f32) -> f32 {
    // Between one and two units in the last place, without the branches of next_up and next_down.
    let step = (x.abs() * f32::EPSILON).copysign(offset);
    x + if offset == 0.0 { 0.0 } else { step }
}

/// An unbounded ray that leaves a surface.
#[inline]
pub fn spawn_ray(surface: &Surface, direction: Vec3) -> Ray {
    let origin = offset_origin(surface.p, surface.p_error, surface.ng, direction);
    Ray { leaves: surface.id, ..Ray::new(origin, direction) }
}

/// The ray from a surface to a point of another surface, with `t_max = 1` at that point.
///
/// Both ends are moved off their surfaces, towards each other; an occluder in between, and only that, is hit in (0, 1).
/// Where the two points coincide the direction is zero: such a ray hits nothing.
#[inline]
pub fn shadow_ray(
    surface: &Surface,
    target: Vec3,
    target_error: Vec3,
    target_normal: Vec3,
    target_id: PrimitiveId,
) -> Ray {
    let origin = offset_origin(surface.p, surface.p_error, surface.ng, target - surface.p);
    let back = origin - target;
    // The direction is rounded, hence the far end is where `t = 1` says only within a multiple of the ray's length.
    let slack = Vec3::splat(gamma(8) * back.abs().max_element());
    let end = offset_origin(target, target_error + slack, target_normal, back);
    Ray { leaves: surface.id, arrives: target_id, ..Ray::segment(origin, end - origin) }
}

/// The ray from a surface to a point in free space (a point light, a pinhole), with `t_max = 1` at that point.
#[inline]
pub fn shadow_ray_to_point(surface: &Surface, target: Vec3) -> Ray {
    let origin = offset_origin(surface.p, surface.p_error, surface.ng, target - surface.p);
    Ray { leaves: surface.id, ..Ray::segment(origin, target - origin) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_to_the_side_asked_for_and_at_least_by_the_error() {
        let p = Vec3::new(1.0, -2000.0, 3e-5);
        let error = p.abs() * gamma(7);
        for ng in [Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::new(1.0, 2.0, -3.0).normalize()] {
            for side in [1.0, -1.0] {
                let moved = offset_origin(p, error, ng, ng * side);
                let distance = (moved.as_dvec3() - p.as_dvec3()).dot(ng.as_dvec3()) * f64::from(side);
                let bound = ng.abs().as_dvec3().dot(error.as_dvec3());
                assert!(distance >= bound, "{distance} {bound}");
                assert!(distance <= 2.0 * bound + f64::from(f32::MIN_POSITIVE), "{distance} {bound}");
            }
        }
    }

    #[test]
    fn no_error_moves_nothing() {
        assert_eq!(offset_origin(Vec3::ONE, Vec3::ZERO, Vec3::Y, Vec3::Y), Vec3::ONE);
    }
}
