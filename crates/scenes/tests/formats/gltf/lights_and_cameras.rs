//! Lights and cameras, and what stands in for them.

use super::{File, triangle};
use etendue_core::{camera::Projection, lights::environment::Environment, rgb::Rgb, scene::DeltaLight};
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// A triangle and a node.
fn with(node: Value, lists: Value) -> File {
    let mut file = triangle(json!({}));
    file.node(node);
    for (name, list) in lists.as_object().unwrap() {
        file.json[name] = list.clone();
    }
    file
}

fn light(light: Value) -> DeltaLight {
    let turned = json!([0, std::f64::consts::FRAC_1_SQRT_2, 0, std::f64::consts::FRAC_1_SQRT_2]);
    let file = with(
        json!({"translation": [1, 2, 3], "rotation": turned, "extensions": {"KHR_lights_punctual": {"light": 0}}}),
        json!({"extensions": {"KHR_lights_punctual": {"lights": [light]}}, "extensionsUsed": ["KHR_lights_punctual"]}),
    );
    let scene = file.scene();
    assert!(scene.description.environment.is_none());
    scene.description.lights[0].kind.clone()
}

#[test]
fn every_light_is_placed() {
    let DeltaLight::Point { position, intensity } =
        light(json!({"type": "point", "color": [1, 0.5, 0], "intensity": 8}))
    else {
        panic!()
    };
    assert_eq!((position, intensity), (DVec3::new(1.0, 2.0, 3.0), Rgb::new(8.0, 4.0, 0.0)));
    let DeltaLight::Directional { direction, irradiance } = light(json!({"type": "directional"})) else { panic!() };
    // -z, turned by a quarter about y.
    assert!((direction + DVec3::X).length() < 1e-6, "{direction}");
    assert_eq!(irradiance, Rgb::WHITE);
    let spot =
        json!({"type": "spot", "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}, "intensity": 3, "range": 9});
    let DeltaLight::Spot { position, direction, intensity, beam, cutoff, image } = light(spot) else { panic!() };
    assert_eq!((position, intensity, image), (DVec3::new(1.0, 2.0, 3.0), Rgb::splat(3.0), None));
    assert!((direction + DVec3::X).length() < 1e-6, "{direction}");
    assert_eq!((beam, cutoff), (0.25, 0.5));
    let wide = json!({"type": "spot", "spot": {"outerConeAngle": 1.570_796_4}});
    let DeltaLight::Spot { beam, cutoff, .. } = light(wide) else { panic!() };
    assert_eq!((beam, cutoff), (0.0, FRAC_PI_2));
}

#[test]
fn wrong_lights_are_refused() {
    let flaw = |light: Value| {
        with(
            json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}),
            json!({"extensions": {"KHR_lights_punctual": {"lights": [light]}}}),
        )
        .flaw()
    };
    assert!(flaw(json!({"type": "moon"})).contains("lights[0]"));
    assert!(flaw(json!({"type": "point", "color": [1e30, 0, 0], "intensity": 1e30})).contains("not finite"));
    let cones = json!({"innerConeAngle": 0.5, "outerConeAngle": 0.25});
    assert!(flaw(json!({"type": "spot", "spot": cones})).contains("its cones are 0.5 and 0.25"));
    let none = with(json!({"extensions": {"KHR_lights_punctual": {"light": 2}}}), json!({}));
    assert_eq!(none.flaw(), "lights[2] is asked for, and there are 0");
}

#[test]
fn cameras_look_along_minus_z() {
    let camera = json!({"type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 2, "znear": 0.1}});
    let node = json!({"camera": 0, "translation": [0, 0, 5], "scale": [2, 2, 2]});
    let file = with(node.clone(), json!({"cameras": [camera, camera]}));
    let camera = file.scene().description.camera.unwrap();
    assert_eq!(camera.resolution.to_array(), [1024, 512]);
    let Projection::Perspective { fov_x } = camera.projection else { panic!() };
    assert!(((0.5 * fov_x).tan() - 2.0 * 0.4f64.tan()).abs() < 1e-6, "{fov_x}");
    let to_world = camera.to_world;
    assert_eq!(to_world.translation, DVec3::Z * 5.0);
    assert_eq!(to_world.transform_vector3(DVec3::Z), -DVec3::Z);
    assert_eq!(to_world.transform_vector3(DVec3::Y), DVec3::Y);
    // Here x is to the left of the image.
    assert_eq!(to_world.transform_vector3(DVec3::X), -DVec3::X);

    let mut second = with(node, json!({"cameras": file.json["cameras"]}));
    second.node(json!({"camera": 1}));
    assert!(second.scene().notes.contains(&"the first of several cameras is taken".to_owned()));
}

#[test]
fn orthographic_cameras_are_read() {
    let camera = json!({"type": "orthographic", "orthographic": {"xmag": 1.5, "ymag": 3, "zfar": 10, "znear": 0}});
    let camera = with(json!({"camera": 0}), json!({"cameras": [camera]})).scene().description.camera.unwrap();
    assert_eq!(camera.projection, Projection::Orthographic { width: 3.0 });
    assert_eq!(camera.resolution.to_array(), [512, 1024]);
}

#[test]
fn wrong_cameras_are_refused() {
    let flaw = |camera: Value| with(json!({"camera": 0}), json!({"cameras": [camera]})).flaw();
    for camera in [
        json!({"type": "perspective"}),
        json!({"type": "fisheye"}),
        json!({"type": "perspective", "perspective": {"yfov": 0, "znear": 1}}),
        json!({"type": "perspective", "perspective": {"yfov": 4, "znear": 1}}),
        json!({"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": -1, "znear": 1}}),
        json!({"type": "orthographic", "orthographic": {"xmag": 0, "ymag": 1, "zfar": 1, "znear": 0}}),
    ] {
        assert!(flaw(camera.clone()).starts_with("cameras[0]"), "{camera}");
    }
    let flat = with(
        json!({"camera": 0, "scale": [1, 0, 0]}),
        json!({"cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]}),
    );
    assert!(flat.flaw().contains("gives it no direction"));
}

#[test]
fn without_a_camera_all_is_seen() {
    let mut file = triangle(json!({}));
    file.json["nodes"][0]["scale"] = json!([300, 20, 1]);
    file.node(json!({"mesh": 0, "translation": [-100, 50, 2000]}));
    let scene = file.scene();
    assert!(scene.notes.iter().any(|n| n.contains("no camera")));
    let camera = scene.description.camera.as_ref().unwrap();
    let Projection::Perspective { fov_x } = camera.projection else { panic!() };
    let aspect = f64::from(camera.resolution.x) / f64::from(camera.resolution.y);
    let to_camera: DAffine3 = camera.to_world.inverse();
    let corners = [[0.0, 0.0, 0.0], [300.0, 0.0, 0.0], [0.0, 20.0, 0.0], [-100.0, 50.0, 2000.0], [-99.0, 50.0, 2000.0]];
    let mut widest = 0f64;
    for corner in corners {
        let p = to_camera.transform_point3(DVec3::from(corner));
        let (x, y) = (p.x / p.z / (0.5 * fov_x).tan(), p.y / p.z / (0.5 * fov_x).tan() * aspect);
        assert!(p.z > 0.0 && x.abs() < 1.0 && y.abs() < 1.0, "{corner:?}: {x} {y}");
        widest = widest.max(x.abs()).max(y.abs());
    }
    assert!(widest > 0.7 && widest < 0.91, "{widest}");
    // From the front, above, and right.
    assert!(camera.to_world.transform_vector3(DVec3::Z).cmplt(DVec3::ZERO).all());
}

#[test]
fn without_a_light_the_environment_is_white() {
    let scene = triangle(json!({})).scene();
    assert!(matches!(scene.description.environment, Some(Environment::Constant(Rgb::WHITE))));
    assert!(scene.notes.iter().any(|n| n.contains("no light")));
    assert!(triangle(json!({"emissiveFactor": [1, 0, 0]})).scene().description.environment.is_none());
}

#[test]
fn a_scene_of_nothing_needs_a_camera() {
    assert_eq!(File::new().flaw(), "the scene has neither a camera nor surfaces to see");
    let mut file = File::new();
    file.node(json!({"camera": 0}));
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]);
    assert!(file.scene().notes.contains(&"the scene has no surfaces".to_owned()));
}
