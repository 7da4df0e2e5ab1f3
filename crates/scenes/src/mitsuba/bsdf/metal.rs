//! What conductors are made of.

use super::kinds::ior;
use crate::{
    error::{LoadError, abridged},
    mitsuba::{
        document::suggestion,
        plugin::{Meaning, Plugin},
    },
    spectrum,
};
use etendue_core::{bsdf::ConductorFresnel, rgb::Rgb};

/// By `eta` and `k`, by name, or with `material` `none` all reflected.
pub(super) fn conductor(plugin: &Plugin) -> Result<ConductorFresnel, LoadError> {
    let material = plugin.text("material")?;
    let none = material.is_none_or(|m| m.eq_ignore_ascii_case("none"));
    let given = (plugin.colour("eta", Meaning::Index)?, plugin.colour("k", Meaning::Index)?);
    // Of older files: what is around it.
    let outside = if plugin.has("ext_eta") { ior(plugin, "ext_eta", "air")? as f32 } else { 1.0 };
    let (eta, k) = match (given, material) {
        ((None, None), _) if none => return Ok(ConductorFresnel::Constant(Rgb::WHITE)),
        ((None, None), name) => named(plugin, name.unwrap_or_default())?,
        ((Some(_), Some(_)), _) if !none => {
            return Err(plugin.error_at("material", "`material` is given beside `eta` and `k`"));
        }
        ((Some(eta), Some(k)), _) => (eta, k),
        _ => return Err(plugin.error("`eta` and `k` go together")),
    };
    Ok(ConductorFresnel::Complex { eta: eta / outside, k: k / outside, tint: Rgb::WHITE })
}

fn named(plugin: &Plugin, name: &str) -> Result<(Rgb, Rgb), LoadError> {
    spectrum::conductor(name).ok_or_else(|| {
        // The same letters come first: `cu` is nearer to Cu than to Au.
        let mut same = spectrum::conductor_names().filter(|known| known.eq_ignore_ascii_case(name));
        let guess = match same.next() {
            Some(known) => suggestion(known, [known]),
            None => suggestion(name, spectrum::conductor_names()),
        };
        let message = format!(
            "the conductor `{}` is not known{guess}; give `eta` and `k`, the material `none` for a mirror, or one of {}",
            abridged(name),
            spectrum::conductor_names().collect::<Vec<_>>().join(", ")
        );
        plugin.error_at("material", message)
    })
}
