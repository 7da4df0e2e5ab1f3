//! Samples per second of a whole pass: `cargo bench -p etendue-bidir`.
//!
//! The scenes of path tracing's bench: a room of diffuse walls under an area light, the same room with a glass and a metal ball,
//! and a floor with a ball under an image of the sky. A pass is a light path a pixel, and for `bidir` a camera path as
//! well, on every thread that rayon has; `RAYON_NUM_THREADS=1 cargo bench -p etendue-bidir` measures one.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etendue_bidir::{BIDIR, LIGHT};
use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness},
    camera::{CameraDescription, Projection},
    film::Film,
    filter::Filter,
    independent::independent,
    lights::environment::{Environment, Rows},
    material::Material,
    rgb::Rgb,
    scene::{NamedMaterial, Object, ObjectShape, Scene, SceneDescription},
    technique::Settings,
    texture::Bitmap,
};
use glam::{DAffine3, DMat3, DQuat, DVec3, UVec2, Vec2, dcamera::lh::view::look_at_affine3};
use std::{hint::black_box, sync::Arc, time::Duration};

/// Pixels in a row and in a column.
const SIZE: u32 = 64;
/// Longest path.
const MAX_DEPTH: u32 = 10;

fn camera(eye: DVec3, target: DVec3, fov_x: f64) -> CameraDescription {
    CameraDescription {
        projection: Projection::Perspective { fov_x },
        to_world: look_at_affine3(eye, target, DVec3::Y).inverse(),
        resolution: UVec2::splat(SIZE),
        crop: None,
    }
}

fn material(name: &str, material: Material) -> NamedMaterial {
    NamedMaterial { name: name.into(), material, two_sided: true }
}

fn object(name: &str, shape: ObjectShape, to_world: DAffine3, material: usize) -> Object {
    Object { name: name.into(), shape, to_world, material, emission: None, absorption: None }
}

fn ball(name: &str, center: DVec3, radius: f64, material: usize) -> Object {
    object(name, ObjectShape::Sphere { center, radius, inverted: false }, DAffine3::IDENTITY, material)
}

/// A rectangle whose normal is `normal`.
fn rectangle(name: &str, center: DVec3, normal: DVec3, half: f64, material: usize) -> Object {
    let turned = DQuat::from_rotation_arc(DVec3::Z, normal);
    let to_world = DAffine3::from_scale_rotation_translation(DVec3::new(half, half, 1.0), turned, center);
    object(name, ObjectShape::Rectangle, to_world, material)
}

/// A cube of grey walls from -1 to 1 with two blocks and a light under its ceiling.
fn diffuse_room() -> SceneDescription {
    let block = |name: &str, half: DVec3, angle: f64, center: DVec3| {
        let turned = DQuat::from_rotation_y(angle);
        object(name, ObjectShape::Cube, DAffine3::from_scale_rotation_translation(half, turned, center), 0)
    };
    let light = rectangle("light", DVec3::Y * 0.98, DVec3::NEG_Y, 0.3, 0);
    SceneDescription {
        name: "diffuse room".into(),
        camera: Some(camera(DVec3::Z * 0.95, DVec3::ZERO, 1.4)),
        materials: vec![material("grey", Material::lambert(Rgb::splat(0.6)))],
        objects: vec![
            object("walls", ObjectShape::Cube, DAffine3::IDENTITY, 0),
            block("tall", DVec3::new(0.25, 0.6, 0.25), 0.3, DVec3::new(-0.4, -0.4, -0.4)),
            block("low", DVec3::new(0.25, 0.3, 0.25), -0.3, DVec3::new(0.4, -0.7, 0.0)),
            Object { emission: Some(Rgb::splat(8.0).into()), ..light },
        ],
        ..SceneDescription::default()
    }
}

/// The room with a ball of glass and one of rough metal in place of the blocks.
fn glossy_room() -> SceneDescription {
    let mut scene = diffuse_room();
    scene.name = "glossy room".into();
    scene.materials.push(material("glass", Material::dielectric(1.5, None)));
    let roughness = Roughness { distribution: Distribution::Ggx, alpha: Vec2::splat(0.2) };
    let fresnel = ConductorFresnel::Constant(Rgb::new(0.9, 0.7, 0.4));
    scene.materials.push(material("metal", Material::conductor(fresnel, Some(roughness))));
    scene.objects.retain(|o| o.name != "tall" && o.name != "low");
    scene.objects.push(ball("glass", DVec3::new(0.4, -0.6, 0.1), 0.35, 1));
    scene.objects.push(ball("metal", DVec3::new(-0.4, -0.6, -0.3), 0.35, 2));
    scene
}

/// A floor with a ball under a sky that has a small bright sun.
fn floor_under_a_sky() -> SceneDescription {
    let (width, height) = (128, 64);
    let texel = |i: u32| {
        let (column, row) = (i % width, i / width);
        match (column, row) {
            (40..=41, 20..=21) => Rgb::splat(2000.0),
            _ if row < height / 2 => Rgb::new(0.5, 0.7, 1.0),
            _ => Rgb::splat(0.1),
        }
    };
    let image = Bitmap { width, height, texels: (0..width * height).map(texel).collect() };
    SceneDescription {
        name: "floor under a sky".into(),
        camera: Some(camera(DVec3::new(0.0, 1.5, 3.0), DVec3::Y * 0.3, 0.8)),
        materials: vec![material("grey", Material::lambert(Rgb::splat(0.5)))],
        objects: vec![rectangle("floor", DVec3::ZERO, DVec3::Y, 20.0, 0), ball("ball", DVec3::Y * 0.5, 0.5, 0)],
        environment: Some(Environment::LatLong {
            image: Arc::new(image),
            scale: 1.0,
            to_world: DMat3::IDENTITY,
            rows: Rows::Centred,
        }),
        ..SceneDescription::default()
    }
}

fn passes(c: &mut Criterion) {
    let mut group = c.benchmark_group("pass");
    group.throughput(Throughput::Elements(u64::from(SIZE * SIZE))).warm_up_time(Duration::from_millis(300));
    group.measurement_time(Duration::from_secs(2)).sample_size(20);
    for description in [diffuse_room(), glossy_room(), floor_under_a_sky()] {
        let scene = Arc::new(Scene::new(&description).expect("the scene is valid"));
        for info in [&LIGHT, &BIDIR] {
            let knobs: Vec<f64> = info.knobs.iter().map(|knob| knob.default).collect();
            let mut technique = (info.build)(scene.clone(), Settings::new(MAX_DEPTH, independent), &knobs);
            let mut film = Film::new(UVec2::splat(SIZE), Filter::Box);
            let mut pass = 0;
            group.bench_function(format!("{}/{}", description.name, info.name), |b| {
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
