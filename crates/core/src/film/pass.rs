//! Adding a pass in which every pixel makes its own estimate.

use super::{Film, PixelSums};
use crate::{
    fixed::{FixedSquare, FixedSum},
    parallel,
    rgb::Rgb,
    statistics::render::{RejectedSample, RenderStatistics},
};
use glam::UVec2;

/// Pixels, in scanline order, that share a state made by `start`.
pub(super) const PIXELS_PER_RUN: usize = 128;

impl Film {
    /// Adds a pass: one estimate of every pixel, made by `estimate`.
    ///
    /// Runs of 128 pixels in scanline order are rendered in parallel, on rayon's current thread pool; `start` makes the
    /// state of a run (a sampler). The runs do not depend on the number of threads. Returns what was counted, rejected
    /// estimates included; `technique` and `pass` say in their records where they came from.
    pub fn add_pass<S>(
        &mut self,
        technique: &'static str,
        pass: u32,
        start: impl Fn() -> S + Sync,
        estimate: impl Fn(&mut S, UVec2, &mut RenderStatistics) -> Rgb + Sync,
    ) -> RenderStatistics {
        let width = self.resolution.x;
        parallel::for_runs_of(&mut self.pixels, PIXELS_PER_RUN, |first, pixels| {
            let mut statistics = RenderStatistics::default();
            let mut state = start();
            for (pixel, sums) in scanline(first, width).zip(pixels) {
                let value = estimate(&mut state, pixel, &mut statistics);
                if !add(sums, value) {
                    reject(&mut statistics, technique, pass, pixel);
                }
            }
            statistics
        })
    }
}

/// Adds an estimate, or 0 in its place, in which case it returns false.
#[inline]
fn add(sums: &mut PixelSums, value: Rgb) -> bool {
    let accepted = is_accepted(value);
    let value = if accepted { value } else { Rgb::BLACK }.to_array().map(f64::from);
    let fits = sums.add(value.map(FixedSum::from_in_range), value.map(|v| FixedSquare::from_in_range(v * v)));
    accepted && fits
}

/// Whether a film takes a value: every channel is finite, not negative, and below the limit.
#[inline]
pub(super) fn is_accepted(value: Rgb) -> bool {
    value.to_array().iter().all(|v| (0.0..Film::ESTIMATE_LIMIT).contains(v))
}

#[cold]
pub(super) fn reject(statistics: &mut RenderStatistics, technique: &'static str, pass: u32, pixel: UVec2) {
    statistics.reject(RejectedSample { pass, y: pixel.y, x: pixel.x, technique });
}

/// The pixels from number `first` on, row by row, without end.
pub(super) fn scanline(first: usize, width: u32) -> impl Iterator<Item = UVec2> {
    let row = width.max(1) as usize;
    let mut next = UVec2::new((first % row) as u32, (first / row) as u32);
    std::iter::repeat_with(move || {
        let pixel = next;
        next.x += 1;
        if next.x == width {
            next = UVec2::new(0, pixel.y + 1);
        }
        pixel
    })
}
