//! A closed room whose walls all emit and reflect alike: the radiance is known.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{Stage, ggx, glass, grey, mirror, rough_metal},
};
use crate::{LoadedScene, cube::inward_cube};
use etendue_core::{material::Material, rgb::Rgb, scene::ObjectShape};
use glam::DVec3;

pub(super) const BUILTIN: Builtin = Builtin {
    name: "furnace",
    summary: "closed room that emits and reflects alike everywhere: the radiance is known exactly",
    parameters: &[
        Parameter {
            name: "reflectance",
            summary: "albedo of the walls",
            kind: ParameterKind::Number { default: 0.5, range: (0.0, 0.999) },
        },
        Parameter {
            name: "emission",
            summary: "radiance that the walls emit, W/(sr m²)",
            kind: ParameterKind::Number { default: 0.25, range: (0.0, 1e6) },
        },
        Parameter {
            name: "room",
            summary: "shape of the room: twelve triangles or an analytic sphere",
            kind: ParameterKind::Choice { options: &["box", "sphere"] },
        },
        Parameter {
            name: "material",
            summary: "what the walls are (lambert) or what a sphere in the middle of the room is",
            kind: ParameterKind::Choice {
                options: &["lambert", "conductor", "dielectric", "rough-conductor", "rough-dielectric"],
            },
        },
        Parameter {
            name: "alpha",
            summary: "GGX roughness of the rough materials",
            kind: ParameterKind::Number { default: 0.3, range: (1e-4, 1.0) },
        },
    ],
    build,
};

/// The radiance everywhere in a closed room whose walls emit `emission` and reflect the share `reflectance` diffusely:
/// paths of at most `max_depth` segments add up to `emission * (1 + reflectance + ... + reflectance^(max_depth - 1))`;
/// `u32::MAX` stands for no bound.
///
/// It holds in the scene `furnace` for `material=lambert`. A mirror or a glass ball in the room takes segments of a path
/// without loss, so that then it holds for paths without a bound only.
pub fn furnace_radiance(emission: f64, reflectance: f64, max_depth: u32) -> f64 {
    if reflectance == 1.0 {
        return emission * f64::from(max_depth);
    }
    // Summed as a geometric series; a bound that is no bound leaves nothing of the power.
    let left_out = if max_depth == u32::MAX { 0.0 } else { reflectance.powf(f64::from(max_depth)) };
    emission * (1.0 - left_out) / (1.0 - reflectance)
}

/// Tests energy: every pixel is [`furnace_radiance`]. A lossless ball in the room (smooth conductor of reflectance 1, smooth
/// dielectric) must vanish; a rough one shows what its single-scattering model loses. The room's mesh shares its vertices,
/// so that a ray that gets out is a fault of the intersection.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("furnace", DVec3::new(0.2, 0.1, 0.9), DVec3::ZERO, 60.0);
    let walls = stage.material("walls", Material::lambert(grey(values.number("reflectance"))));
    let room = match values.choice("room") {
        "sphere" => stage.sphere("room", DVec3::ZERO, 1.25, walls),
        _ => stage.mesh("room", inward_cube(1.25), walls),
    };
    if let ObjectShape::Sphere { inverted, .. } = &mut room.shape {
        *inverted = true;
    }
    room.emission = Some(grey(values.number("emission")));

    let alpha = values.number("alpha") as f32;
    let ball = match values.choice("material") {
        "conductor" => mirror([1.0; 3]),
        "dielectric" => glass(),
        "rough-conductor" => rough_metal(Rgb::WHITE.to_array(), alpha),
        "rough-dielectric" => Material::Dielectric { eta: 1.5, roughness: Some(ggx(alpha)) },
        _ => return stage.finish(64),
    };
    let ball = stage.material("ball", ball);
    stage.sphere("ball", DVec3::ZERO, 0.35, ball);
    // Light may go round inside the ball for long; roulette ends it without bias.
    stage.finish(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_is_the_truncated_series() {
        let sum = |depth| (0..depth).map(|i| 0.25 * 0.7f64.powi(i)).sum::<f64>();
        for depth in [1, 2, 3, 17] {
            let closed = furnace_radiance(0.25, 0.7, depth as u32);
            assert!((closed / sum(depth) - 1.0).abs() < 1e-14, "{depth}: {closed}");
        }
        assert_eq!(furnace_radiance(0.25, 0.5, u32::MAX), 0.5);
        assert_eq!(furnace_radiance(0.25, 0.0, 1), 0.25);
        assert_eq!(furnace_radiance(2.0, 1.0, 3), 6.0);
    }
}
