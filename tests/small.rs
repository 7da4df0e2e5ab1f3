//! Small scenes for tests, as code.

use etendue_core::{
    camera::{CameraDescription, Projection},
    geometry::Mesh,
    lights::environment::Environment,
    material::Material,
    rgb::Rgb,
    scene::{DeltaLight, LightDescription, NamedMaterial, Object, ObjectShape, SceneDescription},
};
use glam::{DAffine3, DQuat, DVec3, UVec2};

/// A transform that stands at `eye` and looks at `target` (camera space: +z forward, +y up).
pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> DAffine3 {
    let forward = (target - eye).normalize();
    let left = up.cross(forward).normalize();
    DAffine3::from_mat3_translation(glam::DMat3::from_cols(left, forward.cross(left), forward), eye)
}

/// A camera that sees a square of side `width` in parallel projection.
pub fn orthographic(eye: DVec3, target: DVec3, up: DVec3, width: f64, resolution: u32) -> CameraDescription {
    CameraDescription {
        projection: Projection::Orthographic { width },
        to_world: look_at(eye, target, up),
        resolution: UVec2::splat(resolution),
        crop: None,
    }
}

/// A pinhole camera.
pub fn pinhole(eye: DVec3, target: DVec3, fov_x: f64, resolution: u32) -> CameraDescription {
    CameraDescription {
        projection: Projection::Perspective { fov_x },
        to_world: look_at(eye, target, DVec3::Y),
        resolution: UVec2::splat(resolution),
        crop: None,
    }
}

/// A two-sided material.
pub fn material(name: &str, material: Material) -> NamedMaterial {
    NamedMaterial { name: name.into(), material, two_sided: true }
}

/// A grey Lambert material.
pub fn grey(reflectance: f32) -> NamedMaterial {
    material("grey", Material::lambert(Rgb::splat(reflectance)))
}

/// An object that emits nothing.
pub fn object(name: &str, shape: ObjectShape, to_world: DAffine3, material: usize) -> Object {
    Object { name: name.into(), shape, to_world, material, emission: None, absorption: None }
}

/// A sphere.
pub fn sphere(name: &str, center: DVec3, radius: f64, material: usize) -> Object {
    object(name, ObjectShape::Sphere { center, radius, inverted: false }, DAffine3::IDENTITY, material)
}

/// A rectangle centred at `center` whose normal is `normal`.
pub fn rectangle(name: &str, center: DVec3, normal: DVec3, half: (f64, f64), material: usize) -> Object {
    let rotation = DQuat::from_rotation_arc(DVec3::Z, normal.normalize());
    let to_world = DAffine3::from_scale_rotation_translation(DVec3::new(half.0, half.1, 1.0), rotation, center);
    object(name, ObjectShape::Rectangle, to_world, material)
}

/// The same object, emitting.
pub fn emitting(object: Object, radiance: f32) -> Object {
    Object { emission: Some(Rgb::splat(radiance).into()), ..object }
}

/// A white-ish floor in the plane y = 0, of which an orthographic camera above sees a spot of side `seen` at the origin,
/// lit by `lights`. The reflected radiance there is `0.5 / pi` times the irradiance.
pub fn lit_floor(seen: f64, lights: Vec<Object>) -> SceneDescription {
    let mut objects = vec![rectangle("floor", DVec3::ZERO, DVec3::Y, (10.0, 10.0), 0)];
    objects.extend(lights);
    SceneDescription {
        name: "lit floor".into(),
        camera: Some(orthographic(DVec3::Y * 0.25, DVec3::ZERO, DVec3::Z, seen, 4)),
        materials: vec![grey(0.5), material("black", Material::lambert(Rgb::BLACK))],
        objects,
        ..SceneDescription::default()
    }
}

/// The floor of [`lit_floor`] lit by a light without an extent.
pub fn delta_lit_floor(seen: f64, kind: DeltaLight) -> SceneDescription {
    SceneDescription { lights: vec![LightDescription { name: "light".into(), kind }], ..lit_floor(seen, Vec::new()) }
}

/// The same scene under a constant sky.
pub fn under_sky(scene: SceneDescription, radiance: f32) -> SceneDescription {
    SceneDescription { environment: Some(Environment::Constant(Rgb::splat(radiance))), ..scene }
}

/// The scene moved and scaled by its transforms, camera and lights included.
pub fn transformed(scene: &SceneDescription, by: &DAffine3) -> SceneDescription {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        object.to_world = *by * object.to_world;
    }
    for instance in &mut scene.instances {
        instance.to_world = *by * instance.to_world;
    }
    for light in &mut scene.lights {
        match &mut light.kind {
            DeltaLight::Point { position, .. } | DeltaLight::Spot { position, .. } => {
                *position = by.transform_point3(*position);
            }
            DeltaLight::Projector { to_world, .. } => *to_world = *by * *to_world,
            DeltaLight::Directional { .. } => {}
        }
    }
    if let Some(camera) = &mut scene.camera {
        camera.to_world = *by * camera.to_world;
    }
    scene
}

/// The scene with every mesh, rectangle and cube as a mesh whose vertices are already in the world, moved by `offset`, in
/// single precision: what a file with baked coordinates holds.
pub fn baked(scene: &SceneDescription, offset: DVec3) -> SceneDescription {
    let mut scene = transformed(scene, &DAffine3::from_translation(offset));
    for object in &mut scene.objects {
        let quad = |x: DVec3, y: DVec3, z: DVec3| [z - x - y, z + x - y, z + x + y, z - x + y];
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let faces = match object.shape {
            ObjectShape::Rectangle => vec![quad(x, y, DVec3::ZERO)],
            ObjectShape::Cube => {
                vec![quad(x, y, z), quad(y, x, -z), quad(y, z, x), quad(z, y, -x), quad(z, x, y), quad(x, z, -y)]
            }
            _ => continue,
        };
        let mut mesh = Mesh::default();
        for face in faces {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(face.map(|p| object.to_world.transform_point3(p).as_vec3()));
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        object.shape = ObjectShape::Mesh(mesh);
        object.to_world = DAffine3::IDENTITY;
    }
    scene
}
