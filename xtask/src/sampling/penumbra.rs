//! Images of the penumbra of three lights, 4 samples a pixel times 16 of the light, against quadrature.

use super::{Measured, Study, index_of};
use crate::{error::Error, picture::Picture};
use etendue_core::{rgb::Rgb, sampler::Purpose, statistics::moments::Moments};
use etendue_sampling::{integrands::LightShape, pattern::Pattern};
use glam::{DVec2, UVec2};
use rayon::prelude::*;
use serde::Serialize;

/// Pixels along a side, and with less than as many trials.
const SIDE: u32 = 64;
const SMALL_SIDE: u32 = 16;
/// Samples of a pixel, and of the light for each.
pub const SAMPLES: (u32, u32) = (4, 16);
/// Steps of this part.
pub const STEPS: u32 = 3 * (Pattern::ALL.len() as u32 + 1);
/// The floor that is seen, metres along a side, about the origin.
const FLOOR: f64 = 0.6;
/// Images with other seeds that the errors are over, unless there are fewer trials.
const IMAGES: u32 = 8;

/// A pattern's error on the image of a light.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The light's shape.
    pub light: &'static str,
    /// The pattern.
    pub pattern: &'static str,
    /// Mean squared error of a pixel, relative to the squared brightness of the open floor.
    pub error: Measured,
    /// The same of 4 x 4 pixels together: what is left when the image is seen from afar.
    pub blurred: Measured,
}

/// The images of a light.
pub struct Penumbra {
    /// The light's shape.
    pub light: &'static str,
    /// By quadrature.
    pub truth: Picture,
    /// By pattern.
    pub pictures: Vec<Picture>,
    /// Their errors.
    pub rows: Vec<Row>,
}

pub(super) fn measure(study: &Study) -> Result<Vec<Penumbra>, Error> {
    LightShape::ALL.into_iter().map(|shape| of(study, shape)).collect()
}

fn of(study: &Study, shape: LightShape) -> Result<Penumbra, Error> {
    let light = match shape {
        LightShape::Linear => "linear",
        LightShape::Square => "square",
        LightShape::Round => "round",
    };
    study.step(&format!("{light} light by quadrature"))?;
    let pixels_along = if study.trials < SIDE { SMALL_SIDE } else { SIDE };
    let side = FLOOR / f64::from(pixels_along);
    let corner = |pixel: UVec2| side * pixel.as_dvec2() - 0.5 * FLOOR;
    let pixels =
        || (0..pixels_along * pixels_along).into_par_iter().map(|i| UVec2::new(i % pixels_along, i / pixels_along));
    let truth: Vec<f64> = pixels().map(|p| shape.pixel_irradiance(corner(p), side)).collect();
    let open = truth.iter().copied().fold(0.0, f64::max);
    let (mut pictures, mut rows) = (Vec::new(), Vec::new());
    for pattern in Pattern::ALL {
        study.step(&format!("{light} light by {}", pattern.name()))?;
        let (mut error, mut blurred) = (Moments::default(), Moments::default());
        for image in 0..u64::from(IMAGES.min(study.trials)) {
            let part = 2 << 48 | index_of(pattern) << 32 | shape as u64;
            let seeds = [0, 1].map(|i| study.seed(part, 2 * image + i));
            let estimate: Vec<f64> = pixels().map(|p| pixel(shape, pattern, seeds, p, corner(p), side)).collect();
            let errors: Vec<f64> = estimate.iter().zip(&truth).map(|(e, t)| (e - t) / open).collect();
            error.push(errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64);
            blurred.push(blur(&errors, pixels_along));
            if image == 0 {
                pictures.push(picture(&estimate, pixels_along, open));
            }
        }
        let (error, blurred) = (Measured::of(&error), Measured::of(&blurred));
        rows.push(Row { light, pattern: pattern.name(), error, blurred });
    }
    Ok(Penumbra { light, truth: picture(&truth, pixels_along, open), pictures, rows })
}

/// A pixel's estimate: each of its samples has a pattern of its own on the light.
fn pixel(shape: LightShape, pattern: Pattern, seeds: [u64; 2], pixel: UVec2, corner: DVec2, side: f64) -> f64 {
    let (film, light) = SAMPLES;
    let (mut film_sampler, mut light_sampler) = (pattern.sampler()(seeds[0], film), pattern.sampler()(seeds[1], light));
    let mut sum = 0.0;
    for f in 0..film {
        film_sampler.start_pixel(pixel, SIDE, f);
        let point = corner + side * film_sampler.get_2d(0, Purpose::Film).as_dvec2();
        for l in 0..light {
            light_sampler.start_pixel(pixel, SIDE, f * light + l);
            sum += shape.sample(point, light_sampler.get_2d(1, Purpose::LightPoint).as_dvec2());
        }
    }
    sum / f64::from(film * light)
}

/// Mean square of the means of blocks of 4 x 4.
fn blur(errors: &[f64], side: u32) -> f64 {
    const BLOCK: usize = 4;
    let side = side as usize;
    let block = |x: usize, y: usize| {
        let sum: f64 = (0..BLOCK).map(|j| errors[(y + j) * side + x..][..BLOCK].iter().sum::<f64>()).sum();
        (sum / (BLOCK * BLOCK) as f64).powi(2)
    };
    let places = || (0..side).step_by(BLOCK);
    let sum: f64 = places().flat_map(|y| places().map(move |x| (x, y))).map(|(x, y)| block(x, y)).sum();
    sum / (side / BLOCK).pow(2) as f64
}

fn picture(values: &[f64], side: u32, open: f64) -> Picture {
    // The lowest row of the floor is the last of the picture.
    let rows = values.chunks(side as usize).rev().flatten();
    let pixels = rows.map(|v| Rgb::splat((0.8 * v / open) as f32)).collect();
    Picture { size: UVec2::splat(side), pixels }
}
