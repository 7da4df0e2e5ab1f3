//! Tests of the crate as a user sees it.

mod accepted;
mod builtins;
mod damage;
mod errors;
mod files;
mod images;
mod language;
mod lenient;
mod lights;
mod materials;
mod meshes;
mod mitsuba;
mod ranges;
mod shared_files;
mod sides;
mod textures;
