//! Caustics on glossy surfaces.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{Stage, ggx, glass, grey, mirror, rough_metal},
};
use crate::LoadedScene;
use etendue_core::{bsdf::Distribution, material::Material, rgb::Rgb};
use glam::DVec3;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "glossy-caustic",
    summary: "glass and mirror balls over a glossy metal and a glossy plastic plate: caustics that depend on where they are seen from",
    parameters: &[Parameter {
        name: "roughness",
        summary: "GGX roughness of the plates; up to 0.15 they take no photons",
        kind: ParameterKind::Number { default: 0.3, range: (0.05, 1.0) },
    }],
    build,
};

/// Tests estimates of light on surfaces that scatter in some directions more than in others.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("glossy-caustic", DVec3::new(0.0, 2.5, 4.0), DVec3::new(0.0, 0.1, 0.0), 34.0);
    let alpha = values.number("roughness") as f32;
    let wall = stage.lambert("wall", [0.45, 0.47, 0.5]);
    let dark = stage.lambert("dark", [0.0; 3]);
    let metal = stage.material("metal", rough_metal([0.85, 0.66, 0.4], alpha));
    let plastic = stage.material(
        "plastic",
        Material::Plastic {
            eta: 1.5,
            diffuse: Rgb::new(0.1, 0.2, 0.32).into(),
            specular: Rgb::WHITE.into(),
            nonlinear: false,
            roughness: Some((Distribution::Ggx, ggx(alpha).alpha.x)),
        },
    );
    let glass = stage.material("glass", glass());
    let silver = stage.material("silver", mirror([0.95, 0.95, 0.94]));
    stage.quad("metal plate", [[-2.6, 0.0, -2.6], [-2.6, 0.0, 2.6], [0.0, 0.0, 2.6], [0.0, 0.0, -2.6]], metal);
    stage.quad("plastic plate", [[0.0, 0.0, -2.6], [0.0, 0.0, 2.6], [2.6, 0.0, 2.6], [2.6, 0.0, -2.6]], plastic);
    stage.quad("back wall", [[-2.6, 0.0, -2.6], [2.6, 0.0, -2.6], [2.6, 2.2, -2.6], [-2.6, 2.2, -2.6]], wall);
    stage.sphere("glass ball, left", DVec3::new(-0.75, 0.5, 0.35), 0.36, glass);
    stage.sphere("glass ball, right", DVec3::new(0.75, 0.5, 0.35), 0.36, glass);
    stage.sphere("mirror ball, left", DVec3::new(-0.7, 0.4, -0.95), 0.4, silver);
    stage.sphere("mirror ball, right", DVec3::new(0.7, 0.4, -0.95), 0.4, silver);
    let (place, aim) = (DVec3::new(0.0, 3.6, -0.6), DVec3::new(0.0, 0.0, 0.1));
    let normal = (aim - place).normalize();
    let u = DVec3::X * 0.12;
    let light = stage.rectangle("light", place, u, normal.cross(u), dark);
    light.emission = Some(grey(900.0).into());
    stage.finish(12)
}
