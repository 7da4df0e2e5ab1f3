//! A box of diffuse walls with two blocks and a light under the ceiling.

use super::{
    Builtin, Values,
    parts::{RoomWalls, Stage},
};
use crate::LoadedScene;
use etendue_core::rgb::Rgb;
use glam::DVec3;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "cornell",
    summary: "diffuse box with two blocks and an area light: indirect light and soft shadows",
    parameters: &[],
    build,
};

/// Tests diffuse indirect light, colour bleeding and soft shadows: the easy case that every technique must get right.
/// The layout is the classic one; its measures and colours are its own.
fn build(_: &Values) -> LoadedScene {
    let mut stage = Stage::new("cornell", DVec3::new(0.0, 1.05, 4.6), DVec3::new(0.0, 1.05, 0.0), 34.0);
    let white = stage.lambert("white", [0.74, 0.73, 0.7]);
    let brick = stage.lambert("brick", [0.6, 0.12, 0.08]);
    let moss = stage.lambert("moss", [0.16, 0.42, 0.13]);
    let dark = stage.lambert("dark", [0.0; 3]);
    let walls = RoomWalls {
        floor: Some(white),
        ceiling: Some(white),
        left: Some(brick),
        right: Some(moss),
        back: Some(white),
        front: None,
    };
    stage.room([-1.2, 0.0, -1.3], [1.2, 2.1, 1.1], walls);
    stage.cuboid("tall block", DVec3::new(-0.46, 0.63, -0.48), DVec3::new(0.33, 0.63, 0.33), 21.0, white);
    stage.cuboid("low block", DVec3::new(0.45, 0.31, 0.22), DVec3::new(0.32, 0.31, 0.32), -16.0, white);
    let down = (DVec3::X * 0.28, DVec3::Z * 0.24);
    stage.rectangle("light", DVec3::new(0.0, 2.09, -0.1), down.0, down.1, dark).emission =
        Some(Rgb::new(48.0, 38.0, 23.0).into());
    stage.finish(12)
}
