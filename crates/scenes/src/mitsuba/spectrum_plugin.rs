//! Spectra that stand as plugins: `uniform`, `d65`, `srgb` and their like.

use super::{
    document::Reader,
    plugin::{Meaning, Plugin},
    tree::Node,
};
use crate::error::LoadError;
use etendue_core::rgb::Rgb;

const KINDS: [&str; 5] = ["uniform", "d65", "srgb", "rgb", "rawconstant"];

/// Returns `true` for an element that is a spectrum, by `<spectrum>` or by `<texture>`.
pub(super) fn is_spectrum(node: Node) -> bool {
    node.tag() == "spectrum" || node.attribute("type").is_some_and(|kind| KINDS.contains(&kind))
}

/// The RGB of a spectrum, the same whether it is light or what a surface does to light.
pub(super) fn rgb<'d>(reader: &Reader<'d>, node: Node<'d>) -> Result<Rgb, LoadError> {
    let plugin = Plugin::new(reader, node)?;
    let needed = |name| {
        plugin
            .colour(name, Meaning::Reflectance)?
            .ok_or_else(|| plugin.error(format!("the spectrum type `{}` needs the parameter `{name}`", plugin.kind)))
    };
    let rgb = match plugin.kind {
        "uniform" | "rawconstant" => needed("value")?,
        // White of the daylight for which RGB is made.
        "d65" => Rgb::splat(plugin.not_negative("scale")?.unwrap_or(1.0) as f32),
        "srgb" | "rgb" if plugin.has("value") => needed("value")?,
        "srgb" | "rgb" => needed("color")?,
        _ => return Err(plugin.unknown_kind(&KINDS)),
    };
    plugin.finish()?;
    Ok(rgb)
}
