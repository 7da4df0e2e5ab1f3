//! Convergence studies, renders, references and reports of the rendering techniques: the commands behind
//! `cargo xtask`.

#![deny(unsafe_code)]

pub mod clock;
pub mod error;
pub mod exr_file;
pub mod files;
pub mod film_file;
pub mod hash;
pub mod interrupt;
pub mod job;
pub mod picture;
pub mod progress;
pub mod samplers;
pub mod techniques;
