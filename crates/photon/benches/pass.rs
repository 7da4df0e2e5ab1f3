//! Samples per second of a whole pass: `cargo bench -p etendue-photon --bench pass`.
//!
//! A room with a glass ball and a grey one, 64 x 64 pixels, on every thread that rayon has. The maps of `photon` are made before;
//! a pass of `sppm` traces its own.

mod room;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etendue_core::{film::Film, filter::Filter, independent::independent, scene::Scene, technique::Settings};
use etendue_photon::{PHOTON, SPPM};
use glam::UVec2;
use room::room;
use std::{hint::black_box, sync::Arc, time::Duration};

/// Pixels in a row and in a column.
const SIZE: u32 = 64;

fn passes(c: &mut Criterion) {
    let mut group = c.benchmark_group("pass");
    group.throughput(Throughput::Elements(u64::from(SIZE * SIZE))).warm_up_time(Duration::from_millis(300));
    group.measurement_time(Duration::from_secs(3)).sample_size(20);
    let scene = Arc::new(Scene::new(&room()).expect("the scene is valid"));
    for info in [&PHOTON, &SPPM] {
        let knobs: Vec<f64> = info.knobs.iter().map(|knob| knob.default).collect();
        let mut technique = (info.build)(scene.clone(), Settings::new(10, independent), &knobs);
        let mut film = Film::new(UVec2::splat(SIZE), Filter::Box);
        technique.pass(1, 0, &mut film);
        let mut pass = 1;
        group.bench_function(info.name, |b| {
            b.iter(|| {
                technique.pass(1, pass, black_box(&mut film));
                pass += 1;
            });
        });
    }
    group.finish();
}

criterion_group!(benches, passes);
criterion_main!(benches);
