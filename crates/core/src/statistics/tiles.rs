//! Images compared by the means of their tiles, which find local errors where single pixels are too noisy to test.

use super::{
    chi_square::{sidak, sidak_p_value},
    moments::Moments,
    special::student_t_two_sided,
};
use crate::rgb::Rgb;

/// A tile size that makes one tile of any image, to compare image means.
pub const WHOLE_IMAGE: usize = usize::MAX;

/// The means of an image's tiles: squares from the upper left corner on, cut off at the right and lower edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Tiles {
    /// Tiles side by side.
    pub columns: usize,
    /// Tiles one above the other.
    pub rows: usize,
    /// Mean of each tile, red, green, blue, row by row from the top.
    pub means: Vec<[f64; 3]>,
}

/// Tile means of an image whose rows are `width` pixels, in tiles of `tile` pixels a side.
///
/// # Panics
/// If `width` or `tile` is 0, or the image has an incomplete row; so does [`replicated_tile_means`].
pub fn tile_means(image: &[Rgb], width: usize, tile: usize) -> Tiles {
    assert!(image.len().is_multiple_of(width), "an image of {} pixels has no rows of {width}", image.len());
    let (columns, rows) = (width.div_ceil(tile), (image.len() / width).div_ceil(tile));
    let mut means = vec![[0.0; 3]; columns * rows];
    let mut counts = vec![0_u64; columns * rows];
    for (y, row) in image.chunks(width).enumerate() {
        for (x, pixel) in row.iter().enumerate() {
            let index = y / tile * columns + x / tile;
            counts[index] += 1;
            means[index].iter_mut().zip(pixel.to_array()).for_each(|(sum, v)| *sum += f64::from(v));
        }
    }
    for (mean, count) in means.iter_mut().zip(counts) {
        mean.iter_mut().for_each(|sum| *sum /= count as f64);
    }
    Tiles { columns, rows, means }
}

/// The mean over replicates of the tile means, and its standard errors from the scatter of the replicates (of which there
/// must be one at least; with one, the errors are infinite). A t-test with them has the number of replicates less one
/// degrees of freedom.
pub fn replicated_tile_means(images: &[&[Rgb]], width: usize, tile: usize) -> (Tiles, Vec<[f64; 3]>) {
    let mut tiles = tile_means(images[0], width, tile);
    let replicates: Vec<Tiles> = images.iter().map(|image| tile_means(image, width, tile)).collect();
    let mut errors = vec![[0.0; 3]; tiles.means.len()];
    for (i, (mean, error)) in tiles.means.iter_mut().zip(&mut errors).enumerate() {
        for c in 0..3 {
            let moments: Moments = replicates.iter().map(|r| r.means[i][c]).collect();
            (mean[c], error[c]) = (moments.mean(), moments.standard_error());
        }
    }
    (tiles, errors)
}

/// What a comparison found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Column, row and channel of the tile that differs most significantly.
    pub worst: (usize, usize, usize),
    /// Its difference, in standard errors, positive when the first image is brighter.
    pub t: f64,
    /// Its difference over the mean of its tile in the second image.
    pub relative: f64,
    /// Probability that equal images would differ this much in any tile and channel, Sidak-corrected for their number.
    pub p_value: f64,
    /// Number of tiles times channels.
    pub tests: usize,
    /// How many of them differ at the Sidak-corrected significance.
    pub failures: usize,
}

/// Compares tile means, given the standard error of the difference for each tile and channel, and the degrees of freedom
/// it was estimated with (infinite: known).
///
/// The images agree, at this significance, when there are no failures. A tile that has no error (black in all
/// replicates, say) fails unless it is equal, and so does one that is not a number.
///
/// # Panics
/// If the images or the errors differ in their numbers of tiles, or there are none.
pub fn compare(a: &Tiles, b: &Tiles, errors: &[[f64; 3]], degrees: f64, significance: f64) -> Comparison {
    assert_eq!((a.columns, a.rows, a.means.len()), (b.columns, b.rows, errors.len()));
    let tests = 3 * a.means.len();
    let threshold = sidak(significance, tests);
    let mut worst: Option<(f64, usize, usize, f64)> = None;
    let mut failures = 0;
    for (i, error) in errors.iter().enumerate() {
        for (c, &error) in error.iter().enumerate() {
            let difference = a.means[i][c] - b.means[i][c];
            let t = if difference == 0.0 { 0.0 } else { difference / error };
            let p = if t.is_nan() { 0.0 } else { student_t_two_sided(t, degrees) };
            failures += usize::from(p <= threshold);
            // Among p-values that have run out of digits the larger difference is the worse.
            if worst.is_none_or(|(q, .., u)| p < q || p == q && t.abs() > u.abs()) {
                worst = Some((p, i, c, t));
            }
        }
    }
    let (p, i, c, t) = worst.expect("there is at least one tile");
    Comparison {
        worst: (i % a.columns, i / a.columns, c),
        t,
        relative: (a.means[i][c] - b.means[i][c]) / b.means[i][c],
        p_value: sidak_p_value(p, tests),
        tests,
        failures,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        independent::Independent,
        sampler::{Purpose, Sampler},
    };

    #[test]
    fn means_with_tiles_cut_off_at_the_edges() {
        // 5 x 3 pixels, of value 10 y + x.
        let image: Vec<Rgb> = (0..15).map(|i| Rgb::new((i / 5 * 10 + i % 5) as f32, 1.0, 0.0)).collect();
        let tiles = tile_means(&image, 5, 2);
        assert_eq!((tiles.columns, tiles.rows), (3, 2));
        let red: Vec<f64> = tiles.means.iter().map(|m| m[0]).collect();
        assert_eq!(red, [5.5, 7.5, 9.0, 20.5, 22.5, 24.0]);
        assert!(tiles.means.iter().all(|m| m[1] == 1.0 && m[2] == 0.0));
        assert_eq!(tile_means(&image, 5, WHOLE_IMAGE).means, [[12.0, 1.0, 0.0]]);
    }

    fn noisy(replicate: u32, brightness: f32) -> Vec<Rgb> {
        let mut sampler = Independent::new(21);
        (0..64 * 48)
            .map(|i| {
                sampler.start_sample(i, replicate);
                let u = sampler.get_1d(0, Purpose::Lobe);
                // A heavy tail, as of a path tracer.
                let patch = (40..44).contains(&(i % 64)) && (12..16).contains(&(i / 64));
                Rgb::splat(if patch { brightness } else { 1.0 } * u * u * 3.0)
            })
            .collect()
    }

    fn compared(first: u32, brightness: f32, tile: usize) -> Comparison {
        const REPLICATES: u32 = 16;
        let images = |first: u32, bright: f32| (first..first + REPLICATES).map(move |r| noisy(r, bright));
        let (a, b): (Vec<_>, Vec<_>) = (images(first, brightness).collect(), images(first + 100, 1.0).collect());
        let of = |images: &[Vec<Rgb>]| {
            let images: Vec<&[Rgb]> = images.iter().map(Vec::as_slice).collect();
            replicated_tile_means(&images, 64, tile)
        };
        let ((a, ea), (b, eb)) = (of(&a), of(&b));
        let errors: Vec<[f64; 3]> =
            ea.iter().zip(&eb).map(|(x, y)| std::array::from_fn(|c| x[c].hypot(y[c]))).collect();
        compare(&a, &b, &errors, f64::from(2 * REPLICATES - 2), 1e-3)
    }

    #[test]
    fn equal_expectations_agree_and_a_local_error_is_found() {
        for first in [0, 200, 400] {
            let same = compared(first, 1.0, 16);
            assert_eq!((same.tests, same.failures), (36, 0), "{same:?}");
            assert!(same.p_value > 1e-3);
            assert_eq!(compared(first, 1.0, WHOLE_IMAGE).failures, 0);
            let other = compared(first, 4.0, 8);
            assert!(other.failures > 0 && other.p_value < 1e-3 && other.t > 4.0 && other.relative > 0.4, "{other:?}");
            assert_eq!((other.worst.0, other.worst.1), (5, 1));
        }
    }

    #[test]
    fn what_has_no_error_must_be_equal() {
        let tiles = |v: f64| Tiles { columns: 1, rows: 1, means: vec![[v, 1.0, 1.0]] };
        let errors = [[0.0, 0.1, 0.1]];
        assert_eq!(compare(&tiles(1.0), &tiles(1.0), &errors, 7.0, 0.01).p_value, 1.0);
        for v in [1.0 + 1e-9, f64::NAN] {
            let comparison = compare(&tiles(v), &tiles(1.0), &errors, 7.0, 0.01);
            assert_eq!((comparison.failures, comparison.worst, comparison.p_value), (1, (0, 0, 0), 0.0));
        }
    }
}
