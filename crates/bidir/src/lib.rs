//! Light tracing and bidirectional path tracing.

mod bidirectional;
pub mod densities;
mod light;
pub mod particle;
pub mod strategies;
mod variants;
pub mod weights;

pub use bidirectional::{BIDIR, Bidirectional};
pub use light::{LIGHT, LightTracer};
