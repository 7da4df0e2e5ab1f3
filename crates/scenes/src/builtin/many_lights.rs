//! Many small lights over a field of boxes.

use super::{Builtin, Parameter, ParameterKind, Values, parts::Stage};
use crate::LoadedScene;
use etendue_core::rgb::Rgb;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "many-lights",
    summary: "n small lights over boxes: choosing the light that matters here",
    parameters: &[
        Parameter {
            name: "n",
            summary: "number of lights; their power together stays the same",
            kind: ParameterKind::Integer { default: 1024, range: (1, 1 << 20) },
        },
        Parameter {
            name: "seed",
            summary: "which arrangement",
            kind: ParameterKind::Integer { default: 1, range: (0, u32::MAX) },
        },
    ],
    build,
};

/// Tests the choice among lights: each point is lit by a few of them, and a technique that chooses by power alone wastes
/// nearly all of its shadow rays. The lights are tilted, coloured and one-sided, so that distance is not all that counts.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("many-lights", DVec3::new(0.0, 6.4, 7.6), DVec3::new(0.0, 0.3, 0.6), 48.0);
    let ground = stage.lambert("ground", [0.5, 0.5, 0.48]);
    let boxes = [
        stage.lambert("clay", [0.62, 0.4, 0.28]),
        stage.lambert("slate", [0.3, 0.36, 0.42]),
        stage.lambert("chalk", [0.76, 0.75, 0.71]),
    ];
    let dark = stage.lambert("dark", [0.0; 3]);
    stage.quad("ground", [[-16.0, 0.0, -16.0], [-16.0, 0.0, 16.0], [16.0, 0.0, 16.0], [16.0, 0.0, -16.0]], ground);

    let n = values.integer("n");
    let mut rng = Pcg64::seed_from_u64(u64::from(values.integer("seed")));
    let mut uniform = move |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
    for row in 0..11u32 {
        for column in 0..11u32 {
            let (x, z) = (f64::from(column) - 5.0 + uniform(-0.15, 0.15), f64::from(row) - 5.0 + uniform(-0.15, 0.15));
            let half = DVec3::new(uniform(0.14, 0.28), uniform(0.1, 0.45), uniform(0.14, 0.28));
            let material = boxes[(row * 11 + column) as usize % boxes.len()];
            let name = format!("box {row} {column}");
            stage.cuboid(&name, DVec3::new(x, half.y, z), half, uniform(0.0, 90.0), material);
        }
    }

    // Lights that share a volume shrink as they grow in number, so that they stay apart.
    let half = 0.2 / f64::from(n).cbrt();
    let radiance = 42.0 / (half * half * f64::from(n));
    for i in 0..n {
        let place = DVec3::new(uniform(-5.5, 5.5), uniform(1.2, 2.6), uniform(-5.5, 5.5));
        // Downwards, tilted by at most about 45 degrees.
        let normal = DVec3::new(uniform(-0.7, 0.7), -1.0, uniform(-0.7, 0.7)).normalize();
        let u = normal.cross(DVec3::Z).normalize();
        let hue = uniform(0.0, 1.0);
        let light = stage.rectangle(&format!("light {i}"), place, u * half, normal.cross(u) * half, dark);
        let colour = Rgb::new(1.0, 0.75 + 0.2 * hue as f32, 0.5 + 0.5 * hue as f32);
        light.emission = Some((colour * (radiance * (0.25 + 1.5 * uniform(0.0, 1.0))) as f32).into());
    }
    stage.finish(8)
}
