//! Discrete and piecewise distributions.
pub mod alias;
pub mod piecewise;
