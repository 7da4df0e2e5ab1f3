//! Tests of the readers of other programs' formats, each with files that the test writes itself.

mod gltf;
mod serialized;
mod sun_sky;
