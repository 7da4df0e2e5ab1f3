//! Lens, light and time assigned across pixels.

use super::{Block, NO_PIXEL, seed_of};
use crate::{
    distribution::{MOST, Parameters, Tile},
    layout::Layout,
    permutation::permute,
    sobol::Index,
    stratified::jitter,
    torus::position,
};
use etendue_core::{
    independent::{Independent, unit},
    sampler::{Purpose, Sampler},
};
use glam::{UVec2, Vec2};

/// Film positions one in each stratum of the pixel; points on the lens, points on the first light, and one number more
/// stratified in each pixel and assigned so that samples near each other in the image have them far from each other
/// [Mitchell 1991].
///
/// That further number, the time in the paper, is the choice of the first light: scenes do not move. Further numbers are
/// as by [`sobol`](super::sobol()). At most 64 samples a pixel make one pattern, 16 if their number is unknown. The tile
/// of pixels for a number of samples is made when it is first used.
pub fn mitchell(seed: u64, planned: u32) -> Box<dyn Sampler> {
    let count = if planned == 0 { 16 } else { planned.min(MOST) };
    let words = Independent::new(seed_of(seed, planned));
    let mut sampler = Distributed {
        planned,
        tile: Tile::of(count),
        layout: Layout::new(count),
        shared: words.clone(),
        words,
        stratum: 0,
        parameters: Parameters::default(),
        index: Index::new(0, planned),
    };
    sampler.start_sample(0, 0);
    Box::new(sampler)
}

struct Distributed {
    planned: u32,
    tile: &'static Tile,
    layout: Layout,
    /// Words that all pixels share, of the block.
    shared: Independent,
    /// Words of the pixel.
    words: Independent,
    stratum: u32,
    parameters: Parameters,
    index: Index,
}

impl Distributed {
    /// A parameter of the sample, shifted by an offset that all pixels share.
    #[inline]
    fn shifted(&self, parameter: usize, vertex: u32, purpose: Purpose) -> [u32; 2] {
        let [x, y] = self.parameters[parameter];
        let offset = jitter(self.shared.word(vertex, purpose), 0);
        [x.wrapping_add(offset[0]), y.wrapping_add(offset[1])]
    }

    /// Moves to a sample once `words` are those of its pixel.
    #[inline]
    fn start(&mut self, pixel: UVec2, shared_by: u32, sample: u32) {
        let block = Block::of(sample, self.layout.count());
        self.shared.start_sample(shared_by, block.start);
        let order = self.words.word(u32::MAX, Purpose::Film).wrapping_add(block.start.into());
        self.stratum = permute(sample - block.start, block.count, order);
        // The tile is laid over the image at another place for each block.
        let [x, y] = jitter(self.shared.word(u32::MAX, Purpose::Film), 0);
        self.parameters = self.tile.parameters(pixel.x.wrapping_add(x), pixel.y.wrapping_add(y), self.stratum);
        self.index = Index::new(sample, self.planned);
    }
}

impl Sampler for Distributed {
    #[inline]
    fn start_sample(&mut self, index: u32, sample: u32) {
        self.words.start_sample(index, 0);
        self.start(UVec2::ZERO, index, sample);
    }

    #[inline]
    fn start_pixel(&mut self, pixel: UVec2, width: u32, sample: u32) {
        self.words.start_sample(pixel.y * width + pixel.x, 0);
        self.start(pixel, NO_PIXEL, sample);
    }

    #[inline]
    fn get_1d(&mut self, vertex: u32, purpose: Purpose) -> f32 {
        match (vertex, purpose) {
            (1, Purpose::LightChoice) => unit(self.shifted(2, vertex, purpose)[0]),
            _ => self.index.padded_1d(self.words.word(vertex, purpose)),
        }
    }

    #[inline]
    fn get_2d(&mut self, vertex: u32, purpose: Purpose) -> Vec2 {
        match (vertex, purpose) {
            (0, Purpose::Film) => {
                // Another word for each block.
                let key = self.shared.word(vertex, purpose) ^ self.words.word(vertex, purpose);
                self.layout.place(self.stratum, jitter(key, self.stratum))
            }
            (0, Purpose::Lens) => position(self.shifted(0, vertex, purpose)),
            (1, Purpose::LightPoint) => position(self.shifted(1, vertex, purpose)),
            _ => self.index.padded_2d(self.words.word(vertex, purpose)),
        }
    }
}
