//! Rays per second, one thread: `cargo bench -p etendue-core --bench rays`.
//!
//! A box with 36 triangles, and three larger meshes; each with coherent rays from a camera, the rays that diffuse bounces of
//! those make, random rays, and shadow rays; and the time to build.

mod meshes;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue_core::{
    geometry::{
        Geometry, Mesh, Shape,
        offset::{shadow_ray_to_point, spawn_ray},
    },
    ray::Ray,
};
use glam::Vec3;
use meshes::{View, cuboid, unit};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{hint::black_box, time::Duration};

/// Rays of a batch.
const RAYS: usize = 1 << 14;

/// A closed room with two blocks: 36 triangles.
fn cornell() -> Mesh {
    let mut mesh = Mesh::default();
    cuboid(&mut mesh, Vec3::splat(-1.0), Vec3::splat(1.0));
    cuboid(&mut mesh, Vec3::new(-0.65, -1.0, -0.6), Vec3::new(-0.1, 0.2, 0.0));
    cuboid(&mut mesh, Vec3::new(0.1, -1.0, 0.0), Vec3::new(0.7, -0.4, 0.6));
    mesh
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
    fn new(name: &'static str, mesh: Mesh, view: &View) -> Case {
        let geometry = Geometry::build(vec![Shape::Mesh(mesh.clone())], vec![], vec![]);
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let (lo, hi) = geometry.bounds().expect("a scene");
        let side = (RAYS as f32).sqrt() as usize;
        let part = |i: usize| i as f32 / side as f32 - 0.5;
        let camera: Vec<Ray> = (0..RAYS).map(|i| view.ray(part(i % side), part(i / side))).collect();
        let surfaces: Vec<_> = camera
            .iter()
            .filter_map(|ray| geometry.closest::<0>(ray).map(|hit| (ray, geometry.surface::<0>(ray, &hit))))
            .collect();
        let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
        while bounce.len() < RAYS {
            let (ray, surface) = &surfaces[rng.random_range(0..surfaces.len())];
            let n = if surface.ng.dot(ray.direction) < 0.0 { surface.ng } else { -surface.ng };
            bounce.push(spawn_ray(surface, (n + unit(&mut rng) * 0.999).normalize()));
            shadow.push(shadow_ray_to_point(surface, view.light + unit(&mut rng) * view.light_radius));
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

fn cases() -> Vec<Case> {
    let (eye, light) = (Vec3::new(0.0, 0.0, 0.95), Vec3::new(0.1, 0.9, 0.1));
    let inside = View { eye, middle: Vec3::ZERO, light, light_radius: 0.05 };
    let peers = meshes::peers().into_iter().map(|(name, mesh, view)| Case::new(name, mesh, &view));
    std::iter::once(Case::new("box", cornell(), &inside)).chain(peers).collect()
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
