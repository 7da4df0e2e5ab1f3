//! A cube seen from inside.

use etendue_core::geometry::Mesh;
use glam::Vec3;

/// The cube from `-half` to `half` in each coordinate, flat faces with normals inwards, with shared vertices.
pub(crate) fn inward_cube(half: f32) -> Mesh {
    let sign = |bit: usize| if bit & 1 == 0 { -half } else { half };
    let positions = (0..8).map(|i| Vec3::new(sign(i), sign(i >> 1), sign(i >> 2))).collect();
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_closed_and_faces_inwards() {
        let mesh = inward_cube(2.0);
        let mut edges = std::collections::HashSet::new();
        for t in &mesh.triangles {
            let p = t.map(|i| mesh.positions[i as usize]);
            let normal = (p[1] - p[0]).cross(p[2] - p[0]);
            assert!(normal.dot(p[0]) < 0.0);
            for i in 0..3 {
                assert!(edges.insert((t[i], t[(i + 1) % 3])), "an edge is used twice in one direction");
            }
        }
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
    }
}
