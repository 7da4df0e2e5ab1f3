//! Orthonormal frames.

use glam::Vec3;

/// A right-handed orthonormal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First axis.
    pub s: Vec3,
    /// Second axis.
    pub t: Vec3,
    /// Third axis, the normal.
    pub n: Vec3,
}

impl Frame {
    /// A frame about a unit normal [Duff et al. 2017, listing 3].
    #[inline]
    pub fn from_normal(n: Vec3) -> Frame {
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Frame {
            s: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// From the frame to the world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}
