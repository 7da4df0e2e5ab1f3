//! Scenes in the XML of Mitsuba, of versions 0.5 to 3.
//!
//! Read are the language (`<default>` and `$name`, `<ref>`, `<alias>`, `<include>`, `<path>`), perspective, thin-lens and
//! orthographic sensors with crops, meshes and analytic shapes, groups of shapes and their instances, the usual BSDFs with
//! their textures, and every usual kind of emitter; the README lists them. Everything else is an error with its line and
//! column, or, where loading is lenient, a note that says what stands in for it. Parameters under their older names
//! (`toWorld`, `intIOR`) count as those of today.
//!
//! Defaults and conventions are Mitsuba's. A file that the scene names must lie in the scene's folder unless others are allowed.

mod ahead;
mod bsdf;
mod daylight;
mod document;
mod emitter;
mod encoding;
mod film;
mod images;
mod integrator;
mod medium;
mod parse;
mod plugin;
mod sensor;
mod shape;
mod spectrum_plugin;
mod texture;
mod transform;
mod tree;
mod value;

pub use parse::LARGEST_FILE;

use crate::{
    LoadOptions, LoadedScene,
    error::{LoadError, abridged},
};
use bsdf::Materials;
use document::Reader;
use etendue_core::scene::SceneDescription;
use parse::Parser;
use std::{collections::HashMap, path::Path};
use tree::Node;

/// What is collected while the elements of a scene are read.
struct Import<'r, 'd> {
    reader: &'r Reader<'d>,
    materials: Materials<'r, 'd>,
    description: SceneDescription,
    /// The groups of shapes that have been read, by their elements.
    groups: HashMap<u32, usize>,
}

/// Reads a scene file with the meshes and images that it names.
///
/// # Errors
///
/// A file that cannot be read, or anything in it that is wrong or not supported.
pub fn load(path: &Path, options: LoadOptions) -> Result<LoadedScene, LoadError> {
    let Parser { tree, folders, notes, .. } = Parser::read(path, options.outside_folder)?;
    let reader = Reader::new(&tree, &folders, options)?;
    let mut scene = scene(&reader, tree.node(0), path)?;
    scene.notes = [notes, reader.notes()].concat();
    Ok(scene)
}

fn scene<'d>(reader: &Reader<'d>, root: Node<'d>, path: &Path) -> Result<LoadedScene, LoadError> {
    if root.tag() != "scene" {
        let message = format!("a scene file starts with <scene>, not <{}>", abridged(root.tag()));
        return Err(root.error(message));
    }
    root.allow_attributes(&["version"])?;
    root.required("version")?;

    let description = SceneDescription { name: path.display().to_string(), ..SceneDescription::default() };
    let mut import = Import { reader, materials: Materials::new(reader), description, groups: HashMap::new() };
    let mut integrator = None;
    let mut sensor: Option<sensor::Sensor> = None;
    for node in root.children() {
        let once = |taken: bool| match taken {
            true => Err(node.error(format!("a second <{}>; a scene has one", node.tag()))),
            false => Ok(()),
        };
        let read = match node.tag() {
            "integrator" => {
                once(integrator.is_some())?;
                integrator = Some(integrator::integrator(reader, node)?);
                continue;
            }
            "sensor" if sensor.is_some() => {
                reader.note(format!("the sensor in {} is passed over: the first one is taken", node.whereabouts()));
                continue;
            }
            "sensor" => {
                sensor = Some(sensor::sensor(reader, node)?);
                continue;
            }
            "bsdf" => import.materials.declare(node),
            "shape" => import.shape(node),
            "emitter" => import.emitter(node),
            // They are read where something refers to them.
            "texture" | "spectrum" | "medium" if node.attribute("id").is_some() => Ok(()),
            "alias" => Ok(()),
            "texture" | "spectrum" => {
                reader.note(format!("the {} is not used: it has no id", node.called()));
                continue;
            }
            other => Err(node.error(format!("<{}> is not supported in a scene", abridged(other)))),
        };
        reader.forgiven(read, "it is left out")?;
    }
    let integrator = integrator.unwrap_or_else(|| integrator::missing(reader));
    let sensor = sensor.ok_or_else(|| root.error("the scene has no <sensor>"))?;
    let Import { materials, mut description, .. } = import;
    description.materials = materials.finish();
    description.camera = Some(sensor.camera);
    Ok(LoadedScene {
        description,
        filter: sensor.filter,
        max_depth: integrator.max,
        roulette_depth: integrator.roulette,
        samples: Some(sensor.samples),
        notes: Vec::new(),
        exact: None,
    })
}
