//! Sample patterns: stratified, low-discrepancy and blue noise, their spectra, and resampled importance sampling.
//!
//! Patterns are points in the unit square ([`pattern`]), for any renderer; and [`sampler`]s, from which every technique
//! takes the numbers of its paths.
//!
//! ```
//! use etendue_core::sampler::Purpose;
//! use etendue_sampling::pattern::Pattern;
//!
//! // The area of a quarter of a disk, from 256 points: the error of independent ones is 0.026.
//! let inside = |points: Vec<glam::Vec2>| points.iter().filter(|p| p.length() < 1.0).count() as f32 / 256.0;
//! let area = inside(Pattern::Sobol.points(256, 1));
//! assert!((area - std::f32::consts::FRAC_PI_4).abs() < 0.01);
//!
//! // The same from the numbers that a path tracer would take for its lens.
//! let mut sampler = Pattern::Sobol.sampler()(1, 256);
//! let lens = (0..256).map(|sample| {
//!     sampler.start_sample(17, sample);
//!     sampler.get_2d(0, Purpose::Lens)
//! });
//! assert!((inside(lens.collect()) - std::f32::consts::FRAC_PI_4).abs() < 0.01);
//! ```

pub mod blue_noise;
pub mod discrepancy;
mod distribution;
pub mod halton;
pub mod integrands;
mod lattice;
pub mod layout;
pub mod mask;
pub mod pattern;
pub mod permutation;
pub mod ris;
pub mod sampler;
pub mod sobol;
pub mod spectrum;
pub mod strata;
pub mod stratified;
mod torus;

/// The README's examples, compiled and run as they stand.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
