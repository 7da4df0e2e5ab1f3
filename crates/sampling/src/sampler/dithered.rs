//! Sobol points dithered by a blue-noise mask over the screen.

use super::NO_PIXEL;
use crate::{
    mask::mask_bits,
    sobol::Index,
    stratified::jitter,
    torus::{Place, position},
};
use etendue_core::{
    independent::{Independent, unit},
    sampler::{Purpose, Sampler},
};
use glam::{UVec2, Vec2};

/// The same Sobol points in all pixels, shifted around the torus by the values of a blue-noise mask, which is laid over the
/// screen at another place for each dimension [Georgiev and Fajardo 2016].
///
/// The error is no smaller than that of a shifted Sobol sequence, but neighbouring pixels err in different directions:
/// the eye, or a filter, averages it away. The effect is for few samples a pixel. For what is not a pixel
/// ([`start_sample`](Sampler::start_sample)), numbers are as by [`sobol`](super::sobol()).
pub fn blue_noise_dithered(seed: u64, planned: u32) -> Box<dyn Sampler> {
    Box::new(Dithered { words: Independent::new(seed), planned, index: Index::new(0, planned), pixel: None })
}

struct Dithered {
    /// Words that all pixels share, or those of the light path.
    words: Independent,
    planned: u32,
    index: Index,
    pixel: Option<UVec2>,
}

impl Dithered {
    /// What the mask adds to the two numbers of an address.
    #[inline]
    fn shift(&self, key: u64) -> Place {
        let Some(pixel) = self.pixel else { return [0; 2] };
        let at = |random: u32| mask_bits(pixel.wrapping_add(UVec2::new(random & 0xffff, random >> 16)));
        jitter(key, 0).map(at)
    }
}

impl Sampler for Dithered {
    #[inline]
    fn start_sample(&mut self, index: u32, sample: u32) {
        self.words.start_sample(index, 0);
        (self.index, self.pixel) = (Index::new(sample, self.planned), None);
    }

    #[inline]
    fn start_pixel(&mut self, pixel: UVec2, _width: u32, sample: u32) {
        self.start_sample(NO_PIXEL, sample);
        self.pixel = Some(pixel);
    }

    #[inline]
    fn get_1d(&mut self, vertex: u32, purpose: Purpose) -> f32 {
        let key = self.words.word(vertex, purpose);
        unit(self.index.padded_bits(key)[0].wrapping_add(self.shift(key)[0]))
    }

    #[inline]
    fn get_2d(&mut self, vertex: u32, purpose: Purpose) -> Vec2 {
        let key = self.words.word(vertex, purpose);
        let (point, shift) = (self.index.padded_bits(key), self.shift(key));
        position([point[0].wrapping_add(shift[0]), point[1].wrapping_add(shift[1])])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: u32 = 64;

    /// Variance over all squares of 8 by 8 pixels of the mean of an image, over that of independent pixels.
    fn share_of_low_frequencies(image: &[f64]) -> f64 {
        let mean = image.iter().sum::<f64>() / image.len() as f64;
        let variance = |values: &[f64]| values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
        let square = |at: u32| -> f64 {
            let (x, y) = (at % (SIZE - 7), at / (SIZE - 7));
            (0..64).map(|i| image[((y + i / 8) * SIZE + x + i % 8) as usize]).sum::<f64>() / 64.0
        };
        let squares: Vec<f64> = (0..(SIZE - 7).pow(2)).map(square).collect();
        variance(&squares) * 64.0 / variance(image)
    }

    #[test]
    fn the_error_is_blue_over_the_screen() {
        // Smooth functions and one with an edge, at a sample a pixel and at four.
        let integrands: [fn(Vec2) -> f64; 3] =
            [|p| p.x.into(), |p| f64::from(p.x * p.y), |p| f64::from(u8::from(p.x + 0.5 * p.y < 0.8))];
        for integrand in integrands {
            for (samples, most) in [(1, 0.5), (4, 0.9)] {
                for seed in 0..3 {
                    let mut sampler = blue_noise_dithered(seed, samples);
                    let mut pixel = |i: u32| -> f64 {
                        let value = |sample| {
                            sampler.start_pixel(UVec2::new(i % SIZE, i / SIZE), SIZE, sample);
                            integrand(sampler.get_2d(1, Purpose::LightPoint))
                        };
                        (0..samples).map(value).sum::<f64>() / f64::from(samples)
                    };
                    let image: Vec<f64> = (0..SIZE * SIZE).map(&mut pixel).collect();
                    let share = share_of_low_frequencies(&image);
                    assert!(share < most, "{samples} samples, seed {seed}: {share}");
                }
            }
        }
    }
}
