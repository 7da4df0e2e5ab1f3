//! Weights that join two strategies by multiple importance sampling.
//!
//! Densities may be 0 or infinite, and as large or small as an `f32` holds: weights are computed from the densities'
//! ratio, so nothing overflows to `inf / inf`. A strategy that alone can make a path (the other's density is 0, as for a
//! delta lobe or a delta light) has weight exactly 1. For several samples of a strategy, pass its density times their
//! number.

/// The balance heuristic's weight of a sample from the strategy of density `pdf`, when the other strategy's density at
/// the sample is `other` [Veach 1997, eq. 9.8]. Both in the same measure, not negative. In `[0, 1]`.
#[inline]
pub fn balance_heuristic(pdf: f32, other: f32) -> f32 {
    1.0 / (1.0 + ratio(pdf, other))
}

/// The power heuristic's weight with exponent 2 [Veach 1997, eq. 9.13], arguments as for [`balance_heuristic`].
#[inline]
pub fn power_heuristic(pdf: f32, other: f32) -> f32 {
    let ratio = ratio(pdf, other);
    1.0 / (1.0 + ratio * ratio)
}

/// `other / pdf`, where 0 to 0 and infinity to infinity is 1; the test compiles to a select.
#[inline]
fn ratio(pdf: f32, other: f32) -> f32 {
    debug_assert!(pdf >= 0.0 && other >= 0.0);
    if pdf == other { 1.0 } else { other / pdf }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HEURISTICS: [fn(f32, f32) -> f32; 2] = [balance_heuristic, power_heuristic];

    #[test]
    fn known_values() {
        assert_eq!(balance_heuristic(1.0, 3.0), 0.25);
        assert_eq!(power_heuristic(1.0, 3.0), 0.1);
        assert_eq!(power_heuristic(2.0, 2.0), 0.5);
    }

    #[test]
    fn extreme_densities() {
        for heuristic in HEURISTICS {
            for pdf in [1e-45, f32::MIN_POSITIVE, 1.0, 1e30, f32::MAX, f32::INFINITY] {
                assert_eq!(heuristic(pdf, 0.0), 1.0, "alone, {pdf}");
                assert_eq!(heuristic(0.0, pdf), 0.0, "impossible, {pdf}");
                assert_eq!(heuristic(pdf, pdf), 0.5, "equal, {pdf}");
            }
            assert_eq!(heuristic(0.0, 0.0), 0.5);
            assert_eq!(heuristic(f32::INFINITY, 1e30), 1.0);
            assert_eq!(heuristic(1e30, f32::INFINITY), 0.0);
        }
        assert_eq!(power_heuristic(1e30, 1e-30), 1.0);
        assert_eq!(power_heuristic(1e-30, 1e30), 0.0);
    }

    proptest! {
        #[test]
        fn weights_are_a_partition_of_1(
            a in prop::num::f32::POSITIVE | prop::num::f32::ZERO | prop::num::f32::SUBNORMAL | prop::num::f32::INFINITE,
            b in prop::num::f32::POSITIVE | prop::num::f32::ZERO | prop::num::f32::SUBNORMAL | prop::num::f32::INFINITE,
        ) {
            let (a, b) = (a.abs(), b.abs());
            for heuristic in HEURISTICS {
                let (wa, wb) = (heuristic(a, b), heuristic(b, a));
                prop_assert!((0.0..=1.0).contains(&wa) && (0.0..=1.0).contains(&wb));
                prop_assert!((wa + wb - 1.0).abs() <= 2.0 * f32::EPSILON, "{a:e} {b:e}: {wa} + {wb}");
                let ordered = if a > b { wa >= wb } else { a == b || wa <= wb };
                prop_assert!(ordered);
            }
        }
    }
}
