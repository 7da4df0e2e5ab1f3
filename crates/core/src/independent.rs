//! Independent random numbers.

use crate::{
    digest::{GOLDEN, mix},
    sampler::{Purpose, Sampler},
};
use glam::Vec2;

/// Independent uniform numbers, computed from their address alone: whatever else is drawn, or in which order, changes
/// none of them.
///
/// A number is a hash of (seed, index, sample, vertex, purpose) by the output function of SplitMix64, which is a
/// bijection of 64 bits [Steele, Lea and Flood 2014, fig. 16; constants of Stafford's mix 13]. It has 24 bits.
///
/// ```
/// use etendue_core::{independent::Independent, sampler::{Purpose, Sampler}};
/// let mut sampler = Independent::new(7);
/// sampler.start_sample(1000, 3);
/// let u = sampler.get_1d(2, Purpose::Roulette);
/// sampler.get_2d(0, Purpose::Film);
/// assert_eq!(u, sampler.get_1d(2, Purpose::Roulette));
/// ```
#[derive(Clone, Debug)]
pub struct Independent {
    seed: u64,
    /// Hash of seed, index and sample.
    base: u64,
}

/// More purposes than there are.
const PURPOSES: u64 = 32;

const _: () = assert!((Purpose::LightCandidate as u64) < PURPOSES);

impl Independent {
    /// A sampler at sample 0 of index 0.
    pub fn new(seed: u64) -> Independent {
        let mut sampler = Independent { seed: mix(seed.wrapping_add(GOLDEN)), base: 0 };
        sampler.start_sample(0, 0);
        sampler
    }

    /// 64 bits for an address, of which the numbers are the upper ones of either half: the source of other samplers.
    #[inline]
    pub fn word(&self, vertex: u32, purpose: Purpose) -> u64 {
        let address = u64::from(vertex) * PURPOSES + purpose as u64 + 1;
        mix(self.base.wrapping_add(address.wrapping_mul(GOLDEN)))
    }
}

impl Sampler for Independent {
    #[inline]
    fn start_sample(&mut self, index: u32, sample: u32) {
        // Hashed twice, so that the bases of neighbours are far from each other's multiples of GOLDEN; a bijection, so
        // that no two samples of a seed share a base.
        let address = u64::from(index) << 32 | u64::from(sample);
        self.base = mix(mix(address.wrapping_mul(GOLDEN) ^ self.seed).wrapping_add(self.seed));
    }

    #[inline]
    fn get_1d(&mut self, vertex: u32, purpose: Purpose) -> f32 {
        unit((self.word(vertex, purpose) >> 32) as u32)
    }

    #[inline]
    fn get_2d(&mut self, vertex: u32, purpose: Purpose) -> Vec2 {
        let word = self.word(vertex, purpose);
        Vec2::new(unit((word >> 32) as u32), unit(word as u32))
    }
}

/// Builds an [`Independent`] sampler, which has no use for the number of planned samples.
pub fn independent(seed: u64, _planned: u32) -> Box<dyn Sampler> {
    Box::new(Independent::new(seed))
}

/// The upper 24 bits as a number in `[0, 1)`: all that an `f32` resolves near 1, so that nothing rounds to 1.
#[inline]
pub fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1 << 24) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{sampler::SamplerBuilder, statistics::chi_square};

    const PURPOSES_USED: [Purpose; 5] =
        [Purpose::Film, Purpose::Lens, Purpose::LightChoice, Purpose::Direction, Purpose::CameraConnection];

    /// Chi-square of pairs on a grid of 32 x 32.
    fn p_value(pairs: impl Iterator<Item = (f32, f32)>) -> f64 {
        let mut counts = vec![0_u64; 1024];
        let mut total = 0;
        for (x, y) in pairs {
            counts[(y * 32.0) as usize * 32 + (x * 32.0) as usize] += 1;
            total += 1;
        }
        let expected = vec![total as f64 / 1024.0; 1024];
        chi_square::test(&counts, &expected, 5.0).p_value
    }

    #[test]
    fn the_same_address_gives_the_same_number_and_another_one_does_not() {
        const BUILD: SamplerBuilder = independent;
        let (mut a, mut b) = (BUILD(3, 0), BUILD(3, 16));
        a.get_1d(0, Purpose::Film);
        b.start_sample(9, 9);
        b.start_sample(0, 0);
        let u = a.get_2d(4, Purpose::Lobe);
        assert_eq!(u, b.get_2d(4, Purpose::Lobe));
        assert_ne!(u, a.get_2d(5, Purpose::Lobe));
        assert_ne!(u, a.get_2d(4, Purpose::Direction));
        a.start_sample(0, 1);
        assert_ne!(u, a.get_2d(4, Purpose::Lobe));
        a.start_sample(1, 0);
        assert_ne!(u, a.get_2d(4, Purpose::Lobe));
        assert_ne!(u, BUILD(4, 0).get_2d(4, Purpose::Lobe));
    }

    #[test]
    fn numbers_reach_their_ends_and_never_1() {
        assert_eq!(unit(0), 0.0);
        assert_eq!(unit(u32::MAX), 1.0_f32.next_down());
    }

    #[test]
    fn pairs_of_neighbouring_addresses_are_uniform() {
        let seeds = [0, 1, u64::MAX];
        let number = |seed: u64, index: u32, sample: u32, vertex: u32, purpose: Purpose| {
            let mut sampler = Independent::new(seed);
            sampler.start_sample(index, sample);
            sampler.get_1d(vertex, purpose)
        };
        let mut p_values = Vec::new();
        for seed in seeds {
            let addresses = || (0..400_u32).flat_map(|index| (0..400_u32).map(move |sample| (index, sample)));
            for purpose in PURPOSES_USED {
                p_values.push(p_value(addresses().map(|(i, s)| {
                    let mut sampler = Independent::new(seed);
                    sampler.start_sample(i, s);
                    sampler.get_2d(3, purpose).into()
                })));
                let mut against = |other: &dyn Fn(u32, u32) -> f32| {
                    let first = |i, s| number(seed, i, s, 1, purpose);
                    p_values.push(p_value(addresses().map(|(i, s)| (first(i, s), other(i, s)))));
                };
                against(&|i, s| number(seed, i + 1, s, 1, purpose));
                against(&|i, s| number(seed, i + 512, s, 1, purpose));
                against(&|i, s| number(seed, i, s + 1, 1, purpose));
                against(&|i, s| number(seed, i, s, 2, purpose));
                against(&|i, s| number(seed, i, s, 1, Purpose::Roulette));
                against(&|i, s| number(seed.wrapping_add(2), i, s, 1, purpose));
                against(&|i, s| number(seed ^ 1 << 63, i, s, 1, purpose));
            }
            // Along one path.
            let along = |i: u32| number(seed, 5, 5, i, Purpose::Lobe);
            p_values.push(p_value((0..160_000).map(|i| (along(i), along(i + 1)))));
        }
        let worst = p_values.iter().copied().fold(1.0, f64::min);
        assert!(worst > chi_square::sidak(1e-4, p_values.len()), "{worst:e} of {}", p_values.len());
    }

    #[test]
    fn every_bit_is_fair() {
        let mut ones = [0_u32; 48];
        let samples = 1 << 16;
        for sample in 0..samples {
            let mut sampler = Independent::new(11);
            sampler.start_sample(sample >> 8, sample & 255);
            let u = sampler.get_2d(0, Purpose::Film) * (1 << 24) as f32;
            let bits = u64::from(u.x as u32) << 24 | u64::from(u.y as u32);
            ones.iter_mut().enumerate().for_each(|(i, n)| *n += (bits >> i & 1) as u32);
        }
        for n in ones {
            let z = (f64::from(n) - f64::from(samples) / 2.0) / (f64::from(samples) / 4.0).sqrt();
            assert!(z.abs() < 5.0, "{z}");
        }
    }
}
