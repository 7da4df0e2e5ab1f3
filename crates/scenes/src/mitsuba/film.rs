//! The film and its filter.

use super::plugin::Plugin;
use crate::error::LoadError;
use etendue_core::{camera::Crop, filter::Filter};
use glam::UVec2;

/// The largest width and height of a film.
const LARGEST_SIDE: i64 = etendue_core::film::Film::MOST_PER_SIDE as i64;
/// The most pixels of a film.
const MOST_PIXELS: i64 = etendue_core::film::Film::MOST_PIXELS as i64;

/// The standard deviation of Mitsuba's own filter, pixels.
const DEFAULT_STDDEV: f32 = 0.5;

/// What a film says.
pub(super) struct Film {
    pub(super) resolution: UVec2,
    pub(super) crop: Option<Crop>,
    pub(super) filter: Filter,
}

impl Default for Film {
    fn default() -> Film {
        Film { resolution: UVec2::new(768, 576), crop: None, filter: Filter::Gaussian { stddev: DEFAULT_STDDEV } }
    }
}

/// Reads a film.
pub(super) fn film(plugin: &Plugin) -> Result<Film, LoadError> {
    match plugin.kind {
        "hdrfilm" => {}
        "ldrfilm" | "tiledhdrfilm" | "mfilm" | "specfilm" => {
            plugin.reader.note(format!("the film `{}` is taken as one of linear RGB", plugin.kind));
        }
        _ => return Err(plugin.unknown_kind(&["hdrfilm"])),
    }
    let default = Film::default();
    let width = plugin.integer("width", 1..=LARGEST_SIDE)?.unwrap_or(i64::from(default.resolution.x));
    let height = plugin.integer("height", 1..=LARGEST_SIDE)?.unwrap_or(i64::from(default.resolution.y));
    if width * height > MOST_PIXELS {
        return Err(plugin.error_at("width", format!("{width} x {height} is more than {MOST_PIXELS} pixels")));
    }
    // What Mitsuba would write; linear RGB is rendered whatever they say.
    for name in ["file_format", "component_format", "pixel_format", "label", "tonemap_method", "variable"] {
        plugin.text(name)?;
    }
    for name in ["banner", "compensate", "high_quality_edges", "attach_log", "fill_alpha"] {
        plugin.boolean(name)?;
    }
    for name in ["gamma", "exposure", "key", "burn", "digits"] {
        plugin.float(name)?;
    }
    if plugin.boolean("sample_border")? == Some(true) {
        plugin.reader.note("the film's sample_border has no effect: pixels are filtered by sampling");
    }
    let filter = match plugin.single("rfilter")? {
        Some(node) => {
            let read = rfilter(&Plugin::new(plugin.reader, node)?);
            plugin.reader.forgiven(read, "a Gaussian is taken")?.unwrap_or(default.filter)
        }
        None => default.filter,
    };
    let resolution = UVec2::new(width as u32, height as u32);
    let crop = crop(plugin, resolution)?;
    plugin.finish()?;
    Ok(Film { resolution, crop, filter })
}

/// The part of the film that is rendered; none for all of it.
fn crop(plugin: &Plugin, film: UVec2) -> Result<Option<Crop>, LoadError> {
    let given = |name, from, default: u32| -> Result<u32, LoadError> {
        Ok(plugin.integer(name, from..=LARGEST_SIDE)?.map_or(default, |v| v as u32))
    };
    let offset = UVec2::new(given("crop_offset_x", 0, 0)?, given("crop_offset_y", 0, 0)?);
    let size = UVec2::new(given("crop_width", 1, film.x)?, given("crop_height", 1, film.y)?);
    if (offset + size).cmpgt(film).any() {
        let message = format!(
            "a crop of {} x {} at {}, {} leaves the film of {} x {}",
            size.x, size.y, offset.x, offset.y, film.x, film.y
        );
        return Err(plugin.error(message));
    }
    Ok((size != film).then_some(Crop { offset, size }))
}

fn rfilter(plugin: &Plugin) -> Result<Filter, LoadError> {
    let filter = match plugin.kind {
        "box" => {
            if plugin.positive("radius")?.is_some_and(|r| r != 0.5) {
                return Err(plugin.error_at("radius", "a box of a radius other than 0.5 is not supported"));
            }
            Filter::Box
        }
        "tent" => Filter::Tent { radius: plugin.positive("radius")?.unwrap_or(1.0) as f32 },
        "gaussian" => Filter::Gaussian { stddev: plugin.positive("stddev")?.map_or(DEFAULT_STDDEV, |s| s as f32) },
        "mitchell" | "catmullrom" | "lanczos" => {
            for name in ["b", "c", "lobes"] {
                plugin.float(name)?;
            }
            let note = format!(
                "the filter `{}` is negative in places, which pixels that are filtered by sampling cannot be: a Gaussian of \
                 standard deviation {DEFAULT_STDDEV} stands in for it",
                plugin.kind
            );
            plugin.reader.note(note);
            Filter::Gaussian { stddev: DEFAULT_STDDEV }
        }
        _ => return Err(plugin.unknown_kind(&["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"])),
    };
    plugin.finish()?;
    Ok(filter)
}
