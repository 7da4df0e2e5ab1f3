//! Meshes to trace rays through, made by formulas.

use etendue_core::{geometry::Mesh, ray::Ray};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f32::consts::TAU;

/// Where a mesh is seen from, and a light in it.
pub struct View {
    /// The camera.
    pub eye: Vec3,
    /// What it looks at.
    pub middle: Vec3,
    /// Middle of a round light.
    pub light: Vec3,
    /// Its radius.
    pub light_radius: f32,
}

impl View {
    /// The ray through a point of the image, whose coordinates go from -1/2 to 1/2.
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let forward = (self.middle - self.eye).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        Ray::new(self.eye, (forward + right * x - up * y).normalize())
    }
}

/// The meshes of the comparison with another engine.
pub fn peers() -> Vec<(&'static str, Mesh, View)> {
    let view = |eye: Vec3, middle: Vec3, light: Vec3, light_radius| View { eye, middle, light, light_radius };
    vec![
        ("blob", blob(187, 187), view(Vec3::new(0.0, 0.6, 2.2), Vec3::ZERO, Vec3::new(1.0, 2.0, 1.5), 0.3)),
        (
            "terrain",
            terrain_with_spheres(),
            view(Vec3::new(-0.9, 0.5, -0.9), Vec3::new(0.0, -0.1, 0.0), Vec3::new(0.3, 1.5, 0.2), 0.2),
        ),
        (
            "architecture",
            architecture(),
            view(Vec3::new(-9.0, 1.7, -3.5), Vec3::new(4.0, 1.9, 0.5), Vec3::new(0.0, 3.6, 0.0), 0.4),
        ),
    ]
}

/// A uniform direction.
pub fn unit(rng: &mut Pcg64Mcg) -> Vec3 {
    let (z, phi) = (rng.random::<f32>() * 2.0 - 1.0, rng.random::<f32>() * TAU);
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// Adds a box.
pub fn cuboid(mesh: &mut Mesh, lo: Vec3, hi: Vec3) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend((0..8).map(|i| {
        let pick = |bit: usize, k: usize| if i >> bit & 1 == 1 { hi[k] } else { lo[k] };
        Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    }));
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        mesh.triangles.extend([[a, b, c].map(|i| i + base), [a, c, d].map(|i| i + base)]);
    }
}

/// A surface over a grid of `width` times `height` cells.
fn grid(mesh: &mut Mesh, width: u32, height: u32, p: impl Fn(f32, f32) -> Vec3) {
    let base = mesh.positions.len() as u32;
    for j in 0..=height {
        for i in 0..=width {
            mesh.positions.push(p(i as f32 / width as f32, j as f32 / height as f32));
        }
    }
    for j in 0..height {
        for i in 0..width {
            let a = base + j * (width + 1) + i;
            let b = a + width + 1;
            mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
    }
}

/// A unit direction by parameters in the unit square.
fn direction(u: f32, v: f32) -> Vec3 {
    let (phi, theta) = (u * TAU, v * TAU * 0.5);
    Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
}

/// A bumpy sphere.
fn blob(width: u32, height: u32) -> Mesh {
    let mut mesh = Mesh::default();
    grid(&mut mesh, width, height, |u, v| {
        let d = direction(u, v);
        let bumps = (d.x * 9.0).sin() * (d.y * 11.0).cos() + (d.z * 23.0 + d.x * 17.0).sin() * 0.4;
        d * (0.8 + 0.13 * bumps)
    });
    mesh
}

fn height(x: f32, z: f32) -> f32 {
    let octave = |k: i32| {
        let f = 3.0 * 1.9f32.powi(k);
        ((x * f + k as f32).sin() * (z * f * 1.1 - x * f * 0.4).cos()) / f
    };
    (0..7).map(octave).sum::<f32>() * 0.5
}

/// A terrain of a million triangles.
fn terrain(cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    grid(&mut mesh, cells, cells, |u, v| {
        let (x, z) = (u * 2.0 - 1.0, v * 2.0 - 1.0);
        Vec3::new(x, height(x, z), z)
    });
    mesh
}

/// A terrain and two hundred spheres on it, a million triangles.
fn terrain_with_spheres() -> Mesh {
    let mut mesh = terrain(550);
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    for _ in 0..200 {
        let (x, z) = (rng.random_range(-0.95..0.95), rng.random_range(-0.95..0.95));
        let radius = rng.random_range(0.01..0.06);
        let center = Vec3::new(x, height(x, z) + radius, z);
        grid(&mut mesh, 62, 16, |u, v| center + direction(u, v) * radius);
    }
    mesh
}

/// A hall of long thin triangles: fluted columns, beams, a coffered ceiling, floor boards and blinds, turned off the axes.
fn architecture() -> Mesh {
    let mut mesh = Mesh::default();
    cuboid(&mut mesh, Vec3::new(-10.0, -0.2, -5.0), Vec3::new(10.0, 0.0, 5.0));
    cuboid(&mut mesh, Vec3::new(-10.0, 4.5, -5.0), Vec3::new(10.0, 4.7, 5.0));
    cuboid(&mut mesh, Vec3::new(-10.2, 0.0, -5.0), Vec3::new(-10.0, 4.5, 5.0));
    cuboid(&mut mesh, Vec3::new(10.0, 0.0, -5.0), Vec3::new(10.2, 4.5, 5.0));
    cuboid(&mut mesh, Vec3::new(-10.0, 0.0, 5.0), Vec3::new(10.0, 4.5, 5.2));
    // Boards over the whole length.
    for i in 0..600 {
        let z = -5.0 + i as f32 / 60.0;
        cuboid(&mut mesh, Vec3::new(-10.0, 0.0, z), Vec3::new(10.0, 0.01, z + 0.0155));
    }
    // Fluted columns: strips from floor to ceiling.
    for column in 0..36 {
        let (x, z) = (-8.5 + (column / 2 % 18) as f32, if column % 2 == 0 { -3.0 } else { 3.0 });
        grid(&mut mesh, 480, 1, |u, v| {
            let r = 0.28 + 0.02 * (u * TAU * 24.0).cos();
            Vec3::new(x + r * (u * TAU).cos(), v * 4.5, z + r * (u * TAU).sin())
        });
    }
    // Beams across, and blinds along one side.
    for i in 0..80 {
        let x = -9.9 + i as f32 * 0.25;
        cuboid(&mut mesh, Vec3::new(x, 4.2, -5.0), Vec3::new(x + 0.06, 4.5, 5.0));
    }
    for i in 0..160 {
        let y = 0.6 + i as f32 * 0.022;
        cuboid(&mut mesh, Vec3::new(-10.0, y, -5.0), Vec3::new(10.0, y + 0.003, -4.94));
    }
    // Rods between random points of the walls.
    let mut rng = Pcg64Mcg::seed_from_u64(12);
    for _ in 0..640 {
        let a = Vec3::new(rng.random_range(-9.5..9.5), rng.random_range(2.8..4.4), -4.9);
        let b = Vec3::new(a.x + rng.random_range(-3.0..3.0), rng.random_range(2.8..4.4), 4.9);
        let base = mesh.positions.len() as u32;
        for k in 0..3 {
            let arm = Vec3::new((k as f32 * TAU / 3.0).cos(), (k as f32 * TAU / 3.0).sin(), 0.0) * 0.008;
            mesh.positions.extend([a + arm, b + arm]);
        }
        for k in 0..3u32 {
            let (i, j) = (base + 2 * k, base + 2 * ((k + 1) % 3));
            mesh.triangles.extend([[i, i + 1, j], [j, i + 1, j + 1]]);
        }
    }
    // Off the axes, as a building on a map is.
    let turn = glam::Mat3::from_rotation_y(0.3);
    mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
    mesh
}
