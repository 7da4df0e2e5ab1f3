//! Statistics: of renders, and for tests and studies.

pub mod chi_square;
pub mod render;
pub mod special;
