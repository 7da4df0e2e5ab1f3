//! The sensor and its sampler.

use super::{
    document::Reader,
    film::{Film, film},
    plugin::Plugin,
    tree::Node,
    value::number,
};
use crate::error::LoadError;
use etendue_core::{
    camera::{CameraDescription, Projection},
    filter::Filter,
};
use glam::{DAffine3, DVec2};

/// Samplers other than `independent`, of which the number of samples is taken.
const SAMPLERS: [&str; 7] =
    ["independent", "stratified", "multijitter", "orthogonal", "ldsampler", "halton", "hammersley"];

/// What a sensor says.
pub(super) struct Sensor {
    pub(super) camera: CameraDescription,
    pub(super) filter: Filter,
    pub(super) samples: u32,
}

/// Reads the sensor.
pub(super) fn sensor<'d>(reader: &Reader<'d>, node: Node<'d>) -> Result<Sensor, LoadError> {
    let plugin = Plugin::new(reader, node)?;
    let Film { resolution, crop, filter } = match plugin.single("film")? {
        Some(film) => self::film(&Plugin::new(reader, film)?)?,
        None => Film::default(),
    };
    let samples = match plugin.single("sampler")? {
        Some(sampler) => self::sampler(&Plugin::new(reader, sampler)?)?,
        None => 4,
    };
    let mut to_world = plugin.to_world()?;
    let aspect = f64::from(resolution.x) / f64::from(resolution.y);
    let projection = match plugin.kind {
        "perspective" => {
            // It matters to a lens only.
            plugin.positive("focus_distance")?;
            let offset = |name| plugin.float(name).map(|v| v.unwrap_or(0.0));
            let offset = DVec2::new(offset("principal_point_offset_x")?, offset("principal_point_offset_y")?);
            match fov_x(&plugin, aspect)? {
                fov_x if offset == DVec2::ZERO => Projection::Perspective { fov_x },
                fov_x => Projection::OffAxis { fov_x, offset },
            }
        }
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
            plugin.positive("focus_distance")?;
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
        let turned = turned(to_world).filter(|_| plugin.kind != "orthographic");
        match turned {
            // The eye of a perspective is a point: scaling the same in each direction changes nothing.
            Some(turned) => to_world = turned,
            None => return Err(plugin.error_at("to_world", "a camera may be turned and moved, not scaled or sheared")),
        }
    }
    for name in ["near_clip", "far_clip"] {
        if plugin.positive(name)?.is_some() {
            reader.note(format!("the sensor's {name} has no effect: nothing is clipped"));
        }
    }
    for name in ["shutter_open", "shutter_close"] {
        if plugin.float(name)?.is_some_and(|v| v != 0.0) {
            reader.note(format!("the sensor's {name} has no effect: nothing moves"));
        }
    }
    if let Some((_, place)) = plugin.nested("medium").first() {
        reader.forgive(place.error("a camera in a medium is not supported"), "the medium is left out")?;
    }
    plugin.finish()?;
    Ok(Sensor { camera: CameraDescription { projection, to_world, resolution, crop }, filter, samples })
}

/// Whether the columns are of unit length and at right angles, to the digits that files carry.
fn rigid(to_world: DAffine3) -> bool {
    let m = to_world.matrix3;
    (m.transpose() * m - glam::DMat3::IDENTITY).to_cols_array().iter().all(|e| e.abs() <= 1e-3)
}

/// The transform without a scale that is the same in each direction, if it has no other.
fn turned(mut to_world: DAffine3) -> Option<DAffine3> {
    to_world.matrix3 *= to_world.matrix3.x_axis.length().recip();
    rigid(to_world).then_some(to_world)
}

/// The horizontal field of view in radians.
pub(super) fn fov_x(plugin: &Plugin, aspect: f64) -> Result<f64, LoadError> {
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

fn sampler(plugin: &Plugin) -> Result<u32, LoadError> {
    if !SAMPLERS.contains(&plugin.kind) && plugin.kind != "sobol" {
        plugin.reader.forgive(plugin.unknown_kind(&SAMPLERS), "its number of samples is taken")?;
    }
    let samples = plugin.integer("sample_count", 1..=i64::from(u32::MAX))?.unwrap_or(4) as u32;
    if plugin.integer("seed", 0..=i64::MAX)?.is_some() {
        plugin.reader.note("the sampler's seed has no effect");
    }
    if plugin.kind == "independent" {
        plugin.finish()?;
    } else {
        plugin.reader.note(format!("of the sampler `{}` only the number of samples is taken", plugin.kind));
    }
    Ok(samples)
}
