//! Materials [glTF 2.0, sec. 3.9 and appendix B].

use super::{
    Notes, flaw, item,
    texture::{Lookup, Textures},
    valid,
};
use crate::error::{Flaw, abridged};
use etendue_core::{
    material::{Bitangent, Material, Principled, PrincipledThin, Relief},
    rgb::Rgb,
    scene::NamedMaterial,
    texture::Texture,
};
use gltf_json::{
    Root,
    material::{self, AlphaMode},
};
use serde_json::{Map, Value};
use std::collections::HashMap;

/// A material as a primitive uses it.
#[derive(Clone)]
pub(super) struct Surface {
    /// Index into the scene's materials.
    pub(super) material: usize,
    pub(super) emission: Option<Texture<Rgb>>,
    pub(super) absorption: Option<Rgb>,
    /// The set of texture coordinates that it looks textures up with, if any.
    pub(super) uvs: Option<u32>,
    /// What the vertex colours are to be multiplied by, if it takes them.
    pub(super) colors: Option<Rgb>,
}

/// The materials of a file.
pub(super) struct Materials<'d> {
    root: &'d Root,
    textures: Textures<'d>,
    /// By the file's index (none is the default material), and whether vertex colours are there.
    known: HashMap<(Option<usize>, bool), Surface>,
    pub(super) list: Vec<NamedMaterial>,
}

/// A material that is being read.
struct Reader<'m, 'd> {
    textures: &'m mut Textures<'d>,
    notes: &'m mut Notes,
    name: &'m str,
    /// The set of texture coordinates of the textures so far.
    uvs: Option<u32>,
}

impl<'d> Materials<'d> {
    pub(super) fn new(root: &'d Root, textures: Textures<'d>) -> Materials<'d> {
        Materials { root, textures, known: HashMap::new(), list: Vec::new() }
    }

    /// A material for primitives with or without vertex colours.
    pub(super) fn surface(&mut self, index: Option<usize>, colored: bool, notes: &mut Notes) -> Result<Surface, Flaw> {
        if let Some(known) = self.known.get(&(index, colored)) {
            return Ok(known.clone());
        }
        let default = material::Material::default();
        let (material, fallback) = match index {
            Some(index) => (item(&self.root.materials, "materials", index)?, format!("materials[{index}]")),
            None => (&default, "default".to_owned()),
        };
        let name = material.name.as_deref().unwrap_or(&fallback).to_owned();
        let mut reader = Reader { textures: &mut self.textures, notes, name: &name, uvs: None };
        let (made, mut surface) = reader.read(material, colored)?;
        surface.material = self.list.len();
        self.list.push(NamedMaterial { name, material: made, two_sided: material.double_sided });
        self.known.insert((index, colored), surface.clone());
        Ok(surface)
    }
}

impl Reader<'_, '_> {
    fn read(&mut self, material: &material::Material, colored: bool) -> Result<(Material, Surface), Flaw> {
        let pbr = &material.pbr_metallic_roughness;
        let [r, g, b, alpha] = pbr.base_color_factor.0.map(|v| self.unit("baseColorFactor", v));
        let base = self.admitted(pbr.base_color_texture.as_ref().map(Lookup::of))?;
        let mut colors = None;
        let base_color = match &base {
            Some(lookup) => {
                if colored {
                    self.note("has a texture, so that vertex colours are left out");
                }
                self.textures.colour(lookup, [r, g, b], self.notes)?
            }
            None if colored => {
                colors = Some(Rgb::new(r, g, b));
                Texture::VertexColor
            }
            None => Rgb::new(r, g, b).into(),
        };
        let opacity = self.opacity(material, base.as_ref(), alpha)?;

        let surface_texture = self.admitted(pbr.metallic_roughness_texture.as_ref().map(Lookup::of))?;
        let metal = self.unit("metallicFactor", pbr.metallic_factor.0);
        let rough = self.unit("roughnessFactor", pbr.roughness_factor.0);
        // Roughness is in green, metal in blue.
        let metallic = self.number(surface_texture, 2, metal)?;
        let roughness = self.number(surface_texture, 1, rough)?;
        let normals = match &material.normal_texture {
            Some(info) => match self.admitted(Some(Lookup::of_normals(info)?))? {
                Some(lookup) if info.scale.is_finite() => Some(self.textures.normals(&lookup, info.scale, self.notes)?),
                _ => None,
            },
            None => None,
        };
        let emission = self.emission(material)?;

        let extensions = material.extensions.as_ref();
        let ior = extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |i| i.ior.0);
        let eta = if ior >= 1.0 && ior.is_finite() { ior } else { 1.5 };
        // 0 is for materials of another model [KHR_materials_ior].
        if eta != ior && ior != 0.0 {
            self.note(&format!("has an ior of {ior}, which is below 1; it counts as 1.5"));
        }
        let transmission = extensions.and_then(|e| e.transmission.as_ref());
        let transmitted = match transmission {
            Some(transmission) => {
                let lookup = self.admitted(transmission.transmission_texture.as_ref().map(Lookup::of))?;
                let factor = self.unit("transmissionFactor", transmission.transmission_factor.0);
                self.number(lookup, 0, factor)?
            }
            None => 0.0.into(),
        };
        let transmits = transmitted != Texture::Constant(0.0);
        let volume = extensions.and_then(|e| e.volume.as_ref());
        if let Some(thickness) = volume.map(|v| v.thickness_factor.0).filter(|thickness| *thickness < 0.0) {
            self.note(&format!("has a thicknessFactor of {thickness}, which is negative; it counts as 0"));
        }
        let volume = volume.filter(|v| v.thickness_factor.0 > 0.0);
        let absorption = volume.filter(|_| transmits).and_then(|volume| {
            let (distance, color) = (volume.attenuation_distance.0, volume.attenuation_color.0);
            if distance <= 0.0 || distance.is_nan() {
                self.note(&format!(
                    "has an attenuationDistance of {distance}, which is not positive; nothing is absorbed"
                ));
            }
            let color = color.map(|c| self.unit("attenuationColor", c));
            // The colour is what is left of white after the distance [KHR_materials_volume]; black would be endless.
            let coefficient = color.map(|c| -c.max(f32::MIN_POSITIVE).ln() / distance);
            let coefficient = Rgb::from(coefficient).map(|c| c.max(0.0));
            (distance > 0.0 && coefficient.is_valid() && !coefficient.is_black()).then_some(coefficient)
        });
        let [sheen, clearcoat, clearcoat_gloss] = self.layers(extensions.map(|e| &e.others));
        if extensions.is_some_and(|e| e.unlit.is_some()) {
            self.note("is meant to be shown without light, and is lit");
        }

        let scattering = if transmits && volume.is_none() {
            if metallic != Texture::Constant(0.0) {
                self.note("transmits without a thickness, so that its metallic share is left out");
            }
            Material::PrincipledThin(Box::new(PrincipledThin {
                base_color,
                roughness,
                anisotropic: 0.0.into(),
                spec_trans: transmitted,
                eta,
                spec_tint: 0.0.into(),
                sheen,
                sheen_tint: 0.0.into(),
                flatness: 0.0.into(),
                diff_trans: 0.0.into(),
            }))
        } else {
            Material::Principled(Box::new(Principled {
                base_color,
                roughness,
                anisotropic: 0.0.into(),
                metallic,
                spec_trans: transmitted,
                eta,
                spec_tint: 0.0.into(),
                sheen,
                sheen_tint: 0.0.into(),
                flatness: 0.0.into(),
                clearcoat,
                clearcoat_gloss,
            }))
        };
        let masked = match opacity {
            Texture::Constant(1.0) => scattering,
            opacity => Material::Mask { opacity, material: Box::new(scattering) },
        };
        let made = match normals {
            Some(normals) => Material::Relief {
                relief: Relief::NormalMap { normals, bitangent: Bitangent::AlongV },
                material: Box::new(masked),
            },
            None => masked,
        };
        Ok((made, Surface { material: 0, emission, absorption, uvs: self.uvs, colors }))
    }

    /// A texture if it has an image and is looked up with the coordinates of the material's others; else a note.
    fn admitted(&mut self, lookup: Option<Lookup>) -> Result<Option<Lookup>, Flaw> {
        let Some(lookup) = lookup else { return Ok(None) };
        if !self.textures.has_image(&lookup, self.notes)? {
            return Ok(None);
        }
        if *self.uvs.get_or_insert(lookup.set) != lookup.set {
            self.note(&format!(
                "looks textures up with several sets of coordinates; textures[{}] is left out",
                lookup.texture
            ));
            return Ok(None);
        }
        Ok(Some(lookup))
    }

    fn number(&mut self, lookup: Option<Lookup>, channel: usize, factor: f32) -> Result<Texture<f32>, Flaw> {
        match lookup {
            Some(lookup) => self.textures.number(&lookup, channel, factor, self.notes),
            None => Ok(factor.into()),
        }
    }

    fn opacity(
        &mut self,
        material: &material::Material,
        base: Option<&Lookup>,
        alpha: f32,
    ) -> Result<Texture<f32>, Flaw> {
        let cutoff = material.alpha_cutoff.map_or(0.5, |c| c.0);
        if cutoff < 0.0 || cutoff.is_nan() {
            self.note(&format!("has an alphaCutoff of {cutoff}, which is negative"));
        }
        match (valid(&material.alpha_mode, || format!("the material `{}`", self.name))?, base) {
            (AlphaMode::Opaque, _) => Ok(1.0.into()),
            (AlphaMode::Mask, Some(base)) => self.textures.threshold(base, alpha, cutoff, self.notes),
            (AlphaMode::Mask, None) => Ok(if alpha >= cutoff { 1.0 } else { 0.0 }.into()),
            (AlphaMode::Blend, Some(base)) => self.textures.number(base, 3, alpha, self.notes),
            (AlphaMode::Blend, None) => Ok(alpha.into()),
        }
    }

    /// Radiance, in the nits that the file says.
    fn emission(&mut self, material: &material::Material) -> Result<Option<Texture<Rgb>>, Flaw> {
        let strength = material.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |s| s.emissive_strength.0);
        let factor = Rgb::from(material.emissive_factor.0) * strength;
        if !factor.is_valid() || strength < 0.0 {
            return Err(flaw(format!("the material `{}` emits what is negative or not finite", self.name)));
        }
        if material.emissive_factor.0.iter().any(|c| *c > 1.0) {
            self.note("has an emissiveFactor above 1, which is taken as it is");
        }
        if factor.is_black() {
            return Ok(None);
        }
        let emission = match self.admitted(material.emissive_texture.as_ref().map(Lookup::of))? {
            Some(lookup) => self.textures.colour(&lookup, factor.to_array(), self.notes)?,
            None => factor.into(),
        };
        if emission == Texture::Constant(Rgb::BLACK) {
            return Ok(None);
        }
        if material.double_sided {
            self.note("is double-sided, but emits from its front only");
        }
        Ok(Some(emission))
    }

    /// Sheen, and the clear coat with its gloss, as the principled material has them.
    fn layers(&mut self, extensions: Option<&Map<String, Value>>) -> [Texture<f32>; 3] {
        let of = |name: &str, field: &str| extensions.and_then(|e| e.get(name)).and_then(|e| e.get(field));
        let mut number =
            |name: &str, value: Option<&Value>| self.unit(name, value.and_then(Value::as_f64).unwrap_or(0.0) as f32);
        let (sheen, coat) = ("KHR_materials_sheen", "KHR_materials_clearcoat");
        let sheen_color = of(sheen, "sheenColorFactor").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let sheen_strength = sheen_color.iter().map(|c| number("sheenColorFactor", Some(c))).fold(0.0, f32::max);
        let coat_strength = number("clearcoatFactor", of(coat, "clearcoatFactor"));
        let coat_roughness = number("clearcoatRoughnessFactor", of(coat, "clearcoatRoughnessFactor"));
        if sheen_strength > 0.0 {
            self.note("has a sheen, which is approximated");
        }
        if coat_strength > 0.0 {
            self.note("has a clear coat, which is approximated");
        }
        let textures = ["clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"];
        if textures.iter().any(|t| of(coat, t).is_some())
            || ["sheenColorTexture", "sheenRoughnessTexture"].iter().any(|t| of(sheen, t).is_some())
        {
            self.note("has textures of its sheen or clear coat, which are left out");
        }
        // The gloss takes the microfacet roughness from 0.1 to 0.001 [Burley 2012, sec. 5.6].
        let alpha = coat_roughness.powi(2);
        let gloss = ((0.1 - alpha) / (0.1 - 0.001)).clamp(0.0, 1.0);
        [sheen_strength.into(), coat_strength.into(), gloss.into()]
    }

    /// A number that belongs in the unit interval, moved there with a note.
    fn unit(&mut self, name: &str, value: f32) -> f32 {
        let moved = if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
        if moved != value {
            self.note(&format!("has a {name} of {value}, outside of 0 to 1; it counts as {moved}"));
        }
        moved
    }

    fn note(&mut self, what: &str) {
        self.notes.add(format!("the material `{}` {what}", abridged(self.name)));
    }
}
