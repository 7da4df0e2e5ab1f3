//! Sample patterns: stratified, low-discrepancy and blue noise, their spectra, and resampled importance sampling.

pub mod blue_noise;
mod distribution;
pub mod halton;
mod lattice;
pub mod layout;
pub mod mask;
pub mod pattern;
pub mod permutation;
pub mod sampler;
pub mod sobol;
pub mod stratified;
mod torus;
