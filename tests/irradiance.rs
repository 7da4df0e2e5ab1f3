//! Direct light on a floor against the analytic irradiance of every kind of light.

use etendue_core::{
    filter::Filter,
    rgb::Rgb,
    scene::*,
    statistics::moments::Moments,
    texture::{Bitmap, Interpolation, Texture, Wrap},
};
use etendue_tests::{Run, aiming, limit, small::*};
use glam::{Affine2, DAffine3, DQuat, DVec3, Mat2, Vec2};
use std::{f64::consts::PI, sync::Arc};

/// Every technique's mean over a spot of the floor is `0.5 / pi` times `irradiance`, within its own standard error.
fn shows(name: &str, scene: &SceneDescription, irradiance: f64) {
    for technique in aiming() {
        let run = Run::of(scene, Filter::Box, 2);
        let mut means = Moments::default();
        for seed in 0..16 {
            let film = run.film(technique, seed, 0..64);
            let image = film.mean_image();
            means.push(image.iter().map(|c: &Rgb| f64::from(c.g)).sum::<f64>() / image.len() as f64);
        }
        let expected = 0.5 / PI * irradiance;
        // Single precision leaves an error of its own, of a few roundings, where there is no noise.
        let error = means.standard_error().hypot(2e-6 * expected);
        let deviation = (means.mean() - expected) / error;
        println!(
            "{name}, {}: {:.7} against {expected:.7}, {deviation:.2} standard errors",
            technique.name,
            means.mean()
        );
        assert!(
            deviation.abs() < limit(means.count()),
            "{name}, {}: {} against {expected}",
            technique.name,
            means.mean()
        );
    }
}

/// Irradiance right under the middle of a parallel rectangle of half sides `a`, `b` at height `h`
/// [Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3].
fn rectangle_irradiance(radiance: f64, a: f64, b: f64, h: f64) -> f64 {
    let (x, y) = (a / h, b / h);
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let corner = (x / p * (y / p).atan() + y / q * (x / q).atan()) / (2.0 * PI);
    4.0 * PI * radiance * corner
}

#[test]
fn rectangles() {
    for (a, b, h) in [(0.5, 0.3, 1.0), (3.0, 2.0, 0.5), (1e-3, 1e-3, 1.0)] {
        let radiance = 1.0 / (a * b) as f32;
        let light = rectangle("light", DVec3::Y * h, DVec3::NEG_Y, (a, b), 1);
        let scene = lit_floor(1e-4, vec![emitting(light, radiance)]);
        shows(&format!("rectangle {a} x {b} at {h}"), &scene, rectangle_irradiance(f64::from(radiance), a, b, h));
    }
}

#[test]
fn spheres_from_tiny_to_huge() {
    for (radius, height) in [(1e-4, 1.0), (0.1, 1.0), (0.7, 1.0), (50.0, 51.0), (1e-3, 9.0)] {
        let radiance = (height / radius * (height / radius)) as f32;
        let light = emitting(sphere("light", DVec3::Y * height, radius, 1), radiance);
        let expected = PI * f64::from(radiance) * (radius / height).powi(2);
        shows(&format!("sphere of {radius} at {height}"), &lit_floor(1e-6, vec![light]), expected);
    }
}

/// The point lies inside the sphere, which shines inwards: half of what is around it is above the floor.
#[test]
fn a_sphere_around_the_point() {
    let shape = ObjectShape::Sphere { center: DVec3::Y * 2.0, radius: 8.0, inverted: true };
    let light = emitting(object("light", shape, DAffine3::IDENTITY, 1), 0.7);
    shows("inside a sphere", &lit_floor(1e-3, vec![light]), PI * f64::from(0.7f32));
}

#[test]
fn disks() {
    for (radius, height) in [(0.4, 1.0), (5.0, 1.0), (1e-4, 2.0)] {
        let radiance = (height / radius * (height / radius)) as f32;
        let to_world = DAffine3::from_scale_rotation_translation(
            DVec3::splat(radius),
            DQuat::from_rotation_x(PI / 2.0),
            DVec3::Y * height,
        );
        let light = emitting(object("light", ObjectShape::Disk, to_world, 1), radiance);
        let expected = PI * f64::from(radiance) * radius * radius / (radius * radius + height * height);
        shows(&format!("disk of {radius} at {height}"), &lit_floor(1e-6, vec![light]), expected);
    }
}

#[test]
fn lights_without_an_extent() {
    let intensity = Rgb::splat(3.0);
    let position = DVec3::new(0.0, 2.0, 1.0);
    let cubed = position.length().powi(3);
    shows(
        "point",
        &delta_lit_floor(1e-5, DeltaLight::Point { position, intensity }),
        f64::from(intensity.g) * position.y / cubed,
    );
    for (beam, cutoff) in [(0.3, 0.6), (0.0, 0.8), (0.5, 0.5)] {
        let spot = DeltaLight::Spot { position, direction: -position, intensity, beam, cutoff, image: None };
        shows("spot on its axis", &delta_lit_floor(1e-5, spot), f64::from(intensity.g) * position.y / cubed);
    }
    // 0.4 radians off the axis, where the intensity has fallen to half.
    let axis = DQuat::from_rotation_x(0.4) * -position;
    let spot = DeltaLight::Spot { position, direction: axis, intensity, beam: 0.2, cutoff: 0.6, image: None };
    shows("spot off its axis", &delta_lit_floor(1e-5, spot), 0.5 * f64::from(intensity.g) * position.y / cubed);
    let directional = DeltaLight::Directional { direction: DVec3::new(1.0, -2.0, 0.5), irradiance: Rgb::splat(1.5) };
    shows("directional", &delta_lit_floor(1.0, directional), 1.5 * 2.0 / 5.25f64.sqrt());
}

/// A cylinder around the floor's middle that shines inwards: what its open end does not take of the sky above.
#[test]
fn inside_a_cylinder() {
    for (radius, height) in [(1.0, 2.0), (3.0, 0.5), (1e-3, 1e-3)] {
        let (from, to) = (DVec3::Y * -0.25 * height, DVec3::Y * height);
        let shape = ObjectShape::Cylinder { from, to, radius, inverted: true };
        let light = emitting(object("light", shape, DAffine3::IDENTITY, 1), 0.7);
        let mut scene = lit_floor(1e-6, vec![light]);
        // The camera stands inside.
        scene.camera = Some(orthographic(DVec3::Y * (0.1 * height), DVec3::ZERO, DVec3::Z, 1e-6 * radius, 4));
        let expected = PI * f64::from(0.7f32) * height * height / (radius * radius + height * height);
        shows(&format!("cylinder of {radius} up to {height}"), &scene, expected);
    }
}

/// Half of a rectangle: by symmetry, half of what the whole sends to the point below its middle.
#[test]
fn textured_rectangles() {
    let (a, b, h) = (0.5, 0.3, 1.0);
    let to_uv = Affine2 { matrix2: Mat2::from_cols(Vec2::X, Vec2::ZERO), translation: Vec2::new(0.0, 0.25) };
    let emission = Texture::Checkerboard { even: Rgb::splat(5.0), odd: Rgb::BLACK, to_uv };
    let light = rectangle("light", DVec3::Y * h, DVec3::NEG_Y, (a, b), 1);
    let scene = lit_floor(1e-4, vec![Object { emission: Some(emission), ..light }]);
    shows("half a rectangle", &scene, 0.5 * rectangle_irradiance(5.0, a, b, h));
}

/// A projector's irradiance is that of a plane at distance 1; a spot's image is a factor.
#[test]
fn pictures() {
    let texels = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Rgb::splat).to_vec();
    let bitmap = Arc::new(Bitmap { width: 3, height: 2, texels });
    let image = || Texture::Bitmap {
        bitmap: bitmap.clone().into(),
        interpolation: Interpolation::Nearest,
        wrap: Wrap::Clamp,
        to_uv: Affine2::IDENTITY,
    };
    // Three metres above the floor and aside, looking down: the floor's middle is to the right of the axis and below.
    let (height, x, z) = (3.0, 0.9, 0.4);
    let position = DVec3::new(x, height, z);
    // Who looks down with +z up has +x to the left.
    let to_world = look_at(position, position - DVec3::Y, DVec3::Z);
    let projector = DeltaLight::Projector { to_world, fov_x: 1.0, aspect: 1.5, irradiance: image() };
    let half = 3.0 * 0.5f64.tan();
    let texel = |half_height: f64| {
        let (u, v) = (0.5 + 0.5 * x / half, 0.5 - 0.5 * z / half_height);
        f64::from(u8::from(v < 0.5)) * 3.0 + (u * 3.0).floor() + 1.0
    };
    shows("projector", &delta_lit_floor(1e-5, projector), texel(half / 1.5) / (height * height));

    let cubed = position.length().powi(3);
    let spot = DeltaLight::Spot {
        position,
        direction: DVec3::NEG_Y,
        intensity: Rgb::splat(2.0),
        beam: 0.5,
        cutoff: 0.5,
        image: Some((image(), DVec3::Z)),
    };
    shows("spot with an image", &delta_lit_floor(1e-5, spot), 2.0 * texel(half) * height / cubed);
}

#[test]
fn a_constant_sky() {
    shows("constant sky", &under_sky(lit_floor(1.0, Vec::new()), 0.6), PI * f64::from(0.6f32));
}

/// Point and spot lights that lie on a surface of any shape, lit steeply and flatly, light what is on either side of it.
#[test]
fn lights_on_surfaces() {
    let from = DVec3::new(0.61, 0.83, 0.17);
    let to_spot = -from.normalize();
    let across = to_spot.any_orthonormal_vector();
    let expected = from.y / from.length().powi(3);
    let kinds = [
        DeltaLight::Point { position: from, intensity: Rgb::WHITE },
        DeltaLight::Spot {
            position: from,
            direction: to_spot,
            intensity: Rgb::WHITE,
            beam: 0.4,
            cutoff: 0.5,
            image: None,
        },
    ];
    // Between the ray to the spot and the surface.
    for degrees in [1.0f64, 30.0, 90.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let normal = to_spot * sin + across * cos;
        let turned = DQuat::from_rotation_arc(DVec3::Z, normal);
        let flat = |size: DVec3| DAffine3::from_scale_rotation_translation(size, turned, from);
        let behind = from - normal * 0.2;
        // Along its axis the cylinder is as wide as its diameter, and the light lies beside it.
        let upright = DQuat::from_rotation_arc(DVec3::Z, normal.any_orthonormal_vector());
        let shapes = [
            ("rectangle", ObjectShape::Rectangle, flat(DVec3::splat(0.2))),
            ("disk", ObjectShape::Disk, flat(DVec3::splat(0.2))),
            ("edge", ObjectShape::Rectangle, flat(DVec3::splat(0.2)) * DAffine3::from_translation(DVec3::X)),
            ("sphere", ObjectShape::Sphere { center: behind, radius: 0.2, inverted: false }, DAffine3::IDENTITY),
            ("cube", ObjectShape::Cube, flat(DVec3::splat(0.1)) * DAffine3::from_translation(DVec3::NEG_Z)),
            (
                "cylinder",
                ObjectShape::Cylinder { from: DVec3::NEG_Z, to: DVec3::Z, radius: 1.0, inverted: false },
                DAffine3::from_scale_rotation_translation(DVec3::splat(0.2), upright, behind),
            ),
        ];
        for (name, shape, to_world) in shapes {
            for kind in &kinds {
                let mut scene = delta_lit_floor(1e-4, kind.clone());
                scene.objects.push(object("touched", shape.clone(), to_world, 1));
                shows(&format!("a light on a {name} at {degrees} degrees"), &scene, expected);
            }
        }
    }
}

/// The same by light tracing, whose particles start at such a light.
#[test]
fn particles_leave_lights_on_surfaces() {
    let light = |position| DeltaLight::Point { position, intensity: Rgb::WHITE };
    let at = DVec3::new(0.0, 1.3, 0.0);
    for shape in [ObjectShape::Rectangle, ObjectShape::Disk] {
        let mut scene = delta_lit_floor(0.8, light(at));
        let touched = DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.2),
            DQuat::from_rotation_arc(DVec3::Z, DVec3::new(0.1, -1.0, 0.2).normalize()),
            at,
        );
        scene.objects.push(object("touched", shape, touched, 1));
        let run = Run::of(&scene, Filter::Box, 2);
        let [path, light] = [&etendue_path::INFO, &etendue_bidir::LIGHT].map(|technique| {
            let mut means = Moments::default();
            for seed in 0..16 {
                let image = run.film(technique, seed, 0..256).mean_image();
                means.push(image.iter().map(|c: &Rgb| f64::from(c.g)).sum::<f64>() / image.len() as f64);
            }
            means
        });
        let deviation = (light.mean() - path.mean()) / light.standard_error().hypot(path.standard_error());
        assert!(path.mean() > 0.05 && deviation.abs() < limit(16), "{} {}", light.mean(), path.mean());
    }
}
