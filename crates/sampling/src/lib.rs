//! Sample patterns and what can be made of samples.

pub mod discrepancy;
pub mod integrands;
pub mod ris;
pub mod spectrum;
pub mod strata;
