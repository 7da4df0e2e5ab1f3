//! The alias method.

use super::probabilities;

/// A distribution over indices, sampled in constant time by the alias method [Walker 1977; Vose 1991].
///
/// ```
/// use etendue_core::distribution::AliasTable;
/// let table = AliasTable::new(&[1.0, 0.0, 3.0]).unwrap();
/// let sample = table.sample(0.9);
/// assert_eq!((sample.index, sample.pmf), (2, 0.75));
/// assert_eq!(table.pmf(1), 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AliasTable {
    columns: Vec<Column>,
    pmf: Vec<f32>,
}

/// One of as many equal parts of the unit interval as there are entries; its lower end belongs to the entry of the same
/// index, the rest to another.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Column {
    /// The part that is its own, in `[0, 1]`.
    own: f32,
    /// Whose the rest is.
    alias: u32,
}

/// An index that was picked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AliasSample {
    /// The index.
    pub index: usize,
    /// Its probability, positive.
    pub pmf: f32,
    /// What is left of `u`: uniform in `[0, 1)` and independent of the index. Of the 24 bits of `u`, the choice among
    /// `n` entries uses up a little over `log2 n`.
    pub u: f32,
}

impl AliasTable {
    /// The distribution proportional to `weights`. `None` if there are none, one is negative or not finite, all are
    /// zero, or there are more than `2^24`, among which `u` could not tell.
    ///
    /// An entry whose probability is below `f32::MIN_POSITIVE` is taken as zero, and one of zero is never picked.
    pub fn new(weights: &[f64]) -> Option<AliasTable> {
        let n = weights.len();
        let mut probabilities = probabilities(weights.iter().copied()).filter(|_| n <= 1 << 24)?;
        let pmf: Vec<f32> = probabilities.iter().map(|&p| p as f32).collect();

        // [Vose 1991, fig. 2]: while there is one, an entry with less than a column's share is topped up by one with
        // more. In units of a column.
        probabilities.iter_mut().for_each(|p| *p *= n as f64);
        let mut columns = vec![Column { own: 1.0, alias: 0 }; n];
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| probabilities[i] < 1.0);
        let most = (0..n).fold(0, |most, i| if probabilities[i] > probabilities[most] { i } else { most });
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            columns[s] = Column { own: probabilities[s] as f32, alias: l as u32 };
            probabilities[l] -= 1.0 - probabilities[s];
            if probabilities[l] < 1.0 {
                large.pop();
                small.push(l);
            }
        }
        // What is left over in either list is 1 but for rounding, except where rounding used up the large ones before
        // some small one's turn. That one keeps its share, not a whole column, and the heaviest entry takes the rest.
        for s in small {
            columns[s] = Column { own: probabilities[s] as f32, alias: most as u32 };
        }
        Some(AliasTable { columns, pmf })
    }

    /// Picks an index with `u` in `[0, 1)`.
    #[inline]
    pub fn sample(&self, u: f32) -> AliasSample {
        let (index, rest) = self.invert(f64::from(u));
        AliasSample { index, pmf: self.pmf[index], u: (rest as f32).min(1.0_f32.next_down()) }
    }

    /// Picks an index with `u` in `[0, 1)` of more bits than an `f32` has: among a million entries 24 bits leave four to
    /// tell an entry from its alias.
    #[inline]
    pub fn pick(&self, u: f64) -> usize {
        self.invert(u).0
    }

    #[inline]
    fn invert(&self, u: f64) -> (usize, f64) {
        // In f64 the product of 24 and 24 bits is exact.
        let scaled = u * self.columns.len() as f64;
        let column = (scaled as usize).min(self.columns.len() - 1);
        let Column { own, alias } = self.columns[column];
        let own = f64::from(own);
        let part = scaled - column as f64;
        if part < own { (column, part / own) } else { (alias as usize, (part - own) / (1.0 - own)) }
    }

    /// Probability of an index.
    ///
    /// # Panics
    /// If the index is not less than [`AliasTable::len`].
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        self.pmf[index]
    }

    /// Number of entries, at least 1.
    #[expect(clippy::len_without_is_empty, reason = "it is never empty")]
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> u64 {
        (self.columns.capacity() * size_of::<Column>() + self.pmf.capacity() * size_of::<f32>()) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::chi_square;
    use proptest::prelude::*;

    /// The probability that each index gets from the columns.
    fn implied(table: &AliasTable) -> Vec<f64> {
        let mut implied = vec![0.0; table.len()];
        for (i, column) in table.columns.iter().enumerate() {
            implied[i] += f64::from(column.own) / table.len() as f64;
            implied[column.alias as usize] += (1.0 - f64::from(column.own)) / table.len() as f64;
        }
        implied
    }

    #[test]
    fn invalid_weights_make_no_table() {
        for weights in [&[][..], &[0.0, 0.0], &[1.0, -1.0], &[f64::NAN, 1.0], &[f64::INFINITY]] {
            assert_eq!(AliasTable::new(weights), None, "{weights:?}");
        }
    }

    #[test]
    fn extreme_weights() {
        let table = AliasTable::new(&[f64::MAX, f64::MAX, 5e-324, 0.0]).unwrap();
        assert_eq!([0, 1, 2, 3].map(|i| table.pmf(i)), [0.5, 0.5, 0.0, 0.0]);
        let table = AliasTable::new(&[5e-324, 5e-324]).unwrap();
        assert_eq!([0, 1].map(|i| table.pmf(i)), [0.5, 0.5]);
        assert_eq!(AliasTable::new(&[0.0, 1e-300]).unwrap().sample(0.0).index, 1);
    }

    #[test]
    fn one_bright_entry_among_a_million_dark_ones() {
        let mut weights = vec![0.0; 1 << 20];
        weights[123_456] = 1e-3;
        let table = AliasTable::new(&weights).unwrap();
        for i in 0..1 << 16 {
            let sample = table.sample(i as f32 / (1 << 16) as f32);
            assert_eq!((sample.index, sample.pmf), (123_456, 1.0));
        }
    }

    #[test]
    fn an_entry_far_lighter_than_rounding_gets_no_more_than_its_share() {
        // The others' probabilities round to a sum other than 1.
        for n in 3..200 {
            let weights: Vec<f64> = (0..n).map(|i| if i % 3 == 0 { 1e-22 } else { 0.1 + f64::from(i) }).collect();
            let table = AliasTable::new(&weights).unwrap();
            for (i, share) in implied(&table).into_iter().enumerate().step_by(3) {
                let pmf = f64::from(table.pmf(i));
                assert!((share - pmf).abs() <= 1e-6 * pmf, "{i} of {n}: {share:e} {pmf:e}");
            }
        }
    }

    #[test]
    fn indices_and_what_is_left_of_u_are_distributed_as_promised() {
        let weights = [1.0, 5.0, 0.0, 0.25, 8.0, 0.01, 3.0];
        let table = AliasTable::new(&weights).unwrap();
        const BINS: usize = 8;
        const SAMPLES: usize = 1 << 22;
        let mut counts = vec![0; weights.len() * BINS];
        for i in 0..SAMPLES {
            // A permutation of all multiples of 2^-22, in place of random numbers: what varies is the table's rounding.
            let sample = table.sample((i.wrapping_mul(0x9e37_79b1) % SAMPLES) as f32 / SAMPLES as f32);
            assert_eq!(sample.pmf, table.pmf(sample.index));
            counts[sample.index * BINS + (sample.u * BINS as f32) as usize] += 1;
        }
        let expected: Vec<f64> =
            (0..counts.len()).map(|c| f64::from(table.pmf(c / BINS)) * SAMPLES as f64 / BINS as f64).collect();
        let test = chi_square::test(&counts, &expected, 5.0);
        assert!(test.p_value > 1e-4, "{test:?}");
    }

    proptest! {
        #[test]
        fn the_columns_hold_the_probabilities(
            weights in prop::collection::vec(prop_oneof![2 => Just(0.0), 8 => 0.0..1.0_f64, 1 => 1e-30..1e30_f64], 1..200),
            us in prop::collection::vec(prop_oneof![Just(0.0), Just(1.0_f32.next_down()), 0.0..1.0_f32], 50),
        ) {
            prop_assume!(weights.iter().any(|&w| w > 0.0));
            let table = AliasTable::new(&weights).unwrap();
            let total: f64 = weights.iter().sum();
            for (i, share) in implied(&table).into_iter().enumerate() {
                prop_assert!((f64::from(table.pmf(i)) - weights[i] / total).abs() < 1e-7);
                prop_assert!((share - weights[i] / total).abs() < 1e-7);
            }
            for u in us {
                let sample = table.sample(u);
                prop_assert!(sample.pmf > 0.0 && weights[sample.index] > 0.0);
                prop_assert!((0.0..1.0).contains(&sample.u));
            }
        }
    }
}
