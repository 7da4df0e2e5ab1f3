//! What the targets check: the same as the mutation tests of `etendue-scenes`.

#![allow(dead_code, reason = "the targets need a part of what the tests have")]

#[path = "../../crates/scenes/tests/formats/gltf/build.rs"]
mod build;
#[path = "../../crates/scenes/tests/mutations/checks.rs"]
pub mod checks;
#[path = "../../crates/scenes/tests/mutations/seeds.rs"]
mod seeds;
#[path = "../../crates/scenes/tests/formats/serialized_writer.rs"]
mod serialized_writer;
