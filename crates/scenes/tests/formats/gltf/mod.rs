//! glTF: what a small file says is what the scene has.

mod build;
mod files;
mod geometry;
mod lights_and_cameras;
mod materials;
mod ranges;
mod refusals;

use build::{F32, File, U8, U16, base64, png, triangle};
use etendue_core::{
    geometry::Mesh,
    scene::{Object, ObjectShape},
};
use etendue_scenes::{LoadedScene, gltf::read};

/// Further kinds of numbers of accessors.
const I16: u32 = 5122;
const U32: u32 = 5125;

impl File {
    /// The scene, the same from both forms of the file.
    pub(crate) fn scene(&self) -> LoadedScene {
        let text = read(&self.text()).unwrap_or_else(|flaw| panic!("{flaw}"));
        let binary = read(&self.binary()).unwrap_or_else(|flaw| panic!("{flaw}"));
        assert_eq!(format!("{:?}", text.description), format!("{:?}", binary.description));
        text
    }

    /// What is wrong with it.
    pub(crate) fn flaw(&self) -> String {
        read(&self.text()).expect_err("it was read").message
    }
}

pub(crate) fn mesh(object: &Object) -> &Mesh {
    match &object.shape {
        ObjectShape::Mesh(mesh) => mesh,
        other => panic!("{other:?} is not a mesh"),
    }
}
