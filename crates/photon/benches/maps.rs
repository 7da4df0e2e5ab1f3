//! What maps cost by the number of photons: `cargo bench -p etendue-photon --bench maps [-- MOST]`.
//!
//! For each power of ten up to MOST (10,000,000 by itself): how long photons take from light to map, how large the map is, what
//! an estimate of 50 photons takes, and what precomputed irradiance takes and saves.

mod room;

use etendue_core::{
    film::Film,
    filter::Filter,
    has,
    independent::independent,
    scene::Scene,
    technique::{Settings, Technique},
};
use etendue_photon::{
    Options, PhotonMapper,
    aim::Aim,
    map::PhotonMap,
    trace::{Job, Store},
};
use glam::UVec2;
use room::room;
use std::{sync::Arc, time::Instant};

fn main() {
    let most = std::env::args().filter_map(|a| a.parse::<f64>().ok()).next().unwrap_or(1e7);
    let scene = Arc::new(Scene::new(&room()).expect("the scene is valid"));
    let settings = Settings::new(10, independent);
    println!("   photons    traced      built    MB of map   M photons/s");
    let mut photons = 1e4;
    while photons <= most {
        let aim = Aim::default();
        let job = Job {
            scene: &scene,
            settings: &settings,
            store: Store::All,
            aim: &aim,
            seed: 1,
            set: 0,
            emitted: (photons / 2.3) as u32,
        };
        let start = Instant::now();
        let traced = job.trace::<{ has::CURVED | has::LOBES }>();
        let trace = start.elapsed().as_secs_f64();
        let count = traced.photons.len();
        let start = Instant::now();
        let map = PhotonMap::new(traced.photons);
        let build = start.elapsed().as_secs_f64();
        let megabytes = map.memory_bytes() as f64 * 1e-6;
        let rate = count as f64 * 1e-6 / (trace + build);
        println!("{count:10} {trace:8.3} s {build:8.3} s {megabytes:12.2} {rate:13.2}");
        photons *= 10.0;
    }
    println!("final gathering, 64x64, 16 passes:");
    for photons in [20_000, 200_000] {
        for every in [0, 1, 4, 16] {
            let options = Options { global_photons: photons, irradiance_every: every, ..Options::default() };
            let mut mapper = PhotonMapper::new(scene.clone(), settings, options);
            let start = Instant::now();
            mapper.prepare(1, 0);
            let prepare = start.elapsed().as_secs_f64();
            let mut film = Film::new(UVec2::splat(64), Filter::Box);
            let start = Instant::now();
            (0..16).for_each(|pass| mapper.pass(1, pass, &mut film));
            let passes = start.elapsed().as_secs_f64();
            let ahead = match every {
                0 => "full estimates".to_owned(),
                n => format!("irradiance at every {n}."),
            };
            println!("{photons:8} photons, {ahead:24}: maps {prepare:7.3} s, passes {passes:7.3} s");
        }
    }
}
