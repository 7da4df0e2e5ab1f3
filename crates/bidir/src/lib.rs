//! Light tracing and bidirectional path tracing.
