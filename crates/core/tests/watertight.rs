//! Rays aimed at the edges and vertices of closed meshes, where a careless intersection test lets them through.

use etendue_core::{
    geometry::{Geometry, Mesh, Shape},
    ray::Ray,
};
use glam::{Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::HashMap;

fn cube() -> Mesh {
    let positions =
        (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0).collect();
    let triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    Mesh { positions, triangles, ..Mesh::default() }
}

/// A subdivided icosahedron.
fn icosphere(levels: usize) -> Mesh {
    let phi = (1.0 + 5f32.sqrt()) * 0.5;
    let mut positions = Vec::new();
    for (a, b) in [(1.0, phi), (1.0, -phi), (-1.0, phi), (-1.0, -phi)] {
        positions.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
    }
    // The faces of the icosahedron are the triples of vertices at mutual distance 2.
    let near = |a: usize, b: usize| (positions[a].distance(positions[b]) - 2.0).abs() < 0.1;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let outward = (positions[b] - positions[a]).cross(positions[c] - positions[a]).dot(positions[a]);
                    triangles.push(if outward > 0.0 { [a, b, c] } else { [a, c, b] }.map(|i| i as u32));
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    let mut positions: Vec<Vec3> = positions.into_iter().map(Vec3::normalize).collect();
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push(((positions[a as usize] + positions[b as usize]) * 0.5).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    Mesh { positions, triangles, ..Mesh::default() }
}

/// A closed, star-shaped mesh with spikes.
fn blob(levels: usize, seed: u64) -> Mesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut mesh = icosphere(levels);
    for p in &mut mesh.positions {
        *p *= 0.6 + 0.4 * rng.random::<f32>();
    }
    mesh
}

fn transformed(mesh: &Mesh, rotation: Quat, scale: f32, translation: Vec3) -> Mesh {
    let positions = mesh.positions.iter().map(|&p| rotation * p * scale + translation).collect();
    Mesh { positions, ..mesh.clone() }
}

fn on_sphere(rng: &mut Pcg64Mcg) -> Vec3 {
    loop {
        let p = Vec3::new(rng.random(), rng.random(), rng.random()) * 2.0 - 1.0;
        if (0.01..1.0).contains(&p.length_squared()) {
            return p.normalize();
        }
    }
}

/// A point of an edge, a vertex, or the rounded middle of an edge; and its triangle.
fn target(mesh: &Mesh, rng: &mut Pcg64Mcg) -> Vec3 {
    let triangle = mesh.triangles[rng.random_range(0..mesh.triangles.len())];
    let corner = rng.random_range(0..3);
    let [a, b] = [triangle[corner], triangle[(corner + 1) % 3]].map(|i| mesh.positions[i as usize]);
    match rng.random_range(0..4) {
        0 => a,
        1 => (a + b) * 0.5,
        _ => a.lerp(b, rng.random()),
    }
}

/// Rays from within, which must all hit, and rays of shadows from within to far outside; returns rays tested and leaks.
fn leaks(mesh: &Mesh, center: Vec3, size: f32, rays: usize, seed: u64) -> (usize, usize) {
    let geometry = Geometry::build(vec![Shape::Mesh(mesh.clone())], vec![], vec![]);
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut leaks = 0;
    for i in 0..rays {
        let target = target(mesh, &mut rng);
        // Star-shaped meshes: this close to the centre is inside.
        let origin = match i % 4 {
            0 => center,
            // In a plane with the target: axis-aligned directions, components of zero.
            1 => {
                let mut origin = center;
                let axis = rng.random_range(0..3);
                origin[axis] = center[axis] + (target[axis] - center[axis]) * 0.25;
                origin
            }
            _ => center + on_sphere(&mut rng) * (0.3 * size * rng.random::<f32>()),
        };
        let direction = target - origin;
        let closest = geometry.closest::<0>(&Ray::new(origin, direction));
        let shadow = geometry.occluded::<0>(&Ray::segment(origin, direction * 8.0));
        leaks += usize::from(closest.is_none() || !shadow);
    }
    (rays, leaks)
}

#[test]
fn closed_meshes_do_not_leak() {
    let shapes =
        [("cube", cube(), 150), ("sphere", icosphere(4), 60), ("blob", blob(3, 7), 60), ("large blob", blob(5, 8), 30)];
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut total = 0;
    for (name, mesh, thousands) in &shapes {
        for scale in [1e-4, 1.0, 1e5f32] {
            for shift in [0.0, 1.0, 1000.0] {
                let axis_aligned = shift == 1.0;
                let rotation =
                    if axis_aligned { Quat::IDENTITY } else { Quat::from_axis_angle(on_sphere(&mut rng), 1.0) };
                let translation = on_sphere(&mut rng) * (scale * shift);
                let placed = transformed(mesh, rotation, scale, translation);
                let (rays, leaks) = leaks(&placed, translation, scale, thousands * 1000, 3);
                assert_eq!(leaks, 0, "{name}, scale {scale}, shift {shift}: of {rays} rays");
                total += rays;
            }
        }
    }
    assert!(total >= 2_000_000);
}

/// Rays from outside along axes and in the planes of faces, aimed at the vertices of a cube on a grid: all must enter.
#[test]
fn axis_aligned_rays_do_not_miss_flat_boxes() {
    let mesh = cube();
    let geometry = Geometry::build(vec![Shape::Mesh(mesh)], vec![], vec![]);
    for axis in 0..3 {
        for sign in [-1.0f32, 1.0] {
            for zero in [0.0f32, -0.0] {
                for i in 0..=16 {
                    for k in 0..=16 {
                        let mut origin = Vec3::ZERO;
                        origin[axis] = -3.0 * sign;
                        origin[(axis + 1) % 3] = i as f32 / 8.0 - 1.0;
                        origin[(axis + 2) % 3] = k as f32 / 8.0 - 1.0;
                        let mut direction = Vec3::splat(zero);
                        direction[axis] = sign;
                        let hit = geometry.closest::<0>(&Ray::new(origin, direction));
                        assert_eq!(hit.map(|h| h.t), Some(2.0), "{origin} {direction}");
                        let mut inside = origin;
                        inside[axis] = 0.5;
                        assert!(
                            geometry.occluded::<0>(&Ray { t_max: 2.0, ..Ray::new(inside, direction) }),
                            "{inside} {direction}"
                        );
                    }
                }
            }
        }
    }
}
