//! Light does not leak through walls and around corners.

use etendue_core::{
    camera::{CameraDescription, Projection},
    filter::Filter,
    has,
    independent::independent,
    rgb::Rgb,
    scene::*,
    statistics::render::Rays,
    technique::{Settings, Technique},
    walk::{Limits, SurfaceVertex, Vertex, Walk},
};
use etendue_photon::{
    IndirectLight, Options, PhotonMapper, ProgressiveMapper, ProgressiveOptions,
    aim::Aim,
    kd_tree::Neighbours,
    kernel::Kernel,
    map::{Gathering, PhotonMap},
    trace::{Job, Store},
};
use etendue_tests::{Run, small::*};
use glam::{DAffine3, DVec3, UVec2, Vec2};

fn seen(eye: DVec3, target: DVec3, width: f64) -> CameraDescription {
    CameraDescription {
        projection: Projection::Orthographic { width },
        to_world: look_at(
            eye,
            target,
            if (eye - target).x == 0.0 && (eye - target).z == 0.0 { DVec3::Z } else { DVec3::Y },
        ),
        resolution: UVec2::splat(8),
        crop: None,
    }
}

fn lit(objects: Vec<Object>, light: DeltaLight, camera: CameraDescription) -> SceneDescription {
    SceneDescription {
        name: "leaks".into(),
        camera: Some(camera),
        materials: vec![grey(0.7)],
        objects,
        lights: vec![LightDescription { name: "light".into(), kind: light }],
        ..SceneDescription::default()
    }
}

/// The brightest pixel of the maps shown as they are, and of the progressive form.
fn brightest(scene: &SceneDescription, depth: u32) -> [f32; 2] {
    let run = Run::of(scene, Filter::Box, depth);
    let shown = Options { indirect: IndirectLight::Show, global_radius: 0.5, ..Options::default() };
    let progressive = ProgressiveOptions { photons: 100.0, nearest: 50, radius: 0.5, pixels: 1e6, alpha: 1.0 };
    let mut techniques: [Box<dyn Technique>; 2] = [
        Box::new(PhotonMapper::new(run.scene.clone(), run.settings, shown)),
        Box::new(ProgressiveMapper::new(run.scene.clone(), run.settings, progressive)),
    ];
    techniques.each_mut().map(|technique| {
        let mut film = etendue_core::film::Film::new(run.resolution, run.filter);
        (0..4).for_each(|pass| technique.pass(1, pass, &mut film));
        film.mean_image().iter().map(|c| c.max_element()).fold(0.0, f32::max)
    })
}

/// A lamp on the left of a wall a millimetre thick, of which the camera sees the right side; and the same with a single sheet.
#[test]
fn nothing_comes_through_a_thin_wall() {
    let block = object("wall", ObjectShape::Cube, DAffine3::from_scale(DVec3::new(5e-4, 1.0, 1.0)), 0);
    let sheet = rectangle("wall", DVec3::ZERO, DVec3::X, (1.0, 1.0), 0);
    for wall in [block, sheet] {
        // A second surface on the left throws light back, so that there are photons of more than one bounce.
        let other = rectangle("other", DVec3::X * -1.0, DVec3::X, (1.0, 1.0), 0);
        let lamp = DeltaLight::Point { position: DVec3::X * -0.5, intensity: Rgb::WHITE };
        let camera = |x: f64| seen(DVec3::X * x, DVec3::ZERO, 1.0);
        let dark = lit(vec![wall.clone(), other.clone()], lamp.clone(), camera(0.5));
        assert_eq!(brightest(&dark, 6), [0.0; 2]);
        let bright = lit(vec![wall, other], lamp, camera(-0.6));
        assert!(brightest(&bright, 6).iter().all(|b| *b > 0.01));
    }
}

/// A sun that shines along the floor, onto a wall that stands on it: the floor next to the wall has no photon of its own.
#[test]
fn nothing_comes_around_a_corner() {
    let sun = DeltaLight::Directional { direction: DVec3::X, irradiance: Rgb::WHITE };
    let floor = rectangle("floor", DVec3::ZERO, DVec3::Y, (1.0, 1.0), 0);
    let wall = rectangle("wall", DVec3::new(1.0, 1.0, 0.0), DVec3::NEG_X, (1.0, 1.0), 0);
    let camera = seen(DVec3::new(0.9, 0.5, 0.0), DVec3::new(0.9, 0.0, 0.0), 0.1);
    assert_eq!(brightest(&lit(vec![floor, wall], sun, camera), 2)[0], 0.0);
}

/// The radius of an estimate on a sheet lit from both sides is that of one side's photons.
#[test]
fn photons_of_the_other_side_do_not_shrink_the_radius() {
    let sheet = rectangle("sheet", DVec3::ZERO, DVec3::Z, (1.0, 1.0), 0);
    let lamp = DeltaLight::Point { position: DVec3::Z * 2.0, intensity: Rgb::splat(10.0) };
    let mut scene = lit(vec![sheet], lamp, seen(DVec3::Z, DVec3::ZERO, 1.0));
    scene.lights.push(LightDescription {
        name: "behind".into(),
        kind: DeltaLight::Point { position: DVec3::Z * -1.0, intensity: Rgb::splat(20.0) },
    });
    let scene = Scene::new(&scene).expect("the scene is valid");
    let settings = Settings::new(4, independent);
    let job = Job {
        scene: &scene,
        settings: &settings,
        store: Store::All,
        aim: &Aim::default(),
        seed: 1,
        set: 0,
        emitted: 200_000,
    };
    let photons = job.trace::<{ has::ALL }>().photons;
    let front: Vec<_> = photons.iter().copied().filter(|(_, p)| p.normal.vector().z > 0.0).collect();
    assert!(front.len() > 500 && front.len() * 2 < photons.len(), "{} of {}", front.len(), photons.len());
    let (both, front) = (PhotonMap::new(photons), PhotonMap::new(front));
    let gathering = Gathering { nearest: 40, radius: 0.5, kernel: Kernel::Disk, parts: settings.parts, max_depth: 4 };
    let vertex = |film: Vec2| -> SurfaceVertex {
        let limits = Limits { max_depth: 2, roulette_depth: 9 };
        match Walk::<{ has::ALL }>::from_camera(&scene, limits, film, Vec2::ZERO).trace(&mut Rays::default()) {
            Vertex::Surface(vertex) => vertex,
            Vertex::Escaped(_) => panic!("the camera sees the sheet"),
        }
    };
    let mut found = Neighbours::default();
    for i in 0..50 {
        let vertex = vertex(Vec2::new(0.7 + 0.13 * i as f32, 7.3 - 0.12 * i as f32));
        let a = both.reach::<{ has::ALL }>(&vertex, &gathering, &mut found);
        let b = front.reach::<{ has::ALL }>(&vertex, &gathering, &mut found);
        assert!(a == b && a > 0.0 && a < 0.5, "{a} {b}");
        let a = both.radiance::<{ has::ALL }>(&vertex, &gathering, &mut found).expect("there is light").radiance;
        let b = front.radiance::<{ has::ALL }>(&vertex, &gathering, &mut found).expect("there is light").radiance;
        assert!((a.g / b.g - 1.0).abs() < 1e-5 && a.g > 0.0, "{a:?} {b:?}");
    }
}

/// No photon, one, or all in one point: estimates are finite, and nothing where there is nothing.
#[test]
fn odd_maps_give_finite_estimates() {
    let lamp = DeltaLight::Point { position: DVec3::Z * 2.0, intensity: Rgb::WHITE };
    let sheet = rectangle("sheet", DVec3::ZERO, DVec3::Z, (1.0, 1.0), 0);
    let scene = Scene::new(&lit(vec![sheet], lamp, seen(DVec3::Z, DVec3::ZERO, 1.0))).expect("the scene is valid");
    let settings = Settings::new(4, independent);
    let job = Job {
        scene: &scene,
        settings: &settings,
        store: Store::All,
        aim: &Aim::default(),
        seed: 1,
        set: 0,
        emitted: 9000,
    };
    let one = job.trace::<{ has::ALL }>().photons[0];
    let limits = Limits { max_depth: 2, roulette_depth: 9 };
    let mut walk = Walk::<{ has::ALL }>::from_camera(&scene, limits, Vec2::splat(4.1), Vec2::ZERO);
    let Vertex::Surface(vertex) = walk.trace(&mut Rays::default()) else { panic!("the camera sees the sheet") };
    let here = (vertex.surface.p, one.1);
    let line: Vec<_> = (0..100).map(|i| (vertex.surface.p * (1.0 + i as f32), one.1)).collect();
    let mut found = Neighbours::default();
    for photons in [vec![], vec![one], vec![here], vec![here; 1000], vec![one; 1000], vec![one, here], line] {
        let empty = photons.is_empty();
        let map = PhotonMap::new(photons);
        for (nearest, radius) in [(2, 0.0), (2, 1.0), (50, 0.3), (100_000, 1e9), (50, f32::INFINITY)] {
            let gathering = Gathering { nearest, radius, kernel: Kernel::Cone, parts: settings.parts, max_depth: 4 };
            for kernel in Kernel::ALL {
                let gathering = Gathering { kernel, ..gathering };
                for estimate in [
                    map.radiance::<{ has::ALL }>(&vertex, &gathering, &mut found),
                    map.radiance_within::<{ has::ALL }>(&vertex, &gathering, radius),
                ] {
                    assert!(estimate.is_none_or(|e| e.radiance.is_valid()), "{gathering:?}");
                    assert!(!empty || estimate.is_none_or(|e| e.radiance.is_black()));
                }
            }
            map.irradiance(map.clone(), 1, &gathering, |_, _, _| true)
                .tree
                .payloads()
                .iter()
                .for_each(|i| assert!(i.value.is_valid()));
        }
    }
}

/// A floor with a wall on it: disks are clear up to the wall, to the border, and not beyond; on a ball as long as it is nearly flat.
#[test]
fn disks_are_clear_up_to_walls_and_edges() {
    let floor = rectangle("floor", DVec3::ZERO, DVec3::Y, (1.0, 1.0), 0);
    let wall = rectangle("wall", DVec3::Y * 0.5, DVec3::X, (1.0, 0.5), 0);
    let lamp = DeltaLight::Point { position: DVec3::Y * 2.0, intensity: Rgb::WHITE };
    let camera = seen(DVec3::new(0.9, 0.5, 0.0), DVec3::new(0.9, 0.0, 0.0), 0.1);
    let ball = sphere("ball", DVec3::X * 9.0, 1.0, 0);
    let scene = Scene::new(&lit(vec![floor, wall, ball], lamp, camera)).expect("the scene is valid");
    let place = |p: DVec3| (p - scene.middle()).as_vec3();
    let is_clear =
        |p, normal, radius| etendue_photon::clear::is_clear::<{ has::ALL }>(&scene, place(p), normal, radius);
    for x in [-0.75f64, -0.4, -0.2, 0.1, 0.3, 0.6, 0.9] {
        let free = x.abs().min(1.0 - x.abs()) as f32;
        let p = DVec3::X * x;
        // Probes are an eighth of a turn apart, and the first of them half of that from an axis.
        assert!(is_clear(p, glam::Vec3::Y, 0.99 * free), "{x}");
        assert!(!is_clear(p, glam::Vec3::Y, 1.2 * free), "{x}");
    }
    assert!(is_clear(DVec3::new(9.0, 1.0, 0.0), glam::Vec3::Y, 0.3));
    assert!(!is_clear(DVec3::new(9.0, 1.0, 0.0), glam::Vec3::Y, 1.2));
}
