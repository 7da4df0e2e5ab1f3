//! Points, spectra and star discrepancies of every pattern.

use super::{Study, index_of};
use crate::{error::Error, picture::encode_png};
use etendue_core::statistics::moments::Moments;
use etendue_sampling::{
    discrepancy::star_discrepancy,
    pattern::Pattern,
    spectrum::{Ring, Spectrum},
};
use glam::{UVec2, Vec2};
use serde::Serialize;

/// Points of a picture and of the patterns whose spectra are taken.
pub const POINTS: u32 = 256;
/// The highest frequency: four times that at which a regular grid has its first power.
pub const HIGHEST: u32 = 64;
/// Realisations that a spectrum is the mean of, unless there are fewer trials.
pub const REALISATIONS: u32 = 64;
/// Numbers of points whose discrepancy is taken, and of patterns that it is the mean of.
pub const COUNTS: [u32; 3] = [64, 256, 1024];
const DISCREPANCY_PATTERNS: u32 = 16;
/// Steps of this part.
pub const STEPS: u32 = Pattern::ALL.len() as u32;
/// Pixels along the side of a picture: two to a frequency and one more, and a margin.
const SIDE: u32 = 2 * HIGHEST + 1;
/// Pictures in a row of the sheet: four pairs of points and spectrum.
const PAIRS: u32 = 4;
const GAP: u32 = 6;

/// The mean star discrepancy of a pattern.
#[derive(Clone, Debug, Serialize)]
pub struct Discrepancy {
    /// The pattern.
    pub pattern: &'static str,
    /// By number of points, as in [`COUNTS`].
    pub star: [f64; COUNTS.len()],
}

/// The spectrum of a pattern along its rings.
#[derive(Clone, Debug, Serialize)]
pub struct Rings {
    /// The pattern.
    pub pattern: &'static str,
    /// Mean power at frequencies up to half of a regular grid's first.
    pub low_frequencies: f64,
    /// Mean over rings of the anisotropy, decibels.
    pub anisotropy_db: f64,
    /// Frequency, mean power, anisotropy.
    pub rings: Vec<(u32, f64, f64)>,
}

/// A pattern's pictures, in grey.
struct Pair {
    points: Vec<u8>,
    spectrum: Vec<u8>,
}

/// What is drawn and tabled.
pub struct Pictures {
    pairs: Vec<Pair>,
    /// By pattern.
    pub discrepancies: Vec<Discrepancy>,
    /// By pattern.
    pub rings: Vec<Rings>,
}

pub(super) fn measure(study: &Study) -> Result<Pictures, Error> {
    let mut pictures = Pictures { pairs: vec![], discrepancies: vec![], rings: vec![] };
    for pattern in Pattern::ALL {
        study.step(&format!("spectrum, {}", pattern.name()))?;
        let points = |count: u32, kind: u64, trial: u64| {
            pattern.points(count, study.seed(5 << 48 | kind << 40 | index_of(pattern) << 32 | u64::from(count), trial))
        };
        // Nothing in the regular grid is random.
        let once = pattern == Pattern::Grid;
        let mut spectrum = Spectrum::new(HIGHEST);
        (0..if once { 1 } else { REALISATIONS.min(study.trials) })
            .for_each(|r| spectrum.add(&points(POINTS, 0, r.into())));
        let first = points(POINTS, 0, 0);
        pictures.pairs.push(Pair { points: draw_points(&first), spectrum: draw_spectrum(&spectrum) });
        pictures.rings.push(rings(pattern, &spectrum));
        let star = COUNTS.map(|count| {
            let patterns = 0..if once { 1 } else { DISCREPANCY_PATTERNS.min(study.trials) };
            patterns.map(|p| star_discrepancy(&points(count, 1, p.into()))).collect::<Moments>().mean()
        });
        pictures.discrepancies.push(Discrepancy { pattern: pattern.name(), star });
    }
    Ok(pictures)
}

fn rings(pattern: Pattern, spectrum: &Spectrum) -> Rings {
    let rings = spectrum.rings();
    // The first rings have too few frequencies to tell a direction.
    let decibels: Moments = rings.iter().skip(4).map(Ring::anisotropy_db).filter(|db: &f64| db.is_finite()).collect();
    Rings {
        pattern: pattern.name(),
        low_frequencies: spectrum.mean_below(0.5 * f64::from(POINTS).sqrt()),
        anisotropy_db: decibels.mean(),
        rings: rings.iter().map(|r| (r.radius, r.mean, r.anisotropy)).collect(),
    }
}

/// Disks on white, with soft borders.
fn draw_points(points: &[Vec2]) -> Vec<u8> {
    const RADIUS: f32 = 1.9;
    let mut grey = vec![255u8; (SIDE * SIDE) as usize];
    for p in points {
        let at = Vec2::new(p.x, 1.0 - p.y) * SIDE as f32 - 0.5;
        for y in (at.y - RADIUS - 1.0).ceil().max(0.0) as u32..=((at.y + RADIUS + 1.0) as u32).min(SIDE - 1) {
            for x in (at.x - RADIUS - 1.0).ceil().max(0.0) as u32..=((at.x + RADIUS + 1.0) as u32).min(SIDE - 1) {
                let inside = (RADIUS + 0.5 - at.distance(Vec2::new(x as f32, y as f32))).clamp(0.0, 1.0);
                let pixel = &mut grey[(y * SIDE + x) as usize];
                *pixel = (*pixel).min((255.0 - 230.0 * inside) as u8);
            }
        }
    }
    grey
}

/// White noise is a middle grey.
fn draw_spectrum(spectrum: &Spectrum) -> Vec<u8> {
    let grey = |power: f64| (255.0 * (1.0 - (-0.7 * power).exp())).round() as u8;
    let mut pixels: Vec<u8> = spectrum.image().into_iter().map(grey).collect();
    // Frequency 0 is the number of points, in any pattern.
    let middle = pixels.len() / 2;
    pixels[middle] = 0;
    pixels
}

impl Pictures {
    /// The points and the spectrum of a pattern as PNG files.
    pub fn png(&self, index: usize) -> [Vec<u8>; 2] {
        let pair = &self.pairs[index];
        [&pair.points, &pair.spectrum].map(|grey| {
            let rgb: Vec<u8> = grey.iter().flat_map(|g| [*g; 3]).collect();
            encode_png(UVec2::splat(SIDE), &rgb)
        })
    }

    /// All of them on one sheet, in the order of the list, four pairs in a row: points on the left, spectrum on the right.
    pub fn sheet(&self) -> (UVec2, Vec<u8>) {
        let cell = UVec2::new(2 * SIDE + 3 * GAP, SIDE + 2 * GAP);
        let size = cell * UVec2::new(PAIRS, (self.pairs.len() as u32).div_ceil(PAIRS));
        let mut rgb = vec![232u8; (3 * size.x * size.y) as usize];
        for (index, pair) in self.pairs.iter().enumerate() {
            let corner = cell * UVec2::new(index as u32 % PAIRS, index as u32 / PAIRS) + GAP;
            for (grey, left) in [(&pair.points, 0), (&pair.spectrum, SIDE + GAP)] {
                for (i, g) in (0..).zip(grey) {
                    let at = corner + UVec2::new(left + i % SIDE, i / SIDE);
                    let first = 3 * (at.y * size.x + at.x) as usize;
                    rgb[first..first + 3].fill(*g);
                }
            }
        }
        (size, rgb)
    }
}
