//! Particles: what they leave behind is what the lights emit.

use etendue_bidir::particle::Particle;
use etendue_core::{
    filter::Filter,
    has,
    independent::independent,
    scene::{ObjectShape, SceneDescription},
    statistics::{moments::Moments, render::Rays},
};
use etendue_tests::{Run, limit, small::*};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;

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
        let particle = Particle::<{ has::ALL }>::emit(&run.scene, &run.settings, &mut *sampler);
        let mut particle = particle.expect("a light that shines everywhere");
        while let Some(vertex) = particle.trace(&mut Rays::default()) {
            sum += f64::from(vertex.beta.g * (1.0 - reflectance));
            if !particle.walk.scatter(&vertex, &mut *sampler) {
                break;
            }
        }
        absorbed.push(sum);
    }
    let flux = PI * f64::from(radiance) * 16.0 * PI;
    let z = (absorbed.mean() - flux) / absorbed.standard_error();
    println!("absorbed {:.4} of {flux:.4}, {z:.2} standard errors", absorbed.mean());
    assert!(z.abs() < limit(absorbed.count()), "{} of {flux}", absorbed.mean());
}
