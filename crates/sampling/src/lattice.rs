//! The numbers that samples take: multiples of `2^-24`, all that an `f32` resolves near 1.
//!
//! Where `[0, 1)` is cut into parts that are no powers of two, a number rounded from its part may end up in the next
//! one, or at 1. So a part is taken as the multiples of `2^-24` that it holds.

/// `2^24`.
const SIZE: u32 = 1 << 24;

/// `[0, 1)` in `count` equal parts; at least 1, at most `2^27`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parts {
    count: u32,
    /// Multiples of `2^-24` in a part.
    steps: f64,
}

impl Parts {
    #[inline]
    pub(crate) fn new(count: u32) -> Parts {
        Parts { count, steps: f64::from(SIZE) / f64::from(count) }
    }

    #[inline]
    pub(crate) fn count(self) -> u32 {
        self.count
    }

    /// The `random / 2^32`-th part of the way through parts `from..to`: a number of that range, below 1.
    ///
    /// Parts narrower than `2^-24` may hold no such number; the first above is then taken, the last one of all at most.
    #[inline]
    pub(crate) fn place(self, from: u32, to: u32, random: u32) -> f32 {
        between(self.boundary(from), self.boundary(to), random)
    }

    /// The first multiple of `2^-24` that is not below `part / count`.
    #[inline]
    pub(crate) fn boundary(self, part: u32) -> u32 {
        // The product is at most one off the quotient; the exact remainder says where.
        let near = (f64::from(part) * self.steps) as i64;
        let count = i64::from(self.count);
        let remainder = (i64::from(part) << 24) - near * count;
        (near + i64::from(remainder > 0) - i64::from(remainder <= -count)) as u32
    }
}

/// As [`Parts::place`] from one boundary to another.
#[inline]
pub(crate) fn between(from: u32, to: u32, random: u32) -> f32 {
    let steps = (u64::from(random) * u64::from(to - from)) >> 32;
    (from + steps as u32).min(SIZE - 1) as f32 * (1.0 / SIZE as f32)
}

/// As [`Parts::place`] for part `part` of `count`.
#[inline]
pub(crate) fn place(part: u32, count: u32, random: u32) -> f32 {
    Parts::new(count).place(part, part + 1, random)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn boundaries_are_those_of_exact_arithmetic(count in 1..=1_u32 << 27, share in 0.0..=1.0) {
            for part in [0, (f64::from(count) * share) as u32, count - 1, count] {
                prop_assert_eq!(u64::from(Parts::new(count).boundary(part)), (u64::from(part) << 24).div_ceil(count.into()));
            }
        }

        #[test]
        fn a_number_lies_in_its_part(count in 1..=1_u32 << 24, share in 0.0..1.0, random: u32) {
            let part = (f64::from(count) * share) as u32;
            let u = f64::from(place(part, count, random));
            prop_assert!((part..=part).contains(&((u * f64::from(count)) as u32)), "{u} is not in {part} of {count}");
        }
    }

    #[test]
    fn ends_are_reached_and_never_1() {
        assert_eq!(place(0, 1, 0), 0.0);
        assert_eq!(place(0, 1, u32::MAX), 1.0_f32.next_down());
        assert_eq!(place((1 << 27) - 1, 1 << 27, u32::MAX), 1.0_f32.next_down());
    }
}
