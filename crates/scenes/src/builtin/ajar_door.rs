//! A room whose only light comes through a door that stands ajar.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{RoomWalls, Stage, glass, rough_metal},
};
use crate::{LoadedScene, placement::rotation};
use etendue_core::rgb::Rgb;
use glam::DVec3;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "ajar-door",
    summary: "room lit through a door ajar from the room behind: nothing but indirect light",
    parameters: &[Parameter {
        name: "angle",
        summary: "how far the door is open, degrees",
        kind: ParameterKind::Number { default: 28.0, range: (1.0, 90.0) },
    }],
    build,
};

/// Tests light that is hard to find: the lamp stands in the next room, next to the wall, so that every path to it leads through
/// the gap of the door and bounces at least once there.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("ajar-door", DVec3::new(0.9, 1.5, 2.3), DVec3::new(-0.25, 0.95, -1.5), 62.0);
    let plaster = stage.lambert("plaster", [0.72, 0.71, 0.68]);
    let planks = stage.lambert("planks", [0.48, 0.34, 0.21]);
    let paint = stage.lambert("paint", [0.55, 0.6, 0.62]);
    let cloth = stage.lambert("cloth", [0.5, 0.14, 0.12]);
    let dark = stage.lambert("dark", [0.0; 3]);
    let steel = stage.material("steel", rough_metal([0.72, 0.71, 0.69], 0.12));
    let glass = stage.material("glass", glass());

    let walls = RoomWalls {
        floor: Some(planks),
        ceiling: Some(plaster),
        left: Some(plaster),
        right: Some(plaster),
        back: Some(plaster),
        front: Some(plaster),
    };
    stage.room([-2.1, 0.0, -5.6], [2.1, 2.6, 2.6], walls);

    // The wall between the rooms lies about z = -1.6 and leaves a doorway from x = -0.5 to 0.5 up to y = 2.1.
    let wall_z = -1.6;
    stage.cuboid("wall left of door", DVec3::new(-1.3, 1.3, wall_z), DVec3::new(0.8, 1.3, 0.07), 0.0, plaster);
    stage.cuboid("wall right of door", DVec3::new(1.3, 1.3, wall_z), DVec3::new(0.8, 1.3, 0.07), 0.0, plaster);
    stage.cuboid("wall above door", DVec3::new(0.0, 2.35, wall_z), DVec3::new(0.5, 0.25, 0.07), 0.0, plaster);

    // The door hangs on its left edge and opens into the room in front.
    let turn = -values.number("angle");
    let hinge = DVec3::new(-0.5, 1.045, wall_z + 0.1);
    let middle = hinge + rotation(DVec3::Y, turn) * (DVec3::X * 0.49);
    stage.cuboid("door", middle, DVec3::new(0.49, 1.04, 0.02), turn, paint);

    let lamp = (DVec3::X * 0.45, DVec3::Z * 0.45);
    let light = stage.rectangle("lamp", DVec3::new(0.75, 2.58, -3.2), lamp.0, lamp.1, dark);
    light.emission = Some(Rgb::new(560.0, 500.0, 400.0).into());

    stage.cuboid("chest", DVec3::new(-1.35, 0.35, -0.5), DVec3::new(0.5, 0.35, 0.4), 12.0, cloth);
    stage.cuboid("table", DVec3::new(1.1, 0.4, -0.35), DVec3::new(0.5, 0.4, 0.5), -20.0, planks);
    stage.sphere("steel ball", DVec3::new(1.0, 1.06, -0.5), 0.26, steel);
    stage.sphere("glass ball", DVec3::new(-1.25, 0.94, -0.4), 0.24, glass);
    stage.finish(16)
}
