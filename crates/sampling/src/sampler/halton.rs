//! Halton points, the first dimensions of a path from one sequence.

use crate::{
    halton::{DIMENSIONS, point, radical_inverse},
    sobol::Index,
};
use etendue_core::{
    independent::Independent,
    sampler::{Purpose, Sampler},
};
use glam::Vec2;

/// Numbers from scrambled Halton sequences.
///
/// Film, lens, and what a walk from the camera takes at its first four vertices are the 32 dimensions of one sequence:
/// they are well distributed together, not only each by itself. All others are padded with its first two dimensions.
pub fn halton(seed: u64, planned: u32) -> Box<dyn Sampler> {
    Box::new(Halton { words: Independent::new(seed), planned, sample: 0, index: Index::new(0, planned) })
}

struct Halton {
    words: Independent,
    planned: u32,
    sample: u32,
    index: Index,
}

/// Dimensions of film and lens.
const AT_CAMERA: u32 = 4;
/// Dimensions of a vertex.
const AT_VERTEX: u32 = 7;

const _: () = assert!(DIMENSIONS as u32 == AT_CAMERA + 4 * AT_VERTEX);

/// The first dimension of an address, if it is one of the sequence's.
#[inline]
fn dimension(vertex: u32, purpose: Purpose) -> Option<usize> {
    let (first, offset) = match (vertex, purpose) {
        (0, Purpose::Film) => return Some(0),
        (0, Purpose::Lens) => return Some(2),
        (1..=4, Purpose::LightPoint) => (vertex, 0),
        (1..=4, Purpose::Direction) => (vertex, 2),
        (1..=4, Purpose::LightChoice) => (vertex, 4),
        (1..=4, Purpose::Lobe) => (vertex, 5),
        (1..=4, Purpose::Roulette) => (vertex, 6),
        _ => return None,
    };
    Some((AT_CAMERA + AT_VERTEX * (first - 1) + offset) as usize)
}

impl Sampler for Halton {
    #[inline]
    fn start_sample(&mut self, index: u32, sample: u32) {
        self.words.start_sample(index, 0);
        (self.sample, self.index) = (sample, Index::new(sample, self.planned));
    }

    #[inline]
    fn get_1d(&mut self, vertex: u32, purpose: Purpose) -> f32 {
        let key = self.words.word(vertex, purpose);
        match dimension(vertex, purpose) {
            Some(dimension) => radical_inverse(self.sample, dimension, key),
            None => self.index.padded_1d(key),
        }
    }

    #[inline]
    fn get_2d(&mut self, vertex: u32, purpose: Purpose) -> Vec2 {
        let key = self.words.word(vertex, purpose);
        match dimension(vertex, purpose) {
            // A pair at the address of a single number may lie at the end of the table.
            Some(dimension) if dimension + 1 < DIMENSIONS => point(self.sample, dimension, key),
            _ => point(self.index.shuffled(key), 0, key),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dimension_is_taken_once() {
        let mut taken = [0; DIMENSIONS];
        let mut take = |vertex, purpose, numbers| {
            let first = dimension(vertex, purpose).unwrap();
            taken[first..first + numbers].iter_mut().for_each(|n| *n += 1);
        };
        take(0, Purpose::Film, 2);
        take(0, Purpose::Lens, 2);
        for vertex in 1..=4 {
            for pair in [Purpose::LightPoint, Purpose::Direction] {
                take(vertex, pair, 2);
            }
            for number in [Purpose::LightChoice, Purpose::Lobe, Purpose::Roulette] {
                take(vertex, number, 1);
            }
        }
        assert_eq!(taken, [1; DIMENSIONS]);
        assert_eq!((dimension(5, Purpose::Lobe), dimension(1, Purpose::LightWalkLobe)), (None, None));
    }
}
