//! Tests of the crate as a user sees it.

mod builtins;
mod damage;
mod errors;
mod meshes;
mod mitsuba;
mod shared_files;
