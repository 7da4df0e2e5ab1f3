//! Sample patterns and what can be made of samples.

pub mod ris;
pub mod strata;
