//! Photons carry what lights emit, less what surfaces absorb.

use etendue_core::{
    camera::{CameraDescription, Projection},
    has,
    independent::independent,
    lights::environment::Environment,
    material::Material,
    rgb::Rgb,
    scene::*,
    statistics::{moments::Moments, render::Rays},
    technique::Settings,
    walk::{Limits, Vertex, Walk},
};
use etendue_photon::{
    aim::Aim,
    kd_tree::Neighbours,
    kernel::Kernel,
    map::{Gathering, PhotonMap},
    trace::{Job, Store},
};
use etendue_tests::{limit, small::*};
use glam::{DAffine3, DVec3, UVec2, Vec2};
use std::f64::consts::PI;

const REPLICATES: u64 = 16;

/// Power of the stored photons by depth, for each of some seeds.
fn stored(description: &SceneDescription, store: Store, aim: &Aim, emitted: u32) -> Vec<Vec<f64>> {
    let scene = Scene::new(description).expect("the scene is valid");
    let settings = Settings::new(24, independent);
    (0..REPLICATES)
        .map(|seed| {
            let job = Job { scene: &scene, settings: &settings, store, aim, seed, set: 0, emitted };
            let mut power = vec![0.0; 24];
            for (_, photon) in job.trace::<{ has::ALL }>().photons {
                power[photon.history().depth as usize] += f64::from(photon.power.g);
            }
            power
        })
        .collect()
}

fn hold(name: &str, values: impl Iterator<Item = f64>, expected: f64) {
    let mut moments = Moments::default();
    values.for_each(|v| moments.push(v));
    let error = moments.standard_error().hypot(1e-5 * expected);
    let z = (moments.mean() - expected) / error;
    println!("{name}: {:.6} against {expected:.6}, {z:+.2} standard errors", moments.mean());
    assert!(z.abs() < limit(REPLICATES), "{name}: {} against {expected}, {z} standard errors", moments.mean());
}

/// A closed box of albedo 0.6 about the origin, with lights inside.
fn closed(lights: Vec<LightDescription>, objects: Vec<Object>) -> SceneDescription {
    let walls = object("walls", ObjectShape::Cube, DAffine3::IDENTITY, 0);
    SceneDescription {
        name: "closed box".into(),
        camera: Some(CameraDescription {
            projection: Projection::Perspective { fov_x: 1.0 },
            to_world: DAffine3::IDENTITY,
            resolution: UVec2::splat(4),
            crop: None,
        }),
        materials: vec![grey(0.6), material("black", Material::lambert(Rgb::BLACK))],
        objects: std::iter::once(walls).chain(objects).collect(),
        lights,
        ..SceneDescription::default()
    }
}

fn light(kind: DeltaLight) -> Vec<LightDescription> {
    vec![LightDescription { name: "light".into(), kind }]
}

/// In a closed box each bounce leaves the albedo's share: what arrives is `flux (1 + a + a² + ..)`, and what is absorbed of it,
/// `1 - a` of each, is what was emitted.
#[test]
fn stored_is_emitted_minus_absorbed() {
    let panel = emitting(rectangle("panel", DVec3::Y * 0.9, DVec3::NEG_Y, (0.2, 0.3), 1), 5.0);
    let position = DVec3::new(0.2, 0.3, -0.4);
    let cases = [
        ("area", closed(Vec::new(), vec![panel]), 4.0 * 0.06 * 5.0 * PI),
        (
            "point",
            closed(light(DeltaLight::Point { position, intensity: Rgb::splat(2.0) }), Vec::new()),
            2.0 * 4.0 * PI,
        ),
    ];
    for (name, scene, flux) in cases {
        let powers = stored(&scene, Store::All, &Aim::default(), 20_000);
        hold(&format!("{name}, first surfaces"), powers.iter().map(|p| p[1]), flux);
        // The panel's black face takes a little of what is reflected; it is found by its own photons.
        if name == "area" {
            continue;
        }
        for depth in 2..6 {
            let expected = flux * 0.6f64.powi(depth - 1);
            hold(&format!("{name}, depth {depth}"), powers.iter().map(|p| p[depth as usize]), expected);
        }
        let all: f64 = (0..23).map(|k| flux * 0.6f64.powi(k)).sum();
        hold(&format!("{name}, all"), powers.iter().map(|p| p.iter().sum()), all);
    }
}

/// Light from infinity: a ball in the open gets its cross section's share of a sun, and four times that, times pi, of a sky.
#[test]
fn light_from_infinity_carries_what_a_ball_intercepts() {
    let ball = |lights, environment| SceneDescription {
        objects: vec![sphere("ball", DVec3::new(0.3, 0.1, 0.2), 0.5, 0), sphere("far", DVec3::splat(9.0), 0.1, 1)],
        environment,
        ..closed(lights, Vec::new())
    };
    let sun =
        DeltaLight::Directional { direction: DVec3::new(0.2, -1.0, 0.3).normalize(), irradiance: Rgb::splat(3.0) };
    let both = |radius: f64| radius * radius * PI;
    let area = both(0.5) + both(0.1);
    let powers = stored(&ball(light(sun), None), Store::All, &Aim::default(), 200_000);
    hold("sun", powers.iter().map(|p| p[1]), 3.0 * area);
    let sky = Some(Environment::Constant(Rgb::splat(0.7)));
    let powers = stored(&ball(Vec::new(), sky), Store::All, &Aim::default(), 200_000);
    // What one ball hides from the other, a few ten thousandths, is below the noise.
    hold("sky", powers.iter().map(|p| p[1]), 0.7 * PI * 4.0 * area);
}

/// Irradiance that is computed ahead is on average the sun's, as it is at the places and as it is found at evenly spread points,
/// which a place owns the more of the fewer photons there are around it.
#[test]
fn irradiance_ahead_is_right_on_average() {
    let sun = DeltaLight::Directional { direction: DVec3::NEG_Y, irradiance: Rgb::splat(3.0) };
    let scene = SceneDescription {
        camera: Some(orthographic(DVec3::Y * 5.0, DVec3::ZERO, DVec3::Z, 14.0, 64)),
        lights: light(sun),
        ..lit_floor(1.0, Vec::new())
    };
    let scene = Scene::new(&scene).expect("it is valid");
    let settings = Settings::new(4, independent);
    for nearest in [5, 12, 50, 500] {
        let gathering = Gathering { nearest, radius: 100.0, kernel: Kernel::Cone, parts: settings.parts, max_depth: 4 };
        let (mut at_places, mut found_there) = (Vec::new(), Vec::new());
        for seed in 0..REPLICATES {
            let traced = |set, emitted| {
                let aim = &Aim::default();
                let job = Job { scene: &scene, settings: &settings, store: Store::All, aim, seed, set, emitted };
                PhotonMap::new(job.trace::<{ has::ALL }>().photons)
            };
            let map = traced(0, 20_000);
            let places = map.irradiance(traced(1, 5_000), 4, &gathering, |_, _, _| true);
            // Far from the border, past which there are no photons.
            let inside = (0..places.tree.len() as u32).filter(|i| places.tree.position(*i).abs().max_element() < 7.0);
            at_places.push(inside.map(|i| f64::from(places.tree.payload(i).value.g)).collect::<Moments>().mean());
            let mut room = Neighbours::default();
            let spread = (0..64 * 64).filter_map(|i| {
                let film = Vec2::new((i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5);
                let limits = Limits { max_depth: 2, roulette_depth: 9 };
                let mut walk = Walk::<{ has::ALL }>::from_camera(&scene, limits, film, Vec2::ZERO);
                let Vertex::Surface(vertex) = walk.trace(&mut Rays::default()) else { panic!("there is a floor") };
                let (p, place) = places.place(&vertex, gathering.radius, &mut room)?;
                Some(place.reflected(p, 2, Rgb::splat(std::f32::consts::PI), (&map, &gathering), &mut room))
            });
            found_there.push(spread.map(|e| f64::from(e.g)).collect::<Moments>().mean());
        }
        hold(&format!("{nearest} nearest, at places"), at_places.into_iter(), 3.0);
        hold(&format!("{nearest} nearest, as found"), found_there.into_iter(), 3.0);
    }
}

/// Aimed emission stores the same power with many more photons.
#[test]
fn aiming_keeps_the_power_of_caustics() {
    let mut loaded = etendue_scenes::load("pool:grid=32").expect("a built-in scene");
    loaded.description.camera.as_mut().expect("a camera").resolution = UVec2::splat(8);
    let scene = Scene::new(&loaded.description).expect("the scene is valid");
    let settings = Settings::new(12, independent);
    let none = Aim::default();
    let job = Job {
        scene: &scene,
        settings: &settings,
        store: Store::Caustic,
        aim: &none,
        seed: 99,
        set: 7,
        emitted: 1 << 13,
    };
    let aim = Aim::at(&job.pilot::<{ has::ALL }>().by_number());
    let total = |p: &Vec<f64>| p.iter().sum::<f64>();
    let plain = stored(&loaded.description, Store::Caustic, &none, 1 << 15);
    let aimed = stored(&loaded.description, Store::Caustic, &aim, 1 << 12);
    let (mut a, mut b) = (Moments::default(), Moments::default());
    plain.iter().for_each(|p| a.push(total(p)));
    aimed.iter().for_each(|p| b.push(total(p)));
    let z = (a.mean() - b.mean()) / a.standard_error().hypot(b.standard_error());
    println!("{} and aimed {}: {z:+.2}", a.mean(), b.mean());
    assert!(a.mean() > 0.0 && z.abs() < limit(REPLICATES), "{a:?} {b:?}");
    let count = |aim: &Aim| Job { aim, ..job }.trace::<{ has::ALL }>().photons.len();
    let (plain, aimed) = (count(&none), count(&aim));
    println!("{plain} photons of {} emissions, aimed {aimed}", job.emitted);
    assert!(aimed > 5 * plain, "{plain} {aimed}");
}
