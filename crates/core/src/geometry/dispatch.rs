//! One walk, compiled for the baseline and for AVX2, and the choice between them.
//!
//! Both are the same source without fused multiply-adds; they return the same bits.

use super::{Geometry, Hit, bvh::traverse::Best};
use crate::ray::Ray;

/// The instruction set that walks run on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Simd {
    /// What the target always has.
    Baseline,
    /// AVX2 and its companions; held only where [`Simd::detect`] has found them.
    #[cfg(target_arch = "x86_64")]
    Avx2(Detected),
}

/// Proof that AVX2, BMI1 and BMI2 have been detected: only [`Simd::detect`] makes it.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Detected(());

impl Simd {
    /// The best that this machine has.
    pub fn detect() -> Simd {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi1") && is_x86_feature_detected!("bmi2") {
            return Simd::Avx2(Detected(()));
        }
        Simd::Baseline
    }

    #[inline]
    pub fn closest<const HAS: u32>(self, geometry: &Geometry, ray: &Ray) -> Option<Hit> {
        match self {
            Simd::Baseline => closest::<HAS>(geometry, ray),
            // SAFETY: a `Detected` exists only where the features that the function is compiled for have been detected.
            #[cfg(target_arch = "x86_64")]
            Simd::Avx2(Detected(())) => unsafe { closest_avx2::<HAS>(geometry, ray) },
        }
    }

    #[inline]
    pub fn occluded<const HAS: u32>(self, geometry: &Geometry, ray: &Ray) -> bool {
        match self {
            Simd::Baseline => occluded::<HAS>(geometry, ray),
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Simd::Avx2(Detected(())) => unsafe { occluded_avx2::<HAS>(geometry, ray) },
        }
    }
}

#[inline(always)]
fn closest_with<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    let mut best = Best::new(ray.t_max);
    geometry.walk::<HAS, false>(ray, &mut best);
    best.found()
}

fn closest<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    closest_with::<HAS>(geometry, ray)
}

fn occluded<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> bool {
    geometry.walk::<HAS, true>(ray, &mut Best::new(ray.t_max))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn closest_avx2<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    closest_with::<HAS>(geometry, ray)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn occluded_avx2<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> bool {
    geometry.walk::<HAS, true>(ray, &mut Best::new(ray.t_max))
}
