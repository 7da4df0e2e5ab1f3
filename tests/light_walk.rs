//! The walk from a light, against the walk from the camera: a minimal light tracer made of the core's parts renders what
//! the path tracer renders, and what particles leave behind is what the lights emit.

use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness, TransportMode},
    camera::Crop,
    film::Film,
    filter::Filter,
    geometry::offset::{offset_origin, shadow_ray_to_point},
    has,
    independent::independent,
    material::{Bitangent, Material, Relief},
    ray::Ray,
    rgb::Rgb,
    sampler::{Purpose, Sampler},
    scene::*,
    statistics::{
        moments::Moments,
        render::Rays,
        tiles::{WHOLE_IMAGE, compare, replicated_tile_means},
    },
    technique::{Part, Parts},
    texture::{Bitmap, Texture},
    walk::{SurfaceVertex, Vertex, Walk},
};
use etendue_tests::{Run, limit, small::*};
use glam::{DAffine3, DVec3, UVec2, Vec2};
use std::sync::Arc;

/// Follows one particle and calls `visit` at each surface that it meets.
fn particle(run: &Run, sampler: &mut dyn Sampler, mut visit: impl FnMut(&SurfaceVertex, &mut dyn Sampler)) {
    let scene = &*run.scene;
    let (u_choice, u_point, u_direction) = (
        sampler.get_1d(0, Purpose::EmissionChoice),
        sampler.get_2d(0, Purpose::EmissionPoint),
        sampler.get_2d(0, Purpose::EmissionDirection),
    );
    let Some(e) = scene.lights().sample_emission::<{ has::ALL }>(u_choice, u_point, u_direction) else { return };
    let ray = Ray::new(offset_origin(e.p, e.p_error, e.normal, e.direction), e.direction);
    let limits = run.settings.limits();
    let mut walk = Walk::<{ has::ALL }>::new(scene, TransportMode::Importance, limits, ray, e.weight(), e.pdf_w);
    while let Vertex::Surface(vertex) = walk.trace(&mut Rays::default()) {
        visit(&vertex, sampler);
        if !walk.scatter(&vertex, sampler) {
            return;
        }
    }
}

/// An image by light tracing: each vertex of each particle is connected to the camera.
fn light_traced(run: &Run, seed: u64, passes: u32) -> Vec<Rgb> {
    let (scene, mut film) = (&*run.scene, Film::new(run.resolution, run.filter));
    let paths = run.resolution.x * run.resolution.y;
    for pass in 0..passes {
        let counted = film.add_splat_pass(
            "light tracer",
            pass,
            paths,
            || independent(seed, passes),
            |sampler, path, splats, statistics| {
                sampler.start_sample(path, pass);
                particle(run, &mut **sampler, |vertex, sampler| {
                    let lens = sampler.get_2d(vertex.depth, Purpose::CameraConnection);
                    // The connection is one edge more.
                    if vertex.depth >= run.settings.max_depth {
                        return;
                    }
                    let Some(camera) = scene.camera().sample_direct(vertex.surface.p, lens) else { return };
                    let (f_cos, _) = vertex.eval_pdf::<{ has::ALL }>(camera.wi, TransportMode::Importance);
                    let distance = camera.target.distance(vertex.surface.p);
                    let left = vertex.transmittance::<{ has::ALL }>(scene, camera.wi, distance);
                    let value = vertex.beta * f_cos * left * (camera.importance / (camera.pdf_w * paths as f32));
                    let ray = shadow_ray_to_point(&vertex.surface, camera.target);
                    if !value.is_black() && !scene.occluded::<{ has::ALL }>(&ray) {
                        splats.splat(statistics, camera.film, value);
                    }
                });
            },
            |_, _, _, _| Rgb::BLACK,
        );
        assert_eq!(counted.rejected, 0, "{:?}", counted.rejected_samples);
    }
    film.mean_image()
}

/// Both tracers see the same image (what the camera sees of the lights themselves left out), its mean and its tiles.
fn agree(name: &str, mut run: Run, passes: u32) {
    let parts = Part::ALL.into_iter().filter(|p| *p != Part::Emission).fold(Parts::NONE, Parts::with);
    run.settings.parts = parts;
    let replicates = 24;
    let path = run.replicates(&etendue_path::INFO, 0..replicates, passes);
    let light: Vec<Vec<Rgb>> = (100..100 + replicates).map(|seed| light_traced(&run, seed, passes)).collect();
    for tile in [WHOLE_IMAGE, 8] {
        let width = run.resolution.x as usize;
        let of = |images: &[Vec<Rgb>]| {
            replicated_tile_means(&images.iter().map(Vec::as_slice).collect::<Vec<_>>(), width, tile)
        };
        let ((a, a_errors), (b, b_errors)) = (of(&light), of(&path));
        let errors: Vec<_> = a_errors.iter().zip(&b_errors).map(|(x, y)| [0, 1, 2].map(|c| x[c].hypot(y[c]))).collect();
        let found = compare(&a, &b, &errors, (replicates - 1) as f64, 6.334e-5);
        println!("{name}, tiles of {tile}: worst {:+.2} standard errors, {:+.2} %", found.t, 100.0 * found.relative);
        assert_eq!(found.failures, 0, "{name}: {found:?}");
    }
}

#[test]
fn light_tracing_renders_what_path_tracing_does() {
    agree("cornell", Run::builtin("cornell", 32), 24);
    agree("many-lights", Run::builtin("many-lights:n=16", 32), 24);
}

/// Every kind of light, and both a pinhole and a lens and parallel rays.
#[test]
fn so_it_does_with_every_kind_of_light_and_camera() {
    let mut scene = lit_floor(3.0, vec![emitting(sphere("lamp", DVec3::new(0.5, 1.0, 0.0), 0.2, 1), 2.0)]);
    scene.objects.push(sphere("ball", DVec3::new(-0.6, 0.4, 0.3), 0.4, 0));
    let intensity = Rgb::new(1.0, 0.5, 0.25);
    let position = DVec3::new(-1.0, 1.5, -0.5);
    for (name, kind) in [
        ("point", DeltaLight::Point { position, intensity }),
        (
            "spot",
            DeltaLight::Spot {
                position,
                direction: DVec3::new(1.0, -1.5, 0.5),
                intensity,
                beam: 0.3,
                cutoff: 0.7,
                image: None,
            },
        ),
        ("sun", DeltaLight::Directional { direction: DVec3::new(0.3, -1.0, 0.2), irradiance: intensity }),
    ] {
        scene.lights.push(LightDescription { name: name.into(), kind });
    }
    let scene = under_sky(scene, 0.05);
    let at = look_at(DVec3::new(0.0, 3.0, -3.0), DVec3::ZERO, DVec3::Y);
    use etendue_core::camera::Projection::*;
    for (name, projection) in [
        ("pinhole", Perspective { fov_x: 0.9 }),
        ("lens", ThinLens { fov_x: 0.9, aperture_radius: 0.1, focus_distance: 4.0 }),
        ("parallel", Orthographic { width: 3.0 }),
    ] {
        let mut scene = scene.clone();
        let camera = scene.camera.as_mut().expect("a camera");
        (camera.projection, camera.to_world, camera.resolution) = (projection, at, UVec2::splat(16));
        agree(name, Run::of(&scene, Filter::Tent { radius: 1.0 }, 6), 64);
    }
}

/// Shapes that emit by a texture, a cylinder among them, and lights that throw a picture.
#[test]
fn so_it_does_with_textured_lights_and_pictures() {
    let texels = (0..12).map(|i| Rgb::new(i as f32, (i % 5) as f32, (7 * i % 11) as f32) * 0.3).collect();
    let noise = Texture::bitmap(Arc::new(Bitmap { width: 4, height: 3, texels }));
    let shining = |object: Object| Object { emission: Some(noise.clone()), ..object };
    let (from, to) = (DVec3::new(-1.2, 0.3, 0.8), DVec3::new(-0.5, 0.6, 1.1));
    let tube = ObjectShape::Cylinder { from, to, radius: 0.15, inverted: false };
    let mut scene = lit_floor(
        3.0,
        vec![
            shining(sphere("lamp", DVec3::new(0.6, 0.7, 0.0), 0.2, 1)),
            shining(object("tube", tube, DAffine3::IDENTITY, 0)),
            shining(rectangle("panel", DVec3::new(0.0, 1.5, 0.5), DVec3::NEG_Y, (0.5, 0.3), 1)),
        ],
    );
    scene.objects.push(sphere("ball", DVec3::new(-0.4, 0.4, -0.3), 0.3, 0));
    let position = DVec3::new(-1.0, 1.5, -0.5);
    let (beam, cutoff) = (0.3, 0.7);
    let intensity = Rgb::new(1.0, 0.5, 0.25);
    let image = Some((noise.clone(), DVec3::Z));
    let to_world = look_at(DVec3::new(1.0, 2.0, -0.5), DVec3::new(0.3, 0.0, 0.0), DVec3::Z);
    for (name, kind) in [
        ("spot", DeltaLight::Spot { position, direction: DVec3::new(1.0, -1.5, 0.5), intensity, beam, cutoff, image }),
        ("projector", DeltaLight::Projector { to_world, fov_x: 0.7, aspect: 1.3, irradiance: noise.clone() }),
    ] {
        scene.lights.push(LightDescription { name: name.into(), kind });
    }
    let camera = scene.camera.as_mut().expect("a camera");
    camera.projection = etendue_core::camera::Projection::Perspective { fov_x: 0.9 };
    camera.to_world = look_at(DVec3::new(0.0, 3.0, -3.0), DVec3::ZERO, DVec3::Y);
    camera.resolution = UVec2::splat(16);
    agree("textured lights and pictures", Run::of(&scene, Filter::Box, 6), 64);
    // Through a crop of the film as well.
    let camera = scene.camera.as_mut().expect("a camera");
    camera.resolution = UVec2::new(40, 24);
    camera.crop = Some(Crop { offset: UVec2::new(13, 5), size: UVec2::new(16, 8) });
    agree("crop", Run::of(&scene, Filter::Tent { radius: 1.0 }, 6), 64);
}

/// Bumps and normal maps so steep that many are seen turned, on all sorts of material; glass that absorbs.
#[test]
fn so_it_does_with_reliefs_and_absorption() {
    let texels: Vec<f32> = (0..35).map(|i| ((i * i * 7 + 3 * i) % 11) as f32 * 0.02).collect();
    let bump = Relief::Bump { height: Texture::bitmap(Arc::new(Bitmap { width: 7, height: 5, texels })), scale: 1.0 };
    let texels = (0..12).map(|i| Rgb::new((i % 5) as f32 * 0.2 + 0.1, (i * 7 % 4) as f32 * 0.3, 0.7)).collect();
    let normals = Texture::bitmap(Arc::new(Bitmap { width: 4, height: 3, texels }));
    let map = Relief::NormalMap { normals, bitangent: Bitangent::RightHanded };
    let shiny = Roughness { distribution: Distribution::Ggx, alpha: Vec2::new(0.3, 0.2) };
    let metal = Material::conductor(ConductorFresnel::Constant(Rgb::splat(0.8)), Some(shiny));
    let mirror = Material::conductor(ConductorFresnel::Constant(Rgb::splat(0.8)), None);
    let on = |relief: &Relief, inner: Material| Material::Relief { relief: relief.clone(), material: Box::new(inner) };
    for (name, ball, floor) in [
        ("lambert", on(&bump, Material::lambert(Rgb::splat(0.7))), on(&map, Material::lambert(Rgb::splat(0.7)))),
        ("metal", on(&map, metal.clone()), on(&bump, metal)),
        ("mirror", on(&map, mirror), on(&bump, Material::lambert(Rgb::splat(0.7)))),
        ("glass", on(&map, Material::dielectric(1.5, None)), Material::lambert(Rgb::splat(0.7))),
        ("plain glass that absorbs", Material::dielectric(1.5, None), Material::lambert(Rgb::splat(0.7))),
        (
            "rough glass",
            on(&bump, Material::dielectric(1.5, Some(shiny))),
            on(&map, Material::lambert(Rgb::splat(0.7))),
        ),
    ] {
        let mut scene = lit_floor(3.0, vec![emitting(sphere("lamp", DVec3::new(1.2, 1.6, 0.3), 0.5, 1), 2.0)]);
        scene.materials.extend([material("ball", ball), material("floor", floor)]);
        scene.objects[0].material = 3;
        scene.objects[0].to_world *= DAffine3::from_scale(DVec3::splat(0.2));
        let absorption = name.contains("glass").then_some(Rgb::new(0.1, 1.0, 3.0));
        scene.objects.push(Object { absorption, ..sphere("ball", DVec3::new(-0.3, 0.7, 0.2), 0.6, 2) });
        let mut scene = under_sky(scene, 0.1);
        let camera = scene.camera.as_mut().expect("a camera");
        // Past the ball: what a mirror shows, no path from a light brings to a pinhole.
        camera.projection = etendue_core::camera::Projection::Perspective { fov_x: 0.4 };
        camera.to_world = look_at(DVec3::new(0.0, 2.0, -3.0), DVec3::new(0.3, 0.0, -1.2), DVec3::Y);
        camera.resolution = UVec2::splat(16);
        agree(&format!("relief on {name}"), Run::of(&scene, Filter::Box, 5), 64);
    }
}

/// In a closed room all that is emitted is absorbed in the end.
#[test]
fn what_is_absorbed_is_what_is_emitted() {
    let (reflectance, radiance) = (0.7f32, 0.4f32);
    let shape = ObjectShape::Sphere { center: DVec3::ZERO, radius: 2.0, inverted: true };
    let scene = SceneDescription {
        name: "closed room".into(),
        camera: Some(pinhole(DVec3::ZERO, DVec3::Z, 1.0, 4)),
        materials: vec![grey(reflectance)],
        objects: vec![emitting(object("walls", shape, DAffine3::IDENTITY, 0), radiance)],
        ..SceneDescription::default()
    };
    let run = Run::of(&scene, Filter::Box, u32::MAX);
    let mut sampler = independent(3, 0);
    let mut absorbed = Moments::default();
    for index in 0..200_000 {
        sampler.start_sample(index, 0);
        let mut sum = 0.0;
        particle(&run, &mut *sampler, |vertex, _| sum += f64::from(vertex.beta.g * (1.0 - reflectance)));
        absorbed.push(sum);
    }
    let flux = std::f64::consts::PI * f64::from(radiance) * 16.0 * std::f64::consts::PI;
    let z = (absorbed.mean() - flux) / absorbed.standard_error();
    println!("absorbed {:.4} of {flux:.4}, {z:.2} standard errors", absorbed.mean());
    assert!(z.abs() < limit(absorbed.count()), "{} of {flux}", absorbed.mean());
}
