//! What is known at a hit, before it is known which shape it belongs to.

use crate::rgb::Rgb;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// A [`Surface`](super::Surface) without its shape; in the space of its shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    pub p: Vec3,
    pub p_error: Vec3,
    pub ng: Vec3,
    pub ns: Vec3,
    pub dpdu: Vec3,
    pub dpdv: Vec3,
    pub uv: Vec2,
    pub color: Rgb,
}

impl Local {
    /// A point where neither texture coordinates nor tangents are asked for.
    #[inline]
    pub fn bare(p: Vec3, p_error: Vec3, ng: Vec3, ns: Vec3) -> Local {
        Local { p, p_error, ng, ns, dpdu: Vec3::ZERO, dpdv: Vec3::ZERO, uv: Vec2::ZERO, color: Rgb::WHITE }
    }
}

/// An angle of local coordinates over a full turn, in [0, 1].
#[inline]
pub(super) fn turn(x: f32, y: f32) -> f32 {
    let u = y.atan2(x) * (1.0 / TAU);
    if u < 0.0 { u + 1.0 } else { u }
}

/// The derivatives as far as they are defined: of finite, positive length, which survives being squared; else a tangent
/// and nothing.
#[inline]
pub(super) fn tangents(ng: Vec3, dpdu: Vec3, dpdv: Vec3) -> (Vec3, Vec3) {
    let usable = |d: Vec3| d.length_squared().is_finite() && d.length_squared() > 0.0;
    (if usable(dpdu) { dpdu } else { tangent(ng) }, if usable(dpdv) { dpdv } else { Vec3::ZERO })
}

/// A unit vector at right angles to the unit vector `n`. [Duff et al. 2017, listing 3]
#[inline]
pub(super) fn tangent(n: Vec3) -> Vec3 {
    let sign = 1f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    Vec3::new(1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x)
}
