//! The sensor with its film, filter and sampler.

use super::{document::Reader, plugin::Plugin, value::number};
use crate::error::LoadError;
use etendue_core::{
    camera::{CameraDescription, Projection},
    filter::Filter,
};
use glam::{DAffine3, UVec2};
use roxmltree::Node;

/// The largest width and height of a film.
const LARGEST_SIDE: i64 = 1 << 16;
/// The most pixels of a film.
const MOST_PIXELS: i64 = 1 << 28;

/// What a sensor says.
pub(super) struct Sensor {
    pub(super) camera: CameraDescription,
    pub(super) filter: Filter,
    pub(super) samples: u32,
}

/// Reads the sensor.
pub(super) fn sensor<'d>(
    reader: &Reader<'d>,
    node: Node<'d, 'd>,
    notes: &mut Vec<String>,
) -> Result<Sensor, LoadError> {
    let plugin = Plugin::new(reader, node)?;
    let (resolution, filter) = match plugin.single("film")? {
        Some(film) => self::film(&Plugin::new(reader, film)?, notes)?,
        None => (UVec2::new(768, 576), Filter::Gaussian { stddev: 0.5 }),
    };
    let samples = match plugin.single("sampler")? {
        Some(sampler) => self::sampler(&Plugin::new(reader, sampler)?, notes)?,
        None => 4,
    };
    let mut to_world = plugin.to_world()?;
    let aspect = f64::from(resolution.x) / f64::from(resolution.y);
    let projection = match plugin.kind.as_str() {
        "perspective" => Projection::Perspective { fov_x: fov_x(&plugin, aspect)? },
        "thinlens" => {
            let aperture_radius = plugin.positive("aperture_radius")?;
            let missing = || plugin.error("the sensor type `thinlens` needs the parameter `aperture_radius`");
            Projection::ThinLens {
                fov_x: fov_x(&plugin, aspect)?,
                aperture_radius: aperture_radius.ok_or_else(missing)?,
                // Mitsuba focuses on its far clipping plane.
                focus_distance: match plugin.positive("focus_distance")? {
                    Some(distance) => distance,
                    None => plugin.positive("far_clip")?.unwrap_or(1e4),
                },
            }
        }
        "orthographic" => {
            // The film spans -1 to 1 in the camera's x.
            let scale = to_world.matrix3.x_axis.length();
            to_world.matrix3.x_axis /= scale;
            to_world.matrix3.y_axis /= scale;
            to_world.matrix3.z_axis = to_world.matrix3.z_axis.normalize();
            Projection::Orthographic { width: 2.0 * scale }
        }
        _ => return Err(plugin.unknown_kind(&["perspective", "thinlens", "orthographic"])),
    };
    if !rigid(to_world) {
        return Err(plugin.error_at("to_world", "a camera may be turned and moved, not scaled or sheared"));
    }
    for name in ["near_clip", "far_clip"] {
        if plugin.positive(name)?.is_some() {
            notes.push(format!("the sensor's {name} has no effect: nothing is clipped"));
        }
    }
    for name in ["principal_point_offset_x", "principal_point_offset_y", "shutter_open", "shutter_close"] {
        if plugin.float(name)?.is_some_and(|v| v != 0.0) {
            return Err(plugin.error_at(name, format!("a `{name}` other than 0 is not supported")));
        }
    }
    plugin.finish()?;
    Ok(Sensor { camera: CameraDescription { projection, to_world, resolution, crop: None }, filter, samples })
}

/// Whether the columns are of unit length and at right angles, to the digits that files carry.
fn rigid(to_world: DAffine3) -> bool {
    let m = to_world.matrix3;
    (m.transpose() * m - glam::DMat3::IDENTITY).to_cols_array().iter().all(|e| e.abs() <= 1e-3)
}

/// The horizontal field of view in radians.
fn fov_x(plugin: &Plugin, aspect: f64) -> Result<f64, LoadError> {
    let axis = plugin.word("fov_axis", &["x", "y", "diagonal", "smaller", "larger"])?.unwrap_or("x");
    let (fov, axis) = match (plugin.float("fov")?, plugin.text("focal_length")?) {
        (Some(_), Some(_)) => return Err(plugin.error_at("focal_length", "`focal_length` is given beside `fov`")),
        (Some(fov), None) => (fov.to_radians(), axis),
        (None, focal_length) => {
            let text = focal_length.unwrap_or("50mm");
            let length = number(text.trim().trim_end_matches("mm")).ok().filter(|l| *l > 0.0);
            let wrong = || plugin.error_at("focal_length", "the parameter `focal_length` is not like `50mm`");
            // Of 35 mm film, whose diagonal is that of 36 x 24 mm.
            (2.0 * (36f64.hypot(24.0) / (2.0 * length.ok_or_else(wrong)?)).atan(), "diagonal")
        }
    };
    let tan = (0.5 * fov).tan();
    let tan_x = match axis {
        "y" => tan * aspect,
        "smaller" if aspect > 1.0 => tan * aspect,
        "larger" if aspect < 1.0 => tan * aspect,
        "diagonal" => tan / (1.0 + 1.0 / (aspect * aspect)).sqrt(),
        _ => tan,
    };
    let fov_x = 2.0 * tan_x.atan();
    if !(fov > 0.0 && fov < std::f64::consts::PI && fov_x > 0.0 && fov_x < std::f64::consts::PI) {
        return Err(plugin.error_at("fov", "the field of view is not between 0 and 180 degrees"));
    }
    Ok(fov_x)
}

fn film(plugin: &Plugin, notes: &mut Vec<String>) -> Result<(UVec2, Filter), LoadError> {
    if plugin.kind != "hdrfilm" {
        return Err(plugin.unknown_kind(&["hdrfilm"]));
    }
    let width = plugin.integer("width", 1..=LARGEST_SIDE)?.unwrap_or(768);
    let height = plugin.integer("height", 1..=LARGEST_SIDE)?.unwrap_or(576);
    if width * height > MOST_PIXELS {
        return Err(plugin.error_at("width", format!("{width} x {height} is more than {MOST_PIXELS} pixels")));
    }
    // What Mitsuba would write; linear RGB is rendered whatever they say.
    plugin.word("file_format", &["openexr", "exr", "rgbe", "pfm"])?;
    plugin.word("component_format", &["float16", "float32", "uint32"])?;
    plugin.word("pixel_format", &["rgb", "rgba"])?;
    for name in ["banner", "compensate", "high_quality_edges"] {
        plugin.boolean(name)?;
    }
    if plugin.boolean("sample_border")? == Some(true) {
        notes.push("the film's sample_border has no effect: pixels are filtered by sampling".to_owned());
    }
    let filter = match plugin.single("rfilter")? {
        Some(node) => rfilter(&Plugin::new(plugin.reader, node)?)?,
        None => Filter::Gaussian { stddev: 0.5 },
    };
    plugin.finish()?;
    Ok((UVec2::new(width as u32, height as u32), filter))
}

fn rfilter(plugin: &Plugin) -> Result<Filter, LoadError> {
    let filter = match plugin.kind.as_str() {
        "box" => {
            if plugin.positive("radius")?.is_some_and(|r| r != 0.5) {
                return Err(plugin.error_at("radius", "a box of a radius other than 0.5 is not supported"));
            }
            Filter::Box
        }
        "tent" => Filter::Tent { radius: plugin.positive("radius")?.unwrap_or(1.0) as f32 },
        "gaussian" => Filter::Gaussian { stddev: plugin.positive("stddev")?.unwrap_or(0.5) as f32 },
        _ => return Err(plugin.unknown_kind(&["box", "tent", "gaussian"])),
    };
    plugin.finish()?;
    Ok(filter)
}

fn sampler(plugin: &Plugin, notes: &mut Vec<String>) -> Result<u32, LoadError> {
    if plugin.kind != "independent" {
        return Err(plugin.unknown_kind(&["independent"]));
    }
    let samples = plugin.integer("sample_count", 1..=i64::from(u32::MAX))?.unwrap_or(4) as u32;
    if plugin.integer("seed", 0..=i64::MAX)?.is_some() {
        notes.push("the sampler's seed has no effect".to_owned());
    }
    plugin.finish()?;
    Ok(samples)
}
