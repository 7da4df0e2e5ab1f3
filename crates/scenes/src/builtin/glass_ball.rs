//! A glass ball in a box.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{RoomWalls, Stage, glass},
};
use crate::LoadedScene;
use etendue_core::rgb::Rgb;
use glam::DVec3;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "glass-ball",
    summary: "glass ball in a box under a lamp: the caustic that photon maps were first shown with",
    parameters: &[Parameter {
        name: "light",
        summary: "half edge of the light, metres; its power stays the same",
        kind: ParameterKind::Number { default: 0.15, range: (0.001, 0.5) },
    }],
    build,
};

/// Tests a caustic by refraction alone, on a diffuse floor that the camera sees directly, in a room of coloured walls.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("glass-ball", DVec3::new(0.0, 1.15, 4.1), DVec3::new(0.0, 0.85, 0.0), 36.0);
    let white = stage.lambert("white", [0.72, 0.72, 0.71]);
    let rose = stage.lambert("rose", [0.6, 0.18, 0.16]);
    let teal = stage.lambert("teal", [0.12, 0.38, 0.4]);
    let dark = stage.lambert("dark", [0.0; 3]);
    let glass = stage.material("glass", glass());
    let walls = RoomWalls {
        floor: Some(white),
        ceiling: Some(white),
        left: Some(rose),
        right: Some(teal),
        back: Some(white),
        front: None,
    };
    stage.room([-1.1, 0.0, -1.1], [1.1, 2.0, 1.1], walls);
    stage.sphere("glass ball", DVec3::new(0.1, 0.62, 0.1), 0.45, glass);
    let half = values.number("light");
    let light = stage.rectangle("light", DVec3::new(-0.3, 1.98, 0.0), DVec3::X * half, DVec3::Z * half, dark);
    light.emission = Some((Rgb::new(1.0, 0.9, 0.75) * (2.1 / (half * half)) as f32).into());
    stage.finish(12)
}
