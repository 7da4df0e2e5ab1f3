//! Statistics: of renders, and for tests and studies.

pub mod chi_square;
pub mod image_error;
pub mod moments;
pub mod render;
pub mod slope;
pub mod special;
pub mod tiles;
pub mod welch;
