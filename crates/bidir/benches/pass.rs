//! Samples per second of a whole pass: `cargo bench -p etendue-bidir`.
//!
//! The scenes of path tracing's bench. A pass is a light path a pixel (more where the knob `particles` says so), and for
//! `bidir` a camera path as well, on every thread that rayon has; `RAYON_NUM_THREADS=1 cargo bench -p etendue-bidir`
//! measures one.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etendue_bidir::{BIDIR, LIGHT};
use etendue_core::{film::Film, independent::independent, scene::Scene, technique::Settings};
use std::{hint::black_box, sync::Arc, time::Duration};

fn passes(c: &mut Criterion) {
    let mut group = c.benchmark_group("pass");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2)).sample_size(20);
    for name in ["cornell", "glass-ball", "sky"] {
        let loaded = etendue_scenes::load(name).expect("a built-in scene");
        let scene = Arc::new(Scene::new(&loaded.description).expect("the scene is valid"));
        let resolution = scene.camera().resolution();
        group.throughput(Throughput::Elements(u64::from(resolution.element_product())));
        for info in [&LIGHT, &BIDIR] {
            let knobs: Vec<f64> = info.knobs.iter().map(|knob| knob.default).collect();
            let mut technique = (info.build)(scene.clone(), Settings::new(10, independent), &knobs);
            let mut film = Film::new(resolution, loaded.filter);
            let mut pass = 0;
            group.bench_function(format!("{name}/{}", info.name), |b| {
                b.iter(|| {
                    technique.pass(1, pass, black_box(&mut film));
                    pass += 1;
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, passes);
criterion_main!(benches);
