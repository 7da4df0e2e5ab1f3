//! Fixed-point numbers of 128 bits, whose sums do not depend on the order of their terms.

use std::sync::atomic::{AtomicU64, Ordering};

/// A fixed-point number: a multiple of `2^-FRACTION`, made from numbers of magnitude below `2^LIMIT`.
///
/// Adding is exact, so a sum has the same bits in any order; at least `2^(127 - FRACTION - LIMIT)` terms fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fixed<const FRACTION: u32, const LIMIT: u32>(i128);

/// What a film sums: resolution `2^-64` (5.4e-20), terms below `2^32`, room for `2^31` terms. A positive `f32` of at
/// least `2^-41` is held exactly.
pub type FixedSum = Fixed<64, 32>;

/// Squares of what a film sums: resolution `2^-43` (1.1e-13, the square of 3.4e-7), terms below `2^64`, room for
/// `2^20` of the largest terms.
pub type FixedSquare = Fixed<43, 64>;

impl<const FRACTION: u32, const LIMIT: u32> Fixed<FRACTION, LIMIT> {
    /// Zero.
    pub const ZERO: Self = Fixed(0);

    /// Numbers of this magnitude and above are refused: `2^LIMIT`.
    pub const TERM_LIMIT: f64 = {
        assert!(FRACTION + LIMIT < 127 && LIMIT <= 64);
        // A double that is a power of two is its biased exponent alone.
        f64::from_bits(((1023 + LIMIT) as u64) << 52)
    };

    /// The nearest multiple of the resolution; `None` when `value` is not finite or its magnitude is at least
    /// [`Fixed::TERM_LIMIT`].
    #[inline]
    pub fn new(value: f64) -> Option<Self> {
        (value.abs() < Self::TERM_LIMIT).then(|| Self::from_in_range(value))
    }

    /// As [`Fixed::new`], for a value whose range has been checked.
    #[inline]
    pub(crate) fn from_in_range(value: f64) -> Self {
        debug_assert!(value.abs() < Self::TERM_LIMIT);
        let bits = value.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as i32;
        // A subnormal is far below any resolution: that the implicit bit is wrong for it does not matter.
        let mantissa = bits & ((1 << 52) - 1) | 1 << 52;
        // |value| = mantissa * 2^(exponent - 1075) [IEEE 754-2019, sec. 3.4]
        let shift = exponent - 1075 + FRACTION as i32;
        let magnitude = if shift >= 0 {
            i128::from(mantissa) << shift
        } else {
            let shift = (-shift).min(63) as u32;
            i128::from((mantissa + (1 << (shift - 1))) >> shift)
        };
        Fixed(if value < 0.0 { -magnitude } else { magnitude })
    }

    /// The multiple of the resolution, as it is stored in files.
    #[inline]
    pub const fn to_raw(self) -> i128 {
        self.0
    }

    /// The number whose multiple of the resolution is `raw`.
    #[inline]
    pub const fn from_raw(raw: i128) -> Self {
        Fixed(raw)
    }

    /// The nearest double.
    #[inline]
    pub fn to_f64(self) -> f64 {
        // 2^-FRACTION; scaling by a power of two rounds no further.
        self.0 as f64 * f64::from_bits(((1023 - FRACTION) as u64) << 52)
    }

    /// The exact sum; `None` when it does not fit.
    #[inline]
    pub fn checked_add(self, other: Self) -> Option<Self> {
        self.0.checked_add(other.0).map(Fixed)
    }
}

/// A [`Fixed`] to which many threads may add at once, in safe code: the sum does not depend on their order.
#[derive(Debug, Default)]
pub struct AtomicFixed<const FRACTION: u32, const LIMIT: u32> {
    low: AtomicU64,
    high: AtomicU64,
}

impl<const FRACTION: u32, const LIMIT: u32> AtomicFixed<FRACTION, LIMIT> {
    /// Adds a term. The sum is modulo `2^128` units of the resolution.
    #[inline]
    pub fn add(&self, term: Fixed<FRACTION, LIMIT>) {
        let low = term.0 as u64;
        let high = (term.0 >> 64) as u64;
        // Additions to the low limb have one order, and each carry belongs to exactly one of them; the carries then
        // commute. Nobody may read in between, so relaxed order is enough.
        let before = self.low.fetch_add(low, Ordering::Relaxed);
        let high = high.wrapping_add(u64::from(before.overflowing_add(low).1));
        if high != 0 {
            self.high.fetch_add(high, Ordering::Relaxed);
        }
    }

    /// The sum of what was added; meaningless while other threads are adding.
    #[inline]
    pub fn get(&self) -> Fixed<FRACTION, LIMIT> {
        let high = self.high.load(Ordering::Relaxed) as i64;
        Fixed(i128::from(high) << 64 | i128::from(self.low.load(Ordering::Relaxed)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum(terms: impl Iterator<Item = f64>) -> FixedSum {
        terms.fold(FixedSum::ZERO, |sum, t| sum.checked_add(FixedSum::new(t).unwrap()).unwrap())
    }

    #[test]
    fn limits_and_rounding() {
        let limit = (2.0_f64).powi(32);
        assert_eq!(FixedSum::TERM_LIMIT, limit);
        assert_eq!(FixedSquare::TERM_LIMIT, limit * limit);
        for refused in [limit, -limit, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            assert_eq!(FixedSum::new(refused), None);
        }
        let unit = (2.0_f64).powi(-64);
        for (value, raw) in [
            (0.0, 0),
            (-0.0, 0),
            (1.0, 1 << 64),
            (-1.0, -1 << 64),
            (unit, 1),
            (0.5 * unit, 1),
            (0.4999 * unit, 0),
            (2.5 * unit, 3),
            (-2.4 * unit, -2),
            (f64::MIN_POSITIVE, 0),
            (5e-324, 0),
            (limit.next_down(), ((1 << 53) - 1) << 43),
        ] {
            assert_eq!(FixedSum::new(value).unwrap().to_raw(), raw, "{value:e}");
        }
    }

    #[test]
    fn the_promised_number_of_terms_fits() {
        let largest = FixedSquare::new(FixedSquare::TERM_LIMIT.next_down()).unwrap();
        assert!(largest.to_raw().checked_mul(1 << 20).is_some());
        let largest = FixedSum::new(FixedSum::TERM_LIMIT.next_down()).unwrap();
        assert!(largest.to_raw().checked_mul(1 << 31).is_some());
    }

    #[test]
    fn threads_agree_with_one_after_another() {
        let terms: Vec<f64> = (0..40_000).map(|i| (f64::from(i) * 0.7331).sin() * 4e9 * 0.5_f64.powi(i % 90)).collect();
        let total = AtomicFixed::<64, 32>::default();
        std::thread::scope(|scope| {
            for part in terms.chunks(terms.len() / 4) {
                let total = &total;
                scope.spawn(move || part.iter().for_each(|&t| total.add(FixedSum::new(t).unwrap())));
            }
        });
        assert_eq!(total.get(), sum(terms.iter().copied()));
    }

    proptest! {
        #[test]
        fn f32_above_the_floor_is_exact(negative: bool, exponent in -41..32, fraction in 0..1_u32 << 23) {
            // From 2^-41, of which the last bit is the resolution, up to the limit.
            let magnitude = f32::from_bits(((127 + exponent) as u32) << 23 | fraction);
            let v = f64::from(if negative { -magnitude } else { magnitude });
            prop_assert_eq!(FixedSum::new(v).unwrap().to_f64(), v);
        }

        #[test]
        fn sums_are_commutative_and_associative_in_bits(
            terms in prop::collection::vec((-4e9..4e9_f64, 0..100_i32), 3..40), cut in 0_usize..40,
        ) {
            let terms: Vec<f64> = terms.iter().map(|&(v, e)| v * 0.5_f64.powi(e)).collect();
            let cut = cut.min(terms.len());
            let forward = sum(terms.iter().copied());
            prop_assert_eq!(forward, sum(terms.iter().rev().copied()));
            let (a, b) = terms.split_at(cut);
            prop_assert_eq!(forward, sum(b.iter().copied()).checked_add(sum(a.iter().copied())).unwrap());
            let atomic = AtomicFixed::default();
            terms.iter().for_each(|&t| atomic.add(FixedSum::new(t).unwrap()));
            prop_assert_eq!(forward, atomic.get());
        }
    }
}
