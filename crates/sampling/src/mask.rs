//! A blue-noise dither mask.

use crate::permutation::permute;
use glam::UVec2;
use std::sync::OnceLock;

/// Pixels on a side of the mask, which repeats.
pub const MASK_SIZE: u32 = 128;

const PIXELS: usize = (MASK_SIZE * MASK_SIZE) as usize;

/// Spread of the Gaussian by which pixels are crowded, in pixels [Ulichney 1993, sec. 3].
const SIGMA: f32 = 1.9;

/// Where the Gaussian ends, at about 1e-6.
const REACH: u32 = 10;

/// The mask's value at a pixel: a number in `[0, 1)`, each of `MASK_SIZE^2` equidistant ones once, such that neighbours
/// differ much and the values of any region are spread evenly.
///
/// Made by void and cluster [Ulichney 1993], on the torus, when it is first used.
pub fn mask(pixel: UVec2) -> f32 {
    // The upper bits of the rank are those of a number of 24 bits: nothing is rounded.
    mask_bits(pixel) as f32 / 4_294_967_296.0
}

/// The same times `2^32`.
#[inline]
pub(crate) fn mask_bits(pixel: UVec2) -> u32 {
    static MASK: OnceLock<Vec<u16>> = OnceLock::new();
    let pixel = pixel % MASK_SIZE;
    u32::from(MASK.get_or_init(void_and_cluster)[(pixel.y * MASK_SIZE + pixel.x) as usize]) << (32 - PIXELS.ilog2())
}

/// Some pixels and how crowded each place is by them.
struct Crowd {
    taken: Vec<bool>,
    density: Vec<f32>,
    gaussian: Vec<f32>,
    voids: Extremes,
    clusters: Extremes,
}

/// The pixel of each row that is crowded least or most, `None` where it is to be found again.
type Extremes = Vec<Option<Option<usize>>>;

impl Crowd {
    fn new() -> Crowd {
        let along = |d: u32| (-(d as f32).powi(2) / (2.0 * SIGMA * SIGMA)).exp();
        let gaussian = (0..=2 * REACH).map(|d| along(d.abs_diff(REACH))).collect();
        let unknown = vec![None; MASK_SIZE as usize];
        Crowd {
            taken: vec![false; PIXELS],
            density: vec![0.0; PIXELS],
            gaussian,
            voids: unknown.clone(),
            clusters: unknown,
        }
    }

    /// Takes a pixel or gives it back.
    fn set(&mut self, pixel: usize, taken: bool) {
        self.taken[pixel] = taken;
        let sign = if taken { 1.0 } else { -1.0 };
        let (x, y) = (pixel as u32 % MASK_SIZE, pixel as u32 / MASK_SIZE);
        for (dy, wy) in (0..).zip(&self.gaussian) {
            let row = (y + MASK_SIZE + dy - REACH) % MASK_SIZE;
            (self.voids[row as usize], self.clusters[row as usize]) = (None, None);
            for (dx, wx) in (0..).zip(&self.gaussian) {
                let column = (x + MASK_SIZE + dx - REACH) % MASK_SIZE;
                self.density[(row * MASK_SIZE + column) as usize] += sign * wx * wy;
            }
        }
    }

    /// The free pixel that is crowded least.
    fn void(&mut self) -> usize {
        extreme(&mut self.voids, |i| if self.taken[i] { f32::NEG_INFINITY } else { -self.density[i] })
    }

    /// The taken pixel that is crowded most.
    fn cluster(&mut self) -> usize {
        extreme(&mut self.clusters, |i| if self.taken[i] { self.density[i] } else { f32::NEG_INFINITY })
    }
}

/// The pixel of largest value, the first of them; one at least must be finite.
fn extreme(rows: &mut Extremes, value: impl Fn(usize) -> f32) -> usize {
    let largest = |pixels: &mut dyn Iterator<Item = usize>| {
        pixels.fold((None, f32::NEG_INFINITY), |best, i| if value(i) > best.1 { (Some(i), value(i)) } else { best }).0
    };
    let size = MASK_SIZE as usize;
    let of_row = |(row, known): (usize, &mut Option<Option<usize>>)| {
        *known.get_or_insert_with(|| largest(&mut (row * size..(row + 1) * size)))
    };
    largest(&mut rows.iter_mut().enumerate().filter_map(of_row)).expect("there is such a pixel")
}

fn void_and_cluster() -> Vec<u16> {
    // A tenth of the pixels, moved from clusters to voids until that moves none.
    let first = PIXELS / 10;
    let mut crowd = Crowd::new();
    (0..first as u32).for_each(|i| crowd.set(permute(i, PIXELS as u32, 1) as usize, true));
    loop {
        let cluster = crowd.cluster();
        crowd.set(cluster, false);
        let void = crowd.void();
        crowd.set(void, true);
        if void == cluster {
            break;
        }
    }
    let prototype: Vec<usize> = (0..PIXELS).filter(|&i| crowd.taken[i]).collect();

    // Those are ranked by taking them away from the clusters, the others by filling voids.
    let mut ranks = vec![0; PIXELS];
    for rank in (0..first).rev() {
        let cluster = crowd.cluster();
        crowd.set(cluster, false);
        ranks[cluster] = rank as u16;
    }
    prototype.into_iter().for_each(|pixel| crowd.set(pixel, true));
    for rank in first..PIXELS {
        let void = crowd.void();
        crowd.set(void, true);
        ranks[void] = rank as u16;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(x: u32, y: u32) -> f64 {
        f64::from(mask(UVec2::new(x, y)))
    }

    #[test]
    fn every_value_is_there_once() {
        let mut seen = vec![false; PIXELS];
        for y in 0..MASK_SIZE {
            (0..MASK_SIZE).for_each(|x| seen[(value(x, y) * PIXELS as f64) as usize] = true);
        }
        assert!(seen.into_iter().all(|s| s));
        assert_eq!(value(3, 5), value(3 + MASK_SIZE, 5 + 7 * MASK_SIZE));
    }

    /// The power spectrum over that of white noise, as a mean over frequencies of `from..to` periods in the mask.
    fn power(from: f64, to: f64) -> f64 {
        let size = f64::from(MASK_SIZE);
        let wave: Vec<(f64, f64)> =
            (0..MASK_SIZE).map(|i| (f64::from(i) / size * std::f64::consts::TAU).sin_cos()).collect();
        let (mut sum, mut frequencies) = (0.0, 0);
        for (fx, fy) in (0..=64_u32).flat_map(|fx| (0..=64_u32).map(move |fy| (fx, fy))) {
            let length = f64::from(fx).hypot(f64::from(fy));
            // A sample of the larger frequencies will do.
            if !(from..to).contains(&length) || (length > 20.0 && (fx * 7 + fy) % 16 > 0) {
                continue;
            }
            let (mut re, mut im) = (0.0, 0.0);
            for (x, y) in (0..MASK_SIZE).flat_map(|y| (0..MASK_SIZE).map(move |x| (x, y))) {
                let (sin, cos) = wave[((fx * x + fy * y) % MASK_SIZE) as usize];
                (re, im) = (re + cos * value(x, y), im + sin * value(x, y));
            }
            sum += (re * re + im * im) / (PIXELS as f64 / 12.0);
            frequencies += 1;
        }
        sum / f64::from(frequencies)
    }

    #[test]
    fn low_frequencies_have_little_power() {
        for (from, to, most) in [(1.0, 8.0, 1e-4), (8.0, 16.0, 1e-3), (16.0, 32.0, 0.02)] {
            let power = power(from, to);
            assert!(power < most, "{from} to {to}: {power:e}");
        }
        assert!(power(40.0, 64.0) > 0.8);
    }
}
