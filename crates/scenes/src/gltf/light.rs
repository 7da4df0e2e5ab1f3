//! Lights without an extent [KHR_lights_punctual].

use super::{Notes, flaw, item, valid};
use crate::error::Flaw;
use etendue_core::{
    rgb::Rgb,
    scene::{DeltaLight, LightDescription},
};
use glam::{DAffine3, DVec3};
use gltf_json::{Root, extensions::scene::khr_lights_punctual::Type};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The light of a node.
pub(super) fn light(
    root: &Root,
    index: usize,
    to_world: &DAffine3,
    node: &str,
    notes: &mut Notes,
) -> Result<LightDescription, Flaw> {
    let lights = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let lights = lights.map_or(&[][..], |l| &l.lights);
    let light = item(lights, "lights", index)?;
    let place = || format!("lights[{index}]");
    let color = Rgb::from(light.color) * light.intensity;
    if !color.is_valid() || light.intensity < 0.0 {
        return Err(flaw(format!("{}: its intensity or colour is negative or not finite", place())));
    }
    if light.color.iter().any(|c| *c > 1.0) {
        notes.add(format!("{}: its colour is above 1, and taken as it is", place()));
    }
    let position = to_world.translation;
    let direction = to_world.transform_vector3(DVec3::NEG_Z).try_normalize();
    let direction = direction.ok_or_else(|| flaw(format!("{}: the node `{node}` gives it no direction", place())));
    if light.range.is_some() {
        notes.add("the ranges of lights have no effect");
    }
    let kind = match valid(&light.type_, place)? {
        Type::Point => DeltaLight::Point { position, intensity: color },
        Type::Directional => DeltaLight::Directional { direction: direction?, irradiance: color },
        Type::Spot => {
            let (beam, cutoff) = light
                .spot
                .as_ref()
                .map_or((0.0, FRAC_PI_4), |s| (f64::from(s.inner_cone_angle), f64::from(s.outer_cone_angle)));
            if !(cutoff > 0.0 && (0.0..=cutoff).contains(&beam)) {
                return Err(flaw(format!("{}: its cones are {beam} and {cutoff}", place())));
            }
            // A right angle in single precision is a little more.
            if cutoff > FRAC_PI_2 + 1e-6 {
                notes.add(format!("{}: its outer cone of {cutoff} is beyond a right angle, and cut there", place()));
            }
            DeltaLight::Spot {
                position,
                direction: direction?,
                intensity: color,
                beam: beam.min(FRAC_PI_2),
                cutoff: cutoff.min(FRAC_PI_2),
                image: None,
            }
        }
    };
    let name = light.name.clone().unwrap_or_else(|| node.to_owned());
    Ok(LightDescription { name, kind })
}
