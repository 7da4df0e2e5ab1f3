//! A choice among the parts of a lobe.

use crate::warp::ONE_MINUS_EPSILON;
use std::array;

/// What each active part gets at least, of the energy that all are estimated to scatter.
const LEAST: f32 = 0.1;

/// Probabilities of choosing the parts of a lobe, about in proportion to estimates of the energy that they scatter. No
/// active part gets less than about a tenth, because the estimates may be far off for single directions. All are 0 if
/// no part is active.
#[inline]
pub(super) fn shares<const N: usize>(energies: [f32; N], active: [bool; N]) -> [f32; N] {
    let least = LEAST * energies.iter().sum::<f32>() + f32::MIN_POSITIVE;
    let weights: [f32; N] = array::from_fn(|i| if active[i] { energies[i] + least } else { 0.0 });
    let total: f32 = weights.iter().sum();
    if total > 0.0 { weights.map(|w| w / total) } else { weights }
}

/// The part that `u` chooses, and what is left of `u`, stretched to the unit interval.
#[inline]
pub(super) fn choose<const N: usize>(shares: [f32; N], mut u: f32) -> (usize, f32) {
    let mut last = (0, 0.0);
    for (i, share) in shares.into_iter().enumerate() {
        if u < share {
            return (i, (u / share).min(ONE_MINUS_EPSILON));
        }
        u -= share;
        if share > 0.0 {
            // The shares may sum to less than 1 by rounding.
            last = (i, ONE_MINUS_EPSILON);
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_sum_to_one_and_leave_no_active_part_out() {
        for energies in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1e-30, 3.0, 0.2], [0.3, 0.3, 0.3]] {
            for active in [[true, false, false], [true, true, false], [true, true, true]] {
                let energies = array::from_fn(|i| if active[i] { energies[i] } else { 0.0 });
                let shares = shares(energies, active);
                assert!((shares.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{shares:?}");
                assert!(shares.iter().zip(active).all(|(s, a)| if a { *s > 0.07 } else { *s == 0.0 }), "{shares:?}");
            }
        }
        assert_eq!(shares([0.0, 0.0], [false, false]), [0.0, 0.0]);
    }

    #[test]
    fn choices_follow_the_shares() {
        let shares = [0.25, 0.0, 0.75];
        assert_eq!(choose(shares, 0.0), (0, 0.0));
        assert_eq!(choose(shares, 0.125), (0, 0.5));
        assert_eq!(choose(shares, 0.25), (2, 0.0));
        assert_eq!(choose(shares, ONE_MINUS_EPSILON).0, 2);
        assert_eq!(choose([0.5, 0.499_999, 0.0], ONE_MINUS_EPSILON), (1, ONE_MINUS_EPSILON));
    }
}
