//! Patterns that keep points apart, from a table.

use super::{Block, seed_of};
use crate::{
    blue_noise::{best_candidate_places, poisson_disk_places},
    lattice::Parts,
    permutation::permute_by,
    stratified::jitter,
    torus::{Place, position},
};
use etendue_core::{
    digest::mix,
    independent::Independent,
    sampler::{Purpose, Sampler},
};
use glam::Vec2;
use std::sync::OnceLock;

/// Pairs from one best-candidate pattern of 1,024 points, shifted around the torus by an offset of each pixel and dimension.
///
/// The beginning of the pattern serves for fewer samples; after 1,024 it starts again with another offset, as the variance
/// falls no faster by then than it does for independent patterns. Single numbers are jittered. The pattern is made when it
/// is first used.
pub fn best_candidate(seed: u64, planned: u32) -> Box<dyn Sampler> {
    static POINTS: OnceLock<Vec<Place>> = OnceLock::new();
    Box::new(Tiled::new(POINTS.get_or_init(|| best_candidate_places(LENGTH, 0)), seed, planned))
}

/// As [`best_candidate`] with a Poisson-disk pattern.
pub fn poisson_disk(seed: u64, planned: u32) -> Box<dyn Sampler> {
    static POINTS: OnceLock<Vec<Place>> = OnceLock::new();
    Box::new(Tiled::new(POINTS.get_or_init(|| poisson_disk_places(LENGTH, 0).0), seed, planned))
}

/// Points of a pattern.
const LENGTH: u32 = 1024;

struct Tiled {
    points: &'static [Place],
    planned: u32,
    /// Words of the pixel and the repetition of the pattern.
    words: Independent,
    /// Where the block is in the pattern.
    block: Block,
    /// A part for each sample of the block.
    parts: Parts,
    /// The sample's number in the block.
    index: u32,
}

impl Tiled {
    fn new(points: &'static [Place], seed: u64, planned: u32) -> Tiled {
        let words = Independent::new(seed_of(seed, planned));
        let block = Block::of(0, planned.min(LENGTH));
        Tiled { points, planned, words, block, parts: Parts::new(block.count), index: 0 }
    }
}

impl Sampler for Tiled {
    #[inline]
    fn start_sample(&mut self, index: u32, sample: u32) {
        // If the number of samples is unknown, the blocks of a repetition together make the pattern.
        let length = if self.planned == 0 { LENGTH } else { self.planned.min(LENGTH) };
        let in_pattern = sample % length;
        self.words.start_sample(index, sample - in_pattern);
        self.block = Block::of(in_pattern, self.planned.min(LENGTH));
        if self.block.count != self.parts.count() {
            self.parts = Parts::new(self.block.count);
        }
        self.index = in_pattern - self.block.start;
    }

    #[inline]
    fn get_1d(&mut self, vertex: u32, purpose: Purpose) -> f32 {
        // Each block has strata of its own.
        let key = mix(self.words.word(vertex, purpose).wrapping_add(self.block.start.into()));
        let part = permute_by(self.index, self.block.count, key);
        self.parts.place(part, part + 1, jitter(key, part)[0])
    }

    #[inline]
    fn get_2d(&mut self, vertex: u32, purpose: Purpose) -> Vec2 {
        let key = self.words.word(vertex, purpose);
        let point = self.points[(self.block.start + permute_by(self.index, self.block.count, key)) as usize];
        // Not the bits that the order came from.
        let offset = jitter(key, u32::MAX);
        position([point[0].wrapping_add(offset[0]), point[1].wrapping_add(offset[1])])
    }
}
