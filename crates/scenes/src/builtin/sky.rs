//! Things of several materials under a sky with a small strong sun.

use super::{
    Builtin, Parameter, ParameterKind, Values,
    parts::{Stage, ggx, glass, rough_metal},
};
use crate::LoadedScene;
use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness},
    lights::environment::{Environment, Rows},
    material::Material,
    rgb::Rgb,
    texture::Bitmap,
};
use glam::{DMat3, DVec3, Vec2};
use std::{f64::consts::PI, sync::Arc};

pub(super) const BUILTIN: Builtin = Builtin {
    name: "sky",
    summary: "things of many materials under a sky image with a small strong sun: environment light",
    parameters: &[
        Parameter {
            name: "sun",
            summary: "irradiance of the sun over that of the sky, on the ground; 0 is an overcast day",
            kind: ParameterKind::Number { default: 2.0, range: (0.0, 1e3) },
        },
        Parameter {
            name: "elevation",
            summary: "height of the sun above the horizon, degrees",
            kind: ParameterKind::Number { default: 38.0, range: (5.0, 85.0) },
        },
        Parameter {
            name: "width",
            summary: "width of the sky's image in texels; it is half as high",
            kind: ParameterKind::Integer { default: 512, range: (64, 8192) },
        },
    ],
    build,
};

/// Angular radius of the sun, degrees: several times the real one, so that a 512 texel sky resolves it.
const SUN_RADIUS: f64 = 1.2;

/// Tests sampling of an image of light from all directions, where a few texels hold most of the power, and its joining with
/// the sampling of diffuse, glossy, anisotropic, smooth and rough dielectric surfaces.
fn build(values: &Values) -> LoadedScene {
    let mut stage = Stage::new("sky", DVec3::new(0.0, 2.3, 6.4), DVec3::new(0.0, 0.55, 0.0), 42.0);
    let ground = stage.lambert("ground", [0.42, 0.4, 0.36]);
    let chalk = stage.lambert("chalk", [0.78, 0.77, 0.74]);
    let tile = stage.lambert("tile", [0.6, 0.22, 0.12]);
    let copper = stage.material("copper", brushed_copper());
    let steel = stage.material("steel", rough_metal([0.68, 0.67, 0.65], 0.06));
    let glass = stage.material("glass", glass());
    let frosted = stage.material("frosted glass", Material::dielectric(1.5, Some(ggx(0.2))));
    stage.quad("ground", [[-25.0, 0.0, -25.0], [-25.0, 0.0, 25.0], [25.0, 0.0, 25.0], [25.0, 0.0, -25.0]], ground);
    stage.cuboid("wall", DVec3::new(0.2, 0.85, -2.2), DVec3::new(2.3, 0.85, 0.14), 4.0, chalk);
    stage.sphere("copper ball", DVec3::new(-1.75, 0.62, -0.3), 0.62, copper);
    stage.sphere("steel ball", DVec3::new(-0.35, 0.55, -0.75), 0.55, steel);
    stage.sphere("glass ball", DVec3::new(0.75, 0.5, 0.35), 0.5, glass);
    stage.sphere("frosted ball", DVec3::new(1.95, 0.56, -0.35), 0.56, frosted);
    stage.cuboid("tile block", DVec3::new(-0.62, 0.26, 1.1), DVec3::new(0.26, 0.26, 0.26), 33.0, tile);
    stage.description.environment = Some(Environment::LatLong {
        image: Arc::new(sky_image(values.integer("width"), values.number("elevation"), values.number("sun"))),
        scale: 1.0,
        to_world: DMat3::IDENTITY,
        rows: Rows::Centred,
    });
    stage.finish(12)
}

fn brushed_copper() -> Material {
    // Index of refraction of copper near 650, 550 and 450 nm, rounded.
    let fresnel =
        ConductorFresnel::Complex { eta: Rgb::new(0.21, 0.95, 1.16), k: Rgb::new(3.6, 2.58, 2.4), tint: Rgb::WHITE };
    let roughness = Roughness { distribution: Distribution::Ggx, alpha: Vec2::new(0.08, 0.3) };
    Material::conductor(fresnel, Some(roughness))
}

/// A blue sky over grey ground, with a sun that adds `sun` times the sky's irradiance on the ground.
pub(super) fn sky_image(width: u32, elevation: f64, sun: f64) -> Bitmap<Rgb> {
    let height = width / 2;
    let sun_direction =
        DVec3::new(-0.6, 0.0, 0.8) * elevation.to_radians().cos() + DVec3::Y * elevation.to_radians().sin();
    let cos_radius = SUN_RADIUS.to_radians().cos();
    let direction = |column: f64, row: f64| {
        let (phi, theta) = (column / f64::from(width) * 2.0 * PI, row / f64::from(height) * PI);
        DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos())
    };
    // Irradiance on the ground of the sky, and of a sun of radiance 1, from the texels themselves.
    let (mut sky_irradiance, mut sun_irradiance) = (0.0, 0.0);
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    let mut coverage = Vec::with_capacity(texels.capacity());
    for row in 0..height {
        let solid_angle = 2.0 * PI / f64::from(width)
            * ((f64::from(row) / f64::from(height) * PI).cos() - (f64::from(row + 1) / f64::from(height) * PI).cos());
        for column in 0..width {
            let d = direction(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let sky = sky_radiance(d.y);
            // The sun's edge is smoothed by 8 x 8 points a texel.
            let near = d.dot(sun_direction) > (SUN_RADIUS.to_radians() + 2.0 * PI / f64::from(height)).cos();
            let covered = if near {
                (0..64)
                    .filter(|i| {
                        let (i, j) = (f64::from(i % 8) + 0.5, f64::from(i / 8) + 0.5);
                        direction(f64::from(column) + i / 8.0, f64::from(row) + j / 8.0).dot(sun_direction) > cos_radius
                    })
                    .count() as f64
                    / 64.0
            } else {
                0.0
            };
            let cosine = d.y.max(0.0) * solid_angle;
            sky_irradiance += f64::from(sky.luminance()) * cosine;
            sun_irradiance += covered * cosine;
            texels.push(sky);
            coverage.push(covered as f32);
        }
    }
    // No texel of a coarse image may lie in the sun's disc by chance; then it has none.
    if sun_irradiance > 0.0 {
        let radiance = Rgb::new(1.1, 1.0, 0.8) * (sun * sky_irradiance / sun_irradiance) as f32;
        for (texel, covered) in texels.iter_mut().zip(&coverage) {
            *texel += radiance * *covered;
        }
    }
    Bitmap { width, height, texels }
}

/// The sky without its sun, by the sine of the elevation: bright at the horizon, deep blue above, grey below.
fn sky_radiance(y: f64) -> Rgb {
    let (horizon, zenith, below) = (Rgb::new(0.72, 0.8, 0.9), Rgb::new(0.16, 0.3, 0.62), Rgb::new(0.17, 0.16, 0.15));
    if y < 0.0 {
        return below;
    }
    let share = (1.0 - y).powi(3) as f32;
    zenith * (1.0 - share) + horizon * share
}

#[cfg(test)]
mod tests {
    use super::*;

    fn irradiance_up(image: &Bitmap<Rgb>) -> f64 {
        let (w, h) = (f64::from(image.width), f64::from(image.height));
        let mut sum = 0.0;
        for (i, texel) in image.texels.iter().enumerate() {
            let theta = ((i / image.width as usize) as f64 + 0.5) / h * PI;
            sum += f64::from(texel.luminance()) * theta.cos().max(0.0) * theta.sin() * (PI / h) * (2.0 * PI / w);
        }
        sum
    }

    #[test]
    fn the_sun_adds_the_irradiance_asked_for() {
        let overcast = irradiance_up(&sky_image(256, 40.0, 0.0));
        let sunny = irradiance_up(&sky_image(256, 40.0, 3.0));
        let colour = f64::from(Rgb::new(1.1, 1.0, 0.8).luminance());
        assert!((sunny / overcast - (1.0 + 3.0 * colour)).abs() < 1e-3, "{sunny} {overcast}");
    }

    #[test]
    fn every_width_and_elevation_has_its_sun() {
        for (width, elevation) in [(64, 5.0), (64, 85.0), (65, 38.0), (512, 85.0)] {
            let image = sky_image(width, elevation, 1.0);
            assert!(image.texels.iter().all(|t| t.is_valid()));
            let brightest = image.texels.iter().map(|t| t.luminance()).fold(0.0, f32::max);
            assert!(brightest > 10.0, "{width} {elevation}: {brightest}");
        }
    }
}
