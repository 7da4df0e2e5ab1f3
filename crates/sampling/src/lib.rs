//! Sample patterns: stratified, low-discrepancy and blue noise, their spectra, and resampled importance sampling.

pub mod discrepancy;
pub mod integrands;
pub mod ris;
pub mod spectrum;
pub mod strata;
