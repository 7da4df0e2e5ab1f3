//! Scenes in glTF 2.0, as `.gltf` with its files beside it or as `.glb`.
//!
//! Read are meshes (triangles, strips, fans) with their node hierarchy, metallic-roughness materials with their textures,
//! cameras, and the extensions in [`EXTENSIONS`]. A file that requires another extension is refused; what an optional one
//! adds is left out and noted, as are skins, animations, morph targets, points and lines.
//!
//! What glTF has otherwise than a path tracer:
//!
//! - A material is a principled one [Burley 2012, 2015]; its microfacet roughness is the square of the roughness in both. With
//!   `KHR_materials_transmission` it is thin, or with a thickness by `KHR_materials_volume` solid, which then absorbs by
//!   Beer's law. Clear coats and sheen are those of the principled material, and so approximate.
//! - `MASK` and `BLEND` are holes by chance, the former by the alpha's comparison with its cutoff in each texel.
//! - Ambient occlusion is not read: it is what a path tracer finds out. The range of a light is not read either.
//! - Candela, lux and nits are taken as W/sr, W/m² and W/(sr m²), so that the film holds photometric numbers. A spot light
//!   falls off linearly in the angle between its two cones.
//! - A surface emits from its front only, and one that is not double-sided is black from behind.
//! - The first camera is taken. Without one, the scene is seen from the front, above, and right; without any light, its
//!   environment is white.
//!
//! Numbers in the file that point beyond its lists or its bytes are errors. A file that it names must lie in its folder, unless
//! files outside are allowed.

mod accessor;
mod camera;
mod data;
mod document;
mod graph;
mod image;
mod light;
mod material;
mod mesh;
mod texture;

pub use document::EXTENSIONS;

use crate::{
    LoadOptions, LoadedScene,
    error::{Flaw, LoadError, Place, read_file},
    folders::Folders,
};
use document::Document;
use etendue_core::filter::Filter;
use gltf_json::validation::Checked;
use std::path::Path;

/// The largest file that is read.
pub const LARGEST_FILE: u64 = u32::MAX as u64;

/// The most triangles of all meshes together, copies for lights included.
pub const MOST_TRIANGLES: usize = 1 << 27;

/// Reads a scene file with the buffers and images that it names.
///
/// # Errors
///
/// A file that cannot be read, or anything in it that is wrong or not supported but required; `options` may forgive a required
/// extension that is not known.
pub fn load(path: &Path, options: LoadOptions) -> Result<LoadedScene, LoadError> {
    let bytes = read_file(path, LARGEST_FILE)?;
    let folders = Folders::of(path, options.outside_folder)?;
    let mut scene = parse(&bytes, Some(&folders), options.lenient).map_err(|flaw| flaw.of(path))?;
    scene.description.name = path.display().to_string();
    Ok(scene)
}

/// Reads a scene from the bytes of a `.gltf` or `.glb` file that names no others.
///
/// # Errors
///
/// Anything that is wrong or not supported but required.
pub fn read(bytes: &[u8]) -> Result<LoadedScene, Flaw> {
    parse(bytes, None, false)
}

fn parse(bytes: &[u8], folders: Option<&Folders>, lenient: bool) -> Result<LoadedScene, Flaw> {
    let mut notes = Notes::default();
    let document = Document::open(bytes, lenient, &mut notes)?;
    let buffers = data::Buffers::load(&document, folders)?;
    let mut description = graph::scene(&document, &buffers, folders, &mut notes)?;
    description.name = "glTF".to_owned();
    Ok(LoadedScene {
        description,
        filter: Filter::Gaussian { stddev: 0.5 },
        max_depth: u32::MAX,
        roulette_depth: 5,
        samples: None,
        notes: notes.0,
        exact: None,
    })
}

/// What is said about how the scene was loaded, each sentence once.
#[derive(Default)]
struct Notes(Vec<String>);

impl Notes {
    /// More than these are not of use to anyone.
    const MOST: usize = 100;

    fn add(&mut self, note: impl Into<String>) {
        let note = note.into();
        if self.0.len() < Notes::MOST && !self.0.contains(&note) {
            self.0.push(note);
        }
    }
}

/// Something wrong; glTF says where by the names and indices of its lists.
fn flaw(message: impl Into<String>) -> Flaw {
    Flaw::new(Place::Whole, message)
}

/// An item of one of the file's lists.
fn item<'r, T>(list: &'r [T], name: &str, index: usize) -> Result<&'r T, Flaw> {
    list.get(index).ok_or_else(|| flaw(format!("{name}[{index}] is asked for, and there are {}", list.len())))
}

/// A value that is one of those that glTF knows.
fn valid<T: Copy>(value: &Checked<T>, place: impl FnOnce() -> String) -> Result<T, Flaw> {
    match value {
        Checked::Valid(value) => Ok(*value),
        Checked::Invalid => Err(flaw(format!("{}: the value is none of those that are known", place()))),
    }
}
