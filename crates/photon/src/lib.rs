//! Photon maps.
pub mod aim;
mod eye;
pub mod kd_tree;
pub mod kernel;
pub mod map;
mod mapping;
pub mod octahedral;
pub mod photon;
mod progressive;
pub mod surfaces;
pub mod trace;
mod variants;

pub use mapping::{IndirectLight, Options, PHOTON, PhotonMapper};
pub use progressive::{ProgressiveMapper, ProgressiveOptions, SPPM, shrinkage};
