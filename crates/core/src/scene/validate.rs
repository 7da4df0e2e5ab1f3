//! What is refused before anything is placed: references, colours, materials, lights.

use super::{
    description::{DeltaLight, Object, SceneDescription},
    error::{Kind, Problem, SceneError},
    place::{check_transform, object_error},
};
use crate::{
    bsdf::{ConductorFresnel, Roughness},
    lights::Lights,
    material::Material,
    rgb::Rgb,
    texture::Texture,
};
use glam::DVec3;

/// Refuses what is wrong; the camera and the shapes are checked where they are placed.
pub(super) fn check(scene: &SceneDescription) -> Result<(), SceneError> {
    let item = |kind: Kind, name: &str| {
        let name = name.to_string();
        move |problem| SceneError::Item { kind, name, problem }
    };
    for material in &scene.materials {
        check_material(&material.material).map_err(item(Kind::Material, &material.name))?;
    }
    for object in &scene.objects {
        check_object(object, scene.materials.len()).map_err(|problem| object_error(object, problem))?;
    }
    for group in &scene.groups {
        for object in &group.objects {
            check_object(object, scene.materials.len()).map_err(|problem| object_error(object, problem))?;
            if object.emission.is_some_and(|e| !e.is_black()) {
                return Err(item(Kind::Group, &group.name)(Problem::EmitterInGroup(object.name.clone())));
            }
        }
    }
    for (index, instance) in scene.instances.iter().enumerate() {
        let error = item(Kind::Instance, &index.to_string());
        check_index("instance", index, "group", instance.group, scene.groups.len())
            .and_then(|()| check_transform(&instance.to_world))
            .map_err(error)?;
    }
    for light in &scene.lights {
        check_light(&light.kind).map_err(item(Kind::Light, &light.name))?;
    }
    if let Some(environment) = &scene.environment {
        environment.check().map_err(|e| item(Kind::Environment, &scene.name)(Problem::Other(e)))?;
    }
    let all = scene.objects.iter().chain(scene.groups.iter().flat_map(|g| &g.objects));
    let emitting = scene.objects.iter().filter(|o| o.emission.is_some_and(|e| !e.is_black()));
    let (primitives, lights) = (all.map(elements).sum(), emitting.map(elements).sum::<usize>() + scene.lights.len());
    // The hierarchy keeps three bits to tell leaves from nodes, and one for triangles that are cut in parts; one light may be
    // the environment.
    for (count, limit) in [(primitives, 1 << 28), (lights, Lights::LIMIT)] {
        if count >= limit {
            return Err(item(Kind::Object, &scene.name)(Problem::TooMany(count)));
        }
    }
    Ok(())
}

fn elements(object: &Object) -> usize {
    match &object.shape {
        super::ObjectShape::Mesh(mesh) => mesh.triangles.len(),
        super::ObjectShape::Cube => 12,
        super::ObjectShape::Rectangle => 2,
        super::ObjectShape::Sphere { .. } | super::ObjectShape::Disk => 1,
    }
}

fn check_index(what: &'static str, index: usize, target: &str, value: usize, count: usize) -> Result<(), Problem> {
    if value < count {
        Ok(())
    } else {
        Err(Problem::IndexOutOfRange { what, index, target: format!("{target} {value}"), count })
    }
}

fn check_object(object: &Object, materials: usize) -> Result<(), Problem> {
    check_index("it", 0, "material", object.material, materials)?;
    check_colour("emission", object.emission.unwrap_or(Rgb::BLACK), f32::MAX)
}

/// A colour is finite, not negative, and at most `most` in each component.
fn check_colour(what: &'static str, c: Rgb, most: f32) -> Result<(), Problem> {
    for (index, v) in c.to_array().into_iter().enumerate() {
        if !v.is_finite() {
            return Err(Problem::NotFinite { what, index });
        }
        if !(0.0..=most).contains(&v) {
            let expected = if most == 1.0 { "in [0, 1]" } else { "zero or positive" };
            return Err(Problem::OutOfRange { what, value: f64::from(v), expected });
        }
    }
    Ok(())
}

fn check_material(material: &Material) -> Result<(), Problem> {
    match material {
        Material::Lambert { reflectance } => check_texture(reflectance),
        Material::Conductor { fresnel, roughness } => {
            check_roughness(roughness)?;
            match fresnel {
                ConductorFresnel::Constant(c) => check_colour("reflectance", *c, 1.0),
                ConductorFresnel::Complex { eta, k, tint } => {
                    check_colour("index of refraction", *eta, f32::MAX)?;
                    check_colour("extinction", *k, f32::MAX)?;
                    check_colour("tint", *tint, 1.0)
                }
            }
        }
        Material::Dielectric { eta, roughness } => {
            check_roughness(roughness)?;
            let value = f64::from(*eta);
            if eta.is_finite() && *eta > 0.0 {
                Ok(())
            } else {
                Err(Problem::OutOfRange { what: "index of refraction", value, expected: "positive and finite" })
            }
        }
        Material::Mix { first, second, weight } => {
            if !(0.0..=1.0).contains(weight) {
                return Err(Problem::OutOfRange { what: "weight", value: f64::from(*weight), expected: "in [0, 1]" });
            }
            for member in [first, second] {
                if matches!(**member, Material::Mix { .. }) {
                    return Err(Problem::NestedMixture);
                }
                check_material(member)?;
            }
            Ok(())
        }
    }
}

fn check_texture(texture: &Texture) -> Result<(), Problem> {
    match texture {
        Texture::Constant(c) => check_colour("reflectance", *c, 1.0),
        Texture::Checkerboard { even, odd, scale } => {
            check_colour("reflectance", *even, 1.0)?;
            check_colour("reflectance", *odd, 1.0)?;
            if scale.is_finite() { Ok(()) } else { Err(Problem::NotFinite { what: "texture scale", index: 0 }) }
        }
        Texture::Bitmap(bitmap) => {
            let expected = bitmap.width as usize * bitmap.height as usize;
            if expected == 0 || bitmap.texels.len() != expected {
                let problem =
                    format!("its bitmap of {}x{} has {} texels", bitmap.width, bitmap.height, bitmap.texels.len());
                return Err(Problem::Other(problem));
            }
            bitmap.texels.iter().try_for_each(|c| check_colour("reflectance", *c, 1.0))
        }
    }
}

fn check_roughness(roughness: &Option<Roughness>) -> Result<(), Problem> {
    for alpha in roughness.iter().flat_map(|r| r.alpha.to_array()) {
        if !(1e-4..=1.0).contains(&alpha) {
            let expected = "in [0.0001, 1] (a smooth surface has no roughness)";
            return Err(Problem::OutOfRange { what: "roughness", value: f64::from(alpha), expected });
        }
    }
    Ok(())
}

fn check_vector(what: &'static str, v: DVec3) -> Result<(), Problem> {
    if v.is_finite() { Ok(()) } else { Err(Problem::NotFinite { what, index: 0 }) }
}

fn check_direction(v: DVec3) -> Result<(), Problem> {
    check_vector("direction", v)?;
    let value = v.length();
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Problem::OutOfRange { what: "length of the direction", value, expected: "positive and finite" })
    }
}

fn check_light(light: &DeltaLight) -> Result<(), Problem> {
    match light {
        DeltaLight::Point { position, intensity } => {
            check_vector("position", *position)?;
            check_colour("intensity", *intensity, f32::MAX)
        }
        DeltaLight::Spot { position, direction, intensity, beam, cutoff } => {
            check_vector("position", *position)?;
            check_direction(*direction)?;
            check_colour("intensity", *intensity, f32::MAX)?;
            if !(*cutoff > 0.0 && *cutoff <= std::f64::consts::PI) {
                return Err(Problem::OutOfRange { what: "cutoff angle", value: *cutoff, expected: "in (0, pi]" });
            }
            if !(0.0..=*cutoff).contains(beam) {
                return Err(Problem::OutOfRange { what: "beam angle", value: *beam, expected: "in [0, cutoff]" });
            }
            Ok(())
        }
        DeltaLight::Directional { direction, irradiance } => {
            check_direction(*direction)?;
            check_colour("irradiance", *irradiance, f32::MAX)
        }
    }
}
