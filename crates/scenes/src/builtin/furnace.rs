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

/// A closed room in which the radiance is the same everywhere: its walls emit and reflect alike, and nothing else is in it
/// but what loses no light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Furnace {
    /// Radiance that the walls emit.
    pub emission: f64,
    /// Albedo of the walls, which are diffuse.
    pub reflectance: f64,
    /// Whether something in the room takes segments of a path without loss, so that a bound on their number counts.
    pub has_ball: bool,
}

impl Furnace {
    /// The radiance that paths of at most `max_depth` segments add up to, `emission * (1 + reflectance + ... +
    /// reflectance^(max_depth - 1))`; `u32::MAX` stands for no bound. `None` where that is not known: with something in the
    /// room and a bound.
    pub fn radiance(&self, max_depth: u32) -> Option<f64> {
        let Furnace { emission, reflectance, has_ball } = *self;
        if has_ball && max_depth != u32::MAX {
            return None;
        }
        if reflectance == 1.0 {
            return Some(emission * f64::from(max_depth));
        }
        // Summed as a geometric series; a bound that is no bound leaves nothing of the power.
        let left_out = if max_depth == u32::MAX { 0.0 } else { reflectance.powf(f64::from(max_depth)) };
        Some(emission * (1.0 - left_out) / (1.0 - reflectance))
    }
}

/// Tests energy: every pixel is [`Furnace::radiance`]. A lossless ball in the room (smooth conductor of reflectance 1, smooth
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
    room.emission = Some(grey(values.number("emission")).into());

    let furnace =
        |has_ball| Furnace { emission: values.number("emission"), reflectance: values.number("reflectance"), has_ball };
    let alpha = values.number("alpha") as f32;
    let (ball, exact) = match values.choice("material") {
        "conductor" => (mirror([1.0; 3]), Some(furnace(true))),
        "dielectric" => (glass(), Some(furnace(true))),
        "rough-conductor" => (rough_metal(Rgb::WHITE.to_array(), alpha), None),
        "rough-dielectric" => (Material::dielectric(1.5, Some(ggx(alpha))), None),
        _ => return LoadedScene { exact: Some(furnace(false)), ..stage.finish(64) },
    };
    let ball = stage.material("ball", ball);
    stage.sphere("ball", DVec3::ZERO, 0.35, ball);
    // Light may go round inside the ball for long; roulette ends it without bias.
    LoadedScene { exact, ..stage.finish(u32::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_is_the_truncated_series() {
        let sum = |depth| (0..depth).map(|i| 0.25 * 0.7f64.powi(i)).sum::<f64>();
        let room = |emission, reflectance| Furnace { emission, reflectance, has_ball: false };
        for depth in [1, 2, 3, 17] {
            let closed = room(0.25, 0.7).radiance(depth as u32).expect("known");
            assert!((closed / sum(depth) - 1.0).abs() < 1e-14, "{depth}: {closed}");
        }
        assert_eq!(room(0.25, 0.5).radiance(u32::MAX), Some(0.5));
        assert_eq!(room(0.25, 0.0).radiance(1), Some(0.25));
        assert_eq!(room(2.0, 1.0).radiance(3), Some(6.0));
        assert_eq!(Furnace { has_ball: true, ..room(0.25, 0.5) }.radiance(3), None);
    }
}
