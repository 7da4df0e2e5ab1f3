//! Unidirectional path tracing.
