//! Four metal plates of growing roughness that reflect lights of growing size.

use super::{
    Builtin, Values,
    parts::{Stage, grey, rough_metal},
};
use crate::LoadedScene;
use etendue_core::rgb::Rgb;
use glam::DVec3;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "veach-mis",
    summary: "four GGX plates, rough to smooth, reflect spheres, tiny to large: multiple importance sampling",
    parameters: &[],
    build,
};

/// Tests multiple importance sampling, in the spirit of [Veach 1997, fig. 9.2]: sampling the light wins where a small light
/// meets a rough plate, sampling the plate wins where a large light meets a smooth one.
fn build(_: &Values) -> LoadedScene {
    let eye = DVec3::new(0.0, 1.5, 11.0);
    let mut stage = Stage::new("veach-mis", eye, DVec3::new(0.0, 0.45, 0.0), 38.0);
    let matt = stage.lambert("matt", [0.42, 0.41, 0.4]);
    let dark = stage.lambert("dark", [0.0; 3]);
    stage.quad("floor", [[-12.0, -1.9, -4.0], [-12.0, -1.9, 12.0], [12.0, -1.9, 12.0], [12.0, -1.9, -4.0]], matt);
    stage.quad("back wall", [[-12.0, -1.9, -4.0], [12.0, -1.9, -4.0], [12.0, 9.0, -4.0], [-12.0, 9.0, -4.0]], matt);

    // Each plate is turned so that its middle mirrors the row of lights into the eye.
    let row = DVec3::new(0.0, 2.3, -1.2);
    let plates = [(0.4, 0.35, 0.004), (1.7, -0.3, 0.02), (3.0, -0.8, 0.06), (4.3, -1.15, 0.15)];
    for (i, (z, y, alpha)) in plates.into_iter().enumerate() {
        let middle = DVec3::new(0.0, y, z);
        let normal = ((eye - middle).normalize() + (row - middle).normalize()).normalize();
        let metal = stage.material(&format!("metal {i}"), rough_metal([0.92, 0.93, 0.95], alpha));
        stage.rectangle(&format!("plate {i}"), middle, DVec3::X * 3.1, normal.cross(DVec3::X) * 0.48, metal);
    }

    // All four send out the same power, so that radiance goes as one over the radius squared.
    let lights = [
        (-3.15, 0.03, [1.0, 0.75, 0.5]),
        (-1.25, 0.12, [0.85, 1.0, 0.55]),
        (0.9, 0.35, [0.5, 0.9, 1.0]),
        (3.3, 0.85, [0.8, 0.65, 1.0]),
    ];
    for (i, (x, radius, colour)) in lights.into_iter().enumerate() {
        let light = stage.sphere(&format!("light {i}"), row + DVec3::X * x, radius, dark);
        light.emission = Some((Rgb::from(colour) * (1.0 / (radius * radius)) as f32).into());
    }
    stage.sphere("fill light", DVec3::new(6.0, 8.0, 9.0), 0.7, dark).emission = Some(grey(95.0).into());
    stage.finish(10)
}
