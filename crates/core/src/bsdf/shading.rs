//! Shading normals that differ from geometric ones.

use super::TransportMode;

/// The factor that a shading normal `ns` beside the geometric normal `ng` puts on `f |cos wi|`, where the cosine is to
/// `ns`. The arguments are the cosines of `wo` and `wi` to both normals.
///
/// - 0 where a direction is on one side by `ns` and on the other by `ng`: light would leak through the surface. A path's
///   vertex folds directions to one side first, so that this happens only below the horizon of a relief's normal;
/// - 1 for radiance;
/// - for importance `|wo.ns| |wi.ng| / (|wo.ng| |wi.ns|)` [Veach 1997, eq. 5.19], because on a path from a light `wo`
///   is where light comes from, so that the cosine that belongs to `ns` is the other one.
#[inline]
pub fn shading_correction(mode: TransportMode, wo_ng: f32, wo_ns: f32, wi_ng: f32, wi_ns: f32) -> f32 {
    let same_side = |a: f32, b: f32| (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0);
    if !same_side(wo_ng, wo_ns) || !same_side(wi_ng, wi_ns) {
        return 0.0;
    }
    match mode {
        TransportMode::Radiance => 1.0,
        TransportMode::Importance => {
            let factor = (wo_ns / wo_ng) * (wi_ng / wi_ns);
            // Subnormal cosines can overflow the quotients; such directions carry nothing.
            if factor.is_finite() { factor } else { 0.0 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use TransportMode::{Importance, Radiance};

    #[test]
    fn agreeing_normals_correct_nothing() {
        for mode in [Radiance, Importance] {
            assert_eq!(shading_correction(mode, 0.3, 0.3, 0.7, 0.7), 1.0);
            assert_eq!(shading_correction(mode, -0.3, -0.3, 0.7, 0.7), 1.0);
        }
    }

    #[test]
    fn importance_takes_the_quotient_of_the_cosines() {
        assert!((shading_correction(Importance, 0.5, 0.25, 0.8, 0.1) - 4.0).abs() < 1e-6);
        assert!((shading_correction(Importance, -0.5, -0.25, 0.8, 0.1) - 4.0).abs() < 1e-6);
        assert_eq!(shading_correction(Radiance, 0.5, 0.25, 0.8, 0.1), 1.0);
    }

    #[test]
    fn sides_that_disagree_leak_nothing() {
        for mode in [Radiance, Importance] {
            assert_eq!(shading_correction(mode, -0.5, 0.25, 0.8, 0.1), 0.0);
            assert_eq!(shading_correction(mode, 0.5, 0.25, 0.8, -0.1), 0.0);
            assert_eq!(shading_correction(mode, 0.0, 0.25, 0.8, 0.1), 0.0);
            assert_eq!(shading_correction(mode, 0.5, f32::NAN, 0.8, 0.1), 0.0);
        }
        let tiny = f32::MIN_POSITIVE / 4.0;
        assert_eq!(shading_correction(Importance, tiny, 1.0, 1.0, tiny), 0.0);
    }

    /// Swapping the two ends of a path turns one corrected product into the other: f |wi.ns| |wo.ng| is symmetric.
    #[test]
    fn the_corrected_kernel_is_adjoint() {
        let (a_ng, a_ns, b_ng, b_ns) = (0.6f32, 0.45, 0.2, 0.35);
        let radiance = b_ns * shading_correction(Radiance, a_ng, a_ns, b_ng, b_ns) * a_ng;
        let importance = a_ns * shading_correction(Importance, b_ng, b_ns, a_ng, a_ns) * b_ng;
        assert!((radiance - importance).abs() < 1e-6);
    }
}
