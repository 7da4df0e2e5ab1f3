//! Scenes at the end of single precision are refused, and those that are not build.

use etendue_core::{
    camera::{CameraDescription, Projection},
    geometry::Mesh,
    has::ALL,
    material::Material,
    ray::Ray,
    rgb::Rgb,
    scene::{Group, GroupInstance, NamedMaterial, Object, ObjectShape, Scene, SceneDescription},
};
use glam::{DAffine3, DVec3, UVec2, Vec3};

fn object(shape: ObjectShape, scale: f64) -> Object {
    let to_world = DAffine3::from_scale(DVec3::splat(scale));
    Object { name: "thing".to_owned(), shape, to_world, material: 0, emission: None, absorption: None }
}

fn scene(objects: Vec<Object>) -> SceneDescription {
    let projection = Projection::Perspective { fov_x: 1.0 };
    SceneDescription {
        camera: Some(CameraDescription {
            projection,
            to_world: DAffine3::IDENTITY,
            resolution: UVec2::ONE,
            crop: None,
        }),
        materials: vec![NamedMaterial {
            name: "grey".to_owned(),
            material: Material::lambert(Rgb::splat(0.5)),
            two_sided: true,
        }],
        objects,
        ..SceneDescription::default()
    }
}

fn shapes() -> Vec<ObjectShape> {
    let positions = [[-1.0, -1.0, 0.0], [1.0, -0.9, 0.0], [0.3, 1.0, 0.5]].map(Vec3::from).to_vec();
    vec![
        ObjectShape::Mesh(Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() }),
        ObjectShape::Sphere { center: DVec3::ZERO, radius: 1.0, inverted: false },
        ObjectShape::Disk,
        ObjectShape::Cube,
        ObjectShape::Rectangle,
    ]
}

fn builds(description: &SceneDescription) {
    let scene = Scene::new(description).unwrap_or_else(|e| panic!("{e}"));
    for direction in [Vec3::X, Vec3::NEG_Z, Vec3::new(0.6, 0.0, -0.8)] {
        let ray = Ray::new(Vec3::new(0.1, 0.1, 1.0), direction);
        assert!(scene.geometry().closest::<ALL>(&ray).is_none_or(|hit| hit.t.is_finite()));
    }
}

fn refused(description: &SceneDescription, named: &str) {
    let error = Scene::new(description).expect_err("it was built").to_string();
    assert!(error.starts_with(named), "{error}");
}

#[test]
fn enormous_scenes_build_or_are_refused() {
    let small = || object(ObjectShape::Cube, 1.0);
    for shape in shapes() {
        for scale in [1e30, 9e36] {
            builds(&scene(vec![object(shape.clone(), scale), small()]));
        }
        for scale in [2e37, 1e38, 3e38, 1e39] {
            refused(&scene(vec![object(shape.clone(), scale), small()]), "object 'thing': ");
        }
    }
}

#[test]
fn enormous_instances_build_or_are_refused() {
    for shape in shapes() {
        let with = |scale: f64, size: f64| {
            let mut scene = scene(vec![object(ObjectShape::Cube, 1.0)]);
            scene.groups = vec![Group { name: "group".to_owned(), objects: vec![object(shape.clone(), size)] }];
            let to_world = DAffine3::from_scale(DVec3::splat(scale));
            scene.instances = vec![GroupInstance { group: 0, to_world }];
            scene
        };
        builds(&with(1e30, 1e5));
        builds(&with(1e-5, 1e36));
        for (scale, size) in [(1e30, 1e8), (2e37, 1.0), (1e39, 1e-3), (1e-60, 1.0)] {
            refused(&with(scale, size), "instance '0': ");
        }
        refused(&with(1e-5, 1e38), "object 'thing': ");
    }
    let mut empty = scene(vec![object(ObjectShape::Cube, 1.0)]);
    empty.groups = vec![Group { name: "group".to_owned(), objects: Vec::new() }];
    empty.instances = vec![GroupInstance { group: 0, to_world: DAffine3::IDENTITY }];
    builds(&empty);
}
