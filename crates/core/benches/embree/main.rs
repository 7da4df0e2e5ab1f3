//! Our rays beside those of Intel's Embree:
//!
//! `EMBREE_LIBRARY=path/to/libembree4.so cargo bench -p etendue-core --features embree-peer --bench embree`
//!
//! Three meshes (a blob of 70 thousand triangles, a terrain with spheres of a million, a building of 49 thousand long thin
//! ones) and five classes of ray: from the camera, after one and after three diffuse bounces, and towards a light from the
//! first two. Each engine takes 16,384 rays at a time in turn, on one thread, timed by the thread's own processor clock;
//! printed is the ratio of medians, Embree's time over ours: above 1 ours is faster. `ETENDUE_ROUNDS` sets how often.

mod library;
#[path = "../meshes/mod.rs"]
mod meshes;

use cpu_time::ThreadTime;
use etendue_core::{
    geometry::{
        Geometry, Shape, Surface,
        offset::{shadow_ray_to_point, spawn_ray},
    },
    ray::Ray,
};
use library::{Embree, EmbreeScene};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{hint::black_box, time::Instant};

/// Rays that an engine takes at a time.
const BATCH: usize = 1 << 14;
/// Batches of each class.
const BATCHES: usize = 8;

/// Rays of one class.
struct Class {
    name: &'static str,
    rays: Vec<Ray>,
    any: bool,
}

fn hit(geometry: &Geometry, ray: &Ray) -> Option<Surface> {
    geometry.closest::<0>(ray).map(|h| geometry.surface::<0>(ray, &h))
}

/// A diffuse bounce on the side that the ray came from.
fn bounce(surface: &Surface, ray: &Ray, rng: &mut Pcg64Mcg) -> Ray {
    let n = if surface.ng.dot(ray.direction) < 0.0 { surface.ng } else { -surface.ng };
    spawn_ray(surface, (n + meshes::unit(rng) * 0.999).normalize())
}

/// The five classes, in the order in which a path tracer would make them: pixel by pixel.
fn classes(geometry: &Geometry, view: &meshes::View) -> [Class; 5] {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let count = BATCH * BATCHES;
    let side = (count as f64).sqrt() as usize;
    let mut rays: [Vec<Ray>; 5] = Default::default();
    let mut i = 0;
    while rays.iter().any(|class| class.len() < count) {
        let jitter = |rng: &mut Pcg64Mcg| rng.random::<f32>();
        let x = ((i % side) as f32 + jitter(&mut rng)) / side as f32 - 0.5;
        let y = ((i / side % side) as f32 + jitter(&mut rng)) / side as f32 - 0.5;
        i += 1;
        let light = view.light + meshes::unit(&mut rng) * view.light_radius;
        let mut ray = view.ray(x, y);
        rays[0].push(ray);
        for depth in 0..3 {
            let Some(surface) = hit(geometry, &ray) else { break };
            if depth < 2 {
                rays[3 + depth].push(shadow_ray_to_point(&surface, light));
            }
            ray = bounce(&surface, &ray, &mut rng);
            match depth {
                0 => rays[1].push(ray),
                2 => rays[2].push(ray),
                _ => (),
            }
        }
    }
    let names = ["primary", "bounce 1", "bounce 3", "shadow 1", "shadow 2"];
    let mut at = 0;
    rays.map(|mut rays| {
        rays.truncate(count);
        at += 1;
        Class { name: names[at - 1], rays, any: at > 3 }
    })
}

fn seconds(run: impl FnOnce() -> usize) -> (f64, usize) {
    let start = ThreadTime::now();
    let hits = black_box(run());
    (start.elapsed().as_secs_f64(), hits)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Times per ray of ours, Embree's robust and Embree's default, in nanoseconds; and hits that differ from the robust one.
fn time(class: &Class, ours: &Geometry, robust: &EmbreeScene, fast: &EmbreeScene, rounds: usize) -> ([f64; 3], usize) {
    let count = |rays: &[Ray], engine: usize| {
        let hit = |ray: &Ray| match (engine, class.any) {
            (0, false) => ours.closest::<0>(black_box(ray)).is_some(),
            (0, true) => ours.occluded::<0>(black_box(ray)),
            (1, false) => robust.closest(black_box(ray)).is_some(),
            (1, true) => robust.occluded(black_box(ray)),
            (_, false) => fast.closest(black_box(ray)).is_some(),
            (_, true) => fast.occluded(black_box(ray)),
        };
        rays.iter().filter(|ray| hit(ray)).count()
    };
    let mut times: [Vec<f64>; 3] = Default::default();
    let mut differing = 0;
    for round in 0..rounds {
        for batch in class.rays.chunks(BATCH) {
            let mut hits = [0; 3];
            for k in 0..3 {
                // Each engine goes first as often as the others.
                let engine = (k + round) % 3;
                let (time, found) = seconds(|| count(batch, engine));
                times[engine].push(time / batch.len() as f64 * 1e9);
                hits[engine] = found;
            }
            if round == 0 {
                differing += hits[0].abs_diff(hits[1]);
            }
        }
    }
    (times.map(median), differing)
}

fn main() {
    let Some(path) = std::env::var_os("EMBREE_LIBRARY") else {
        println!("EMBREE_LIBRARY names no library: nothing to compare with");
        return;
    };
    // As many threads as Embree gets: builds are compared.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool was made before");
    let rounds = std::env::var("ETENDUE_ROUNDS").map_or(5, |v| v.parse().expect("ETENDUE_ROUNDS is a number"));
    let embree = Embree::load(&path, 1).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let (mut log_robust, mut log_fast, mut cells) = (0.0, 0.0, 0);
    println!("nanoseconds a ray; ratios are Embree's time over ours");
    println!(
        "{:<13}{:<10}{:>8}{:>8}{:>8}{:>10}{:>10}  hits",
        "mesh", "class", "ours", "robust", "default", "/robust", "/default"
    );
    for (name, mesh, view) in meshes::peers() {
        let (geometry, ours) = built(|| Geometry::build(vec![Shape::Mesh(mesh.clone())], vec![], vec![]));
        let (fast, theirs) = built(|| embree.scene(&mesh, false));
        let robust = embree.scene(&mesh, true);
        let bytes = geometry.memory_bytes() as f64 / mesh.triangles.len() as f64;
        for class in classes(&geometry, &view) {
            let ([a, b, c], differing) = time(&class, &geometry, &robust, &fast, rounds);
            println!(
                "{name:<13}{:<10}{a:>8.1}{b:>8.1}{c:>8.1}{:>10.3}{:>10.3}  {differing} differ",
                class.name,
                b / a,
                c / a
            );
            log_robust += (b / a).ln();
            log_fast += (c / a).ln();
            cells += 1;
        }
        println!(
            "{name:<13}{} triangles, {bytes:.0} bytes each; built in {ours:.3} s, Embree's high quality in {theirs:.3} s, one thread each: {:.2}",
            mesh.triangles.len(),
            ours / theirs
        );
    }
    let mean = |log: f64| (log / f64::from(cells)).exp();
    println!("geometric means: {:.3} of robust, {:.3} of default", mean(log_robust), mean(log_fast));
}

/// What is built, and the seconds that it took.
fn built<T>(build: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = build();
    (made, start.elapsed().as_secs_f64())
}
