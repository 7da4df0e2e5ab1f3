//! Absorption inside objects against Beer's law.

use etendue_core::{
    filter::Filter,
    lights::environment::Environment,
    material::Material,
    rgb::Rgb,
    scene::{DeltaLight, LightDescription, Object, SceneDescription},
};
use etendue_path::INFO;
use etendue_tests::{Run, small::*};
use glam::DVec3;
use std::f64::consts::PI;

const ABSORPTION: Rgb = Rgb::new(0.0, 0.4, 1.5);

/// A ball of radius 1 that refracts nothing and absorbs, and a pixel that sees its middle.
fn ball(inside: Vec<Object>) -> SceneDescription {
    let glass = Object { absorption: Some(ABSORPTION), ..sphere("ball", DVec3::ZERO, 1.0, 0) };
    SceneDescription {
        camera: Some(orthographic(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, 1e-6, 1)),
        materials: vec![material("nothing", Material::dielectric(1.0, None)), grey(0.5)],
        objects: [vec![glass], inside].concat(),
        ..SceneDescription::default()
    }
}

fn shows(what: &str, scene: &SceneDescription, length: f64, without: f64) {
    let run = Run::of(scene, Filter::Box, 8);
    let seen = run.film(&INFO, 1, 0..64).mean_image()[0].to_array();
    for (seen, absorption) in seen.into_iter().zip(ABSORPTION.to_array()) {
        let expected = without * (-f64::from(absorption) * length).exp();
        // Nothing is random here but the place in a pixel that sees a millionth of the ball.
        assert!((f64::from(seen) - expected).abs() < 1e-5 * expected, "{what}: {seen}, not {expected}");
    }
}

#[test]
fn light_from_behind_crosses_the_ball() {
    let scene = SceneDescription { environment: Some(Environment::Constant(Rgb::splat(2.0))), ..ball(Vec::new()) };
    shows("behind", &scene, 2.0, 2.0);
}

#[test]
fn a_lamp_inside_lights_what_is_inside() {
    let floor = rectangle("floor", DVec3::ZERO, DVec3::Z, (0.2, 0.2), 1);
    let position = DVec3::new(0.3, 0.0, 0.4);
    let kind = DeltaLight::Point { position, intensity: Rgb::splat(3.0) };
    let lights = vec![LightDescription { name: "lamp".into(), kind }];
    let scene = SceneDescription { lights, ..ball(vec![floor]) };
    // One metre from the ball's surface to the floor, half a metre from there to the lamp, at a cosine of 0.8.
    shows("inside", &scene, 1.5, 0.5 / PI * 3.0 * 0.8 / 0.25);
}

#[test]
fn light_that_leaves_what_absorbs_is_absorbed_no_more() {
    let behind = emitting(rectangle("lamp", DVec3::new(0.0, 0.0, -9.0), DVec3::Z, (1.0, 1.0), 1), 2.0);
    shows("beyond", &ball(vec![behind]), 2.0, 2.0);
}
