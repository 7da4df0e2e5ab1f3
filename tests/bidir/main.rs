//! What bidirectional path tracing is made of: weights, single strategies, particles.

mod direct;
mod particles;
mod scenes;
mod strategies;
mod weights;
