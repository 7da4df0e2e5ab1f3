//! The patterns as [`Sampler`](etendue_core::sampler::Sampler)s, for every technique.
//!
//! Each function here is a [`SamplerBuilder`]. What they have in common:
//!
//! - A number is computed from its address, so any order of calls gives the same bits.
//! - Over seeds, every single number is uniform and so every estimate is unbiased, at every number of samples. Pixels,
//!   and pairs of dimensions of a pixel, are independent of each other unless the function says otherwise. ("Padding":
//!   each dimension, or pair drawn together, has a randomisation of its own and goes through its points in an order of
//!   its own [Kollig and Keller 2002, sec. 3; Kensler 2013, sec. 4; Burley 2020, sec. 4].)
//! - Samples past the planned number are as good as others: a pattern with a fixed number of points is followed by
//!   another of the same size. If the number is unknown, patterns of 16, 16, 32, 64, 128, ... points follow each other,
//!   so that every power of two from 16 on is made of whole ones.

mod distributed;
mod dithered;
mod halton;
mod sobol;
mod stratified;
#[cfg(test)]
mod tests;
mod tiled;

pub use distributed::mitchell;
pub use dithered::blue_noise_dithered;
pub use halton::halton;
pub use sobol::sobol;
pub use stratified::{correlated_multi_jittered, grid, jittered, multi_jittered, uniform_jitter};
pub use tiled::{best_candidate, poisson_disk};

#[cfg(doc)]
use etendue_core::sampler::SamplerBuilder;

/// A run of samples that make one pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Block {
    /// Its first sample.
    start: u32,
    /// How many it has, at least 1.
    count: u32,
}

/// The first block if the number of samples is unknown.
const FIRST_BLOCK: u32 = 16;

impl Block {
    /// The block of a sample, `planned` samples being planned (0: unknown).
    #[inline]
    fn of(sample: u32, planned: u32) -> Block {
        if let Some(before) = sample.checked_div(planned) {
            return Block { start: before * planned, count: planned };
        }
        if sample < FIRST_BLOCK {
            return Block { start: 0, count: FIRST_BLOCK };
        }
        let start = 1 << sample.ilog2();
        Block { start, count: start }
    }
}

/// A pixel that no image has, for what all pixels share.
const NO_PIXEL: u32 = u32::MAX;

/// A seed for which samplers with other plans have other numbers.
fn seed_of(seed: u64, planned: u32) -> u64 {
    seed ^ etendue_core::digest::mix(planned.into())
}

#[cfg(test)]
mod block_tests {
    use super::*;

    #[test]
    fn blocks_follow_each_other() {
        for planned in [0, 1, 7, 64] {
            let mut next = 0;
            while next < 10_000 {
                let block = Block::of(next, planned);
                assert_eq!(block.start, next);
                assert_eq!(Block::of(next + block.count - 1, planned), block);
                next += block.count;
            }
        }
        assert_eq!(Block::of(u32::MAX, 0), Block { start: 1 << 31, count: 1 << 31 });
        assert_eq!(Block::of(u32::MAX, u32::MAX), Block { start: u32::MAX, count: u32::MAX });
    }
}
