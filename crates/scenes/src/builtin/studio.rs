//! Things of several materials on a table, lit by a high-dynamic-range image of a studio.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{Stage, ggx, glass, rough_metal},
};
use crate::LoadedScene;
use etendue_core::{
    bsdf::{ConductorFresnel, Distribution},
    lights::environment::{Environment, Rows},
    material::Material,
    rgb::Rgb,
    texture::Bitmap,
};
use glam::{DMat3, DVec3};
use std::{f64::consts::PI, sync::Arc};

pub(super) const BUILTIN: Builtin = Builtin {
    name: "studio",
    summary: "glass, metals and plastic under a high-dynamic-range image of a studio: caustics of an environment",
    parameters: &[
        Parameter {
            name: "spot",
            summary: "irradiance on the table of the image's one small lamp over that of all the rest",
            kind: ParameterKind::Number { default: 1.0, range: (0.0, 1e3) },
        },
        Parameter {
            name: "width",
            summary: "width of the image in texels; it is half as high",
            kind: ParameterKind::Integer { default: 512, range: (64, 2048) },
        },
    ],
    build,
};

/// A lamp in the image: where its middle is seen (not unit length), half its extents in radians, and its radiance.
struct Panel {
    towards: DVec3,
    half: (f64, f64),
    radiance: Rgb,
}

/// Two soft boxes, one cold and one warm, and a strip light behind.
const PANELS: [Panel; 3] = [
    Panel { towards: DVec3::new(-0.9, 0.8, 0.35), half: (0.30, 0.22), radiance: Rgb::new(4.2, 4.8, 5.6) },
    Panel { towards: DVec3::new(1.0, 0.45, 0.5), half: (0.16, 0.30), radiance: Rgb::new(5.4, 4.0, 2.6) },
    Panel { towards: DVec3::new(0.1, 0.7, -1.0), half: (0.55, 0.05), radiance: Rgb::new(9.0, 9.0, 9.0) },
];

/// Where the small lamp is seen, and half its extent in radians.
const SPOT: (DVec3, f64) = (DVec3::new(0.55, 1.0, 0.75), 0.028);

/// Tests caustics of light from infinity: a small strong lamp, and soft ones, all of them texels of an image.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("studio", DVec3::new(0.0, 1.9, 4.0), DVec3::new(0.0, 0.35, 0.0), 38.0);
    let table = stage.lambert("table", [0.52, 0.5, 0.47]);
    let chalk = stage.lambert("chalk", [0.72, 0.7, 0.66]);
    let gold = ConductorFresnel::Complex {
        // Gold near 650, 550 and 450 nm, rounded.
        eta: Rgb::new(0.16, 0.36, 1.47),
        k: Rgb::new(3.48, 2.66, 1.95),
        tint: Rgb::WHITE,
    };
    let gold = stage.material("gold", Material::conductor(gold, Some(ggx(0.05))));
    let silver = stage.material("silver", rough_metal([0.92, 0.91, 0.88], 0.25));
    let glass = stage.material("glass", glass());
    let plastic = stage.material(
        "plastic",
        Material::Plastic {
            eta: 1.5,
            diffuse: Rgb::new(0.1, 0.28, 0.55).into(),
            specular: Rgb::WHITE.into(),
            nonlinear: false,
            roughness: Some((Distribution::Ggx, 0.1)),
        },
    );
    stage.quad("table", [[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]], table);
    stage.sphere("glass ball", DVec3::new(0.1, 0.38, 0.55), 0.38, glass);
    stage.sphere("gold ball", DVec3::new(-0.85, 0.42, 0.0), 0.42, gold);
    stage.sphere("plastic ball", DVec3::new(0.95, 0.4, -0.1), 0.4, plastic);
    stage.cuboid("silver block", DVec3::new(0.05, 0.3, -0.65), DVec3::new(0.3, 0.3, 0.3), 28.0, silver);
    stage.cuboid("chalk block", DVec3::new(0.75, 0.14, 0.75), DVec3::splat(0.14), -20.0, chalk);
    stage.description.environment = Some(Environment::LatLong {
        image: Arc::new(studio_image(values.integer("width"), values.number("spot"))),
        scale: 1.0,
        to_world: DMat3::IDENTITY,
        rows: Rows::Centred,
    });
    stage.finish(12)
}

/// A panel as an image is made of it: a rectangle in the plane that faces the table.
struct Rectangle {
    normal: DVec3,
    right: DVec3,
    up: DVec3,
    /// Half its extents on the plane at distance 1.
    half: (f64, f64),
    /// Angle of the cone around it.
    cone: f64,
}

impl Rectangle {
    fn new(towards: DVec3, (width, height): (f64, f64)) -> Rectangle {
        let normal = towards.normalize();
        let right = DVec3::Y.cross(normal).normalize();
        let half = (width.tan(), height.tan());
        Rectangle { normal, right, up: normal.cross(right), half, cone: half.0.hypot(half.1).atan() }
    }

    fn contains(&self, direction: DVec3) -> bool {
        let along = direction.dot(self.normal);
        along > 0.0
            && (direction.dot(self.right) / along).abs() < self.half.0
            && (direction.dot(self.up) / along).abs() < self.half.1
    }

    /// The share of a texel's 8 x 8 points that lie inside; no point is further from the one in the middle than `radius`.
    fn covered(&self, point: impl Fn(f64, f64) -> DVec3, radius: f64) -> f32 {
        let middle = point(0.5, 0.5).dot(self.normal).clamp(-1.0, 1.0).acos();
        if middle > self.cone + radius {
            return 0.0;
        }
        let at = |i: u32| (f64::from(i) + 0.5) / 8.0;
        (0..64).filter(|i| self.contains(point(at(i % 8), at(i / 8)))).count() as f32 / 64.0
    }
}

/// A dim room with soft boxes, and a small lamp that adds `spot` times their irradiance on the table.
fn studio_image(width: u32, spot: f64) -> Bitmap<Rgb> {
    let height = width / 2;
    let direction = |column: f64, row: f64| {
        let (phi, theta) = (column / f64::from(width) * 2.0 * PI, row / f64::from(height) * PI);
        DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos())
    };
    let panels = PANELS.map(|panel| (Rectangle::new(panel.towards, panel.half), panel.radiance));
    let (lamp, lamp_radiance) = (Rectangle::new(SPOT.0, (SPOT.1, SPOT.1)), Rgb::new(1.0, 0.93, 0.82));
    // Half a texel's diagonal at the horizon, where texels are largest.
    let radius = (PI / f64::from(width)).hypot(0.5 * PI / f64::from(height));
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    let mut lit = Vec::with_capacity(texels.capacity());
    // Irradiance on the table of all but the lamp, and of a lamp of radiance 1.
    let (mut rest, mut one) = (0.0, 0.0);
    for row in 0..height {
        let (top, bottom) = (f64::from(row) / f64::from(height) * PI, f64::from(row + 1) / f64::from(height) * PI);
        let solid_angle = 2.0 * PI / f64::from(width) * (top.cos() - bottom.cos());
        for column in 0..width {
            let point = |u: f64, v: f64| direction(f64::from(column) + u, f64::from(row) + v);
            let y = point(0.5, 0.5).y;
            // Walls grow darker upwards, under a grey ceiling; below the table is a dark floor.
            let wall = if y < 0.0 { 0.05 } else { 0.16 - 0.1 * y };
            let mut texel = Rgb::splat(wall as f32);
            for (panel, radiance) in &panels {
                texel += *radiance * panel.covered(point, radius);
            }
            let share = lamp.covered(point, radius);
            rest += f64::from(texel.luminance()) * y.max(0.0) * solid_angle;
            one += f64::from(lamp_radiance.luminance() * share) * y.max(0.0) * solid_angle;
            texels.push(texel);
            lit.push(share);
        }
    }
    // No point of a coarse image may lie in the lamp by chance; then it has none.
    if one > 0.0 {
        let radiance = lamp_radiance * (spot * rest / one) as f32;
        texels.iter_mut().zip(&lit).for_each(|(texel, share)| *texel += radiance * *share);
    }
    Bitmap { width, height, texels }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn irradiance_up(image: &Bitmap<Rgb>) -> f64 {
        let (w, h) = (f64::from(image.width), f64::from(image.height));
        let texel = |(i, texel): (usize, &Rgb)| {
            let theta = ((i / image.width as usize) as f64 + 0.5) / h * PI;
            f64::from(texel.luminance()) * theta.cos().max(0.0) * theta.sin() * (PI / h) * (2.0 * PI / w)
        };
        image.texels.iter().enumerate().map(texel).sum()
    }

    #[test]
    fn the_lamp_adds_the_irradiance_asked_for() {
        let without = irradiance_up(&studio_image(256, 0.0));
        for spot in [0.5, 4.0] {
            let with = irradiance_up(&studio_image(256, spot));
            assert!((with / without - (1.0 + spot)).abs() < 1e-3 * (1.0 + spot), "{with} {without}");
        }
    }

    #[test]
    fn every_width_has_its_lamp_and_its_panels() {
        for width in [64, 65, 512] {
            let image = studio_image(width, 1.0);
            assert!(image.texels.iter().all(|t| t.is_valid()));
            let brightest = image.texels.iter().map(|t| t.luminance()).fold(0.0, f32::max);
            assert!(brightest > 50.0, "{width}: {brightest}");
            let of_panels = image.texels.iter().filter(|t| t.luminance() > 3.0).count() as f64;
            assert!(of_panels > 0.01 * image.texels.len() as f64, "{width}: {of_panels}");
        }
    }
}
