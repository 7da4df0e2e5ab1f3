//! A glass ball and a mirror ball in a box under a small light.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{RoomWalls, Stage, glass, mirror},
};
use crate::LoadedScene;
use etendue_core::rgb::Rgb;
use glam::DVec3;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "glass-caustic",
    summary: "glass and mirror ball in a box under a small light: caustics that path tracing hardly finds",
    parameters: &[Parameter {
        name: "light",
        summary: "half edge of the light, metres; its power stays the same",
        kind: ParameterKind::Number { default: 0.07, range: (0.001, 0.5) },
    }],
    build,
};

/// Tests caustics by refraction and reflection: light that only paths through the balls carry to the floor and the walls, and
/// that the camera sees through the balls once more.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("glass-caustic", DVec3::new(0.0, 1.0, 4.3), DVec3::new(0.0, 1.0, 0.0), 34.0);
    let white = stage.lambert("white", [0.73, 0.72, 0.7]);
    let ochre = stage.lambert("ochre", [0.62, 0.36, 0.1]);
    let blue = stage.lambert("blue", [0.14, 0.22, 0.5]);
    let dark = stage.lambert("dark", [0.0; 3]);
    let glass = stage.material("glass", glass());
    let silver = stage.material("silver", mirror([0.97, 0.96, 0.95]));
    let walls = RoomWalls {
        floor: Some(white),
        ceiling: Some(white),
        left: Some(ochre),
        right: Some(blue),
        back: Some(white),
        front: None,
    };
    stage.room([-1.1, 0.0, -1.1], [1.1, 2.0, 1.0], walls);
    stage.sphere("mirror ball", DVec3::new(-0.48, 0.42, -0.42), 0.42, silver);
    stage.sphere("glass ball", DVec3::new(0.42, 0.4, 0.3), 0.37, glass);
    let half = values.number("light");
    let light = stage.rectangle("light", DVec3::new(0.05, 1.98, 0.0), DVec3::X * half, DVec3::Z * half, dark);
    light.emission = Some((Rgb::new(1.0, 0.82, 0.55) * (2.3 / (half * half)) as f32).into());
    stage.finish(16)
}
