//! Rotations and viewpoints, in f64.

use glam::{DAffine3, DMat3, DVec3};

/// Sine and cosine of an angle in degrees, exact at multiples of a right angle, so that walls turned by such angles meet
/// without a gap.
fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    match angle.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

/// The rotation about `axis`, a unit vector, counter-clockwise by `angle` degrees.
pub(crate) fn rotation(axis: DVec3, angle: f64) -> DMat3 {
    // Rodrigues: R = cos I + (1 - cos) a a^T + sin [a]x.
    let (sin, cos) = sin_cos_degrees(angle);
    let a = axis;
    let cross =
        DMat3::from_cols(DVec3::new(0.0, a.z, -a.y), DVec3::new(-a.z, 0.0, a.x), DVec3::new(a.y, -a.x, 0.0)) * sin;
    let outer = DMat3::from_cols(a * a.x, a * a.y, a * a.z) * (1.0 - cos);
    DMat3::IDENTITY * cos + outer + cross
}

/// The placement of what stands at `origin` and whose +z looks at `target`, with +y towards `up` and +x to the left; none
/// if the three do not fix one.
pub(crate) fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> Option<DAffine3> {
    let forward = (target - origin).try_normalize()?;
    let left = up.try_normalize()?.cross(forward).try_normalize()?;
    let placed = DAffine3::from_mat3_translation(DMat3::from_cols(left, forward.cross(left), forward), origin);
    placed.is_finite().then_some(placed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_are_exact() {
        assert_eq!(rotation(DVec3::Y, 90.0) * DVec3::Z, DVec3::X);
        assert_eq!(rotation(DVec3::X, -90.0) * DVec3::Z, DVec3::Y);
        assert_eq!(rotation(DVec3::Z, 450.0) * DVec3::X, DVec3::Y);
    }

    #[test]
    fn other_angles_are_rotations() {
        let r = rotation(DVec3::new(1.0, 2.0, -2.0) / 3.0, 33.0);
        assert!((r * r.transpose() - DMat3::IDENTITY).to_cols_array().iter().all(|e| e.abs() < 1e-15));
        assert!((r.determinant() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn look_at_looks_along_z_with_x_to_the_left() {
        let m = look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y).unwrap();
        assert_eq!(m.transform_vector3(DVec3::Z), -DVec3::Z);
        assert_eq!(m.transform_vector3(DVec3::Y), DVec3::Y);
        // Seen along -z with y up, left is -x.
        assert_eq!(m.transform_vector3(DVec3::X), -DVec3::X);
        assert!(look_at(DVec3::ZERO, DVec3::Y, DVec3::Y).is_none());
        assert!(look_at(DVec3::ONE, DVec3::ONE, DVec3::Y).is_none());
    }
}
