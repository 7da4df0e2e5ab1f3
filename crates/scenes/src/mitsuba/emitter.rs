//! Emitters.

use super::{
    Import,
    ahead::ImageFile,
    daylight::daylight,
    document::Reader,
    plugin::{Meaning, Plugin},
    sensor::fov_x,
    texture::{EMISSION, REFLECTANCE, scale_texture, turned, upside_down},
    tree::Node,
};
use crate::{error::LoadError, image_file::Coding};
use etendue_core::{
    lights::environment::{Environment, Rows},
    rgb::Rgb,
    scene::{DeltaLight, LightDescription},
    texture::{Bitmap, Texture},
};
use glam::{DMat3, DVec3};
use std::{f32::consts::PI, sync::Arc};

/// Emitters that stand in the scene by themselves.
const KINDS: [&str; 9] = ["constant", "envmap", "sunsky", "sun", "sky", "point", "spot", "projector", "directional"];

/// The radiance of an `area` emitter, which stands in a shape.
pub(super) fn area_radiance<'d>(reader: &Reader<'d>, node: Node<'d>) -> Result<Texture<Rgb>, LoadError> {
    let plugin = Plugin::new(reader, node)?;
    if plugin.kind != "area" {
        return Err(plugin.unknown_kind(&["area"]));
    }
    let radiance = plugin.texture_or("radiance", EMISSION, Rgb::WHITE)?;
    pass_over_sampling_weight(&plugin)?;
    plugin.finish()?;
    Ok(radiance)
}

/// A way of sampling only; the image is the same, but for a weight of 0.
fn pass_over_sampling_weight(plugin: &Plugin) -> Result<(), LoadError> {
    if plugin.not_negative("sampling_weight")? == Some(0.0) {
        let called = plugin.node.called();
        plugin.reader.note(format!(
            "{called}: its sampling_weight of 0 has no effect, though Mitsuba never samples such a light"
        ));
    }
    Ok(())
}

impl<'d> Import<'_, 'd> {
    /// Adds a light that stands in the scene by itself.
    pub(super) fn emitter(&mut self, node: Node<'d>) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.reader, node)?;
        pass_over_sampling_weight(&plugin)?;
        match plugin.kind {
            // It shines from the shape that refers to it.
            "area" if node.attribute("id").is_some() => return Ok(()),
            "constant" => {
                let radiance = plugin.colour("radiance", Meaning::Emission)?.unwrap_or(Rgb::WHITE);
                self.environment(&plugin, Environment::Constant(radiance))?;
            }
            "envmap" => {
                let environment = image(&plugin)?;
                self.environment(&plugin, environment)?;
            }
            "sunsky" | "sun" | "sky" => {
                let environment = daylight(&plugin)?;
                self.environment(&plugin, environment)?;
            }
            "point" => self.light(&plugin, point(&plugin)?),
            "spot" => self.light(&plugin, spot(&plugin)?),
            "projector" => self.light(&plugin, projector(&plugin)?),
            "directional" => self.light(&plugin, directional(&plugin)?),
            _ => return Err(plugin.unknown_kind(&KINDS)),
        }
        plugin.finish()
    }

    fn environment(&mut self, plugin: &Plugin, environment: Environment) -> Result<(), LoadError> {
        if self.description.environment.is_some() {
            let message = "a second environment; a scene has one `constant`, `envmap` or sky at most";
            return Err(plugin.error(message));
        }
        self.description.environment = Some(environment);
        Ok(())
    }

    fn light(&mut self, plugin: &Plugin, kind: DeltaLight) {
        self.description.lights.push(LightDescription { name: plugin.node.called(), kind });
    }
}

/// A latitude-longitude image. Mitsuba puts its first and last rows on the poles; without a transform a direction `d`
/// lies at `u = atan2(d.x, -d.z) / 2 pi`, which is what [`Environment::LatLong`] says.
fn image(plugin: &Plugin) -> Result<Environment, LoadError> {
    let file = ImageFile::new(plugin.file("filename")?, Coding::Srgb);
    let mut image = plugin.reader.ahead.image(&file)?.bitmap();
    // Mitsuba's own bounds.
    if image.width < 2 || image.height < 3 {
        let message = format!("an environment image of {} x {} is below 2 x 3", image.width, image.height);
        return Err(plugin.error_at("filename", message));
    }
    let wrong = image.texels.iter().filter(|t| !t.is_valid()).count();
    if wrong > 0 {
        let path = file.path.display();
        plugin.reader.note(format!("{path}: {wrong} texels were negative, infinite or not a number and are black"));
        let valid = |t: &Rgb| if t.is_valid() { *t } else { Rgb::BLACK };
        image = with_texels(&image, image.texels.iter().map(valid).collect());
    }
    let scale = plugin.not_negative("scale")?.unwrap_or(1.0);
    // A way of sampling only; the image is the same.
    plugin.boolean("mis_compensation")?;
    let linear = plugin.to_world()?.matrix3;
    let mut to_world = orthonormal(linear).ok_or_else(|| {
        plugin.error_at("to_world", "an environment may be turned and mirrored, not scaled or sheared")
    })?;
    if to_world.determinant() < 0.0 {
        // A mirrored world is a turned one whose image is read from right to left: x changes its sign, and so does u.
        to_world *= DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        let mirrored = image.texels.chunks_exact(image.width as usize).flat_map(|row| row.iter().rev().copied());
        image = with_texels(&image, mirrored.collect());
    }
    Ok(Environment::LatLong { image, scale: scale as f32, to_world, rows: Rows::PoleToPole })
}

fn with_texels(image: &Bitmap<Rgb>, texels: Vec<Rgb>) -> Arc<Bitmap<Rgb>> {
    Arc::new(Bitmap { width: image.width, height: image.height, texels })
}

/// The matrix made exactly orthonormal, if it is so to the digits that files carry.
fn orthonormal(m: DMat3) -> Option<DMat3> {
    const SLACK: f64 = 1e-3;
    let gram = m.transpose() * m;
    if !(gram - DMat3::IDENTITY).to_cols_array().iter().all(|e| e.abs() <= SLACK) {
        return None;
    }
    let x = m.x_axis.normalize();
    let y = (m.y_axis - x * m.y_axis.dot(x)).normalize();
    Some(DMat3::from_cols(x, y, x.cross(y) * m.determinant().signum()))
}

fn point(plugin: &Plugin) -> Result<DeltaLight, LoadError> {
    let intensity = plugin.colour("intensity", Meaning::Emission)?.unwrap_or(Rgb::WHITE);
    let placed = plugin.to_world()?.translation;
    let position = match plugin.vector("position")? {
        Some(_) if plugin.has("to_world") => {
            return Err(plugin.error_at("position", "`position` is given beside `to_world`"));
        }
        Some(position) => position,
        None => placed,
    };
    Ok(DeltaLight::Point { position, intensity })
}

fn spot(plugin: &Plugin) -> Result<DeltaLight, LoadError> {
    let intensity = plugin.colour("intensity", Meaning::Emission)?.unwrap_or(Rgb::WHITE);
    let cutoff = plugin.positive("cutoff_angle")?.unwrap_or(20.0);
    let beam = plugin.float("beam_width")?.unwrap_or(cutoff * 0.75);
    if cutoff > 180.0 {
        return Err(plugin.error_at("cutoff_angle", "the parameter `cutoff_angle` is above 180 degrees"));
    }
    if !(0.0..=cutoff).contains(&beam) {
        return Err(plugin.error_at("beam_width", "the parameter `beam_width` is not from 0 to `cutoff_angle`"));
    }
    let to_world = plugin.to_world()?;
    // Mitsuba looks its image up with both coordinates growing along its axes, y up and x to the left, unless mirrored: the
    // image stands on its head.
    let mirrored = to_world.matrix3.determinant() < 0.0;
    let upright = |image| if mirrored { image } else { turned(image) };
    let image = plugin.texture("texture", REFLECTANCE)?.map(|image| (upright(image), to_world.matrix3.y_axis));
    Ok(DeltaLight::Spot {
        position: to_world.translation,
        direction: to_world.matrix3.z_axis.normalize(),
        intensity,
        beam: beam.to_radians(),
        cutoff: cutoff.to_radians(),
        image,
    })
}

/// Mitsuba's `irradiance` is so only by name: a plane at right angles to the axis at distance 1 receives pi times as much.
fn projector(plugin: &Plugin) -> Result<DeltaLight, LoadError> {
    let image = plugin.texture_or("irradiance", EMISSION, Rgb::WHITE)?;
    let aspect = match &image {
        Texture::Bitmap { bitmap, .. } => {
            let [width, height] = bitmap.size();
            f64::from(width) / f64::from(height)
        }
        _ => 1.0,
    };
    let scale = plugin.not_negative("scale")?.unwrap_or(1.0) as f32;
    let irradiance = scale_texture(upside_down(image), PI * scale);
    Ok(DeltaLight::Projector { to_world: plugin.to_world()?, fov_x: fov_x(plugin, aspect)?, aspect, irradiance })
}

fn directional(plugin: &Plugin) -> Result<DeltaLight, LoadError> {
    let irradiance = plugin.colour("irradiance", Meaning::Emission)?.unwrap_or(Rgb::WHITE);
    let placed = plugin.to_world()?.matrix3.z_axis;
    let direction = match plugin.vector("direction")? {
        Some(_) if plugin.has("to_world") => {
            return Err(plugin.error_at("direction", "`direction` is given beside `to_world`"));
        }
        Some(direction) => direction,
        None => placed,
    };
    let direction = direction.try_normalize().ok_or_else(|| plugin.error_at("direction", "the direction is zero"))?;
    Ok(DeltaLight::Directional { direction, irradiance })
}
