//! Rays per second, one thread: `cargo bench -p etendue-core --bench rays`.
//!
//! Three scenes (a box with 36 triangles, a blob with 82 thousand, a terrain with a million), each with coherent rays
//! from a camera, the rays that diffuse bounces of those make, random rays, and shadow rays; and the time to build.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue_core::{
    geometry::{Geometry, Mesh, Shape, offset::spawn_ray},
    ray::Ray,
};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{f32::consts::TAU, hint::black_box, time::Duration};

/// Rays of a batch.
const RAYS: usize = 1 << 14;

fn unit(rng: &mut Pcg64Mcg) -> Vec3 {
    let (z, phi) = (rng.random::<f32>() * 2.0 - 1.0, rng.random::<f32>() * TAU);
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * phi.cos(), r * phi.sin(), z)
}

fn cuboid(mesh: &mut Mesh, lo: Vec3, hi: Vec3) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend((0..8).map(|i| {
        let pick = |bit: usize, k: usize| if i >> bit & 1 == 1 { hi[k] } else { lo[k] };
        Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    }));
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        mesh.triangles.extend([[a, b, c].map(|i| i + base), [a, c, d].map(|i| i + base)]);
    }
}

/// A closed room with two blocks: 36 triangles.
fn cornell() -> Mesh {
    let mut mesh = Mesh::default();
    cuboid(&mut mesh, Vec3::splat(-1.0), Vec3::splat(1.0));
    cuboid(&mut mesh, Vec3::new(-0.65, -1.0, -0.6), Vec3::new(-0.1, 0.2, 0.0));
    cuboid(&mut mesh, Vec3::new(0.1, -1.0, 0.0), Vec3::new(0.7, -0.4, 0.6));
    mesh
}

/// A surface over a grid of `width` times `height` cells.
fn grid(width: u32, height: u32, p: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=height {
        for i in 0..=width {
            mesh.positions.push(p(i as f32 / width as f32, j as f32 / height as f32));
        }
    }
    for j in 0..height {
        for i in 0..width {
            let a = j * (width + 1) + i;
            let b = a + width + 1;
            mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
    }
    mesh
}

/// A bumpy sphere of 82 thousand triangles.
fn blob() -> Mesh {
    grid(286, 143, |u, v| {
        let (phi, theta) = (u * TAU, v * TAU * 0.5);
        let d = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
        let bumps = (d.x * 9.0).sin() * (d.y * 11.0).cos() + (d.z * 23.0 + d.x * 17.0).sin() * 0.4;
        d * (0.8 + 0.13 * bumps)
    })
}

/// A terrain of a million triangles.
fn terrain() -> Mesh {
    grid(708, 708, |u, v| {
        let (x, z) = (u * 2.0 - 1.0, v * 2.0 - 1.0);
        let height: f32 = (0..7)
            .map(|octave| {
                let f = 3.0 * 1.9f32.powi(octave);
                ((x * f + octave as f32).sin() * (z * f * 1.1 - x * f * 0.4).cos()) / f
            })
            .sum();
        Vec3::new(x, height * 0.5, z)
    })
}

/// A scene with its batches of rays.
struct Case {
    name: &'static str,
    mesh: Mesh,
    geometry: Geometry,
    camera: Vec<Ray>,
    bounce: Vec<Ray>,
    random: Vec<Ray>,
    shadow: Vec<Ray>,
}

impl Case {
    fn new(name: &'static str, mesh: Mesh, eye: Vec3, middle: Vec3) -> Case {
        let geometry = Geometry::build(vec![Shape::Mesh(mesh.clone())], vec![], vec![]);
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let (lo, hi) = geometry.bounds().expect("a scene");
        let side = (RAYS as f32).sqrt() as usize;
        let forward = (middle - eye).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        let camera: Vec<Ray> = (0..RAYS)
            .map(|i| {
                let (x, y) = ((i % side) as f32 / side as f32 - 0.5, (i / side) as f32 / side as f32 - 0.5);
                Ray::new(eye, (forward + right * x + up * y).normalize())
            })
            .collect();
        let surfaces: Vec<_> = camera
            .iter()
            .filter_map(|ray| geometry.closest::<0>(ray).map(|hit| (ray, geometry.surface::<0>(ray, &hit))))
            .collect();
        let light = middle + (hi - lo) * Vec3::new(0.1, 0.49, 0.1);
        let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
        while bounce.len() < RAYS {
            let (ray, surface) = &surfaces[rng.random_range(0..surfaces.len())];
            let n = if surface.ng.dot(ray.direction) < 0.0 { surface.ng } else { -surface.ng };
            bounce.push(spawn_ray(surface, (n + unit(&mut rng) * 0.999).normalize()));
            let target = light + unit(&mut rng) * 0.05;
            shadow.push(etendue_core::geometry::offset::shadow_ray_to_point(surface, target));
        }
        let mut inside = || lo + (hi - lo) * Vec3::new(rng.random(), rng.random(), rng.random());
        let random = (0..RAYS)
            .map(|_| {
                let (a, b) = (inside(), inside());
                Ray::new(a, (b - a).normalize())
            })
            .collect();
        Case { name, mesh, geometry, camera, bounce, random, shadow }
    }
}

fn cases() -> [Case; 3] {
    [
        Case::new("box", cornell(), Vec3::new(0.0, 0.0, 0.95), Vec3::ZERO),
        Case::new("blob", blob(), Vec3::new(0.0, 0.6, 2.2), Vec3::ZERO),
        Case::new("terrain", terrain(), Vec3::new(-0.9, 0.5, -0.9), Vec3::ZERO),
    ]
}

fn rays(c: &mut Criterion) {
    for case in cases() {
        let geometry = &case.geometry;
        println!(
            "{}: {} triangles, {:.1} bytes each",
            case.name,
            geometry.triangle_count(),
            geometry.memory_bytes() as f64 / geometry.triangle_count() as f64
        );
        let mut group = c.benchmark_group(case.name);
        group.throughput(Throughput::Elements(RAYS as u64)).warm_up_time(Duration::from_millis(300));
        group.measurement_time(Duration::from_secs(1)).sample_size(20);
        for (kind, rays) in [("camera", &case.camera), ("bounce", &case.bounce), ("random", &case.random)] {
            group.bench_function(BenchmarkId::new("closest", kind), |b| {
                b.iter(|| rays.iter().filter(|ray| geometry.closest::<0>(black_box(ray)).is_some()).count());
            });
        }
        group.bench_function("surface/bounce", |b| {
            let hits: Vec<_> = case.bounce.iter().filter_map(|r| geometry.closest::<0>(r).map(|h| (*r, h))).collect();
            b.iter(|| hits.iter().map(|(ray, hit)| geometry.surface::<0>(ray, black_box(hit)).p.x).sum::<f32>());
        });
        for (kind, rays) in [("shadow", &case.shadow), ("random", &case.random)] {
            group.bench_function(BenchmarkId::new("occluded", kind), |b| {
                b.iter(|| rays.iter().filter(|ray| geometry.occluded::<0>(black_box(ray))).count());
            });
        }
        group.finish();
    }
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_secs(2));
    for case in cases() {
        group.bench_function(case.name, |b| {
            b.iter_batched(
                || vec![Shape::Mesh(case.mesh.clone())],
                |shapes| Geometry::build(shapes, vec![], vec![]),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, rays, build);
criterion_main!(benches);
