//! Textures: images with factors worked in, each worked out once.

use super::{
    Notes,
    data::Buffers,
    flaw,
    image::{Decoded, flaw_of},
    item, valid,
};
use crate::{error::Flaw, folders::Folders};
use etendue_core::{
    rgb::Rgb,
    texture::{Bitmap, Interpolation, Texel, Texture, Wrap},
};
use glam::{Affine2, Mat2, Vec2, Vec3};
use gltf_json::{
    Root,
    extensions::texture::TextureTransform,
    material::NormalTexture,
    texture::{Info, MagFilter, WrappingMode},
};
use std::{collections::HashMap, hash::Hash, sync::Arc};

/// Where a material looks a texture up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lookup {
    /// Index into the file's textures.
    pub(super) texture: usize,
    /// Which set of texture coordinates.
    pub(super) set: u32,
    /// From the mesh's texture coordinates, whose v grows upwards, to the image's.
    to_uv: Affine2,
}

impl Lookup {
    pub(super) fn of(info: &Info) -> Lookup {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
        Lookup::new(info.index.value(), info.tex_coord, transform)
    }

    /// The lookup of a normal map; its transform is not among what the parser knows.
    pub(super) fn of_normals(info: &NormalTexture) -> Result<Lookup, Flaw> {
        let json = info.extensions.as_ref().and_then(|e| e.others.get("KHR_texture_transform"));
        let transform: Option<TextureTransform> = json
            .map(|t| serde_json::from_value(t.clone()))
            .transpose()
            .map_err(|_| flaw(format!("the transform of the normals of textures[{}] is none", info.index.value())))?;
        Ok(Lookup::new(info.index.value(), info.tex_coord, transform.as_ref()))
    }

    fn new(texture: usize, set: u32, transform: Option<&TextureTransform>) -> Lookup {
        let Some(transform) = transform else { return Lookup { texture, set, to_uv: Affine2::IDENTITY } };
        let (sin, cos) = transform.rotation.0.sin_cos();
        // Counter-clockwise as it is seen, where v grows downwards [KHR_texture_transform].
        let turn = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
        let scale = Mat2::from_diagonal(Vec2::from(transform.scale.0));
        let given = Affine2::from_mat2_translation(turn * scale, Vec2::from(transform.offset.0));
        let flip = Affine2 { matrix2: Mat2::from_diagonal(Vec2::new(1.0, -1.0)), translation: Vec2::Y };
        Lookup { texture, set: transform.tex_coord.unwrap_or(set), to_uv: flip * given * flip }
    }
}

/// What a texture's image is worked into; factors as bits, so that they can be compared.
#[derive(Clone, Copy, Hash, PartialEq, Eq)]
enum Use {
    Colour([u32; 3]),
    Normals(u32),
    Number(usize, u32),
    Threshold(u32, u32),
}

/// The values of an image.
#[derive(Clone)]
enum Values<T> {
    Same(T),
    Many(Arc<Bitmap<T>>),
}

/// The most texels of all textures together, an image counted once for each use.
const MOST_TEXELS: u64 = 1 << 29;

/// The textures of a file.
pub(super) struct Textures<'d> {
    root: &'d Root,
    buffers: &'d Buffers<'d>,
    folders: Option<&'d Folders>,
    /// The image that was decoded last: the uses of one image mostly follow each other.
    last: Option<(usize, Decoded)>,
    colours: HashMap<(usize, Use), Values<Rgb>>,
    numbers: HashMap<(usize, Use), Values<f32>>,
    /// How many texels are held.
    held: u64,
}

impl<'d> Textures<'d> {
    pub(super) fn new(root: &'d Root, buffers: &'d Buffers, folders: Option<&'d Folders>) -> Textures<'d> {
        Textures { root, buffers, folders, last: None, colours: HashMap::new(), numbers: HashMap::new(), held: 0 }
    }

    /// Whether a texture has an image that can be read; if not, a note says so.
    pub(super) fn has_image(&self, lookup: &Lookup, notes: &mut Notes) -> Result<bool, Flaw> {
        let texture = item(&self.root.textures, "textures", lookup.texture)?;
        // What stands for none.
        let has = texture.source.value() != u32::MAX as usize;
        if !has {
            notes.add(format!("textures[{}] has no image in PNG or JPEG and is left out", lookup.texture));
        }
        Ok(has)
    }

    /// Colours, of which the image has sRGB, times a factor.
    pub(super) fn colour(
        &mut self,
        lookup: &Lookup,
        factor: [f32; 3],
        notes: &mut Notes,
    ) -> Result<Texture<Rgb>, Flaw> {
        let factors = Rgb::from(factor);
        let values = self.values(
            lookup,
            Use::Colour(factor.map(f32::to_bits)),
            |t| &mut t.colours,
            |image| image.colours().map(|c| Rgb::from(c) * factors).collect(),
        )?;
        self.texture(lookup, values, notes)
    }

    /// Normals, whose x and y are scaled.
    pub(super) fn normals(&mut self, lookup: &Lookup, scale: f32, notes: &mut Notes) -> Result<Texture<Rgb>, Flaw> {
        let scaled = |[x, y, z, _]: [f32; 4]| {
            let n = Vec3::new(scale * (2.0 * x - 1.0), scale * (2.0 * y - 1.0), 2.0 * z - 1.0);
            Rgb::from((n.try_normalize().unwrap_or(Vec3::Z) * 0.5 + 0.5).clamp(Vec3::ZERO, Vec3::ONE).to_array())
        };
        let values = self.values(
            lookup,
            Use::Normals(scale.to_bits()),
            |t| &mut t.colours,
            |image| image.texels().map(scaled).collect(),
        )?;
        self.texture(lookup, values, notes)
    }

    /// One channel of an image, which is linear, times a factor.
    pub(super) fn number(
        &mut self,
        lookup: &Lookup,
        channel: usize,
        factor: f32,
        notes: &mut Notes,
    ) -> Result<Texture<f32>, Flaw> {
        let values = self.values(
            lookup,
            Use::Number(channel, factor.to_bits()),
            |t| &mut t.numbers,
            |image| image.texels().map(|t| t[channel] * factor).collect(),
        )?;
        self.texture(lookup, values, notes)
    }

    /// 1 where the alpha times a factor reaches a cutoff, 0 elsewhere.
    pub(super) fn threshold(
        &mut self,
        lookup: &Lookup,
        factor: f32,
        cutoff: f32,
        notes: &mut Notes,
    ) -> Result<Texture<f32>, Flaw> {
        let kind = Use::Threshold(factor.to_bits(), cutoff.to_bits());
        let values = self.values(
            lookup,
            kind,
            |t| &mut t.numbers,
            |image| image.texels().map(|t| if t[3] * factor >= cutoff { 1.0 } else { 0.0 }).collect(),
        )?;
        self.texture(lookup, values, notes)
    }

    /// The values of an image for a use, worked out or remembered.
    fn values<T: Texel + PartialEq>(
        &mut self,
        lookup: &Lookup,
        kind: Use,
        memory: impl Fn(&mut Self) -> &mut HashMap<(usize, Use), Values<T>>,
        make: impl FnOnce(&Decoded) -> Vec<T>,
    ) -> Result<Values<T>, Flaw> {
        let index = item(&self.root.textures, "textures", lookup.texture)?.source.value();
        if let Some(known) = memory(self).get(&(index, kind)) {
            return Ok(known.clone());
        }
        if self.last.as_ref().is_none_or(|(i, _)| *i != index) {
            // The memory of the last one is free before that of the next is taken.
            self.last = None;
            let bytes = self.buffers.image(self.root, index, self.folders)?;
            self.last = Some((index, Decoded::of(&bytes).map_err(|e| flaw_of(index, &e))?));
        }
        let Some((_, image)) = &self.last else { return Err(flaw_of(index, "it is not decoded")) };
        let (width, height) = (image.width, image.height);
        self.held += u64::from(width) * u64::from(height);
        if self.held > MOST_TEXELS {
            return Err(flaw(format!("the textures have more than {MOST_TEXELS} texels together")));
        }
        let texels = make(image);
        let values = match texels.iter().all(|t| *t == texels[0]) {
            true => Values::Same(texels[0]),
            false => Values::Many(Arc::new(Bitmap { width, height, texels })),
        };
        memory(self).insert((index, kind), values.clone());
        Ok(values)
    }

    /// Values as they are looked up.
    fn texture<T: Texel>(&self, lookup: &Lookup, values: Values<T>, notes: &mut Notes) -> Result<Texture<T>, Flaw> {
        let bitmap = match values {
            Values::Same(value) => return Ok(Texture::Constant(value)),
            Values::Many(bitmap) => bitmap,
        };
        if !lookup.to_uv.is_finite() {
            return Err(flaw(format!("the transform of textures[{}] is not finite", lookup.texture)));
        }
        let (interpolation, wrap) = self.sampler(lookup.texture, notes)?;
        Ok(Texture::Bitmap { bitmap: bitmap.into(), interpolation, wrap, to_uv: lookup.to_uv })
    }

    /// How a texture is looked up between its texels and beyond its border.
    fn sampler(&self, texture: usize, notes: &mut Notes) -> Result<(Interpolation, Wrap), Flaw> {
        let Some(index) = item(&self.root.textures, "textures", texture)?.sampler.map(|s| s.value()) else {
            return Ok((Interpolation::Bilinear, Wrap::Repeat));
        };
        let sampler = item(&self.root.samplers, "samplers", index)?;
        let place = || format!("samplers[{index}]");
        let interpolation = match sampler.mag_filter.as_ref().map(|f| valid(f, place)).transpose()? {
            Some(MagFilter::Nearest) => Interpolation::Nearest,
            Some(MagFilter::Linear) | None => Interpolation::Bilinear,
        };
        let [s, t] = [&sampler.wrap_s, &sampler.wrap_t].map(|mode| {
            Ok(match valid(mode, place)? {
                WrappingMode::Repeat => Wrap::Repeat,
                WrappingMode::MirroredRepeat => Wrap::Mirror,
                WrappingMode::ClampToEdge => Wrap::Clamp,
            })
        });
        let (s, t) = (s?, t?);
        if s != t {
            notes.add(format!("samplers[{index}] wraps its directions differently; both go as the first"));
        }
        Ok((interpolation, s))
    }
}
