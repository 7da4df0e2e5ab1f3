//! Built-in scenes as code, and importers of scene files.
//!
//! ```
//! let scene = etendue_scenes::load("many-lights:n=64,seed=7")?;
//! assert_eq!(scene.description.objects.iter().filter(|o| o.emission.is_some()).count(), 64);
//! # Ok::<(), etendue_scenes::LoadError>(())
//! ```
//!
//! A scene is asked for by the name of a built-in one, with parameters after a colon, or by the path of a file.
//! [`builtins`] lists the built-in scenes and their parameters as data. Files are scenes in Mitsuba's XML (see [`mitsuba`])
//! or in glTF 2.0 (see [`gltf`]) with the meshes and images that they name; what an importer does not know is an error
//! that says where, or, if [`LoadOptions`] ask for it, a note that says what was left out.
#![deny(unsafe_code)]

pub mod builtin;
mod cube;
mod error;
mod folders;
pub mod gltf;
pub mod image_file;
pub mod mitsuba;
mod normals;
pub mod obj;
mod placement;
pub mod ply;
pub mod serialized;
mod spectrum;
pub mod sun_sky;
mod tessellate;

/// The README's examples, compiled and run as they stand.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

pub use builtin::{Builtin, Parameter, ParameterKind, builtins, furnace::Furnace};
pub use error::{Flaw, LoadError, Place};

use etendue_core::{filter::Filter, scene::SceneDescription};
use std::path::Path;

/// A scene with what its author says about rendering it.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// What is in it; the resolution is its camera's.
    pub description: SceneDescription,
    /// Pixel filter.
    pub filter: Filter,
    /// Longest path, counted as in Mitsuba (1: emission alone, 2: with direct light); `u32::MAX` is no bound.
    pub max_depth: u32,
    /// Depth from which Russian roulette may end a path.
    pub roulette_depth: u32,
    /// Samples a pixel that a file asks for.
    pub samples: Option<u32>,
    /// What a user should know about how it was loaded, a sentence each.
    pub notes: Vec<String>,
    /// The radiance of every pixel, in the scenes where it is known.
    pub exact: Option<Furnace>,
}

/// How a scene file is loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// What is wrong or not supported is left out, or something plain stands in for it, and a note says so; without it, it is an
    /// error.
    pub lenient: bool,
    /// Files outside of the scene's folder may be read where the scene names them.
    pub outside_folder: bool,
}

/// Loads a built-in scene (`cornell`, `many-lights:n=4096,seed=7`) or a scene file (`path/to/scene.xml`, `scene.gltf`,
/// `scene.glb`) that is wholly supported and whose files lie in its folder.
///
/// # Errors
///
/// An unknown name or parameter, a value out of range, a file that cannot be read or that holds something wrong.
pub fn load(spec: &str) -> Result<LoadedScene, LoadError> {
    load_with(spec, LoadOptions::default())
}

/// As [`load`], told how to load a file.
///
/// # Errors
///
/// As those of [`load`].
pub fn load_with(spec: &str, options: LoadOptions) -> Result<LoadedScene, LoadError> {
    let (name, parameters) = spec.split_once(':').unwrap_or((spec, ""));
    if let Some(builtin) = builtins().iter().find(|b| b.name == name) {
        return builtin.load(parameters);
    }
    let path = Path::new(spec);
    let extension = path.extension().map(|e| e.to_string_lossy().into_owned());
    match extension {
        Some(extension) if extension.eq_ignore_ascii_case("xml") => mitsuba::load(path, options),
        Some(extension) if ["gltf", "glb"].iter().any(|e| extension.eq_ignore_ascii_case(e)) => {
            gltf::load(path, options)
        }
        _ if path.is_dir() => Err(Flaw::new(Place::Whole, "is a folder; a scene is a file").of(path)),
        Some(extension) if path.exists() || spec.contains(['/', '\\']) => {
            Err(LoadError::UnsupportedFormat { path: path.to_owned(), extension: format!(".{extension}") })
        }
        None if path.exists() || spec.contains(['/', '\\']) => {
            Err(LoadError::UnsupportedFormat { path: path.to_owned(), extension: "no extension".to_owned() })
        }
        _ => Err(LoadError::UnknownScene {
            name: name.to_owned(),
            nearest: error::nearest(name, builtins().iter().map(|b| b.name)),
            known: builtins().iter().map(|b| b.name).collect::<Vec<_>>().join(", "),
        }),
    }
}
