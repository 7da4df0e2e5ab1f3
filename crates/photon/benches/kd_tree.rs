//! Our kd-tree beside the crate `kiddo`: `cargo bench -p etendue-photon --bench kd_tree [-- POINTS]`.
//!
//! Each case runs both trees in turns, and the median of the rounds counts, so that a machine which slows down slows down
//! both. Queries run on one thread. Of kiddo there is its immutable tree, told not to sort what it finds and to use its
//! scratch again; compiled for the same processor (`RUSTFLAGS="-C target-cpu=native"` gives it its AVX2 code, while ours
//! looks for AVX2 by itself).

use etendue_photon::kd_tree::{KdTree, Neighbours};
use glam::Vec3;
use kiddo::{ImmutableKdTree, QueryScratch, SquaredEuclidean};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::{hint::black_box, num::NonZero, time::Instant};

const K: usize = 50;
const QUERIES: usize = 20_000;
const ROUNDS: usize = 9;

fn random(rng: &mut Pcg64) -> Vec3 {
    Vec3::new(rng.random(), rng.random(), rng.random())
}

/// As photons lie: on the walls of the unit cube and on some spheres, in half of the cases crowded as in caustics.
fn on_surfaces(n: usize, rng: &mut Pcg64) -> Vec<Vec3> {
    let spheres: Vec<(Vec3, f32)> = (0..20).map(|_| (random(rng), 0.02 + 0.15 * rng.random::<f32>())).collect();
    let spots: Vec<(usize, f32, f32)> = (0..10).map(|_| (rng.random_range(0..6), rng.random(), rng.random())).collect();
    let wall = |side: usize, u: f32, v: f32| {
        let mut p = [u, v, u];
        p[side / 2] = (side % 2) as f32;
        p[(side / 2 + 1) % 3] = u;
        p[(side / 2 + 2) % 3] = v;
        Vec3::from(p)
    };
    (0..n)
        .map(|i| match i % 4 {
            0 => wall(rng.random_range(0..6), rng.random(), rng.random()),
            1 => {
                let (side, u, v) = spots[rng.random_range(0..spots.len())];
                let (r, phi) = (0.1 * rng.random::<f32>().powi(2), std::f32::consts::TAU * rng.random::<f32>());
                wall(side, u + r * phi.cos(), v + r * phi.sin())
            }
            _ => {
                let (center, radius) = spheres[rng.random_range(0..spheres.len())];
                center + (random(rng) - 0.5).normalize_or(Vec3::X) * radius
            }
        })
        .collect()
}

fn morton(p: Vec3) -> u64 {
    let spread = |x: f32| {
        let x = (x.clamp(0.0, 0.999) * 1024.0) as u64;
        (0..10).fold(0, |bits, i| bits | (x >> i & 1) << (3 * i))
    };
    spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn compare(name: &str, points: &[Vec3], queries: &[Vec3], radii: &[f32]) {
    let ours = KdTree::new(points.iter().copied().zip(0u32..).collect());
    let arrays: Vec<[f32; 3]> = points.iter().map(|p| p.to_array()).collect();
    let theirs = ImmutableKdTree::<f32, 3>::new_from_slice(&arrays).expect("kiddo builds");
    let mut found = Neighbours::default();
    let mut scratch = QueryScratch::default();
    let most = NonZero::new(K).expect("not 0");
    for &radius in radii {
        let mut times = [Vec::new(), Vec::new()];
        let mut sums = [0.0, 0.0];
        for _ in 0..ROUNDS {
            let start = Instant::now();
            sums[0] = 0.0;
            for q in queries {
                let nearest = ours.k_nearest(black_box(*q), K, radius, &mut found);
                sums[0] += nearest.iter().map(|n| f64::from(n.distance_squared())).sum::<f64>();
            }
            times[0].push(start.elapsed().as_secs_f64());
            let start = Instant::now();
            sums[1] = 0.0;
            for q in queries {
                let q = black_box(q.to_array());
                let query = theirs.query(&q).nearest_n::<SquaredEuclidean<f32>>(most);
                let nearest = if radius.is_finite() {
                    query.within(radius * radius).unsorted().with_scratch(&mut scratch).execute()
                } else {
                    query.unsorted().with_scratch(&mut scratch).execute()
                };
                sums[1] += nearest.iter().map(|n| f64::from(n.distance)).sum::<f64>();
            }
            times[1].push(start.elapsed().as_secs_f64());
        }
        let [a, b] = times.map(|t| median(t) / queries.len() as f64 * 1e6);
        assert!((sums[0] - sums[1]).abs() <= 1e-4 * sums[1], "{name}: {sums:?}");
        println!("{name:34} radius {radius:5}: ours {a:8.3} us, kiddo {b:8.3} us: {:.2}x", b / a);
    }
}

fn build(name: &str, points: &[Vec3]) {
    let pairs: Vec<(Vec3, u32)> = points.iter().copied().zip(0u32..).collect();
    let arrays: Vec<[f32; 3]> = points.iter().map(|p| p.to_array()).collect();
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..5 {
        let pairs = pairs.clone();
        let start = Instant::now();
        let tree = KdTree::new(pairs);
        times[0].push(start.elapsed().as_secs_f64());
        println!("    {:.2} bytes a point", black_box(&tree).structure_bytes() as f64 / tree.len() as f64);
        let start = Instant::now();
        black_box(ImmutableKdTree::<f32, 3>::new_from_slice(&arrays).expect("kiddo builds"));
        times[1].push(start.elapsed().as_secs_f64());
    }
    let [a, b] = times.map(|t| median(t) * 1e3);
    println!("{name:34} build: ours {a:8.2} ms, kiddo {b:8.2} ms: {:.2} of kiddo's", a / b);
}

fn main() {
    let n = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(1_000_000);
    let mut rng = Pcg64::seed_from_u64(1);
    let rng = &mut rng;
    let near = |points: &[Vec3], rng: &mut Pcg64| -> Vec<Vec3> {
        (0..QUERIES).map(|_| points[rng.random_range(0..points.len())] + (random(rng) - 0.5) * 1e-3).collect()
    };
    let sorted = |queries: &[Vec3]| {
        let mut queries = queries.to_vec();
        queries.sort_by_key(|q| morton(*q));
        queries
    };
    let points = on_surfaces(n, rng);
    build("surfaces", &points);
    let queries = near(&points, rng);
    compare("surfaces, random order", &points, &queries, &[0.05, 0.2, f32::INFINITY]);
    compare("surfaces, Morton order", &points, &sorted(&queries), &[0.05, 0.2, f32::INFINITY]);
    let points: Vec<Vec3> = (0..n).map(|_| random(rng)).collect();
    build("random", &points);
    let queries: Vec<Vec3> = (0..QUERIES).map(|_| random(rng)).collect();
    compare("random, random order", &points, &queries, &[0.01, 0.05, 0.2, f32::INFINITY]);
    compare("random, Morton order", &points, &sorted(&queries), &[0.01, 0.05, 0.2, f32::INFINITY]);
    let clumps: Vec<Vec3> = (0..100).map(|_| random(rng)).collect();
    let points: Vec<Vec3> =
        (0..n).map(|i| clumps[i % 100] + (random(rng) - 0.5) * (1e-3 + 0.05 * rng.random::<f32>().powi(4))).collect();
    build("clustered", &points);
    let queries = near(&points, rng);
    compare("clustered, random order", &points, &queries, &[0.05, f32::INFINITY]);
    compare("clustered, Morton order", &points, &sorted(&queries), &[0.05, f32::INFINITY]);
    let points: Vec<Vec3> = (0..n).map(|_| Vec3::ONE * rng.random::<f32>()).collect();
    build("collinear", &points);
    let queries = near(&points, rng);
    compare("collinear", &points, &queries, &[0.05, f32::INFINITY]);
    // kiddo's bucket of points that cannot be split grows with them, so these are few.
    let points = vec![Vec3::splat(0.5); n.min(100_000)];
    build("coincident", &points);
    let queries: Vec<Vec3> = (0..QUERIES.min(500)).map(|_| Vec3::splat(0.5) + (random(rng) - 0.5) * 1e-3).collect();
    compare("coincident", &points, &queries, &[0.05, f32::INFINITY]);
}
