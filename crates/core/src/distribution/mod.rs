//! Discrete and piecewise distributions.
pub mod alias;
pub mod piecewise;

/// The largest `f32` below 1.
pub(crate) const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;
