//! Adding a pass whose paths reach pixels of their own choice.

use super::{
    Film, PixelSums,
    pass::{PIXELS_PER_RUN, is_accepted, reject, scanline},
    pixel_count,
};
use crate::{
    filter::Filter,
    fixed::{AtomicFixed, FixedSquare, FixedSum},
    parallel,
    rgb::Rgb,
    statistics::render::RenderStatistics,
};
use glam::{UVec2, Vec2};
use std::ops::Range;

type AtomicSum = AtomicFixed<64, 32>;

/// Light paths, by number, that share a state made by `start`.
const PATHS_PER_RUN: u32 = 128;

/// Where the paths of one pass leave what they carry to the film; shared by all threads.
///
/// It sums in fixed point, so that the order of the threads does not matter.
pub struct Splats {
    resolution: UVec2,
    filter: Filter,
    technique: &'static str,
    pass: u32,
    pixels: Vec<[AtomicSum; 3]>,
}

impl Splats {
    /// Adds `value`, weighted by the pixel filter, to every pixel whose filter reaches `position`.
    ///
    /// `position` is in pixels from the upper left corner of the film, so pixel centres are at half-integers; what falls
    /// on pixels outside the film is dropped. `value` is the path's contribution to the integral over the film over its
    /// density per pixel area, already divided by the number of paths of the pass. For the image to match one that
    /// samples the filter at each pixel, positions outside the film, within the filter's radius, must be splatted too.
    ///
    /// A value that is not finite or is negative, or a position that is not finite, is counted in `statistics` as
    /// rejected, at the nearest pixel of the film; a value over the film's limit, at the pixels that it would reach.
    #[inline]
    pub fn splat(&self, statistics: &mut RenderStatistics, position: Vec2, value: Rgb) {
        if !(value.is_valid() && position.is_finite()) {
            let last = self.resolution.saturating_sub(UVec2::ONE);
            // The conversion takes NaN to 0 and saturates.
            return reject(statistics, self.technique, self.pass, position.as_uvec2().min(last));
        }
        if self.filter == Filter::Box {
            // Which pixel holds a position on an edge is for `floor` to say: an offset from the centre is rounded.
            let pixel = position.floor();
            if pixel.cmpge(Vec2::ZERO).all() && pixel.cmplt(self.resolution.as_vec2()).all() {
                self.add(statistics, pixel.as_uvec2(), value);
            }
            return;
        }
        let radius = self.filter.radius();
        for y in pixels_reached(position.y, radius, self.resolution.y) {
            let row = value * self.filter.evaluate_1d(position.y - (y as f32 + 0.5));
            for x in pixels_reached(position.x, radius, self.resolution.x) {
                self.add(statistics, UVec2::new(x, y), row * self.filter.evaluate_1d(position.x - (x as f32 + 0.5)));
            }
        }
    }

    #[inline]
    fn add(&self, statistics: &mut RenderStatistics, pixel: UVec2, value: Rgb) {
        // The peak of a narrow filter may lift a value over the limit.
        if !is_accepted(value) {
            return reject(statistics, self.technique, self.pass, pixel);
        }
        let sums = &self.pixels[pixel.y as usize * self.resolution.x as usize + pixel.x as usize];
        for (sum, v) in sums.iter().zip(value.to_array()) {
            if v > 0.0 {
                sum.add(FixedSum::from_in_range(f64::from(v)));
            }
        }
    }
}

/// The pixels of a row of `size` whose centres are at most `radius` from `position`.
fn pixels_reached(position: f32, radius: f32, size: u32) -> Range<u32> {
    let (centre, radius) = (f64::from(position) - 0.5, f64::from(radius));
    // The conversions saturate, so what lies outside the film is an empty range.
    let first = (centre - radius).ceil() as u32;
    let end = (centre + radius).floor() + 1.0;
    first..(end as u32).min(size)
}

impl Film {
    /// Adds a pass in which paths reach pixels of their own choice: light tracing, bidirectional path tracing.
    ///
    /// First `path` runs for each number in `0..paths` (a light path), then `estimate` for each pixel (a camera path, or
    /// black); both may splat. A pixel's estimate of the pass is what `estimate` returns plus what was splatted on it.
    /// Either runs in parallel in runs of 128 on rayon's current thread pool; `start` makes the state of a run (a
    /// sampler). The result has the same bits for any number of threads. Returns what was counted.
    pub fn add_splat_pass<S>(
        &mut self,
        technique: &'static str,
        pass: u32,
        paths: u32,
        start: impl Fn() -> S + Sync,
        path: impl Fn(&mut S, u32, &Splats, &mut RenderStatistics) + Sync,
        estimate: impl Fn(&mut S, UVec2, &Splats, &mut RenderStatistics) -> Rgb + Sync,
    ) -> RenderStatistics {
        let splats = Splats {
            resolution: self.resolution,
            filter: self.filter,
            technique,
            pass,
            pixels: (0..pixel_count(self.resolution)).map(|_| Default::default()).collect(),
        };
        let mut statistics = parallel::for_ranges(paths, PATHS_PER_RUN, |numbers| {
            let mut statistics = RenderStatistics::default();
            let mut state = start();
            for number in numbers {
                path(&mut state, number, &splats, &mut statistics);
            }
            statistics
        });

        let width = self.resolution.x;
        // Camera paths splat on pixels of other runs, so no pixel's estimate is complete before the last of them ends.
        statistics.merge(&parallel::for_runs_of(&mut self.pixels, PIXELS_PER_RUN, |first, pixels| {
            let mut statistics = RenderStatistics::default();
            let mut state = start();
            for (pixel, _) in scanline(first, width).zip(pixels) {
                let value = estimate(&mut state, pixel, &splats, &mut statistics);
                splats.add(&mut statistics, pixel, value);
            }
            statistics
        }));

        statistics.merge(&parallel::for_runs_of(&mut self.pixels, PIXELS_PER_RUN, |first, pixels| {
            let mut statistics = RenderStatistics::default();
            for ((pixel, sums), splatted) in scanline(first, width).zip(pixels).zip(&splats.pixels[first..]) {
                if !add(sums, splatted.each_ref().map(AtomicSum::get)) {
                    reject(&mut statistics, technique, pass, pixel);
                }
            }
            statistics
        }));
        statistics
    }
}

/// Adds the estimate that a pass has summed, or 0 in its place, in which case it returns false.
fn add(sums: &mut PixelSums, estimate: [FixedSum; 3]) -> bool {
    let values = estimate.map(FixedSum::to_f64);
    let accepted = values.iter().all(|v| (0.0..FixedSum::TERM_LIMIT).contains(v));
    let (estimate, values) = if accepted { (estimate, values) } else { Default::default() };
    let fits = sums.add(estimate, values.map(|v| FixedSquare::from_in_range(v * v)));
    accepted && fits
}
