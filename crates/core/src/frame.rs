//! Orthonormal frames around a normal.

use glam::Vec3;

/// A right-handed orthonormal frame; local coordinates are (along tangent, along bitangent, along normal).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x.
    pub tangent: Vec3,
    /// Local y.
    pub bitangent: Vec3,
    /// Local z.
    pub normal: Vec3,
}

impl Frame {
    /// A frame around a unit normal, the tangent wherever it falls [Duff et al. 2017, listing 3].
    #[inline]
    pub fn from_normal(n: Vec3) -> Frame {
        let sign = 1f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Frame {
            tangent: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            bitangent: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            normal: n,
        }
    }

    /// A frame around a unit normal whose tangent is `dpdu` made perpendicular to it (Gram-Schmidt). Where `dpdu` says
    /// nothing (zero, not finite, along the normal), the tangent is that of [`Frame::from_normal`].
    #[inline]
    pub fn from_normal_and_tangent(n: Vec3, dpdu: Vec3) -> Frame {
        // Lengths from 1e-30 to 1e30 must not overflow or vanish when squared.
        let scale = dpdu.abs().max_element();
        let d = dpdu / scale;
        let across = d - n * n.dot(d);
        let length_squared = across.length_squared();
        // What is left after the subtraction must exceed its rounding error by far, or its direction is noise.
        if scale > 0.0 && scale.is_finite() && length_squared > 1e3 * f32::EPSILON * f32::EPSILON {
            let t = across / length_squared.sqrt();
            // Once more: the first subtraction leaves an error of EPSILON over the sine of the angle to the normal.
            let tangent = (t - n * n.dot(t)).normalize();
            Frame { tangent, bitangent: n.cross(tangent), normal: n }
        } else {
            Frame::from_normal(n)
        }
    }

    /// World to local.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.tangent), v.dot(self.bitangent), v.dot(self.normal))
    }

    /// Local to world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        v.x * self.tangent + v.y * self.bitangent + v.z * self.normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp;
    use glam::Vec2;

    fn normals() -> Vec<Vec3> {
        let mut normals = vec![Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        normals.push(Vec3::new(1e-4, -1e-4, -1.0).normalize());
        normals.push(Vec3::new(1e-7, 0.0, -1.0));
        normals.push(Vec3::new(1.0, 0.0, -0.0));
        normals.extend(
            (0..400).map(|i| warp::sample_sphere(Vec2::new((i as f32 + 0.5) / 400.0, (i as f32 * 0.618_034).fract()))),
        );
        normals
    }

    fn assert_orthonormal(f: &Frame) {
        let tolerance = 4.0 * f32::EPSILON;
        for (a, b) in [(f.tangent, f.bitangent), (f.bitangent, f.normal), (f.normal, f.tangent)] {
            assert!(a.dot(b).abs() <= tolerance && (a.length() - 1.0).abs() <= tolerance, "{f:?}");
        }
        assert!((f.tangent.cross(f.bitangent) - f.normal).length() <= 2.0 * tolerance, "{f:?}");
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for n in normals() {
            let frame = Frame::from_normal(n);
            assert_orthonormal(&frame);
            let v = Vec3::new(0.3, -0.8, 0.52);
            assert!((frame.to_world(frame.to_local(v)) - v).length() < 1e-6);
            assert!((frame.to_local(n) - Vec3::Z).length() < 1e-6);
        }
    }

    #[test]
    fn tangents_follow_dpdu() {
        for n in normals() {
            let across = n.any_orthonormal_vector();
            for scale in [1e-30, 1e-6, 1.0, 1e30] {
                for slant in [0.0, 1.0, -1e3] {
                    let frame = Frame::from_normal_and_tangent(n, (across + n * slant) * scale);
                    assert_orthonormal(&frame);
                    assert!(frame.tangent.dot(across) > 0.9999, "{n} {scale} {slant}: {frame:?}");
                }
            }
        }
    }

    #[test]
    fn degenerate_tangents_fall_back() {
        for n in normals() {
            for dpdu in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, n, -3.0 * n, 1e-30 * n, Vec3::splat(f32::MAX)] {
                assert_orthonormal(&Frame::from_normal_and_tangent(n, dpdu));
            }
        }
    }
}
