//! Power spectra of point sets.
//!
//! The periodogram of `N` points in the unit square at an integer frequency `f` is
//!
//! ```text
//! P(f) = |sum_j exp(-2 pi i f.x_j)|^2 / N                    [Ulichney 1988]
//! ```
//!
//! whose expectation is 1 at every `f` but 0 for independent points. A pattern that spreads error evenly has little at low
//! frequencies; one without directions has the same on all of a ring. Averaged over `K` realisations, the mean of a ring
//! is the radial spectrum, and the variance within it over its square the anisotropy: about `1 / K` (`-10` dB for ten)
//! where no direction differs, for a periodogram scatters by as much as its mean.
//!
//! ```
//! use etendue_sampling::spectrum::Spectrum;
//! use glam::Vec2;
//! // A regular grid of 4 x 4 points: all its power is at multiples of 4.
//! let grid: Vec<Vec2> = (0..16).map(|i| Vec2::new((i % 4) as f32, (i / 4) as f32) / 4.0).collect();
//! let mut spectrum = Spectrum::new(6);
//! spectrum.add(&grid);
//! assert!(spectrum.mean_below(3.5) < 1e-20);
//! assert!((spectrum.power(4, 0) - 16.0).abs() < 1e-9 && spectrum.power(4, 1) < 1e-20);
//! ```
//!
//! Source: Ulichney, "Dithering with Blue Noise" (1988); Lagae and Dutré, "A Comparison of Methods for Generating Poisson
//! Disk Distributions" (2008).

use etendue_core::{
    parallel::for_runs_of,
    statistics::{moments::Moments, render::RenderStatistics},
};
use glam::Vec2;
use std::f64::consts::TAU;

/// Points whose tables of sines and cosines are in memory at once.
const CHUNK: usize = 64;

/// The mean periodogram of realisations of a pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    highest: usize,
    realisations: u32,
    /// Sum of periodograms: rows of `2 highest + 1` for `f_y` from 0 up. The other half is its mirror image.
    power: Vec<f64>,
}

/// The frequencies of length `radius - 1/2` to `radius + 1/2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Cycles per unit length.
    pub radius: u32,
    /// Mean power: 1 for white noise.
    pub mean: f64,
    /// Variance over squared mean, of which opposite frequencies count once [Ulichney 1988]; 0 without power.
    pub anisotropy: f64,
}

impl Ring {
    /// The anisotropy in decibels.
    pub fn anisotropy_db(&self) -> f64 {
        10.0 * self.anisotropy.log10()
    }
}

impl Spectrum {
    /// Nothing yet, for frequencies up to `highest` in either direction.
    pub fn new(highest: u32) -> Spectrum {
        let highest = highest as usize;
        Spectrum { highest, realisations: 0, power: vec![0.0; (highest + 1) * (2 * highest + 1)] }
    }

    /// Adds a realisation: a set of points in the unit square, in time proportional to their number times that of the
    /// frequencies. A set without points has no power.
    pub fn add(&mut self, points: &[Vec2]) {
        self.realisations += 1;
        if points.is_empty() {
            return;
        }
        // For every f_y a row of four sums over f_x >= 0: of cosines and sines in x times cosines and sines in y.
        let side = self.highest + 1;
        let mut sums = vec![0.0; side * 4 * side];
        for chunk in points.chunks(CHUNK) {
            let x = Waves::new(chunk.iter().map(|p| p.x), side);
            let y = Waves::new(chunk.iter().map(|p| p.y), side);
            for_runs_of(&mut sums, 4 * side, |first, row| {
                add_row(row, &x, &y, first / (4 * side), chunk.len());
                RenderStatistics::default()
            });
        }
        let scale = 1.0 / points.len() as f64;
        for (row, sums) in self.power.chunks_mut(2 * side - 1).zip(sums.chunks(4 * side)) {
            let [cc, ss, cs, sc] = [0, 1, 2, 3].map(|i| &sums[i * side..(i + 1) * side]);
            for k in 0..side {
                row[self.highest + k] += ((cc[k] - ss[k]).powi(2) + (cs[k] + sc[k]).powi(2)) * scale;
                if k > 0 {
                    row[self.highest - k] += ((cc[k] + ss[k]).powi(2) + (cs[k] - sc[k]).powi(2)) * scale;
                }
            }
        }
    }

    /// Number of realisations.
    pub fn realisations(&self) -> u32 {
        self.realisations
    }

    /// Highest frequency in either direction.
    pub fn highest(&self) -> u32 {
        self.highest as u32
    }

    /// Mean power at a frequency: the number of points at 0, elsewhere 1 for white noise. 0 without realisations.
    ///
    /// # Panics
    /// If the frequency is higher than [`Spectrum::highest`] in either direction.
    pub fn power(&self, x: i32, y: i32) -> f64 {
        let (x, y) = if y < 0 { (-x, -y) } else { (x, y) };
        assert!(x.unsigned_abs().max(y.unsigned_abs()) as usize <= self.highest, "no frequency ({x}, {y})");
        let column = (self.highest as i64 + i64::from(x)) as usize;
        self.power[y as usize * (2 * self.highest + 1) + column] / f64::from(self.realisations.max(1))
    }

    /// Mean power in rows of `2 highest + 1`, from `-highest` to `highest` in both directions, frequency 0 in the middle.
    pub fn image(&self) -> Vec<f64> {
        let h = self.highest as i32;
        (-h..=h).flat_map(|y| (-h..=h).map(move |x| self.power(x, y))).collect()
    }

    /// The rings of radius 1 to [`Spectrum::highest`].
    pub fn rings(&self) -> Vec<Ring> {
        let mut rings = vec![Moments::default(); self.highest + 1];
        for (length, power) in self.half() {
            if let Some(ring) = rings.get_mut(length.round() as usize) {
                ring.push(power);
            }
        }
        let ring = |(radius, m): (usize, &Moments)| {
            let anisotropy = if m.mean() > 0.0 { m.variance() / m.mean().powi(2) } else { 0.0 };
            Ring { radius: radius as u32, mean: m.mean(), anisotropy }
        };
        rings.iter().enumerate().skip(1).map(ring).collect()
    }

    /// Mean power at the frequencies but 0 whose length is not above `radius`: what a pattern has of white noise's energy
    /// there. 0 if there is no such frequency.
    pub fn mean_below(&self, radius: f64) -> f64 {
        self.half().filter(|(length, _)| *length <= radius).map(|(_, power)| power).collect::<Moments>().mean()
    }

    /// Length and mean power of one of every two opposite frequencies, 0 left out.
    fn half(&self) -> impl Iterator<Item = (f64, f64)> {
        let h = self.highest as i32;
        let half = (0..=h).flat_map(move |y| (-h..=h).map(move |x| (x, y))).filter(|&(x, y)| y > 0 || x > 0);
        half.map(|(x, y)| (f64::from(x).hypot(f64::from(y)), self.power(x, y)))
    }
}

/// Cosines and sines of multiples of coordinates: for every point those of the multiples in a row.
struct Waves {
    side: usize,
    cos: Vec<f64>,
    sin: Vec<f64>,
}

impl Waves {
    fn new(coordinates: impl Iterator<Item = f32>, side: usize) -> Waves {
        let (mut cos, mut sin) = (Vec::with_capacity(CHUNK * side), Vec::with_capacity(CHUNK * side));
        for x in coordinates {
            let (step_sin, step_cos) = (TAU * f64::from(x)).sin_cos();
            let (mut c, mut s) = (1.0, 0.0);
            for _ in 0..side {
                cos.push(c);
                sin.push(s);
                // One rotation more: a thousand of them lose three of sixteen digits at most.
                (c, s) = (c * step_cos - s * step_sin, s * step_cos + c * step_sin);
            }
        }
        Waves { side, cos, sin }
    }
}

/// Adds points to the sums of one `f_y`.
fn add_row(row: &mut [f64], x: &Waves, y: &Waves, frequency: usize, points: usize) {
    let side = x.side;
    let (cc, rest) = row.split_at_mut(side);
    let (ss, rest) = rest.split_at_mut(side);
    let (cs, sc) = rest.split_at_mut(side);
    for point in 0..points {
        let (c, s) = (y.cos[point * side + frequency], y.sin[point * side + frequency]);
        let (cos, sin) = (&x.cos[point * side..][..side], &x.sin[point * side..][..side]);
        for k in 0..side {
            cc[k] += cos[k] * c;
            ss[k] += sin[k] * s;
            cs[k] += cos[k] * s;
            sc[k] += sin[k] * c;
        }
    }
}
