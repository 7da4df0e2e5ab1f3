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
