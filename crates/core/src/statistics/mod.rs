//! Statistics: of renders, and for tests and studies.
pub mod render;
