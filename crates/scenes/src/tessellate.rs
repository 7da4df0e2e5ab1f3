//! Fine meshes that stand for round shapes under transforms that leave them no longer round.

use etendue_core::{geometry::Mesh, scene::ObjectShape};
use glam::{DVec3, Vec2};
use std::f64::consts::PI;

/// Cells about the axis, and from pole to pole.
const AROUND: u32 = 256;
const ALONG: u32 = 128;

/// A mesh with the surface, the normals and the texture coordinates of a sphere, a disk or a cylinder; none for other shapes.
///
/// A polygon of [`AROUND`] corners has 1e-4 less area than its circle: disks and cylinders are as much wider, so that their
/// areas, and what they emit, are right. A sphere's area falls short by 1e-4.
pub(crate) fn tessellated(shape: &ObjectShape) -> Option<Mesh> {
    let step = 2.0 * PI / f64::from(AROUND);
    let circle = |u: f64| {
        // The seam closes to the last bit.
        let (sin, cos) = (2.0 * PI * u.fract()).sin_cos();
        (cos, sin)
    };
    match shape {
        ObjectShape::Sphere { center, radius, inverted } => Some(grid(ALONG, *inverted, |u, v| {
            let (cos, sin) = circle(u);
            // The poles are points to the last bit.
            let (ring, z) = if v == 0.0 || v == 1.0 { (0.0, 1.0 - 2.0 * v) } else { (PI * v).sin_cos() };
            let n = DVec3::new(ring * cos, ring * sin, z);
            (*center + n * *radius, if *inverted { -n } else { n })
        })),
        ObjectShape::Disk => {
            let radius = (step / step.sin()).sqrt();
            let mut mesh = grid(1, false, |u, v| {
                let (cos, sin) = circle(u);
                (DVec3::new(cos, sin, 0.0) * (radius * v), DVec3::Z)
            });
            // The radius, then the angle.
            mesh.uvs.iter_mut().for_each(|uv| *uv = Vec2::new(uv.y, uv.x));
            Some(mesh)
        }
        ObjectShape::Cylinder { from, to, radius, inverted } => {
            let axis = *to - *from;
            let x = axis.try_normalize()?.any_orthonormal_vector();
            let y = axis.normalize().cross(x);
            let radius = *radius * 0.5 * step / (0.5 * step).sin();
            Some(grid(1, !*inverted, |u, v| {
                let (cos, sin) = circle(u);
                let n = x * cos + y * sin;
                (*from + axis * v + n * radius, if *inverted { -n } else { n })
            }))
        }
        ObjectShape::Mesh(_) | ObjectShape::Rectangle | ObjectShape::Cube => None,
    }
}

/// A grid of [`AROUND`] x `rows` cells with the positions and normals of `at`, whose parameters in the unit square are the
/// texture coordinates. Where both grow, the front of the faces is that of the second direction times the first;
/// `turned`, the other.
fn grid(rows: u32, turned: bool, at: impl Fn(f64, f64) -> (DVec3, DVec3)) -> Mesh {
    let mut mesh = Mesh::default();
    for (j, i) in (0..=rows).flat_map(|j| (0..=AROUND).map(move |i| (j, i))) {
        let (u, v) = (f64::from(i) / f64::from(AROUND), f64::from(j) / f64::from(rows));
        let (p, n) = at(u, v);
        mesh.positions.push(p.as_vec3());
        mesh.normals.push(n.as_vec3());
        mesh.uvs.push(Vec2::new(u as f32, v as f32));
    }
    for (j, i) in (0..rows).flat_map(|j| (0..AROUND).map(move |i| (j, i))) {
        let a = j * (AROUND + 1) + i;
        let b = a + AROUND + 1;
        mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
    }
    // Cells at a pole have one triangle.
    let is_apart = |[a, b, c]: &[u32; 3]| {
        let p = |i: &u32| mesh.positions[*i as usize];
        p(a) != p(b) && p(b) != p(c) && p(c) != p(a)
    };
    mesh.triangles = mesh.triangles.iter().copied().filter(is_apart).collect();
    if turned {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    mesh
}
