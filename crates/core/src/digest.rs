//! What stands for long data where they are printed.

use std::fmt;

/// A digest of a row of numbers: other numbers, or another order, give another one but for chance.
///
/// Each number is mixed in by the output function of SplitMix64 [Steele, Lea and Flood 2014, fig. 16].
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct Digest(u64);

impl Digest {
    /// Goes on with a number.
    #[inline]
    pub fn add(&mut self, number: u32) {
        self.0 = mix(self.0.wrapping_add(u64::from(number)).wrapping_add(GOLDEN));
    }
}

impl FromIterator<u32> for Digest {
    fn from_iter<I: IntoIterator<Item = u32>>(numbers: I) -> Digest {
        let mut digest = Digest::default();
        numbers.into_iter().for_each(|n| digest.add(n));
        digest
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// The odd integer nearest to `2^64` over the golden ratio [Steele, Lea and Flood 2014, sec. 5].
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A bijection of 64 bits, of which each depends on all [Steele, Lea and Flood 2014, fig. 16; Stafford's constants 13].
#[inline]
pub fn mix(mut z: u64) -> u64 {
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_and_its_place_counts() {
        let base: Digest = [1, 2, 3].into_iter().collect();
        for other in [&[1, 2][..], &[1, 2, 3, 0], &[0, 1, 2, 3], &[1, 3, 2], &[1, 2, 4]] {
            assert_ne!(base, other.iter().copied().collect());
        }
        assert_eq!(format!("{base:?}").len(), 16);
    }
}
