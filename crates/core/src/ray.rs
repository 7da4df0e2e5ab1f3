//! Rays.

use glam::Vec3;

/// A ray `origin + t * direction` for `0 < t < t_max`.
///
/// The direction need not be of unit length: a shadow ray between two points has the difference as its direction and
/// `t_max = 1`, so that no epsilon shortens it.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts, already moved off its surface (see [`crate::geometry::offset`]).
    pub origin: Vec3,
    /// Where it goes; finite and not zero.
    pub direction: Vec3,
    /// Upper bound of `t`, exclusive; infinity for an unbounded ray.
    pub t_max: f32,
}

impl Ray {
    /// An unbounded ray.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction, t_max: f32::INFINITY }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}
