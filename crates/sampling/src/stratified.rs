//! Patterns with one point in each of equal strata: grids, jitter and multi-jitter.

use crate::layout::Layout;
use etendue_core::digest::mix;
use glam::Vec2;

/// The odd integer nearest to `2^64` over the golden ratio.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The middle of a stratum.
const MIDDLE: [u32; 2] = [1 << 31; 2];

/// Two random numbers for stratum `index`.
#[inline]
pub(crate) fn jitter(key: u64, index: u32) -> [u32; 2] {
    halves(mix(key.wrapping_add((u64::from(index) + 1).wrapping_mul(GOLDEN))))
}

#[inline]
pub(crate) fn halves(word: u64) -> [u32; 2] {
    [(word >> 32) as u32, word as u32]
}

/// The middles of `count` strata of equal area: a regular grid where `count` has the factors for it. [`Layout`] says
/// what happens to other numbers, here and in the patterns below. Nothing of it is random.
pub fn grid(count: u32) -> Vec<Vec2> {
    Layout::new(count).place_all(|_| MIDDLE)
}

/// One random point in each of `count` strata of equal area [Cook et al. 1984; Mitchell 1996].
///
/// The variance falls as `N^-2` on smooth integrands of the square and as `N^-3/2` on edges. Order: column by column.
pub fn jittered(count: u32, seed: u64) -> Vec<Vec2> {
    let key = mix(seed ^ 0x3c79_ac49_2ba7_b653);
    Layout::new(count).place_all(|s| jitter(key, s))
}

/// The same random offset in each of `count` strata of equal area: a grid that is shifted as a whole
/// [Ramamoorthi et al. 2012, sec. 3.3].
pub fn uniform_jitter(count: u32, seed: u64) -> Vec<Vec2> {
    let offset = halves(mix(seed ^ 0x1c69_b3f7_4ac4_ae35));
    Layout::new(count).place_all(|_| offset)
}

/// One random point in each of `count` strata, and also in each of `count` columns and of `count` rows
/// [Chiu, Shirley and Wang 1994].
///
/// The rows hold where the strata form a grid ([`Layout::is_grid`]), the rest for every `count`.
pub fn multi_jittered(count: u32, seed: u64) -> Vec<Vec2> {
    let (layout, key) = (Layout::new(count), mix(seed ^ 0x7fb5_d329_728e_a185));
    (0..count).map(|s| layout.place_finely(s, jitter(key, s), key, false)).collect()
}

/// As [`multi_jittered`], with the same arrangement in all columns and in all rows, which keeps points of neighbouring
/// strata further apart [Kensler 2013].
pub fn correlated_multi_jittered(count: u32, seed: u64) -> Vec<Vec2> {
    let (layout, key) = (Layout::new(count), mix(seed ^ 0x4528_21e6_38d0_1377));
    (0..count).map(|s| layout.place_finely(s, jitter(key, s), key, true)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Which rectangles of `columns` by `rows` the points are in, counted.
    fn counts(points: &[Vec2], columns: u32, rows: u32) -> Vec<u32> {
        let mut counts = vec![0; (columns * rows) as usize];
        for p in points {
            // In f64 the products are exact for these sizes, so the floor is the true one.
            let (x, y) = (f64::from(p.x) * f64::from(columns), f64::from(p.y) * f64::from(rows));
            counts[x as usize * rows as usize + y as usize] += 1;
        }
        counts
    }

    fn all_one(points: &[Vec2], columns: u32, rows: u32) -> bool {
        counts(points, columns, rows).iter().all(|&n| n == 1)
    }

    proptest! {
        #[test]
        fn one_point_a_stratum(columns in 1..40_u32, more in 0..20_u32, seed: u64) {
            let rows = columns + more.min(columns);
            let n = columns * rows;
            // The divisor that is found may be another one nearer to the root.
            let columns = Layout::new(n).columns();
            for points in [
                grid(n),
                jittered(n, seed),
                uniform_jitter(n, seed),
                multi_jittered(n, seed),
                correlated_multi_jittered(n, seed),
            ] {
                prop_assert!(all_one(&points, columns, n / columns));
            }
        }

        #[test]
        fn one_point_a_stratum_of_any_number(n in 1..3000_u32, seed: u64) {
            let layout = Layout::new(n);
            let (low, high) = ([0; 2], [u32::MAX; 2]);
            for points in [grid(n), jittered(n, seed), multi_jittered(n, seed), correlated_multi_jittered(n, seed)] {
                for (s, &p) in (0..).zip(&points) {
                    let (low, high) = (layout.place(s, low), layout.place(s, high));
                    prop_assert!(p.cmpge(low).all() && p.cmple(high).all(), "{} {} {}", p, low, high);
                }
            }
        }

        #[test]
        fn multi_jitter_has_one_point_a_column_and_a_row(n in 1..3000_u32, seed: u64) {
            for points in [multi_jittered(n, seed), correlated_multi_jittered(n, seed)] {
                prop_assert!(all_one(&points, n, 1));
                prop_assert!(!Layout::new(n).is_grid() || all_one(&points, 1, n));
            }
        }

        #[test]
        fn the_offset_is_the_same_in_all_strata(side in 1..40_u32, seed: u64) {
            let points = uniform_jitter(side * side, seed);
            let offset = |p: Vec2| (p * side as f32).fract();
            for &p in &points {
                let difference = (offset(p) - offset(points[0])).abs();
                // Two lattice steps, in strata.
                prop_assert!(difference.max_element() <= side as f32 * 2.0 / (1 << 24) as f32, "{difference}");
            }
        }
    }

    #[test]
    fn correlated_columns_are_arranged_alike_and_others_are_not() {
        let arrangement = |points: &[Vec2], column: usize| -> Vec<u32> {
            points[column * 8..][..8].iter().map(|p| (p.x * 64.0) as u32 % 8).collect()
        };
        let (correlated, free) = (correlated_multi_jittered(64, 5), multi_jittered(64, 5));
        assert!((1..8).all(|c| arrangement(&correlated, c) == arrangement(&correlated, 0)));
        assert!((1..8).any(|c| arrangement(&free, c) != arrangement(&free, 0)));
    }

    #[test]
    fn a_grid_of_nine() {
        let third = |k: u32| (k as f32 + 0.5) / 3.0;
        for (s, p) in grid(9).into_iter().enumerate() {
            let expected = Vec2::new(third(s as u32 / 3), third(s as u32 % 3));
            assert!((p - expected).abs().max_element() < 1.0 / (1 << 23) as f32, "{p} {expected}");
        }
    }
}
