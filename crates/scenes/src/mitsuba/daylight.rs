//! The emitters `sunsky`, `sun` and `sky`: an image of daylight.

use super::plugin::{Meaning, Plugin};
use crate::{
    error::LoadError,
    sun_sky::{self, Moment, SUN_APERTURE, SunSky, TURBIDITIES},
};
use etendue_core::lights::environment::{Environment, Rows};
use glam::{DMat3, DQuat, DVec3};
use std::{f64::consts::PI, sync::Arc};

/// The daylight that an emitter describes.
///
/// In Mitsuba 3 the sky's own z is up, its x south and its y west; in older versions its y is up. A sun's direction is given in the
/// world.
pub(super) fn daylight(plugin: &Plugin) -> Result<Environment, LoadError> {
    let turbidity = plugin.float("turbidity")?.unwrap_or(3.0);
    if !(TURBIDITIES.0..=TURBIDITIES.1).contains(&turbidity) {
        let nearest = turbidity.clamp(TURBIDITIES.0, TURBIDITIES.1);
        plugin.reader.note(format!("{}: {nearest} stands in for the turbidity {turbidity}", plugin.node.called()));
    }
    let older = plugin.reader.older;
    let linear = plugin.to_world()?.matrix3;
    let up = linear * if older { DVec3::Y } else { DVec3::Z };
    let up = up.try_normalize().ok_or_else(|| plugin.error_at("to_world", "the sky has no way up"))?;
    // The sky is the same from each side but for the sun, so that any turn that brings its zenith to its place will do.
    let to_world = DMat3::from_quat(DQuat::from_rotation_arc(DVec3::Y, up));
    let towards_sun = match plugin.vector("sun_direction")? {
        Some(direction) => direction,
        None => {
            let d = sun_sky::sun_direction(&moment(plugin)?);
            linear * if older { d } else { DVec3::new(d.z, -d.x, d.y) }
        }
    };
    let towards_sun = towards_sun.try_normalize();
    let towards_sun = towards_sun.ok_or_else(|| plugin.error_at("sun_direction", "the direction is zero"))?;
    let degrees = plugin.positive("sun_aperture")?;
    let times = plugin.positive("sun_radius_scale")?.unwrap_or(1.0);
    let sun_aperture = degrees.map_or(SUN_APERTURE, f64::to_radians) * times;
    if sun_aperture >= PI {
        return Err(plugin.error_at("sun_aperture", "the sun is not below 180 degrees across"));
    }
    let scale = plugin.not_negative("scale")?.unwrap_or(1.0);
    let factor = |name, shines: bool| -> Result<f64, LoadError> {
        let factor = plugin.not_negative(name)?.unwrap_or(1.0);
        Ok(if shines { factor * scale } else { 0.0 })
    };
    let params = SunSky {
        turbidity,
        sun_direction: to_world.transpose() * towards_sun,
        sun_scale: factor("sun_scale", plugin.kind != "sky")?,
        sky_scale: factor("sky_scale", plugin.kind != "sun")?,
        sun_aperture,
        ..SunSky::default()
    };
    // They matter to other models of the sky, or to how one is kept.
    plugin.colour("albedo", Meaning::Reflectance)?;
    plugin.boolean("complex_sun")?;
    plugin.float("stretch")?;
    plugin.integer("resolution", 1..=i64::MAX)?;
    plugin.integer("sun_samples", 0..=i64::MAX)?;
    let model = "the daylight is that of Preetham, Shirley and Smits, which differs from Mitsuba's";
    plugin.reader.note(format!("{}: {model}", plugin.node.called()));
    let image = Arc::new(sun_sky::bake(&params));
    Ok(Environment::LatLong { image, scale: 1.0, to_world, rows: Rows::Centred })
}

/// A place and a time; Mitsuba's own are Tokyo's on an afternoon of July.
fn moment(plugin: &Plugin) -> Result<Moment, LoadError> {
    let number = |name, default: f64| plugin.float(name).map(|v| v.unwrap_or(default));
    let whole = |name, range, default: i64| plugin.integer(name, range).map(|v| v.unwrap_or(default));
    Ok(Moment {
        latitude: number("latitude", 35.6894)?.to_radians(),
        longitude: number("longitude", 139.6917)?.to_radians(),
        timezone: number("timezone", 9.0)?,
        year: whole("year", 1..=9999, 2010)? as i32,
        month: whole("month", 1..=12, 7)? as u32,
        day: whole("day", 1..=31, 10)? as u32,
        hour: number("hour", 15.0)? + number("minute", 0.0)? / 60.0 + number("second", 0.0)? / 3600.0,
    })
}
