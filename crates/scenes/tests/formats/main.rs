//! Tests of the readers of other programs' formats, each with files that the test writes itself.

mod gltf;
mod serialized;
mod serialized_writer;
mod sun_sky;
