//! What maps cost by the number of photons: `cargo bench -p etendue-photon --bench maps [-- MOST]`.
//!
//! For each power of ten up to MOST (10,000,000 by itself): how long photons take from light to map, how large the map is, what
//! an estimate of 50 photons takes, and what precomputed irradiance takes and saves.

use etendue_core::{
    camera::{CameraDescription, Projection},
    film::Film,
    filter::Filter,
    has,
    independent::independent,
    material::Material,
    rgb::Rgb,
    scene::{NamedMaterial, Object, ObjectShape, Scene, SceneDescription},
    technique::{Settings, Technique},
};
use etendue_photon::{
    Options, PhotonMapper,
    aim::Aim,
    map::PhotonMap,
    trace::{Job, Store},
};
use glam::{DAffine3, DQuat, DVec3, UVec2, dcamera::lh::view::look_at_affine3};
use std::{sync::Arc, time::Instant};

/// A room of grey walls with two balls and a lamp.
fn room() -> SceneDescription {
    let object = |name: &str, shape, to_world, material| Object {
        name: name.into(),
        shape,
        to_world,
        material,
        emission: None,
        absorption: None,
    };
    let ball = |name, x: f64, material| {
        let shape = ObjectShape::Sphere { center: DVec3::new(x, -0.6, 0.1), radius: 0.35, inverted: false };
        object(name, shape, DAffine3::IDENTITY, material)
    };
    let down = DQuat::from_rotation_arc(DVec3::Z, DVec3::NEG_Y);
    let lamp_place = DAffine3::from_scale_rotation_translation(DVec3::splat(0.3), down, DVec3::Y * 0.98);
    let named = |name: &str, material| NamedMaterial { name: name.into(), material, two_sided: true };
    SceneDescription {
        name: "room".into(),
        camera: Some(CameraDescription {
            projection: Projection::Perspective { fov_x: 1.4 },
            to_world: look_at_affine3(DVec3::Z * 0.95, DVec3::ZERO, DVec3::Y).inverse(),
            resolution: UVec2::splat(64),
            crop: None,
        }),
        materials: vec![
            named("grey", Material::lambert(Rgb::splat(0.6))),
            named("glass", Material::dielectric(1.5, None)),
        ],
        objects: vec![
            object("walls", ObjectShape::Cube, DAffine3::IDENTITY, 0),
            ball("glass ball", 0.4, 1),
            ball("grey ball", -0.4, 0),
            Object { emission: Some(Rgb::splat(8.0).into()), ..object("lamp", ObjectShape::Rectangle, lamp_place, 0) },
        ],
        ..SceneDescription::default()
    }
}

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
            mapper.prepare(1);
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
