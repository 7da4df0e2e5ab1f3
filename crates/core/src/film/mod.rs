//! The film: sums that merge exactly.

mod pass;
mod splats;

pub use splats::Splats;

use crate::{
    filter::Filter,
    fixed::{FixedSquare, FixedSum},
    rgb::Rgb,
};
use glam::UVec2;
use thiserror::Error;

/// An image as sums over passes, row by row from the top, of which every pixel holds its own number of passes.
///
/// A pass gives every pixel one estimate. Sums are in fixed point ([`FixedSum`], [`FixedSquare`]), so the order in which
/// passes are added, and films merged, changes no bit. An estimate that is negative, not finite, or at least
/// [`Film::ESTIMATE_LIMIT`] is counted as rejected, and the pass then adds 0 at that pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    resolution: UVec2,
    filter: Filter,
    pixels: Vec<PixelSums>,
}

/// The sums of one pixel, red, green, blue: all that a film holds of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelSums {
    /// Sum of the estimates, in units of `2^-64` ([`FixedSum::to_raw`]).
    pub sum: [i128; 3],
    /// Sum of the squares of the estimates, in units of `2^-43` ([`FixedSquare::to_raw`]).
    pub squares: [i128; 3],
    /// Number of estimates.
    pub count: u32,
}

/// Why films could not be merged, or made from raw sums.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FilmError {
    /// The sizes differ.
    #[error("films of {}x{} and {}x{} pixels cannot be merged", .ours.x, .ours.y, .theirs.x, .theirs.y)]
    Resolution {
        /// Size of the film merged into.
        ours: UVec2,
        /// Size of the other.
        theirs: UVec2,
    },
    /// The pixel filters differ.
    #[error("films with the pixel filters {ours:?} and {theirs:?} cannot be merged")]
    Filter {
        /// Filter of the film merged into.
        ours: Filter,
        /// Filter of the other.
        theirs: Filter,
    },
    /// The number of pixels is not what the size says.
    #[error("a film of {}x{} pixels was given the sums of {found} pixels", .resolution.x, .resolution.y)]
    PixelCount {
        /// Size.
        resolution: UVec2,
        /// Number of pixels given.
        found: usize,
    },
    /// Sums that no passes can have made: negative, or without a pass.
    #[error("pixel ({}, {}) holds sums that no passes can have made", .pixel.x, .pixel.y)]
    Corrupt {
        /// The pixel.
        pixel: UVec2,
    },
    /// A sum or a count does not fit.
    #[error("the sums of pixel ({}, {}) do not fit", .pixel.x, .pixel.y)]
    Overflow {
        /// The pixel.
        pixel: UVec2,
    },
}

impl Film {
    /// An estimate of this value or above, in any channel, is rejected: `2^32`.
    pub const ESTIMATE_LIMIT: f32 = FixedSum::TERM_LIMIT as f32;
    /// The most pixels a side of an image that a file or a person may ask for: `2^16`.
    pub const MOST_PER_SIDE: u32 = 1 << 16;
    /// The most pixels of such an image: `2^28`. A film takes about 100 bytes for each.
    pub const MOST_PIXELS: u64 = 1 << 28;

    /// A film without a pass.
    pub fn new(resolution: UVec2, filter: Filter) -> Film {
        Film { resolution, filter, pixels: vec![PixelSums::default(); pixel_count(resolution)] }
    }

    /// A film from the sums of its pixels, row by row from the top.
    pub fn from_raw(resolution: UVec2, filter: Filter, pixels: Vec<PixelSums>) -> Result<Film, FilmError> {
        // The product is taken in 128 bits: a file's header may claim any size.
        if u128::from(resolution.x) * u128::from(resolution.y) != pixels.len() as u128 {
            return Err(FilmError::PixelCount { resolution, found: pixels.len() });
        }
        let film = Film { resolution, filter, pixels };
        let corrupt = |p: &PixelSums| {
            let all = p.sum.iter().chain(&p.squares);
            all.clone().any(|&s| s < 0) || p.count == 0 && all.clone().any(|&s| s != 0)
        };
        match film.pixels.iter().position(corrupt) {
            Some(index) => Err(FilmError::Corrupt { pixel: film.pixel_at(index) }),
            None => Ok(film),
        }
    }

    /// The sums of the pixels, row by row from the top: what a file keeps to lose nothing.
    pub fn raw(&self) -> &[PixelSums] {
        &self.pixels
    }

    /// Width and height in pixels.
    pub fn resolution(&self) -> UVec2 {
        self.resolution
    }

    /// The pixel filter.
    pub fn filter(&self) -> Filter {
        self.filter
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> u64 {
        (self.pixels.capacity() * size_of::<PixelSums>() + size_of::<Film>()) as u64
    }

    /// The largest number of passes at any pixel.
    pub fn passes(&self) -> u32 {
        self.pixels.iter().map(|p| p.count).max().unwrap_or(0)
    }

    /// Number of passes at a pixel.
    ///
    /// # Panics
    /// If the pixel is outside the film; so do [`Film::mean`] and [`Film::variance_of_mean`].
    pub fn count(&self, pixel: UVec2) -> u32 {
        self.pixels[self.index_of(pixel)].count
    }

    /// Mean of the estimates of a pixel; black without one.
    pub fn mean(&self, pixel: UVec2) -> Rgb {
        self.pixels[self.index_of(pixel)].mean()
    }

    /// Variance of the mean of a pixel, by channel, from the scatter of its estimates; infinite with fewer than two.
    pub fn variance_of_mean(&self, pixel: UVec2) -> [f64; 3] {
        self.pixels[self.index_of(pixel)].variance_of_mean()
    }

    /// The mean of every pixel, row by row from the top.
    pub fn mean_image(&self) -> Vec<Rgb> {
        self.pixels.iter().map(PixelSums::mean).collect()
    }

    /// The variance of the mean of every pixel, row by row from the top.
    pub fn variance_image(&self) -> Vec<[f64; 3]> {
        self.pixels.iter().map(PixelSums::variance_of_mean).collect()
    }

    /// Adds the passes of another film: the result has the same bits as if all passes had been added to one film, in
    /// any order. On an error nothing is changed.
    pub fn merge(&mut self, other: &Film) -> Result<(), FilmError> {
        if self.resolution != other.resolution {
            return Err(FilmError::Resolution { ours: self.resolution, theirs: other.resolution });
        }
        if self.filter != other.filter {
            return Err(FilmError::Filter { ours: self.filter, theirs: other.filter });
        }
        let merged: Result<Vec<_>, _> = self
            .pixels
            .iter()
            .zip(&other.pixels)
            .enumerate()
            .map(|(index, (a, b))| a.merged(b).ok_or_else(|| FilmError::Overflow { pixel: self.pixel_at(index) }))
            .collect();
        self.pixels = merged?;
        Ok(())
    }

    fn index_of(&self, pixel: UVec2) -> usize {
        assert!(pixel.cmplt(self.resolution).all(), "pixel {pixel} is outside a film of {}", self.resolution);
        pixel.y as usize * self.resolution.x as usize + pixel.x as usize
    }

    fn pixel_at(&self, index: usize) -> UVec2 {
        let width = self.resolution.x as usize;
        UVec2::new((index % width) as u32, (index / width) as u32)
    }
}

fn pixel_count(resolution: UVec2) -> usize {
    resolution.x as usize * resolution.y as usize
}

impl PixelSums {
    /// Adds an estimate and its square. When a sum is full, adds only to the count and returns false.
    #[inline]
    #[must_use]
    fn add(&mut self, estimate: [FixedSum; 3], squares: [FixedSquare; 3]) -> bool {
        self.count = self.count.saturating_add(1);
        let mut next = *self;
        let mut full = false;
        for c in 0..3 {
            let (sum, overflow) = self.sum[c].overflowing_add(estimate[c].to_raw());
            full |= overflow;
            next.sum[c] = sum;
            let (square, overflow) = self.squares[c].overflowing_add(squares[c].to_raw());
            full |= overflow;
            next.squares[c] = square;
        }
        if !full {
            *self = next;
        }
        !full
    }

    fn merged(&self, other: &PixelSums) -> Option<PixelSums> {
        let mut merged = PixelSums { count: self.count.checked_add(other.count)?, ..*self };
        for c in 0..3 {
            merged.sum[c] = self.sum[c].checked_add(other.sum[c])?;
            merged.squares[c] = self.squares[c].checked_add(other.squares[c])?;
        }
        Some(merged)
    }

    /// Mean of the estimates; black without one.
    pub fn mean(&self) -> Rgb {
        let count = f64::from(self.count.max(1));
        Rgb::from(self.sum.map(|s| (FixedSum::from_raw(s).to_f64() / count) as f32))
    }

    /// Variance of the mean, by channel; infinite with fewer than two estimates.
    pub fn variance_of_mean(&self) -> [f64; 3] {
        if self.count < 2 {
            return [f64::INFINITY; 3];
        }
        let n = f64::from(self.count);
        std::array::from_fn(|c| {
            let sum = FixedSum::from_raw(self.sum[c]).to_f64();
            let squares = FixedSquare::from_raw(self.squares[c]).to_f64();
            // Estimates that hardly differ leave rounding, of either sign.
            (squares - sum * sum / n).max(0.0) / (n * (n - 1.0))
        })
    }
}

#[cfg(test)]
mod tests;
