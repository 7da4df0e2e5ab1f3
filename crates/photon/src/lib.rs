//! Photon maps.
pub mod kd_tree;
