//! The scene of the benches.

use etendue_core::{
    camera::{CameraDescription, Projection},
    material::Material,
    rgb::Rgb,
    scene::{NamedMaterial, Object, ObjectShape, SceneDescription},
};
use glam::{DAffine3, DQuat, DVec3, UVec2, dcamera::lh::view::look_at_affine3};

/// A room of grey walls with two balls and a lamp.
pub fn room() -> SceneDescription {
    let object = |name: &str, shape, to_world, material| Object {
        name: name.into(),
        shape,
        to_world,
        material,
        emission: None,
        absorption: None,
    };
    let ball = |name, x: f64, material| {
        let shape = ObjectShape::Sphere { center: DVec3::new(x, -0.6, 0.1), radius: 0.35, inverted: false };
        object(name, shape, DAffine3::IDENTITY, material)
    };
    let down = DQuat::from_rotation_arc(DVec3::Z, DVec3::NEG_Y);
    let lamp_place = DAffine3::from_scale_rotation_translation(DVec3::splat(0.3), down, DVec3::Y * 0.98);
    let named = |name: &str, material| NamedMaterial { name: name.into(), material, two_sided: true };
    SceneDescription {
        name: "room".into(),
        camera: Some(CameraDescription {
            projection: Projection::Perspective { fov_x: 1.4 },
            to_world: look_at_affine3(DVec3::Z * 0.95, DVec3::ZERO, DVec3::Y).inverse(),
            resolution: UVec2::splat(64),
            crop: None,
        }),
        materials: vec![
            named("grey", Material::lambert(Rgb::splat(0.6))),
            named("glass", Material::dielectric(1.5, None)),
        ],
        objects: vec![
            object("walls", ObjectShape::Cube, DAffine3::IDENTITY, 0),
            ball("glass ball", 0.4, 1),
            ball("grey ball", -0.4, 0),
            Object { emission: Some(Rgb::splat(8.0).into()), ..object("lamp", ObjectShape::Rectangle, lamp_place, 0) },
        ],
        ..SceneDescription::default()
    }
}
