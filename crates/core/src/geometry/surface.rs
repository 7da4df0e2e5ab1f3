//! What is known at a hit, before it is known which shape it belongs to.

use crate::rgb::Rgb;
use glam::{Vec2, Vec3};

/// A [`Surface`](super::Surface) without its shape; in the space of its shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    pub p: Vec3,
    pub p_error: Vec3,
    pub ng: Vec3,
    pub ns: Vec3,
    pub dpdu: Vec3,
    pub uv: Vec2,
    pub color: Rgb,
}

/// A unit vector at right angles to the unit vector `n`. [Duff et al. 2017, listing 3]
#[inline]
pub(super) fn tangent(n: Vec3) -> Vec3 {
    let sign = 1f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    Vec3::new(1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x)
}
