//! What depends on the processor: one walk, compiled for the baseline and for AVX2, the choice between them, and prefetching.
//!
//! Both walks are the same source without fused multiply-adds; they return the same bits. Unsafe code is here and in
//! `bvh/stack.rs` alone.

use super::{
    Geometry, Hit,
    bvh::{Arena, Child, Node, Prepared, ROW, WIDTH, traverse::Best},
};
use crate::ray::Ray;
use std::mem::MaybeUninit;

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

/// The part of a walk that is written for an instruction set.
pub(super) trait Kernel {
    /// As [`Prepared::boxes`].
    fn boxes(ray: &Prepared, node: &Node, cutoff: f32) -> ([f32; WIDTH], u32);
}

/// The kernel in plain Rust.
pub(super) struct Portable;

impl Kernel for Portable {
    #[inline(always)]
    fn boxes(ray: &Prepared, node: &Node, cutoff: f32) -> ([f32; WIDTH], u32) {
        ray.boxes(node, cutoff)
    }
}

/// The kernel for AVX2; used only inside the functions that are compiled for it.
#[cfg(target_arch = "x86_64")]
struct Avx2;

#[cfg(target_arch = "x86_64")]
impl Kernel for Avx2 {
    #[inline(always)]
    fn boxes(ray: &Prepared, node: &Node, cutoff: f32) -> ([f32; WIDTH], u32) {
        // SAFETY: only `closest_avx2` and `occluded_avx2` walk with this kernel, and whoever calls those has seen to it
        // that the processor has AVX2.
        unsafe { boxes_avx2(ray, node, cutoff) }
    }
}

/// [`Prepared::boxes`] by integer comparisons, of a quarter of the latency of those of floats.
///
/// As an integer, a float that is not negative orders as itself, and a negative one is negative: an entry is the largest of
/// three and zero, hence never negative, and where an exit is negative the box is missed whatever its value. None is NaN,
/// as the inverses are finite.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
#[inline]
fn boxes_avx2(ray: &Prepared, node: &Node, cutoff: f32) -> ([f32; WIDTH], u32) {
    use std::arch::x86_64::*;
    let (origin, inverse, inverse_far, near) = ray.slabs();
    let rows = node.bounds.as_ptr().cast::<f32>();
    let plane = |axis: usize, row: usize, inverse: &[f32; 3]| {
        // SAFETY: `row` is where one of the six rows of eight floats begins.
        let bounds = unsafe { _mm256_loadu_ps(rows.byte_add(row)) };
        let from = _mm256_sub_ps(bounds, _mm256_set1_ps(origin[axis]));
        _mm256_castps_si256(_mm256_mul_ps(from, _mm256_set1_ps(inverse[axis])))
    };
    let enter = |axis: usize| plane(axis, near[axis], inverse);
    let leave = |axis: usize| plane(axis, near[axis] ^ ROW, inverse_far);
    let first =
        _mm256_max_epi32(_mm256_max_epi32(enter(0), enter(1)), _mm256_max_epi32(enter(2), _mm256_setzero_si256()));
    let cutoff = _mm256_castps_si256(_mm256_set1_ps(cutoff));
    let last = _mm256_min_epi32(_mm256_min_epi32(leave(0), leave(1)), _mm256_min_epi32(leave(2), cutoff));
    let missed = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(first, last)));
    let mut distances = [0.0; WIDTH];
    // SAFETY: `distances` are eight floats.
    unsafe { _mm256_storeu_ps(distances.as_mut_ptr(), _mm256_castsi256_ps(first)) };
    (distances, !missed as u32 & 0xff)
}

#[inline(always)]
fn closest_with<K: Kernel, const HAS: u32>(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    let mut best = Best::new(ray.t_max);
    geometry.walk::<K, HAS, false>(ray, &mut best);
    best.found()
}

fn closest<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    closest_with::<Portable, HAS>(geometry, ray)
}

fn occluded<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> bool {
    geometry.walk::<Portable, HAS, true>(ray, &mut Best::new(ray.t_max))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn closest_avx2<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    closest_with::<Avx2, HAS>(geometry, ray)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn occluded_avx2<const HAS: u32>(geometry: &Geometry, ray: &Ray) -> bool {
    geometry.walk::<Avx2, HAS, true>(ray, &mut Best::new(ray.t_max))
}

/// Asks for a node or a pack that is likely to be read soon to be brought near; of other children it does something harmless.
#[inline(always)]
pub(super) fn prefetch(arena: &Arena, child: Child) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first = arena.start().wrapping_add(child.index()).cast::<i8>();
        for offset in (0..size_of::<Node>()).step_by(64) {
            // SAFETY: a prefetch reads nothing that the program can observe, from whatever address; SSE, which has the
            // instruction, is part of the architecture.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(offset)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (arena, child);
}

/// Asks the system to back memory that nothing has been written to by large pages. What it answers makes no difference.
pub(super) fn ask_for_large_pages<T>(memory: &mut [MaybeUninit<T>]) {
    #[cfg(target_os = "linux")]
    {
        /// Pages that fit in are asked for: of two megabytes on x86-64, and not smaller elsewhere.
        const PAGE: usize = 2 << 20;
        let bytes = size_of_val(memory);
        let first = memory.as_mut_ptr().cast::<u8>();
        let skipped = first.align_offset(PAGE);
        if let Some(whole) = bytes.checked_sub(skipped).map(|left| left / PAGE * PAGE).filter(|whole| *whole > 0) {
            // SAFETY: the range lies within `memory`; the advice changes neither its contents nor who may access it.
            unsafe { libc::madvise(first.add(skipped).cast(), whole, libc::MADV_HUGEPAGE) };
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = memory;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Mesh, Sphere};
    use glam::Vec3;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn both_instruction_sets_give_the_same_bits() {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(4);
        let mut point = move || Vec3::new(rng.random(), rng.random(), rng.random()) * 2.0 - 1.0;
        let mut mesh = Mesh::default();
        for i in 0..3000 {
            let at = point();
            mesh.positions.extend([at, at + point() * 0.1, at + point() * 0.1]);
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        let sphere = Sphere { center: Vec3::ZERO, radius: 0.3, inverted: false };
        let geometry = Geometry::build(vec![mesh.into(), sphere.into()], vec![], vec![]);
        let mut found = 0;
        for _ in 0..100_000 {
            let (a, b) = (point(), point());
            let ray = Ray::segment(a, b - a);
            let baseline = Simd::Baseline.closest::<1>(&geometry, &ray);
            let detected = geometry.simd().closest::<1>(&geometry, &ray);
            let bits = |hit: Option<Hit>| hit.map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.primitive));
            assert_eq!(bits(baseline), bits(detected));
            assert_eq!(Simd::Baseline.occluded::<1>(&geometry, &ray), detected.is_some());
            assert_eq!(geometry.simd().occluded::<1>(&geometry, &ray), detected.is_some());
            found += usize::from(detected.is_some());
        }
        assert!((10_000..90_000).contains(&found), "{found}");
    }
}
