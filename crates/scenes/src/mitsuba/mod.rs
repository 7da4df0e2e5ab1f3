//! Scenes in the XML of Mitsuba 3.
//!
//! What is read: the integrator `path`; the sensors `perspective`, `thinlens` and `orthographic` with `hdrfilm`, its
//! filters `box`, `tent` and `gaussian`, and the sampler `independent`; the BSDFs `diffuse`, `conductor`,
//! `roughconductor`, `dielectric`, `roughdielectric`, `twosided` and `blendbsdf`; the shapes `rectangle`, `cube`,
//! `sphere`, `disk`, `obj` and `ply`; the emitters `area`, `constant`, `envmap`, `point`, `spot` and `directional`;
//! `<default>` and `$name`, `<ref>`. Everything else is an error with its line and column. Parameters under their older
//! names (`toWorld`, `intIOR`) count as those of today.
//!
//! Defaults and conventions are Mitsuba's. A file that the scene names must lie in the scene's folder.

mod bsdf;
mod document;
mod emitter;
mod plugin;
mod sensor;
mod shape;
mod transform;
mod value;

use crate::{
    LoadedScene,
    error::{Flaw, LoadError, Place, read_file},
};
use bsdf::Materials;
use document::Reader;
use etendue_core::scene::SceneDescription;
use plugin::{Plugin, elements};
use std::path::Path;

/// The largest scene file that is read.
pub const LARGEST_FILE: u64 = 1 << 28;

/// The most elements, attributes aside, that a scene file may have.
const MOST_NODES: u32 = 1 << 24;

/// What is collected while the elements of a scene are read.
struct Import<'r, 'd> {
    reader: &'r Reader<'d>,
    materials: Materials<'r, 'd>,
    description: SceneDescription,
    notes: Vec<String>,
}

/// Reads a scene file with the meshes and images that it names.
///
/// # Errors
///
/// A file that cannot be read, or anything in it that is wrong or not supported.
pub fn load(path: &Path) -> Result<LoadedScene, LoadError> {
    let bytes = read_file(path, LARGEST_FILE)?;
    let text = std::str::from_utf8(&bytes)
        .map_err(|e| Flaw::new(Place::Byte(e.valid_up_to() as u64), "the text is not UTF-8").of(path))?;
    let options = roxmltree::ParsingOptions { nodes_limit: MOST_NODES, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(text, options).map_err(|e| {
        let place = Place::Column(e.pos().row, e.pos().col);
        // The parser ends its messages with the place, which stands in front already.
        let message = e.to_string();
        let message = message.rsplit_once(" at ").map_or(message.as_str(), |(m, _)| m);
        Flaw::new(place, format!("not well-formed XML: {message}")).of(path)
    })?;
    scene(&Reader::new(path, &document)?, document.root_element())
}

fn scene<'d>(reader: &Reader<'d>, root: roxmltree::Node<'d, 'd>) -> Result<LoadedScene, LoadError> {
    if !root.has_tag_name("scene") {
        let message = format!("a scene file starts with <scene>, not <{}>", value::abridged(root.tag_name().name()));
        return Err(reader.error(root, message));
    }
    reader.allow_attributes(root, &["version"])?;
    reader.required(root, "version")?;

    let description = SceneDescription { name: reader.path().display().to_string(), ..SceneDescription::default() };
    let mut import = Import { reader, materials: Materials::new(reader), description, notes: Vec::new() };
    let mut integrator = None;
    let mut sensor: Option<sensor::Sensor> = None;
    for node in elements(reader, root)? {
        let once = |taken: bool| match taken {
            true => Err(reader.error(node, format!("a second <{}>; a scene has one", node.tag_name().name()))),
            false => Ok(()),
        };
        match node.tag_name().name() {
            "default" => {}
            "integrator" => {
                once(integrator.is_some())?;
                integrator = Some(path_integrator(reader, node)?);
            }
            "sensor" => {
                once(sensor.is_some())?;
                sensor = Some(sensor::sensor(reader, node, &mut import.notes)?);
            }
            "bsdf" => import.materials.declare(node)?,
            "shape" => import.shape(node)?,
            "emitter" => import.emitter(node)?,
            other => {
                let message = format!("<{}> is not supported in a scene", value::abridged(other));
                return Err(reader.error(node, message));
            }
        }
    }
    let integrator = integrator.ok_or_else(|| reader.error(root, "the scene has no <integrator>"))?;
    let sensor = sensor.ok_or_else(|| reader.error(root, "the scene has no <sensor>"))?;
    let Import { materials, mut description, mut notes, .. } = import;
    description.materials = materials.finish(&mut notes);
    let (max_depth, roulette_depth) = integrator;
    description.camera = Some(sensor.camera);
    Ok(LoadedScene {
        description,
        filter: sensor.filter,
        max_depth,
        roulette_depth,
        samples: Some(sensor.samples),
        notes,
        exact: None,
    })
}

/// Longest path and depth of roulette.
fn path_integrator<'d>(reader: &Reader<'d>, node: roxmltree::Node<'d, 'd>) -> Result<(u32, u32), LoadError> {
    let plugin = Plugin::new(reader, node)?;
    if plugin.kind != "path" {
        return Err(plugin.unknown_kind(&["path"]));
    }
    let most = i64::from(u32::MAX);
    // Mitsuba: -1 is no bound.
    let max_depth = match plugin.integer("max_depth", -1..=most)?.unwrap_or(-1) {
        -1 => u32::MAX,
        0 => return Err(plugin.error_at("max_depth", "a max_depth of 0 renders nothing; 1 is emission alone")),
        depth => depth as u32,
    };
    let roulette_depth = plugin.integer("rr_depth", 1..=most)?.unwrap_or(5) as u32;
    if plugin.boolean("hide_emitters")? == Some(true) {
        return Err(plugin.error_at("hide_emitters", "hidden emitters are not supported"));
    }
    plugin.finish()?;
    Ok((max_depth, roulette_depth))
}
