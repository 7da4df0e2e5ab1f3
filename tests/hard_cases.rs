//! The corpus of situations in which renderers break: every technique survives every one.
//!
//! Each case is a scene and what must hold. That no sample is rejected is asserted for all of them by [`Run::film`]; that
//! the film is finite and not negative, by [`images`].

use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness},
    camera::{CameraDescription, Projection},
    film::Film,
    filter::Filter,
    geometry::Mesh,
    lights::environment::{Environment, Rows},
    material::Material,
    rgb::Rgb,
    scene::*,
    statistics::moments::Moments,
    technique::TechniqueInfo,
    texture::Bitmap,
};
use etendue_tests::{Run, bias_allowance, limit, small::*};
use glam::{DAffine3, DMat3, DVec3, UVec2, Vec2, Vec3};
use std::{f64::consts::PI, sync::Arc};
use xtask::techniques::TECHNIQUES;

const REPLICATES: u64 = 8;

/// Replicates of the image, each valid.
fn images(technique: &TechniqueInfo, scene: &SceneDescription, depth: u32, passes: u32) -> Vec<Vec<Rgb>> {
    let replicates = Run::of(scene, Filter::Box, depth).replicates(technique, 0..REPLICATES, passes);
    for pixel in replicates.iter().flatten() {
        assert!(pixel.is_valid(), "{} on {}: {pixel:?}", technique.name, scene.name);
    }
    replicates
}

fn mean(image: &[Rgb]) -> f64 {
    image.iter().map(|c| f64::from(c.r) + f64::from(c.g) + f64::from(c.b)).sum::<f64>() / (3 * image.len()) as f64
}

/// The scene renders to something finite for every technique.
fn survives(scene: &SceneDescription) {
    for technique in TECHNIQUES {
        images(technique, scene, 8, 4);
    }
}

/// Every technique's image mean is `expected` within its standard error.
fn has_mean(scene: &SceneDescription, depth: u32, passes: u32, expected: f64) {
    for technique in TECHNIQUES {
        let mut means = Moments::default();
        images(technique, scene, depth, passes).iter().for_each(|i| means.push(mean(i)));
        // Where there is no noise, single precision leaves a few roundings.
        let error = means.standard_error().hypot(2e-6 * expected);
        let difference = means.mean() - expected;
        let z = if difference == 0.0 { 0.0 } else { (difference.abs() - bias_allowance(technique) * expected) / error };
        assert!(z < limit(REPLICATES), "{}, {}: {} not {expected}", scene.name, technique.name, means.mean());
    }
}

/// Every technique renders both scenes alike: means and quarters of the image, replicate by replicate of the same seed.
fn same_image(a: &SceneDescription, b: &SceneDescription, passes: u32) {
    for technique in TECHNIQUES {
        let (a_images, b_images) = (images(technique, a, 8, passes), images(technique, b, 8, passes));
        let size = a_images[0].len();
        for quarter in 0..4 {
            let range = quarter * size / 4..(quarter + 1) * size / 4;
            let (mut difference, mut value) = (Moments::default(), Moments::default());
            for (x, y) in a_images.iter().zip(&b_images) {
                let (x, y) = (mean(&x[range.clone()]), mean(&y[range.clone()]));
                difference.push(x - y);
                value.push(x);
            }
            let error = difference.standard_error().hypot(2e-5 * value.mean());
            assert!(
                difference.mean().abs() < limit(REPLICATES) * error,
                "{} and {}, {}, quarter {quarter}: {} differs by {} +- {error}",
                a.name,
                b.name,
                technique.name,
                value.mean(),
                difference.mean(),
            );
        }
    }
}

/// Two boxes and a sphere in a room open to the camera, lit from the ceiling: surfaces that touch, and a shadow.
fn room() -> SceneDescription {
    let mut objects = vec![
        rectangle("floor", DVec3::ZERO, DVec3::Y, (1.0, 1.0), 0),
        rectangle("back", DVec3::new(0.0, 1.0, -1.0), DVec3::Z, (1.0, 1.0), 0),
        rectangle("left", DVec3::new(-1.0, 1.0, 0.0), DVec3::X, (1.0, 1.0), 0),
        sphere("ball", DVec3::new(0.4, 0.3, 0.2), 0.3, 0),
    ];
    let box_transform =
        DAffine3::from_translation(DVec3::new(-0.4, 0.35, -0.2)) * DAffine3::from_scale(DVec3::new(0.25, 0.35, 0.25));
    objects.push(object("box", ObjectShape::Cube, box_transform, 0));
    objects.push(emitting(rectangle("lamp", DVec3::Y * 1.9, DVec3::NEG_Y, (0.3, 0.3), 0), 8.0));
    SceneDescription {
        name: "room".into(),
        camera: Some(pinhole(DVec3::new(0.3, 1.0, 3.5), DVec3::new(0.0, 0.8, 0.0), 0.7, 16)),
        materials: vec![grey(0.6)],
        objects,
        ..SceneDescription::default()
    }
}

fn named(name: impl Into<String>, scene: SceneDescription) -> SceneDescription {
    SceneDescription { name: name.into(), ..scene }
}

#[test]
fn scale_and_place_do_not_matter() {
    for scale in [1e-4, 1e-2, 1e3, 1e5] {
        let by = DAffine3::from_scale(DVec3::splat(scale));
        same_image(&room(), &named(format!("room scaled by {scale}"), transformed(&room(), &by)), 16);
    }
    let far = DAffine3::from_translation(DVec3::new(2e5, -2e5, 2e5));
    same_image(&room(), &named("room moved by 1e5 sizes", transformed(&room(), &far)), 16);
}

/// Vertices that are a thousand sizes away have lost ten bits before they get here, so the room is a slightly different
/// one: its image is the same within noise and the rounding of its shape.
#[test]
fn single_precision_vertices_far_from_the_origin() {
    let mut far = named("room baked 1e3 sizes away", baked(&room(), DVec3::new(2e3, 1e3, -2e3)));
    far.objects.retain(|o| o.name != "ball");
    let mut near = room();
    near.objects.retain(|o| o.name != "ball");
    for technique in TECHNIQUES {
        let mut difference = Moments::default();
        let (a, b) = (images(technique, &near, 8, 32), images(technique, &far, 8, 32));
        a.iter().zip(&b).for_each(|(a, b)| difference.push(mean(a) / mean(b) - 1.0));
        let error = difference.standard_error().hypot(2e-4);
        assert!(difference.mean().abs() < limit(REPLICATES) * error, "{}: {difference:?}", technique.name);
    }
}

#[test]
fn a_closed_box_leaks_nothing() {
    // Black walls, a bright sky outside: every ray that slips through an edge or corner brings light in.
    for scale in [1e-4, 1.0, 1e5] {
        let mut scene = SceneDescription {
            name: format!("dark box of {scale}"),
            camera: Some(pinhole(DVec3::new(0.1, 0.2, 0.3) * scale, DVec3::ONE * scale, 2.5, 64)),
            materials: vec![grey(0.0)],
            objects: vec![object("box", ObjectShape::Cube, DAffine3::from_scale(DVec3::splat(scale)), 0)],
            ..SceneDescription::default()
        };
        scene = under_sky(scene, 1e6);
        has_mean(&scene, 8, 4, 0.0);
    }
}

#[test]
fn empty_scenes_and_lone_triangles() {
    let camera = Some(pinhole(DVec3::Z * 3.0, DVec3::ZERO, 0.8, 8));
    let empty = SceneDescription { name: "empty".into(), camera, ..SceneDescription::default() };
    has_mean(&empty, 8, 4, 0.0);
    has_mean(&named("empty under a sky", under_sky(empty.clone(), 0.5)), 8, 4, 0.5);
    let positions = vec![Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let lone = SceneDescription {
        name: "one triangle".into(),
        materials: vec![grey(0.5)],
        objects: vec![object("triangle", ObjectShape::Mesh(mesh.clone()), DAffine3::IDENTITY, 0)],
        ..empty.clone()
    };
    survives(&under_sky(lone.clone(), 1.0));
    // The same triangle a thousand times, and between slivers, points and needles.
    let mut crowd = mesh;
    crowd.triangles = vec![[0, 1, 2]; 1000];
    crowd.positions.extend([Vec3::splat(0.5), Vec3::new(0.5, 0.5, 0.5 + 1e-7), Vec3::new(1e6, 0.5, 0.5)]);
    crowd.triangles.extend([[3, 3, 3], [0, 0, 1], [3, 4, 3], [3, 4, 5], [0, 3, 5]]);
    let mut crowded = named("crowd of triangles", lone);
    crowded.objects[0].shape = ObjectShape::Mesh(crowd);
    survives(&under_sky(crowded, 1.0));
}

#[test]
fn shading_normals_that_disagree() {
    let positions = vec![Vec3::new(-1.0, 0.0, -1.0), Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0)];
    for normals in [
        vec![Vec3::ZERO; 3],
        vec![Vec3::NEG_Y; 3],
        vec![Vec3::X, Vec3::NEG_X, Vec3::Z],
        vec![Vec3::Y, Vec3::NEG_Y, Vec3::Y],
    ] {
        let mesh = Mesh {
            positions: positions.clone(),
            normals,
            uvs: Vec::new(),
            colors: Vec::new(),
            triangles: vec![[0, 1, 2]],
        };
        let mut scene = lit_floor(0.5, Vec::new());
        scene.objects[0].shape = ObjectShape::Mesh(mesh);
        scene.objects[0].to_world = DAffine3::IDENTITY;
        survives(&named("odd shading normals", under_sky(scene, 1.0)));
    }
    // Normals that are all zero fall back to the face's own: half the light of a white sky.
    let mesh = Mesh {
        colors: Vec::new(),
        positions: vec![
            Vec3::new(-5.0, 0.0, -5.0),
            Vec3::new(-5.0, 0.0, 5.0),
            Vec3::new(5.0, 0.0, 5.0),
            Vec3::new(5.0, 0.0, -5.0),
        ],
        normals: vec![Vec3::ZERO; 4],
        uvs: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let mut scene = under_sky(lit_floor(0.5, Vec::new()), 1.0);
    scene.objects[0].shape = ObjectShape::Mesh(mesh);
    scene.objects[0].to_world = DAffine3::IDENTITY;
    has_mean(&named("zero shading normals", scene), 8, 32, 0.5);
}

#[test]
fn coplanar_surfaces_and_stacked_glass() {
    let mut scene = room();
    scene.objects.push(rectangle("floor again", DVec3::ZERO, DVec3::Y, (0.5, 0.5), 0));
    survives(&named("coplanar floors", scene));
    let mut scene = lit_floor(0.5, Vec::new());
    scene.materials.push(material("glass", Material::dielectric(1.5, None)));
    for i in 0..8 {
        let at = DVec3::Y * (0.1 + 1e-4 * f64::from(i));
        let facing = if i % 2 == 0 { DVec3::NEG_Y } else { DVec3::Y };
        scene.objects.push(rectangle("sheet", at, facing, (10.0, 10.0), 2));
    }
    survives(&named("stacked glass", under_sky(scene, 1.0)));
}

#[test]
fn cameras_in_odd_places() {
    let mut glass = room();
    glass.materials.push(material("glass", Material::dielectric(1.5, None)));
    glass.objects.push(sphere("around the camera", DVec3::new(0.3, 1.0, 3.5), 0.5, 1));
    survives(&named("camera inside glass", glass));
    let mut surface = room();
    surface.camera = Some(pinhole(DVec3::new(0.2, 0.0, 0.9), DVec3::new(0.0, 0.5, 0.0), 0.7, 8));
    survives(&named("camera on the floor", surface));
    let inside = SceneDescription {
        name: "camera inside a light".into(),
        camera: Some(pinhole(DVec3::ZERO, DVec3::Z, 1.0, 8)),
        materials: vec![grey(0.0)],
        objects: vec![emitting(
            object(
                "light",
                ObjectShape::Sphere { center: DVec3::ZERO, radius: 2.0, inverted: true },
                DAffine3::IDENTITY,
                0,
            ),
            3.0,
        )],
        ..SceneDescription::default()
    };
    has_mean(&inside, 8, 4, 3.0);
}

#[test]
fn lights_that_light_nothing() {
    let dark = |name, light: Object| has_mean(&named(name, lit_floor(0.5, vec![light])), 8, 4, 0.0);
    dark("light in the plane of the floor", emitting(rectangle("light", DVec3::X * 2.0, DVec3::Y, (0.5, 0.5), 1), 5.0));
    dark("light with zero radiance", emitting(rectangle("light", DVec3::Y, DVec3::NEG_Y, (0.5, 0.5), 1), 0.0));
    dark("light facing away", emitting(rectangle("light", DVec3::Y, DVec3::Y, (0.5, 0.5), 1), 5.0));
    let flat = Mesh { positions: vec![Vec3::Y; 3], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    dark("light of zero area", emitting(object("light", ObjectShape::Mesh(flat), DAffine3::IDENTITY, 1), 5.0));
    has_mean(&named("black sky", under_sky(lit_floor(0.5, Vec::new()), 0.0)), 8, 4, 0.0);
}

#[test]
fn a_light_that_touches_a_surface() {
    // A lamp standing on the floor: 1/d² is unbounded in the edge where they meet.
    let light = emitting(rectangle("light", DVec3::new(0.0, 0.5, 0.0), DVec3::Z, (0.5, 0.5), 1), 1.0);
    let mut scene = lit_floor(0.8, vec![light]);
    scene.camera = Some(orthographic(DVec3::Y * 2.0, DVec3::new(0.0, 0.0, 0.01), DVec3::Z, 0.8, 8));
    survives(&named("light in a corner", scene));
}

#[test]
fn a_lamp_among_many_dark_triangles() {
    // A hundred thousand triangles that emit nothing change no number: they are never chosen.
    let lamp = |radiance| emitting(rectangle("lamp", DVec3::Y, DVec3::NEG_Y, (0.5, 0.5), 1), radiance);
    let mut crowded = lit_floor(0.5, vec![lamp(2.0)]);
    let grid: Vec<Vec3> = (0..100_000u32)
        .flat_map(|i| {
            let corner = Vec3::new((i % 300) as f32 * 0.01, 5.0, (i / 300) as f32 * 0.01);
            [corner, corner + Vec3::X * 0.005, corner + Vec3::Z * 0.005]
        })
        .collect();
    let triangles = (0..100_000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Mesh { positions: grid, triangles, ..Mesh::default() };
    crowded.objects.push(emitting(object("dark", ObjectShape::Mesh(mesh), DAffine3::IDENTITY, 1), 0.0));
    same_image(&lit_floor(0.5, vec![lamp(2.0)]), &named("a lamp among dark triangles", crowded), 16);
}

/// A latitude-longitude sky of one colour with one texel of another.
fn sky_with_texel(base: f32, x: u32, y: u32, value: f32) -> Environment {
    let (width, height) = (64, 32);
    let mut texels = vec![Rgb::splat(base); (width * height) as usize];
    texels[(y * width + x) as usize] = Rgb::splat(value);
    let image = Arc::new(Bitmap { width, height, texels });
    Environment::LatLong { image, scale: 1.0, to_world: DMat3::IDENTITY, rows: Rows::Centred }
}

#[test]
fn a_sun_of_one_texel_and_poles() {
    // The sun's energy by quadrature over the bilinear tent around its texel, above the horizon.
    for (x, y, value) in [(10, 8, 1e6f32), (0, 3, 3e5), (63, 0, 1e5)] {
        let environment = sky_with_texel(1.0, x, y, value);
        let mut scene = lit_floor(0.5, Vec::new());
        scene.environment = Some(environment.clone());
        let steps = 4000;
        let mut irradiance = 0.0;
        for i in 0..steps {
            // Only the rows that the tent reaches differ from 1.
            let v = (f64::from(y) - 0.5 + 2.0 * (f64::from(i) + 0.5) / f64::from(steps)) / 32.0;
            if !(0.0..0.5).contains(&v) {
                continue;
            }
            let theta = PI * v;
            let vertical = (1.0 - (v * 32.0 - f64::from(y) - 0.5).abs()).max(0.0);
            // Above the first row's centre the image is constant in v.
            let vertical = if v * 32.0 < 0.5 && y == 0 { 1.0 } else { vertical };
            let horizontal = 2.0 * PI / 64.0;
            let width = PI * 2.0 / 32.0 / f64::from(steps);
            irradiance += (f64::from(value) - 1.0) * vertical * horizontal * theta.cos() * theta.sin() * width;
        }
        has_mean(&named(format!("sun at texel {x}, {y}"), scene), 8, 64, 0.5 / PI * (PI + irradiance));
    }
}

#[test]
fn delta_lights_beside_area_lights() {
    let area = emitting(rectangle("light", DVec3::Y, DVec3::NEG_Y, (0.2, 0.2), 1), 3.0);
    let point = DeltaLight::Point { position: DVec3::new(0.3, 1.0, 0.0), intensity: Rgb::splat(0.7) };
    let (one, other) = (lit_floor(0.5, vec![area.clone()]), delta_lit_floor(0.5, point));
    let mut both = lit_floor(0.5, vec![area]);
    both.lights = other.lights.clone();
    for technique in TECHNIQUES {
        let mut difference = Moments::default();
        let all = [&one, &other, &both].map(|s| images(technique, s, 2, 64));
        for ((a, b), c) in all[0].iter().zip(&all[1]).zip(&all[2]) {
            difference.push(mean(a) + mean(b) - mean(c));
        }
        let z = difference.mean() / difference.standard_error();
        assert!(z.abs() < limit(REPLICATES), "{}: {difference:?}", technique.name);
    }
}

#[test]
fn a_light_behind_glass() {
    // Only a specular path reaches the point light: a path tracer sees nothing of it, and says so in its blind spots.
    let mut scene = lit_floor(0.1, Vec::new());
    scene.materials.push(material("glass", Material::dielectric(1.5, None)));
    scene.objects.push(sphere("bulb", DVec3::Y, 0.3, 2));
    let point = DeltaLight::Point { position: DVec3::Y, intensity: Rgb::WHITE };
    scene.lights.push(LightDescription { name: "filament".into(), kind: point.clone() });
    survives(&named("point light behind glass", scene.clone()));
    scene.lights.clear();
    scene.objects.push(emitting(sphere("filament", DVec3::Y, 0.05, 1), 100.0));
    survives(&named("area light behind glass", scene));
}

#[test]
fn glass_of_index_one_is_not_there() {
    let mut with = under_sky(room(), 0.3);
    with.materials.push(material("air", Material::dielectric(1.0, None)));
    with.objects.push(sphere("bubble", DVec3::new(0.0, 1.0, 2.0), 0.4, 1));
    // A path through the bubble has two edges more, so depth must not bind: the walls are black here.
    with.materials[0] = grey(0.0);
    let mut without = with.clone();
    without.objects.pop();
    same_image(&without, &named("bubble of index 1", with), 16);
}

#[test]
fn albedo_near_one_in_a_closed_room() {
    // Radiance E / (1 - rho) cut at the depth bound: a geometric series.
    let (reflectance, emission, depth) = (0.999, 0.01f32, 40);
    let shape = ObjectShape::Sphere { center: DVec3::ZERO, radius: 1.0, inverted: true };
    let walls = emitting(object("walls", shape, DAffine3::IDENTITY, 0), emission);
    let scene = SceneDescription {
        name: "closed white room".into(),
        camera: Some(pinhole(DVec3::ZERO, DVec3::new(0.2, 0.1, 1.0), 1.5, 8)),
        materials: vec![grey(reflectance)],
        objects: vec![walls],
        ..SceneDescription::default()
    };
    let series = (1.0 - f64::from(reflectance).powi(depth as i32)) / (1.0 - f64::from(reflectance));
    has_mean(&scene, depth, 64, f64::from(emission) * series);
}

#[test]
fn vertices_very_close_together() {
    // Two floors a millionth apart: between them the geometry term is nearly singular.
    let mut scene = room();
    scene.objects.push(rectangle("sheet", DVec3::new(0.0, 1e-6, 0.0), DVec3::Y, (1.0, 1.0), 0));
    same_image(&room(), &named("floor with a sheet a millionth above", scene), 16);
}

#[test]
fn narrow_and_lopsided_lobes() {
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for alpha in [Vec2::splat(1e-4), Vec2::splat(1.0), Vec2::new(1e-4, 1.0), Vec2::new(0.5, 1e-3)] {
            let roughness = Some(Roughness { distribution, alpha });
            let mut scene = under_sky(room(), 0.5);
            scene.materials[0] =
                material("metal", Material::conductor(ConductorFresnel::Constant(Rgb::WHITE), roughness));
            scene.materials.push(material("glass", Material::dielectric(1.5, roughness)));
            scene.objects[3].material = 1;
            survives(&named(format!("{distribution:?} of roughness {alpha}"), scene));
        }
    }
}

#[test]
fn splats_and_filters_conserve_energy() {
    // A constant sky is the same through every filter, right up to the border.
    for filter in [Filter::Box, Filter::Tent { radius: 1.0 }, Filter::Gaussian { stddev: 0.5 }] {
        let camera = CameraDescription {
            projection: Projection::Perspective { fov_x: 1.0 },
            to_world: DAffine3::IDENTITY,
            resolution: UVec2::new(5, 3),
            crop: None,
        };
        let sky = SceneDescription { camera: Some(camera), ..SceneDescription::default() };
        let run = Run::of(&under_sky(sky, 0.25), filter, 4);
        for technique in TECHNIQUES {
            let film: Film = run.film(technique, 1, 0..2);
            assert!(film.mean_image().iter().all(|c| (c.g - 0.25).abs() < 1e-6), "{filter:?}, {}", technique.name);
        }
    }
}

#[test]
fn what_is_invalid_is_refused_by_name() {
    let check = |edit: &dyn Fn(&mut SceneDescription), parts: &[&str]| {
        let mut scene = room();
        edit(&mut scene);
        let message = Scene::new(&scene).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(parts.iter().all(|p| message.contains(p)), "{message:?} lacks one of {parts:?}");
    };
    let mesh = |edit: &dyn Fn(&mut Mesh)| {
        let mut mesh = Mesh {
            colors: Vec::new(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: vec![Vec2::ZERO; 3],
            triangles: vec![[0, 1, 2]],
        };
        edit(&mut mesh);
        ObjectShape::Mesh(mesh)
    };
    check(&|s| s.camera = None, &["room", "no camera"]);
    check(&|s| s.camera.as_mut().unwrap().resolution.x = 0, &["camera"]);
    check(&|s| s.objects[3].shape = mesh(&|m| m.positions[1].x = f32::NAN), &["ball", "position 1", "not finite"]);
    check(&|s| s.objects[3].shape = mesh(&|m| m.normals[2].y = f32::INFINITY), &["ball", "normal 2"]);
    check(&|s| s.objects[3].shape = mesh(&|m| m.uvs[0].y = f32::NAN), &["ball", "texture coordinate 0"]);
    check(&|s| s.objects[3].shape = mesh(&|m| m.triangles[0][2] = 3), &["ball", "vertex 3"]);
    check(&|s| s.objects[3].shape = mesh(&|m| m.normals.truncate(2)), &["ball", "2 normals for 3 vertices"]);
    check(&|s| s.objects[3].to_world.translation.x = f64::NAN, &["ball", "transform"]);
    check(&|s| s.objects[4].to_world.matrix3.y_axis = DVec3::ZERO, &["box", "singular"]);
    check(&|s| s.objects[3].to_world.matrix3.y_axis *= 2.0, &["ball", "uniformly"]);
    check(&|s| s.objects[4].material = 7, &["box", "material 7"]);
    check(&|s| s.objects[5].emission = Some(Rgb::splat(-1.0).into()), &["lamp", "emission"]);
    check(&|s| s.objects[5].emission = Some(Rgb::splat(f32::NAN).into()), &["lamp", "emission"]);
    check(&|s| s.materials[0] = grey(1.5), &["material 'grey'", "reflectance", "1.5"]);
    check(&|s| s.materials[0].material = Material::dielectric(0.0, None), &["grey", "index"]);
    let smooth = Some(Roughness { distribution: Distribution::Ggx, alpha: Vec2::ZERO });
    let glass = Material::dielectric(1.5, smooth);
    check(&|s| s.materials[0].material = glass.clone(), &["grey", "roughness"]);
    check(&|s| s.environment = Some(sky_with_texel(1.0, 3, 4, f32::NAN)), &["environment", "3", "4"]);
    check(&|s| s.environment = Some(sky_with_texel(1.0, 3, 4, -1.0)), &["environment", "3", "4"]);
    let point = DeltaLight::Point { position: DVec3::NAN, intensity: Rgb::WHITE };
    check(
        &|s| s.lights.push(LightDescription { name: "bulb".into(), kind: point.clone() }),
        &["light 'bulb'", "position"],
    );
    let far = DAffine3::from_translation(DVec3::splat(1e300));
    check(&|s| s.objects[4].to_world = far * s.objects[4].to_world, &["'", "not finite"]);
}
