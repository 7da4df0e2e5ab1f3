//! Reliefs of which both sides are one sheet, against those that the back mirrors.

use etendue_core::{
    bsdf::TransportMode,
    camera::{CameraDescription, Projection},
    has::ALL,
    material::{Bitangent, Material, Relief},
    rgb::Rgb,
    scene::{NamedMaterial, Object, ObjectShape, Scene, SceneDescription},
    statistics::render::Rays,
    walk::{Limits, Vertex, Walk},
};
use glam::{DAffine3, DVec3, UVec2, Vec2, Vec3};

/// Values of a white rectangle with this relief, seen from behind, for light from the right and from the left.
fn seen_from_behind(relief: Relief) -> [f32; 2] {
    let material = Material::Relief { relief, material: Box::new(Material::lambert(Rgb::WHITE)) };
    let scene = Scene::new(&SceneDescription {
        camera: Some(CameraDescription {
            projection: Projection::Perspective { fov_x: 0.1 },
            to_world: DAffine3::from_translation(DVec3::new(0.0, 0.0, -1.0)),
            resolution: UVec2::ONE,
            crop: None,
        }),
        materials: vec![NamedMaterial { name: "relief".into(), material, two_sided: true }],
        objects: vec![Object {
            name: "rectangle".into(),
            shape: ObjectShape::Rectangle,
            to_world: DAffine3::IDENTITY,
            material: 0,
            emission: None,
            absorption: None,
        }],
        ..SceneDescription::default()
    })
    .unwrap();
    let (mode, limits) = (TransportMode::Radiance, Limits { max_depth: 2, roulette_depth: 9 });
    let ray = scene.camera().sample_ray(Vec2::splat(0.5), Vec2::ZERO);
    let mut walk = Walk::<ALL>::new(&scene, mode, limits, ray, Rgb::WHITE, 1.0);
    let Vertex::Surface(vertex) = walk.trace(&mut Rays::default()) else { panic!("nothing is met") };
    [0.6, -0.6].map(|x| vertex.eval_pdf::<ALL>(Vec3::new(x, 0.0, -0.8), mode).0.g)
}

/// Figures: Mitsuba 3.9.1, `eval` of a `normalmap` of (0.7, 0.5, 0.9) around a white `twosided` and inside it.
#[test]
fn a_sheet_has_its_dents_behind_as_bumps() {
    let map = || Relief::NormalMap { normals: Rgb::new(0.7, 0.5, 0.9).into(), bitangent: Bitangent::RightHanded };
    for (relief, expected) in
        [(Relief::Sheet(Box::new(map())), [0.141_732, 0.311_811]), (map(), [0.311_811, 0.141_732])]
    {
        for (value, expected) in seen_from_behind(relief).into_iter().zip(expected) {
            assert!((value - expected).abs() < 1e-5, "{value} {expected}");
        }
    }
}
