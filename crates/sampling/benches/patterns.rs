//! What patterns and samplers cost, on one thread. Times are for 1,000 numbers (500 pairs), or for a whole pattern.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue_core::sampler::Purpose;
use etendue_sampling::{pattern::Pattern, sobol::Sequence};
use glam::{UVec2, Vec2};
use std::hint::black_box;

/// Numbers of one sample of a path: what a path tracer takes.
fn samplers(c: &mut Criterion) {
    let mut group = c.benchmark_group("samplers");
    group.throughput(Throughput::Elements(1000));
    for pattern in Pattern::ALL {
        let mut sampler = pattern.sampler()(1, 64);
        let sampler = black_box(sampler.as_mut());
        sampler.start_pixel(UVec2::new(40, 30), 100, 21);
        group.bench_function(BenchmarkId::new("get_2d", pattern.name()), |b| {
            b.iter(|| (0..500).map(|v| sampler.get_2d(v, Purpose::Direction)).sum::<Vec2>());
        });
        group.bench_function(BenchmarkId::new("get_1d", pattern.name()), |b| {
            b.iter(|| (0..1000).map(|v| sampler.get_1d(v, Purpose::Lobe)).sum::<f32>());
        });
    }
    for pattern in Pattern::ALL {
        group.bench_function(BenchmarkId::new("build and start 128 pixels", pattern.name()), |b| {
            b.iter(|| {
                let mut sampler = pattern.sampler()(black_box(1), 64);
                (0..128).for_each(|x| sampler.start_pixel(UVec2::new(x, 0), 200, 21));
                sampler
            });
        });
    }
}

/// Our Sobol points and those of the crate `sobol_burley`, which takes four dimensions at once by SSE.
fn against_sobol_burley(c: &mut Criterion) {
    let mut group = c.benchmark_group("Sobol");
    group.throughput(Throughput::Elements(1000));
    group.bench_function("ours, a sequence", |b| {
        let sequence = Sequence::new(black_box(7));
        b.iter(|| (0..500).map(|i| sequence.point(black_box(i))).sum::<Vec2>());
    });
    group.bench_function("ours, padded, by the sampler", |b| {
        let mut sampler = Pattern::Sobol.sampler()(7, 0);
        let sampler = black_box(sampler.as_mut());
        sampler.start_sample(40, 21);
        b.iter(|| (0..500).map(|v| sampler.get_2d(v, Purpose::Direction)).sum::<Vec2>());
    });
    group.bench_function("sobol_burley::sample, a sequence", |b| {
        let seed = black_box(7);
        let point = |i| Vec2::new(sobol_burley::sample(i, 0, seed), sobol_burley::sample(i, 1, seed));
        b.iter(|| (0..500).map(|i| point(black_box(i))).sum::<Vec2>());
    });
    group.bench_function("sobol_burley::sample, padded", |b| {
        let index = black_box(21);
        let point = |seed| Vec2::new(sobol_burley::sample(index, 0, seed), sobol_burley::sample(index, 1, seed));
        b.iter(|| (0..500).map(|seed| point(black_box(seed))).sum::<Vec2>());
    });
    group.bench_function("sobol_burley::sample_4d, padded", |b| {
        let index = black_box(21);
        let points = |seed| sobol_burley::sample_4d(index, 0, seed).into_iter().sum::<f32>();
        b.iter(|| (0..250).map(|seed| points(black_box(seed))).sum::<f32>());
    });
}

fn whole_patterns(c: &mut Criterion) {
    let mut group = c.benchmark_group("points");
    group.sample_size(10);
    for pattern in Pattern::ALL {
        group.bench_function(BenchmarkId::new("4,096", pattern.name()), |b| {
            b.iter(|| pattern.points(black_box(4096), 1));
        });
    }
    group.bench_function("1,000,000 jittered", |b| b.iter(|| Pattern::Jittered.points(black_box(1_000_000), 1)));
}

criterion_group!(benches, against_sobol_burley, samplers, whole_patterns);
criterion_main!(benches);
