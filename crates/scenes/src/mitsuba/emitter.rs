//! Emitters.

use super::{Import, document::Reader, plugin::Plugin};
use crate::{
    error::LoadError,
    image_file::{self, Image},
};
use etendue_core::{
    lights::environment::{Environment, Rows},
    rgb::Rgb,
    scene::{DeltaLight, LightDescription},
};
use glam::{DMat3, DVec3};
use roxmltree::Node;
use std::sync::Arc;

/// Emitters that stand in the scene by themselves.
const KINDS: [&str; 5] = ["constant", "envmap", "point", "spot", "directional"];

/// The radiance of an `area` emitter, which stands in a shape.
pub(super) fn area_radiance<'d>(reader: &Reader<'d>, node: Node<'d, 'd>) -> Result<Rgb, LoadError> {
    let plugin = Plugin::new(reader, node)?;
    if plugin.kind != "area" {
        return Err(plugin.unknown_kind(&["area"]));
    }
    let radiance = plugin.colour("radiance")?.unwrap_or(Rgb::WHITE);
    plugin.finish()?;
    Ok(radiance)
}

impl<'d> Import<'_, 'd> {
    /// Adds a light that stands in the scene by itself.
    pub(super) fn emitter(&mut self, node: Node<'d, 'd>) -> Result<(), LoadError> {
        let plugin = Plugin::new(self.reader, node)?;
        match plugin.kind.as_str() {
            "constant" => {
                let radiance = plugin.colour("radiance")?.unwrap_or(Rgb::WHITE);
                self.environment(&plugin, Environment::Constant(radiance))?;
            }
            "envmap" => {
                let environment = self.image(&plugin)?;
                self.environment(&plugin, environment)?;
            }
            "point" => self.light(&plugin, point(&plugin)?),
            "spot" => self.light(&plugin, spot(&plugin)?),
            "directional" => self.light(&plugin, directional(&plugin)?),
            _ => return Err(plugin.unknown_kind(&KINDS)),
        }
        plugin.finish()
    }

    fn environment(&mut self, plugin: &Plugin, environment: Environment) -> Result<(), LoadError> {
        if self.description.environment.is_some() {
            return Err(plugin.error("a second environment; a scene has one `constant` or `envmap` at most"));
        }
        self.description.environment = Some(environment);
        Ok(())
    }

    fn light(&mut self, plugin: &Plugin, kind: DeltaLight) {
        let line = self.reader.line(plugin.node);
        let name = plugin.node.attribute("id").map_or_else(|| format!("{} in line {line}", plugin.kind), str::to_owned);
        self.description.lights.push(LightDescription { name, kind });
    }

    /// A latitude-longitude image. Mitsuba puts its first and last rows on the poles; without a transform a direction `d`
    /// lies at `u = atan2(d.x, -d.z) / 2 pi`, which is what [`Environment::LatLong`] says.
    fn image(&mut self, plugin: &Plugin) -> Result<Environment, LoadError> {
        let path = plugin.file("filename")?;
        let Image { mut bitmap, zeroed } = image_file::read(&path)?;
        // Mitsuba's own bounds.
        if bitmap.width < 2 || bitmap.height < 3 {
            let message = format!("an environment image of {} x {} is below 2 x 3", bitmap.width, bitmap.height);
            return Err(plugin.error_at("filename", message));
        }
        if zeroed > 0 {
            self.notes.push(format!(
                "{}: {zeroed} texels were negative, infinite or not a number and are black",
                path.display()
            ));
        }
        let scale = plugin.float("scale")?.unwrap_or(1.0);
        if scale < 0.0 {
            return Err(plugin.error_at("scale", "the parameter `scale` is negative"));
        }
        // A way of sampling only; the image is the same.
        plugin.boolean("mis_compensation")?;
        let linear = plugin.to_world()?.matrix3;
        let mut to_world = orthonormal(linear).ok_or_else(|| {
            plugin.error_at("to_world", "an environment may be turned and mirrored, not scaled or sheared")
        })?;
        if to_world.determinant() < 0.0 {
            // A mirrored world is a turned one whose image is read from right to left: x changes its sign, and so does u.
            to_world *= DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
            let width = bitmap.width as usize;
            bitmap.texels.chunks_exact_mut(width).for_each(<[Rgb]>::reverse);
        }
        Ok(Environment::LatLong { image: Arc::new(bitmap), scale: scale as f32, to_world, rows: Rows::PoleToPole })
    }
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
    let intensity = plugin.colour("intensity")?.unwrap_or(Rgb::WHITE);
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
    let intensity = plugin.colour("intensity")?.unwrap_or(Rgb::WHITE);
    let cutoff = plugin.positive("cutoff_angle")?.unwrap_or(20.0);
    let beam = plugin.float("beam_width")?.unwrap_or(cutoff * 0.75);
    if cutoff > 180.0 {
        return Err(plugin.error_at("cutoff_angle", "the parameter `cutoff_angle` is above 180 degrees"));
    }
    if !(0.0..=cutoff).contains(&beam) {
        return Err(plugin.error_at("beam_width", "the parameter `beam_width` is not from 0 to `cutoff_angle`"));
    }
    let to_world = plugin.to_world()?;
    Ok(DeltaLight::Spot {
        position: to_world.translation,
        direction: to_world.matrix3.z_axis.normalize(),
        intensity,
        beam: beam.to_radians(),
        cutoff: cutoff.to_radians(),
        image: None,
    })
}

fn directional(plugin: &Plugin) -> Result<DeltaLight, LoadError> {
    let irradiance = plugin.colour("irradiance")?.unwrap_or(Rgb::WHITE);
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
