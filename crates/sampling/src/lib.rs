//! Sample patterns: stratified, low-discrepancy and blue noise, their spectra, and resampled importance sampling.
