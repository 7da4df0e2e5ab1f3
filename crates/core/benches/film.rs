//! What the film, the sampler and the distributions cost, on one thread.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue_core::{
    distribution::{AliasTable, Piecewise2d},
    film::{Film, Splats},
    filter::Filter,
    independent::independent,
    mis::power_heuristic,
    reservoir::Reservoir,
    rgb::Rgb,
    sampler::Purpose,
    statistics::render::RenderStatistics,
};
use glam::{UVec2, Vec2};
use std::hint::black_box;

const SIZE: UVec2 = UVec2::new(256, 256);
const PIXELS: u32 = SIZE.x * SIZE.y;
const FILTERS: [(&str, Filter); 3] =
    [("box", Filter::Box), ("tent", Filter::Tent { radius: 1.0 }), ("gaussian", Filter::Gaussian { stddev: 0.5 })];

fn passes(c: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one thread");
    let mut group = c.benchmark_group("film");
    group.throughput(Throughput::Elements(u64::from(PIXELS)));
    let mut film = Film::new(SIZE, Filter::Box);
    group.bench_function("camera pass, a pixel", |b| {
        b.iter(|| {
            pool.install(|| {
                film.add_pass("bench", 0, || (), |_, pixel, _| Rgb::new(pixel.x as f32, pixel.y as f32 * 1e-3, 0.7))
            })
        });
    });
    for (name, filter) in FILTERS {
        let mut film = Film::new(SIZE, filter);
        let splat = |_: &mut (), number: u32, splats: &Splats, statistics: &mut RenderStatistics| {
            let place = number.wrapping_mul(0x9e37_79b9);
            let place = Vec2::new((place & 0xffff) as f32, (place >> 16) as f32) / 256.0;
            splats.splat(statistics, place, Rgb::new(0.1, 0.2, 3.0));
        };
        group.bench_function(BenchmarkId::new("a splat a pixel", name), |b| {
            b.iter(|| pool.install(|| film.add_splat_pass("bench", 0, PIXELS, || (), splat, |_, _, _, _| Rgb::BLACK)));
        });
    }
}

fn numbers(c: &mut Criterion) {
    let mut group = c.benchmark_group("numbers");
    group.throughput(Throughput::Elements(1000));
    let mut sampler = independent(1, 0);
    let sampler = black_box(sampler.as_mut());
    group.bench_function("start_sample", |b| {
        b.iter(|| (0..1000).for_each(|i| sampler.start_sample(black_box(i), 0)));
    });
    group.bench_function("get_1d", |b| {
        b.iter(|| (0..1000).map(|v| sampler.get_1d(v, Purpose::Lobe)).sum::<f32>());
    });
    group.bench_function("get_2d", |b| {
        b.iter(|| (0..1000).map(|v| sampler.get_2d(v, Purpose::Direction)).sum::<Vec2>());
    });
    let us: Vec<Vec2> = (0..1000).map(|v| sampler.get_2d(v, Purpose::Film)).collect();
    for (name, filter) in FILTERS {
        group.bench_function(BenchmarkId::new("filter sample", name), |b| {
            b.iter(|| us.iter().map(|&u| filter.sample(u)).sum::<Vec2>());
        });
    }
    let weights: Vec<f64> = (0..1 << 16).map(|i| f64::from(i % 1000)).collect();
    let table = AliasTable::new(&weights).expect("weights are positive");
    group.bench_function("alias sample of 65536", |b| {
        b.iter(|| us.iter().map(|u| table.sample(u.x).pmf).sum::<f32>());
    });
    let density = Piecewise2d::new(&weights, 256).expect("weights are positive");
    group.bench_function("piecewise sample of 256 x 256", |b| {
        b.iter(|| us.iter().map(|&u| density.sample(u).1).sum::<f32>());
    });
    group.bench_function("power heuristic", |b| {
        b.iter(|| us.iter().map(|u| power_heuristic(u.x, u.y)).sum::<f32>());
    });
    group.bench_function("reservoir update", |b| {
        b.iter(|| {
            let mut reservoir = Reservoir::default();
            us.iter().enumerate().for_each(|(i, u)| _ = reservoir.update(i, f64::from(u.x), u.y));
            reservoir
        });
    });
}

criterion_group!(benches, passes, numbers);
criterion_main!(benches);
