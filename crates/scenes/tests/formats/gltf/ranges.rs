//! Numbers outside of the ranges that the format gives them: a note or an error, and never silence.

use super::triangle;
use serde_json::{Value, json};

/// A material in which the number at a path of names is `value`.
fn with(path: &str, value: f64) -> Value {
    let (mut material, names) = (json!({}), path.split('/'));
    let mut at = &mut material;
    let names: Vec<&str> = names.collect();
    for (i, name) in names.iter().enumerate() {
        let last = i + 1 == names.len();
        at[*name] = match (last, *name) {
            (true, n) if n.ends_with("ColorFactor") && n.starts_with("base") => json!([value, 0.5, 0.5, 1.0]),
            (true, n) if n.ends_with("Color") || n.ends_with("ColorFactor") || n == "emissiveFactor" => {
                json!([value, 0.5, 0.5])
            }
            (true, _) => json!(value),
            (false, _) => json!({}),
        };
        at = &mut at[*name];
    }
    // What the extensions under test work on.
    if path.contains("volume") {
        material["extensions"]["KHR_materials_transmission"] = json!({"transmissionFactor": 1.0});
    }
    if path.contains("attenuation") {
        material["extensions"]["KHR_materials_volume"]["thicknessFactor"] = json!(1.0);
    }
    if path.contains("alphaCutoff") {
        material["alphaMode"] = json!("MASK");
    }
    material
}

#[test]
fn numbers_of_materials_out_of_range_are_told() {
    for (path, wrong, right) in [
        ("pbrMetallicRoughness/baseColorFactor", &[-0.5, 1.8][..], 0.3),
        ("pbrMetallicRoughness/metallicFactor", &[-1.0, 2.0], 1.0),
        ("pbrMetallicRoughness/roughnessFactor", &[-1.0, 2.0], 0.0),
        ("emissiveFactor", &[-1.0, 1.5], 1.0),
        ("alphaCutoff", &[-0.1], 0.0),
        ("extensions/KHR_materials_emissive_strength/emissiveStrength", &[-1.0], 7.0),
        ("extensions/KHR_materials_ior/ior", &[0.5, -1.0], 0.0),
        ("extensions/KHR_materials_transmission/transmissionFactor", &[-0.1, 1.1], 1.0),
        ("extensions/KHR_materials_volume/attenuationColor", &[-0.1, 1.1], 0.5),
        ("extensions/KHR_materials_volume/attenuationDistance", &[-1.0, 0.0], 2.0),
        ("extensions/KHR_materials_volume/thicknessFactor", &[-1.0], 2.0),
        ("extensions/KHR_materials_clearcoat/clearcoatFactor", &[-0.1, 1.1], 0.0),
        ("extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", &[-0.1, 1.1], 1.0),
        ("extensions/KHR_materials_sheen/sheenColorFactor", &[-0.1, 1.1], 0.0),
    ] {
        let name = path.rsplit('/').next().unwrap();
        let told = |value: f64| {
            let file = triangle(with(path, value));
            match etendue_scenes::gltf::read(&file.text()) {
                Ok(scene) => {
                    let forms = [format!(" {name} of "), format!(" {name} above")];
                    scene.notes.iter().any(|note| forms.iter().any(|form| note.contains(form)))
                }
                Err(flaw) => flaw.message.contains("negative"),
            }
        };
        for value in wrong {
            assert!(told(*value), "{path} {value} is silent");
        }
        assert!(!told(right), "{path} {right} is told");
    }
}

#[test]
fn lights_out_of_range_are_told() {
    let flaw = |light: Value| {
        let mut file = triangle(json!({}));
        file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
        file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        file.node(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
        file
    };
    for light in [
        json!({"type": "point", "intensity": -5.0}),
        json!({"type": "point", "color": [1.0, -0.5, 0.0]}),
        json!({"type": "spot", "spot": {"innerConeAngle": 0.9, "outerConeAngle": 0.5}}),
    ] {
        let message = flaw(light.clone()).flaw();
        assert!(message.starts_with("lights[0]: its "), "{light}: {message}");
    }
    for light in
        [json!({"type": "point", "color": [1.5, 1.0, 1.0]}), json!({"type": "spot", "spot": {"outerConeAngle": 2.0}})]
    {
        let notes = flaw(light.clone()).scene().notes;
        assert!(notes.iter().any(|n| n.starts_with("lights[0]: its ")), "{light}: {notes:?}");
    }
}

/// A file may say that its readers need a newer version.
#[test]
fn a_newer_reader_may_be_asked_for() {
    let mut file = triangle(json!({}));
    file.json["asset"]["minVersion"] = json!("2.0");
    file.scene();
    file.json["asset"]["minVersion"] = json!("2.1");
    assert_eq!(file.flaw(), "the file asks for a reader of glTF 2.1; this one is of 2.0");
}
