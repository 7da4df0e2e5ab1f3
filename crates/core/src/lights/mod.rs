//! Lights.
pub mod environment;
