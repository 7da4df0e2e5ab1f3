//! Built-in scenes: they load with every parameter at its ends, and are the same each time.

use etendue_core::{
    lights::environment::Environment,
    material::Material,
    rgb::Rgb,
    scene::{DeltaLight, ObjectShape},
    texture::Texture,
};
use etendue_scenes::{LoadedScene, ParameterKind, builtins, load};
use glam::DVec3;

/// The extreme values of a parameter as text; the largest of those that make a scene big is cut down.
fn extremes(kind: ParameterKind) -> Vec<String> {
    match kind {
        ParameterKind::Integer { range: (low, high), .. } => vec![low.to_string(), high.to_string()],
        ParameterKind::Number { range: (low, high), .. } => vec![low.to_string(), high.to_string()],
        ParameterKind::Choice { options } => options.iter().map(|o| (*o).to_owned()).collect(),
    }
}

fn check(spec: &str, scene: &LoadedScene) {
    let d = &scene.description;
    let camera = d.camera.as_ref().unwrap_or_else(|| panic!("{spec}: no camera"));
    assert!(camera.to_world.is_finite(), "{spec}");
    assert_eq!(camera.resolution.to_array(), [128, 128], "{spec}");
    assert!(scene.max_depth >= 2 && scene.roulette_depth >= 1, "{spec}");
    let emits = d.objects.iter().any(|o| o.emission.is_some());
    assert!(emits || d.environment.is_some() || !d.lights.is_empty(), "{spec}: nothing emits");
    let mut used = vec![false; d.materials.len()];
    for object in &d.objects {
        let name = &object.name;
        used[object.material] = true;
        assert!(object.to_world.is_finite(), "{spec}: {name}");
        assert!(object.to_world.matrix3.determinant() > 0.0, "{spec}: {name} is mirrored or flat");
        let valid = |e: &Texture<Rgb>| e.values().iter().all(|c| c.is_valid());
        assert!(object.emission.as_ref().is_none_or(valid), "{spec}: {name}");
        match &object.shape {
            ObjectShape::Mesh(mesh) => {
                assert!(mesh.positions.iter().all(|p| p.is_finite()), "{spec}: {name}");
                assert!(mesh.normals.is_empty() || mesh.normals.len() == mesh.positions.len(), "{spec}: {name}");
                assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < mesh.positions.len()));
            }
            ObjectShape::Sphere { radius, center, .. } => assert!(*radius > 0.0 && center.is_finite()),
            ObjectShape::Cylinder { .. } => panic!("{spec}: no built-in scene has a cylinder"),
            ObjectShape::Disk | ObjectShape::Rectangle | ObjectShape::Cube => {}
        }
    }
    assert!(used.iter().all(|u| *u), "{spec}: a material is not used");
    for material in &d.materials {
        let Material::Lambert { reflectance } = &material.material else { continue };
        assert!(reflectance.values().iter().all(|c| c.is_valid() && c.max_element() <= 1.0), "{spec}");
    }
    if let Some(Environment::LatLong { image, .. }) = &d.environment {
        assert_eq!(image.texels.len(), image.width as usize * image.height as usize);
        assert!(image.texels.iter().all(|t| t.is_valid()), "{spec}");
    }
    let valid = |light: &DeltaLight| !matches!(light, DeltaLight::Point { position, .. } if !position.is_finite());
    assert!(d.lights.iter().all(|l| valid(&l.kind)), "{spec}");
}

#[test]
fn every_scene_loads_with_its_defaults_and_its_extremes() {
    assert_eq!(builtins().len(), 14);
    for builtin in builtins() {
        check(builtin.name, &load(builtin.name).unwrap());
        for parameter in builtin.parameters {
            for value in extremes(parameter.kind) {
                let spec = format!("{}:{}={value}", builtin.name, parameter.name);
                check(&spec, &load(&spec).unwrap_or_else(|e| panic!("{e}")));
            }
        }
    }
}

#[test]
fn every_parameter_has_a_default_in_its_range() {
    for parameter in builtins().iter().flat_map(|b| b.parameters) {
        let fits = match parameter.kind {
            ParameterKind::Integer { default, range } => (range.0..=range.1).contains(&default),
            ParameterKind::Number { default, range } => (range.0..=range.1).contains(&default),
            ParameterKind::Choice { options } => !options.is_empty(),
        };
        assert!(fits, "{}", parameter.name);
    }
}

#[test]
fn scenes_are_the_same_each_time_and_differ_by_seed() {
    let text = |spec: &str| format!("{:?}", load(spec).unwrap().description);
    assert_eq!(text("many-lights:n=50,seed=3"), text("many-lights: seed=3 , n=50"));
    assert_ne!(text("many-lights:n=50,seed=3"), text("many-lights:n=50,seed=4"));
    assert_eq!(text("sky:width=64"), text("sky:width=64"));
}

#[test]
fn many_lights_have_the_same_power_for_every_number() {
    let power = |n: u32| -> f64 {
        let scene = load(&format!("many-lights:n={n}")).unwrap();
        let lights = scene.description.objects.iter();
        let lights = lights.filter_map(|o| Some((o.emission.as_ref()?.values()[0], o.to_world.matrix3)));
        lights.map(|(e, m)| f64::from(e.b) * m.x_axis.length() * m.y_axis.length()).sum()
    };
    // The lights differ by up to 7 times in power; of thousands, the sum hardly differs.
    let (a, b) = (power(2000), power(16000));
    assert!((a / b - 1.0).abs() < 0.05, "{a} {b}");
}

#[test]
fn lights_face_what_they_light() {
    for name in ["cornell", "glass-caustic", "ring", "ajar-door", "many-lights"] {
        let scene = load(name).unwrap();
        for light in scene.description.objects.iter().filter(|o| o.emission.is_some()) {
            let down = light.to_world.matrix3.z_axis.normalize().dot(-DVec3::Y);
            assert!(down > 0.5, "{name}: {} faces {down}", light.name);
        }
    }
}

#[test]
fn plates_mirror_the_row_of_lights_into_the_eye() {
    let scene = load("veach-mis").unwrap().description;
    let eye = scene.camera.unwrap().to_world.translation;
    let plates: Vec<_> = scene.objects.iter().filter(|o| o.name.starts_with("plate")).collect();
    assert_eq!(plates.len(), 4);
    for plate in plates {
        let (middle, normal) = (plate.to_world.translation, plate.to_world.matrix3.z_axis.normalize());
        let towards_eye = (eye - middle).normalize();
        let mirrored = 2.0 * towards_eye.dot(normal) * normal - towards_eye;
        // The row of lights runs through (., 2.3, -1.2).
        let t = (-1.2 - middle.z) / mirrored.z;
        assert!((middle.y + t * mirrored.y - 2.3).abs() < 1e-9, "{}", plate.name);
    }
}
