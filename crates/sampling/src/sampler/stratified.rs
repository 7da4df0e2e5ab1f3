//! Patterns of one point a stratum.

use super::{Block, NO_PIXEL, seed_of};
use crate::{
    layout::Layout,
    permutation::permute_by,
    stratified::{halves, jitter},
};
use etendue_core::{
    independent::Independent,
    sampler::{Purpose, Sampler},
};
use glam::Vec2;

/// A regular grid, moved by a random offset that is the same for all pixels: their numbers differ in order alone, so
/// that errors show as structure in the image. Single numbers form regular rows.
pub fn grid(seed: u64, planned: u32) -> Box<dyn Sampler> {
    Stratified::boxed(Kind::Grid, seed, planned)
}

/// One random point in each stratum.
pub fn jittered(seed: u64, planned: u32) -> Box<dyn Sampler> {
    Stratified::boxed(Kind::Jittered, seed, planned)
}

/// A regular grid, moved by a random offset of each pixel and dimension. Single numbers form regular rows.
pub fn uniform_jitter(seed: u64, planned: u32) -> Box<dyn Sampler> {
    Stratified::boxed(Kind::UniformJitter, seed, planned)
}

/// Multi-jitter. Single numbers are jittered.
pub fn multi_jittered(seed: u64, planned: u32) -> Box<dyn Sampler> {
    Stratified::boxed(Kind::MultiJittered, seed, planned)
}

/// Correlated multi-jitter. Single numbers are jittered.
pub fn correlated_multi_jittered(seed: u64, planned: u32) -> Box<dyn Sampler> {
    Stratified::boxed(Kind::CorrelatedMultiJittered, seed, planned)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Grid,
    Jittered,
    UniformJitter,
    MultiJittered,
    CorrelatedMultiJittered,
}

struct Stratified {
    kind: Kind,
    planned: u32,
    /// Words of the pixel and the block.
    words: Independent,
    /// Words that all pixels share, of the block.
    shared: Independent,
    /// Strata of the block.
    layout: Layout,
    /// The sample's number in the block.
    index: u32,
}

impl Stratified {
    fn boxed(kind: Kind, seed: u64, planned: u32) -> Box<dyn Sampler> {
        let words = Independent::new(seed_of(seed, planned));
        let layout = Layout::new(Block::of(0, planned).count);
        let mut sampler = Stratified { kind, planned, shared: words.clone(), words, layout, index: 0 };
        sampler.start_sample(0, 0);
        Box::new(sampler)
    }

    /// The sample's stratum, and its random numbers there.
    #[inline]
    fn stratum(&self, vertex: u32, purpose: Purpose, key: u64) -> (u32, [u32; 2]) {
        let stratum = permute_by(self.index, self.layout.count(), key);
        let random = match self.kind {
            Kind::Grid => halves(self.shared.word(vertex, purpose)),
            // Not the bits that the order came from.
            Kind::UniformJitter => jitter(key, u32::MAX),
            Kind::Jittered | Kind::MultiJittered | Kind::CorrelatedMultiJittered => jitter(key, stratum),
        };
        (stratum, random)
    }
}

impl Sampler for Stratified {
    #[inline]
    fn start_sample(&mut self, index: u32, sample: u32) {
        let block = Block::of(sample, self.planned);
        if block.count != self.layout.count() {
            self.layout = Layout::new(block.count);
        }
        self.words.start_sample(index, block.start);
        if self.kind == Kind::Grid {
            self.shared.start_sample(NO_PIXEL, block.start);
        }
        self.index = sample - block.start;
    }

    #[inline]
    fn get_1d(&mut self, vertex: u32, purpose: Purpose) -> f32 {
        let key = self.words.word(vertex, purpose);
        let (stratum, [random, _]) = self.stratum(vertex, purpose, key);
        self.layout.place_1d(stratum, random)
    }

    #[inline]
    fn get_2d(&mut self, vertex: u32, purpose: Purpose) -> Vec2 {
        let key = self.words.word(vertex, purpose);
        let (stratum, random) = self.stratum(vertex, purpose, key);
        match self.kind {
            Kind::Grid | Kind::Jittered | Kind::UniformJitter => self.layout.place(stratum, random),
            Kind::MultiJittered => self.layout.place_finely(stratum, random, key, false),
            Kind::CorrelatedMultiJittered => self.layout.place_finely(stratum, random, key, true),
        }
    }
}
