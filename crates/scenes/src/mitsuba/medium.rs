//! Media: those that absorb and do not scatter.

use super::{
    document::Reader,
    plugin::{Meaning, Plugin},
    tree::Node,
};
use crate::error::LoadError;
use etendue_core::rgb::Rgb;

/// The share of the light that a shape's inside absorbs a metre.
pub(super) fn absorption<'d>(shape: &Plugin<'_, 'd>) -> Result<Option<Rgb>, LoadError> {
    let reader = shape.reader;
    let interior = shape.nested_as("medium", "interior");
    let read = interior.map(|node| medium(reader, node)).transpose();
    let absorption = reader.forgiven(read, "the medium is left out")?.flatten();
    if let Some((_, place)) = shape.nested("medium").iter().find(|(node, _)| Some(*node) != interior) {
        let error = place.error("a medium outside of a shape is not supported; one inside has the name `interior`");
        reader.forgive(error, "the medium is left out")?;
    }
    Ok(absorption)
}

fn medium<'d>(reader: &Reader<'d>, node: Node<'d>) -> Result<Rgb, LoadError> {
    let plugin = Plugin::new(reader, node)?;
    if plugin.kind != "homogeneous" {
        return Err(plugin.unknown_kind(&["homogeneous"]));
    }
    let rate = |name| rate(&plugin, name);
    // Older files give absorption and scattering, those of today their sum and the share that is scattered.
    let older = (rate("sigma_a")?, rate("sigma_s")?);
    let today = (rate("sigma_t")?, rate("albedo")?);
    let scale = plugin.not_negative("scale")?.unwrap_or(1.0) as f32;
    let (absorbed, scatters) = match (older, today) {
        ((None, None), (total, albedo)) => (total.unwrap_or(Rgb::WHITE), !albedo.is_some_and(Rgb::is_black)),
        ((absorbed, scattered), (None, None)) => {
            (absorbed.unwrap_or(Rgb::BLACK), !scattered.unwrap_or(Rgb::BLACK).is_black())
        }
        _ => return Err(plugin.error("`sigma_a` and `sigma_s` do not go with `sigma_t` and `albedo`")),
    };
    if scatters {
        return Err(plugin.error("a medium that scatters light is not supported; one of albedo 0 is"));
    }
    for name in ["sample_emitters", "has_spectral_extinction"] {
        plugin.boolean(name)?;
    }
    plugin.finish()?;
    let absorption = absorbed * scale;
    match absorption.is_valid() {
        true => Ok(absorption),
        false => Err(plugin.error("the absorption is beyond single precision")),
    }
}

/// A rate or share, by a colour or by a `<volume>` that is the same everywhere.
fn rate(plugin: &Plugin, name: &'static str) -> Result<Option<Rgb>, LoadError> {
    let Some(node) = plugin.nested_as("volume", name) else { return plugin.colour(name, Meaning::Index) };
    let volume = Plugin::new(plugin.reader, node)?;
    if volume.kind != "constvolume" {
        return Err(volume.unknown_kind(&["constvolume"]));
    }
    let value = volume.colour("value", Meaning::Index)?;
    volume.finish()?;
    Ok(value)
}
