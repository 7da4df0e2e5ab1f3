//! Shading normals for meshes that come without.

use etendue_core::geometry::Mesh;
use glam::Vec3;

/// Normals at the vertices of a mesh: those of the faces around, weighted by the angle that a face has there
/// [Thürmer and Wüthrich 1998]. A vertex without any face of positive area gets +z.
pub(crate) fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![glam::DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let p = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let Some(normal) = (p[1] - p[0]).cross(p[2] - p[0]).try_normalize() else { continue };
        for corner in 0..3 {
            let to_next = (p[(corner + 1) % 3] - p[corner]).normalize_or_zero();
            let to_previous = (p[(corner + 2) % 3] - p[corner]).normalize_or_zero();
            // atan2 keeps the digits of small and of nearly straight angles.
            let angle = to_next.cross(to_previous).length().atan2(to_next.dot(to_previous));
            sums[triangle[corner] as usize] += normal * angle;
        }
    }
    sums.into_iter().map(|sum| sum.try_normalize().map_or(Vec3::Z, |n| n.as_vec3())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubes_corner_counts_each_face_alike() {
        // Three faces meet at the origin; two of them are split there, so that counting triangles would tilt the normal.
        let positions = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
            .map(|p: [i32; 3]| Vec3::from(p.map(|c| c as f32)));
        let triangles = vec![[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4], [0, 4, 3], [3, 4, 6]];
        let mesh = Mesh { positions: positions.to_vec(), triangles, ..Mesh::default() };
        let n = vertex_normals(&mesh)[0];
        assert!((n - Vec3::splat(-1.0 / 3f32.sqrt())).length() < 1e-6, "{n}");
    }

    #[test]
    fn degenerate_faces_do_no_harm() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0],
            triangles: vec![[0, 1, 2], [1, 1, 1]],
            ..Mesh::default()
        };
        assert_eq!(vertex_normals(&mesh), vec![Vec3::Z; 3]);
    }
}
