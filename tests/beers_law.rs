//! Absorption inside objects, against Beer's law.

use etendue_core::{filter::Filter, material::Material, rgb::Rgb, scene::*, statistics::moments::Moments};
use etendue_tests::{Run, aiming, limit, small::*};
use glam::{DAffine3, DVec3};

/// What each metre absorbs; green not at all.
const ABSORPTION: Rgb = Rgb::new(0.7, 0.0, 2.5);

fn absorbing(object: Object) -> Object {
    Object { absorption: Some(ABSORPTION), ..object }
}

/// A scene of one object of clear glass that does not refract and of whatever stands in it, under a sky of radiance 1; the
/// camera sees a spot of side 1e-4 in parallel rays.
fn glass(eye: DVec3, target: DVec3, objects: Vec<Object>) -> SceneDescription {
    let up = if (target - eye).normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    let scene = SceneDescription {
        name: "absorbing glass".into(),
        camera: Some(orthographic(eye, target, up, 1e-4, 4)),
        materials: vec![material("glass", Material::dielectric(1.0, None)), grey(0.5)],
        objects,
        ..SceneDescription::default()
    };
    under_sky(scene, 1.0)
}

/// Every technique's mean over the image is `expected`, within its own standard error.
fn shows(name: &str, scene: &SceneDescription, expected: [f64; 3]) {
    for technique in aiming() {
        let run = Run::of(scene, Filter::Box, 8);
        let mut means = [0; 3].map(|_| Moments::default());
        for seed in 0..12 {
            let image = run.film(technique, seed, 0..16).mean_image();
            for (c, moments) in means.iter_mut().enumerate() {
                moments.push(image.iter().map(|p| f64::from(p.to_array()[c])).sum::<f64>() / image.len() as f64);
            }
        }
        for (moments, expected) in means.iter().zip(expected) {
            let error = moments.standard_error().hypot(4e-6 * expected);
            let deviation = (moments.mean() - expected) / error;
            println!("{name}, {}: {:.6} against {expected:.6}, {deviation:.2}", technique.name, moments.mean());
            assert!(deviation.abs() < limit(moments.count()), "{name}: {} against {expected}", moments.mean());
        }
    }
}

fn left(distance: f64) -> [f64; 3] {
    ABSORPTION.to_array().map(|a| (-f64::from(a) * distance).exp())
}

#[test]
fn slabs_and_spheres() {
    let slab = DAffine3::from_scale(DVec3::new(3.0, 0.25, 3.0));
    for angle in [0.0, 0.5, 1.0f64] {
        let from = DVec3::new(angle.sin(), angle.cos(), 0.0) * 5.0;
        let slab = absorbing(object("slab", ObjectShape::Cube, slab, 0));
        shows(&format!("slab at {angle}"), &glass(from, DVec3::ZERO, vec![slab]), left(0.5 / angle.cos()));
    }
    for height in [0.0, 0.5, 0.99f64] {
        let ball = absorbing(sphere("ball", DVec3::ZERO, 1.0, 0));
        let scene = glass(DVec3::new(0.0, height, -4.0), DVec3::new(0.0, height, 0.0), vec![ball]);
        shows(&format!("sphere at {height}"), &scene, left(2.0 * (1.0 - height * height).sqrt()));
    }
}

/// The camera inside: what it sees of the sky comes through what is left of the ball.
#[test]
fn a_camera_inside() {
    for (eye, target, distance) in [(DVec3::ZERO, DVec3::Z, 1.0), (DVec3::X * 0.6, DVec3::new(0.6, 0.0, 1.0), 0.8)] {
        let ball = absorbing(sphere("ball", DVec3::ZERO, 1.0, 0));
        shows("inside", &glass(eye, target, vec![ball]), left(distance));
    }
}

/// An instance absorbs over its own size.
#[test]
fn instances() {
    let group = Group { name: "ball".into(), objects: vec![absorbing(sphere("ball", DVec3::ZERO, 1.0, 0))] };
    let mut scene = glass(DVec3::Z * -4.0, DVec3::ZERO, vec![]);
    scene.groups.push(group);
    scene.instances.push(GroupInstance { group: 0, to_world: DAffine3::from_scale(DVec3::splat(0.3)) });
    shows("instance", &scene, left(0.6));
}

/// A lamp and a grey disk in the same glass: shadow rays, sampled directions and their weights all lose the same. The disk is lit
/// through 1 m and seen through 0.5 m.
#[test]
fn lamps_in_glass() {
    let disk = object("disk", ObjectShape::Disk, DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2), 1);
    let radius = 0.02;
    let lamp = emitting(sphere("lamp", DVec3::Y, radius, 1), 1e4);
    let block = absorbing(object("block", ObjectShape::Cube, DAffine3::from_scale(DVec3::splat(1.5)), 0));
    let position = DVec3::new(2.0, 2.0, 0.0);
    let mut scene = glass(position, DVec3::ZERO, vec![disk, lamp, block]);
    scene.environment = None;
    // From the eye to the block's side is 0.5 m to the side: of the way to the middle, three quarters lie inside.
    let inside = position.length() * 0.75;
    let irradiance = std::f64::consts::PI * 1e4 * radius * radius;
    // The lamp's front is nearer than its middle, in the mean over what is seen of it by two thirds of the radius.
    let nearer = radius * 2.0 / 3.0;
    let one = 0.5 / std::f64::consts::PI * irradiance;
    let expected = left(inside + 1.0 - nearer).map(|t| t * one);
    shows("lamp in glass", &scene, expected);
}
