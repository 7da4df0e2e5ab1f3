//! Convergence studies, renders, references and reports of the rendering techniques: the commands behind
//! `cargo xtask`.

#![deny(unsafe_code)]

pub mod check;
pub mod cli;
pub mod clock;
pub mod compare;
pub mod coverage;
pub mod error;
pub mod error_map;
pub mod exr_file;
pub mod files;
pub mod film_file;
pub mod hash;
pub mod interrupt;
pub mod job;
pub mod listing;
pub mod merge;
pub mod output;
pub mod picture;
pub mod progress;
pub mod pyramid;
pub mod reference;
pub mod render;
pub mod report;
pub mod samplers;
pub mod sampling;
pub mod scene;
pub mod study;
pub mod techniques;
