//! Padded Sobol points with Owen scrambling.

use crate::sobol::Index;
use etendue_core::{
    independent::Independent,
    sampler::{Purpose, Sampler},
};
use glam::Vec2;

/// Numbers and pairs from Owen-scrambled Sobol sequences, each scrambled and shuffled by its address [Burley 2020].
///
/// Best at powers of two, of which each from 16 on holds one sample in each box of its area. If fewer than 16 samples are
/// planned, smaller powers do as well.
///
/// ```
/// use etendue_core::sampler::Purpose;
/// let mut sampler = etendue_sampling::sampler::sobol(1, 0);
/// let parts: Vec<u32> = (0..16)
///     .map(|sample| {
///         sampler.start_sample(1000, sample);
///         (sampler.get_1d(2, Purpose::Lobe) * 16.0) as u32
///     })
///     .collect();
/// assert!((0..16).all(|part| parts.contains(&part)));
/// ```
pub fn sobol(seed: u64, planned: u32) -> Box<dyn Sampler> {
    Box::new(Sobol { words: Independent::new(seed), planned, index: Index::new(0, planned) })
}

struct Sobol {
    words: Independent,
    planned: u32,
    index: Index,
}

impl Sampler for Sobol {
    #[inline]
    fn start_sample(&mut self, index: u32, sample: u32) {
        self.words.start_sample(index, 0);
        self.index = Index::new(sample, self.planned);
    }

    #[inline]
    fn get_1d(&mut self, vertex: u32, purpose: Purpose) -> f32 {
        self.index.padded_1d(self.words.word(vertex, purpose))
    }

    #[inline]
    fn get_2d(&mut self, vertex: u32, purpose: Purpose) -> Vec2 {
        self.index.padded_2d(self.words.word(vertex, purpose))
    }
}
