//! Halton points with scrambled digits.

use crate::{
    lattice::place,
    permutation::scaled,
    sobol::{Index, second},
};
use etendue_core::digest::mix;
use glam::Vec2;

/// The bases of the dimensions that there are.
const PRIMES: [u32; DIMENSIONS] = [
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103, 107, 109,
    113, 127, 131,
];

/// The number of dimensions of one sequence. Further ones are for sequences of their own, shuffled ("padding").
pub const DIMENSIONS: usize = 32;

/// The first `count` points of a scrambled Halton sequence in bases 2 and 3.
///
/// Any `2^a 3^b` consecutive points have one in each box of size `2^-a` by `3^-b`. The variance on a smooth integrand
/// falls nearly as `N^-3` at such numbers, and nearly as `N^-2` in between.
pub fn halton(count: u32, seed: u64) -> Vec<Vec2> {
    let key = mix(seed ^ 0x6c8e_9cf5_7093_2bd5);
    (0..count).map(|index| point(index, 0, key)).collect()
}

/// Number `index` of the radical inverses in the base of a dimension, the `dimension`-th prime, with its digits
/// scrambled as `key` says, which need not be random; below 1.
///
/// The same key goes with different dimensions as well as different ones do.
///
/// # Panics
/// If `dimension` is not below [`DIMENSIONS`].
///
/// ```
/// use etendue_sampling::halton::scrambled_radical_inverse;
/// let mut fifths: Vec<u32> = (0..5).map(|i| (scrambled_radical_inverse(i, 2, 7) * 5.0) as u32).collect();
/// fifths.sort();
/// assert_eq!(fifths, [0, 1, 2, 3, 4]);
/// ```
pub fn scrambled_radical_inverse(index: u32, dimension: usize, key: u64) -> f32 {
    radical_inverse(index, dimension, mix(key ^ 0x6c8e_9cf5_7093_2bd5))
}

/// Dimensions `first` and the next, for a key of random bits.
#[inline]
pub(crate) fn point(index: u32, first: usize, key: u64) -> Vec2 {
    Vec2::new(radical_inverse(index, first, key), radical_inverse(index, first + 1, second(key)))
}

/// As [`scrambled_radical_inverse`], for a key of random bits.
#[inline]
pub(crate) fn radical_inverse(index: u32, dimension: usize, key: u64) -> f32 {
    if dimension == 0 {
        return Index::scrambled(index, key);
    }
    let base = &BASES[dimension];
    let (mut rest, mut value, mut hash) = (index, 0, key);
    for _ in 0..base.digits {
        let (quotient, digit) = base.divide(rest);
        rest = quotient;
        // Digits are permuted as the digits before them say [Owen 1995], here by a random affine function modulo the
        // base [Matoušek 1998, sec. 4]. Two digits that differ go to any two that differ, all equally likely, so pairs
        // of points, and with them the variance, are as for random permutations.
        let factor = 1 + scaled(hash as u32, base.prime - 1);
        let offset = scaled((hash >> 32) as u32, base.prime);
        let (_, permuted) = base.divide(factor * digit + offset);
        value = value * base.prime + permuted;
        hash = (hash ^ u64::from(digit + 1)).wrapping_mul(0xd1b5_4a32_d192_ed03);
        hash ^= hash >> 32;
    }
    place(value, base.intervals, mix(hash) as u32)
}

struct Base {
    prime: u32,
    /// As many as there is room for.
    digits: u32,
    /// The base to the power of the digits, at most `2^24`.
    intervals: u32,
    /// `2^64` over the base, rounded up.
    reciprocal: u64,
}

static BASES: [Base; DIMENSIONS] = {
    let mut bases = [const { Base::new(2) }; DIMENSIONS];
    let mut i = 0;
    while i < DIMENSIONS {
        bases[i] = Base::new(PRIMES[i]);
        i += 1;
    }
    bases
};

impl Base {
    const fn new(prime: u32) -> Base {
        let (mut digits, mut intervals) = (1, prime);
        while intervals * prime <= 1 << 24 {
            digits += 1;
            intervals *= prime;
        }
        Base { prime, digits, intervals, reciprocal: u64::MAX / prime as u64 + 1 }
    }

    /// Quotient and remainder, by a product [Lemire, Kaser and Kurz 2019, sec. 3.2]: exact for 32 bits.
    #[inline]
    fn divide(&self, n: u32) -> (u32, u32) {
        let quotient = ((u128::from(self.reciprocal) * u128::from(n)) >> 64) as u32;
        (quotient, n - quotient * self.prime)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn division_is_exact(n: u32) {
            for base in &BASES {
                prop_assert_eq!(base.divide(n), (n / base.prime, n % base.prime));
            }
        }

        #[test]
        fn any_consecutive_points_fall_one_into_each_interval(dimension in 0..DIMENSIONS, first in 0..1_u32 << 20, key: u64) {
            let base = PRIMES[dimension];
            for n in [base, base * base] {
                let mut counts = vec![0; n as usize];
                for index in first..first + n {
                    let u = f64::from(scrambled_radical_inverse(index, dimension, key));
                    counts[(u * f64::from(n)) as usize] += 1;
                }
                prop_assert!(counts.iter().all(|&c| c == 1), "base {}: {:?}", base, counts);
            }
        }

        #[test]
        fn boxes_hold_one_point_each(a in 0..6_u32, b in 0..4_u32, seed: u64) {
            let (columns, rows) = (1 << a, 3_u32.pow(b));
            let mut counts = vec![0; (columns * rows) as usize];
            for p in halton(columns * rows, seed) {
                let (x, y) = (f64::from(p.x) * f64::from(columns), f64::from(p.y) * f64::from(rows));
                counts[x as usize * rows as usize + y as usize] += 1;
            }
            prop_assert!(counts.iter().all(|&n| n == 1));
        }
    }

    #[test]
    fn bases_are_the_first_primes() {
        let is_prime = |n: &u32| (2..*n).all(|d| !n.is_multiple_of(d));
        assert!((2..).filter(is_prime).take(DIMENSIONS).eq(PRIMES));
    }
}
