//! Textures: values that vary over a surface.

use super::{
    ahead::{ImageFile, coding_of},
    document::Reader,
    images::{Held, Images},
    plugin::{Meaning, Plugin},
    spectrum_plugin::{self, is_spectrum},
    tree::Node,
};
use crate::error::{LoadError, abridged};
use etendue_core::{
    rgb::Rgb,
    texture::{Bitmap, CodedBitmap, Interpolation, Raster, Texel, Texture, Wrap},
};
use glam::{Affine2, DAffine3, Mat2, Vec2};
use rayon::prelude::*;
use std::{cell::Cell, sync::Arc};

const KINDS: [&str; 4] = ["bitmap", "checkerboard", "mesh_attribute", "scale"];

/// How deep textures nest at most.
const DEEPEST: usize = 8;

/// From Mitsuba's texture coordinates, in which the first row of an image lies at v = 0, to the core's, in which it lies at v = 1.
const FLIP: Affine2 = Affine2 { matrix2: Mat2::from_cols(Vec2::X, Vec2::NEG_Y), translation: Vec2::Y };

/// What values stand for, and where they may lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Domain {
    pub(super) meaning: Meaning,
    least: f32,
    most: f32,
}

/// What a surface does to light, or a share of something.
pub(super) const REFLECTANCE: Domain = Domain { meaning: Meaning::Reflectance, least: 0.0, most: 1.0 };
/// Light.
pub(super) const EMISSION: Domain = Domain { meaning: Meaning::Emission, least: 0.0, most: f32::MAX };
/// Roughness that the core allows.
pub(super) const ROUGHNESS: Domain = Domain { meaning: Meaning::Reflectance, least: 1e-4, most: 1.0 };
/// A height.
pub(super) const HEIGHT: Domain = Domain { meaning: Meaning::Reflectance, least: f32::MIN, most: f32::MAX };
/// Diffuse transmission.
pub(super) const TRANSMISSION: Domain = Domain { meaning: Meaning::Reflectance, least: 0.0, most: 2.0 };

impl Domain {
    /// The least and the largest value.
    pub(super) fn bounds(self) -> (f32, f32) {
        (self.least, self.most)
    }
}

/// What textures hold here: colours or numbers.
pub(super) trait Value: Texel + PartialEq {
    /// Whether the two values of a checkerboard are exchanged: Mitsuba 3.9.1 looks colours up one way (`eval`) and numbers the
    /// other (`eval_1`).
    const EXCHANGED: bool;
    /// A constant parameter.
    fn constant(plugin: &Plugin, name: &'static str, domain: Domain) -> Result<Option<Self>, LoadError>;
    /// The value, if it lies in a domain.
    fn within(self, domain: Domain) -> Result<Self, String>;
    /// A colour as such a value; a number is the luminance.
    fn of(color: Rgb) -> Self;
    /// An image of colours as one of such values.
    fn image(colors: &Raster<Rgb>) -> Raster<Self>;
    /// Those of its images that are held.
    fn held(images: &Images) -> &Held<Self>;
}

impl Value for Rgb {
    const EXCHANGED: bool = false;

    fn constant(plugin: &Plugin, name: &'static str, domain: Domain) -> Result<Option<Rgb>, LoadError> {
        if domain == REFLECTANCE { plugin.reflectance(name) } else { plugin.colour(name, domain.meaning) }
    }

    fn within(self, domain: Domain) -> Result<Rgb, String> {
        match self.is_within(domain.least, domain.most) {
            true => Ok(self),
            false => Err(format!("not from {} to {}", domain.least, domain.most)),
        }
    }

    fn of(color: Rgb) -> Rgb {
        color
    }

    fn image(colors: &Raster<Rgb>) -> Raster<Rgb> {
        colors.clone()
    }

    fn held(images: &Images) -> &Held<Rgb> {
        &images.colours
    }
}

impl Value for f32 {
    const EXCHANGED: bool = true;

    fn constant(plugin: &Plugin, name: &'static str, domain: Domain) -> Result<Option<f32>, LoadError> {
        let value = match plugin.is_coloured(name) {
            true => plugin.colour(name, domain.meaning)?.map(|color| f64::from(Self::of(color))),
            false => plugin.float(name)?,
        };
        let Some(value) = value else { return Ok(None) };
        let within = (value as f32).within(domain);
        let within = within.map_err(|m| plugin.error_at(name, format!("the parameter `{name}` is {value}, {m}")))?;
        if value < f64::from(domain.least) {
            let called = plugin.node.attribute("id").unwrap_or("without an id");
            let message = format!("the BSDF `{called}` is smoother than {name} = {}, which is taken", domain.least);
            plugin.reader.note(message);
        }
        Ok(Some(within))
    }

    fn within(self, domain: Domain) -> Result<f32, String> {
        // What is smoother than the core allows is made as smooth as that.
        let (least, most) = (if domain == ROUGHNESS { 0.0 } else { domain.least }, domain.most);
        match (least..=most).contains(&self) {
            true => Ok(self.max(domain.least)),
            false => Err(format!("not from {least} to {most}")),
        }
    }

    fn of(color: Rgb) -> f32 {
        // A grey keeps its value to the last bit, and no luminance rounds to more than the largest component.
        if color.r == color.g && color.g == color.b { color.r } else { color.luminance().min(color.max_element()) }
    }

    fn image(colors: &Raster<Rgb>) -> Raster<f32> {
        let [width, height] = colors.size();
        if let Raster::Coded(coded) = colors {
            let texels = coded.bytes().as_chunks().0;
            if texels.iter().all(|[r, g, b]| r == g && g == b) {
                let greys = texels.iter().map(|[grey, _, _]| *grey).collect();
                if let Some(grey) = CodedBitmap::new(width, height, greys, *coded.values()) {
                    return Arc::new(grey).into();
                }
            }
        }
        let texels = colors.bitmap().texels.par_iter().map(|t| f32::of(*t)).collect();
        Arc::new(Bitmap { width, height, texels }).into()
    }

    fn held(images: &Images) -> &Held<f32> {
        &images.numbers
    }
}

impl Plugin<'_, '_> {
    /// A parameter that may be a texture.
    pub(super) fn texture<T: Value>(
        &self,
        name: &'static str,
        domain: Domain,
    ) -> Result<Option<Texture<T>>, LoadError> {
        match self.nested_as("texture", name) {
            Some(node) => {
                let read = texture(self.reader, node, domain, 0);
                self.reader.forgiven(read, "the parameter's default is taken")
            }
            None => Ok(T::constant(self, name, domain)?.map(Texture::Constant)),
        }
    }

    /// A parameter that may be a texture, with what it is if it is not given.
    pub(super) fn texture_or<T: Value>(
        &self,
        name: &'static str,
        domain: Domain,
        default: T,
    ) -> Result<Texture<T>, LoadError> {
        Ok(self.texture(name, domain)?.unwrap_or(Texture::Constant(default)))
    }
}

/// Reads a `<texture>`.
pub(super) fn texture<'d, T: Value>(
    reader: &Reader<'d>,
    node: Node<'d>,
    domain: Domain,
    depth: usize,
) -> Result<Texture<T>, LoadError> {
    if depth == DEEPEST {
        return Err(node.error(format!("textures are nested more than {DEEPEST} deep")));
    }
    let plugin = Plugin::new(reader, node)?;
    let texture = match plugin.kind {
        "bitmap" => bitmap(&plugin, domain)?,
        "checkerboard" => {
            let even = square(&plugin, "color0", domain, 0.4, depth)?;
            let odd = square(&plugin, "color1", domain, 0.2, depth)?;
            let (even, odd) = if T::EXCHANGED { (odd, even) } else { (even, odd) };
            Texture::Checkerboard { even, odd, to_uv: to_uv(&plugin)? }
        }
        "mesh_attribute" | "vertexcolors" => attribute(&plugin)?,
        "scale" => scaled(&plugin, domain, depth)?,
        _ if is_spectrum(node) => {
            let value = T::of(spectrum_plugin::rgb(reader, node)?);
            let within = value.within(domain).map_err(|m| node.error(format!("the spectrum is {m}")))?;
            if within != value {
                reader.note(format!("{}: {} stands in for a smaller roughness", node.called(), domain.least));
            }
            return Ok(Texture::Constant(within));
        }
        _ => return Err(plugin.unknown_kind(&KINDS)),
    };
    plugin.finish()?;
    Ok(texture)
}

/// One of a checkerboard's values, a constant.
fn square<T: Value>(
    plugin: &Plugin,
    name: &'static str,
    domain: Domain,
    default: f32,
    depth: usize,
) -> Result<T, LoadError> {
    match plugin.nested_as("texture", name) {
        None => Ok(T::constant(plugin, name, domain)?.unwrap_or(T::of(Rgb::splat(default)))),
        Some(node) => match texture(plugin.reader, node, domain, depth + 1)? {
            Texture::Constant(value) => Ok(value),
            _ => Err(plugin.error_at(name, "the squares of a checkerboard have one value each, not a texture")),
        },
    }
}

/// From the surface's texture coordinates to those of the texture, both Mitsuba's.
fn to_uv(plugin: &Plugin) -> Result<Affine2, LoadError> {
    let of = |t: DAffine3| {
        let m = t.matrix3;
        let matrix = Mat2::from_cols(m.x_axis.truncate().as_vec2(), m.y_axis.truncate().as_vec2());
        Affine2::from_mat2_translation(matrix, t.translation.truncate().as_vec2())
    };
    // Files of older versions move the coordinates first and scale them then.
    let mut older = [1.0f32, 1.0, 0.0, 0.0];
    for (value, name) in older.iter_mut().zip(["uscale", "vscale", "uoffset", "voffset"]) {
        *value = plugin.float(name)?.map_or(*value, |v| v as f32);
    }
    let [u_scale, v_scale, u_offset, v_offset] = older;
    let scale = Vec2::new(u_scale, v_scale);
    let older = Affine2::from_scale(scale) * Affine2::from_translation(Vec2::new(u_offset, v_offset));
    let whole = plugin.transform("to_uv")?.map_or(Affine2::IDENTITY, of) * older;
    match whole.is_finite() {
        true => Ok(whole),
        false => Err(plugin.error_at("to_uv", "the transform of the texture coordinates is not finite")),
    }
}

fn bitmap<T: Value>(plugin: &Plugin, domain: Domain) -> Result<Texture<T>, LoadError> {
    let path = plugin.file("filename")?;
    let interpolation = match plugin.word("filter_type", &["bilinear", "nearest", "trilinear", "ewa"])? {
        Some("nearest") => Interpolation::Nearest,
        Some(other @ ("trilinear" | "ewa")) => {
            plugin.reader.note(format!("{}: looked up bilinearly, not by the filter `{other}`", path.display()));
            Interpolation::Bilinear
        }
        _ => Interpolation::Bilinear,
    };
    let wrap = match plugin.word("wrap_mode", &["repeat", "mirror", "clamp"])? {
        Some("mirror") => Wrap::Mirror,
        Some("clamp") => Wrap::Clamp,
        _ => Wrap::Repeat,
    };
    let raw = plugin.boolean("raw")?.unwrap_or(false);
    let coding = coding_of(raw, plugin.float("gamma")?);
    // How images are kept and looked up; no matter to what they show.
    plugin.text("format")?;
    plugin.boolean("accel")?;
    plugin.boolean("cache")?;
    plugin.float("max_anisotropy")?;
    let file = ImageFile::new(path, coding);
    let image = plugin.reader.ahead.image(&file)?;
    let bitmap = plugin.reader.images.within(&file, &image, domain, |note| plugin.reader.note(note));
    Ok(Texture::Bitmap { bitmap, interpolation, wrap, to_uv: FLIP * to_uv(plugin)? })
}

fn attribute<T: Value>(plugin: &Plugin) -> Result<Texture<T>, LoadError> {
    if plugin.kind == "mesh_attribute" {
        match plugin.text("name")? {
            Some("vertex_color") => {}
            Some(other) => {
                let message = format!("the mesh attribute `{}` is not supported; `vertex_color` is", abridged(other));
                return Err(plugin.error_at("name", message));
            }
            None => return Err(plugin.error("the texture type `mesh_attribute` needs the parameter `name`")),
        }
        if plugin.float("scale")?.is_some_and(|s| s != 1.0) {
            return Err(plugin.error_at("scale", "a `scale` other than 1 is not supported"));
        }
    }
    plugin.reader.images.meet_vertex_colors();
    Ok(Texture::VertexColor)
}

/// A texture times its parameter.
fn scaled<T: Value>(plugin: &Plugin, domain: Domain, depth: usize) -> Result<Texture<T>, LoadError> {
    let factor = plugin.not_negative("scale")?.unwrap_or(1.0) as f32;
    let Some(inner) = plugin.single("texture")? else {
        return Err(plugin.error("the texture type `scale` needs a texture"));
    };
    match texture::<T>(plugin.reader, inner, domain, depth + 1)? {
        Texture::VertexColor => Err(plugin.error("vertex colours times a factor are not supported")),
        inner => {
            let moved = Cell::new(false);
            let scaled = changed(inner, |v| {
                let within = (v * factor).clamp(domain.least, domain.most);
                moved.set(moved.get() || within != v * factor);
                within
            });
            if moved.get() {
                let (called, least, most) = (plugin.node.called(), domain.least, domain.most);
                plugin.reader.note(format!("{called}: values that are not from {least} to {most} are moved there"));
            }
            Ok(scaled)
        }
    }
}

/// A texture times a factor.
pub(super) fn scale_texture(texture: Texture<Rgb>, factor: f32) -> Texture<Rgb> {
    changed(texture, |v| (v * factor).min(f32::MAX))
}

/// Two textures multiplied, of which one is a constant; none if neither is.
pub(super) fn product(a: &Texture<f32>, b: &Texture<f32>) -> Option<Texture<f32>> {
    match (a, b) {
        (Texture::Constant(_), Texture::VertexColor) | (Texture::VertexColor, Texture::Constant(_)) => None,
        (Texture::Constant(factor), other) | (other, Texture::Constant(factor)) => {
            Some(changed(other.clone(), |v| v * factor))
        }
        _ => None,
    }
}

/// A texture with each component of its values changed; vertex colours stay.
fn changed<T: Value>(texture: Texture<T>, f: impl Fn(f32) -> f32) -> Texture<T> {
    match texture {
        Texture::Constant(value) => Texture::Constant(value.map(&f)),
        Texture::Checkerboard { even, odd, to_uv } => {
            Texture::Checkerboard { even: even.map(&f), odd: odd.map(&f), to_uv }
        }
        Texture::Bitmap { bitmap, interpolation, wrap, to_uv } => {
            Texture::Bitmap { bitmap: bitmap.map(f), interpolation, wrap, to_uv }
        }
        Texture::VertexColor => Texture::VertexColor,
    }
}

/// The texture as it is looked up with coordinates whose v grows the other way.
pub(super) fn upside_down<T: Texel>(texture: Texture<T>) -> Texture<T> {
    looked_up_by(texture, FLIP)
}

/// The texture as it is looked up with coordinates whose u grows the other way.
pub(super) fn turned<T: Texel>(texture: Texture<T>) -> Texture<T> {
    looked_up_by(texture, Affine2 { matrix2: Mat2::from_cols(Vec2::NEG_X, Vec2::Y), translation: Vec2::X })
}

fn looked_up_by<T: Texel>(texture: Texture<T>, before: Affine2) -> Texture<T> {
    match texture {
        Texture::Bitmap { bitmap, interpolation, wrap, to_uv } => {
            Texture::Bitmap { bitmap, interpolation, wrap, to_uv: to_uv * before }
        }
        Texture::Checkerboard { even, odd, to_uv } => Texture::Checkerboard { even, odd, to_uv: to_uv * before },
        other => other,
    }
}
