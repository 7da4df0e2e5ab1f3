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
    /// What it starts on: a triangle is flat, so the ray never meets it again.
    pub leaves: PrimitiveId,
    /// What the end of a segment lies on, by which a triangle cannot hide it.
    pub arrives: PrimitiveId,
}

/// A primitive among all that a ray can meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveId {
    /// Primitive, counted over all shapes of the top level or of the instance's group.
    pub primitive: u32,
    /// Index of the instance; `u32::MAX` at the top level.
    pub instance: u32,
}

impl PrimitiveId {
    /// No primitive: a ray that starts or ends in free space.
    pub const NONE: PrimitiveId = PrimitiveId { primitive: u32::MAX, instance: u32::MAX };
}

impl Ray {
    /// An unbounded ray.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction, t_max: f32::INFINITY, leaves: PrimitiveId::NONE, arrives: PrimitiveId::NONE }
    }

    /// The segment from `origin` to `origin + direction`, both ends excluded.
    #[inline]
    pub fn segment(origin: Vec3, direction: Vec3) -> Ray {
        Ray { t_max: 1.0, ..Ray::new(origin, direction) }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}
