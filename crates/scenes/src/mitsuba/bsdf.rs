//! BSDFs.

use super::{
    document::Reader,
    plugin::Plugin,
    value::{abridged, number},
};
use crate::error::LoadError;
use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness},
    material::Material,
    rgb::Rgb,
    scene::NamedMaterial,
};
use glam::Vec2;
use roxmltree::{Node, NodeId};
use std::collections::HashMap;

const KINDS: [&str; 7] =
    ["diffuse", "conductor", "roughconductor", "dielectric", "roughdielectric", "twosided", "blendbsdf"];

/// Indices of refraction by name, as Mitsuba has them.
const REFRACTION: [(&str, f64); 11] = [
    ("vacuum", 1.0),
    ("air", 1.000277),
    ("water ice", 1.31),
    ("water", 1.333),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("bk7", 1.5046),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// Roughness that [`Roughness`] allows.
const ALPHA: (f64, f64) = (1e-4, 1.0);

/// How deep BSDFs nest at most; no supported material needs more than three.
const DEEPEST: usize = 8;

/// The materials that shapes use, each read once.
pub(super) struct Materials<'r, 'd> {
    reader: &'r Reader<'d>,
    list: Vec<NamedMaterial>,
    index: HashMap<NodeId, usize>,
    /// Those that stand in the scene by themselves, checked whether or not a shape uses them.
    declared: Vec<Node<'d, 'd>>,
    /// Those that are being read, outermost first: to meet one again is a circle.
    open: Vec<NodeId>,
    default: Option<usize>,
    notes: Vec<String>,
}

impl<'r, 'd> Materials<'r, 'd> {
    pub(super) fn new(reader: &'r Reader<'d>) -> Materials<'r, 'd> {
        Materials {
            reader,
            list: Vec::new(),
            index: HashMap::new(),
            declared: Vec::new(),
            open: Vec::new(),
            default: None,
            notes: Vec::new(),
        }
    }

    /// Checks a BSDF that stands in the scene by itself.
    pub(super) fn declare(&mut self, node: Node<'d, 'd>) -> Result<(), LoadError> {
        self.declared.push(node);
        let notes = self.notes.len();
        self.read(node)?;
        self.notes.truncate(notes);
        Ok(())
    }

    /// The index of a shape's material.
    pub(super) fn of_shape(&mut self, node: Option<Node<'d, 'd>>, shape: &str) -> Result<usize, LoadError> {
        let Some(node) = node else {
            // Mitsuba's default: diffuse, one-sided.
            return Ok(*self.default.get_or_insert_with(|| {
                let material = Material::lambert(Rgb::splat(0.5));
                self.list.push(NamedMaterial { name: "default".to_owned(), material, two_sided: false });
                self.list.len() - 1
            }));
        };
        if let Some(index) = self.index.get(&node.id()) {
            return Ok(*index);
        }
        let (material, two_sided) = self.read(node)?;
        let name = node.attribute("id").map_or_else(|| format!("material of {shape}"), str::to_owned);
        self.list.push(NamedMaterial { name, material, two_sided });
        self.index.insert(node.id(), self.list.len() - 1);
        Ok(self.list.len() - 1)
    }

    /// The materials in use; those that are not are noted.
    pub(super) fn finish(self, notes: &mut Vec<String>) -> Vec<NamedMaterial> {
        notes.extend(self.notes);
        for node in self.declared.iter().filter(|n| !self.index.contains_key(&n.id())) {
            let name = node.attribute("id").unwrap_or("without an id");
            // One that is part of another counts as unused by itself.
            notes.push(format!("the BSDF `{name}` is not used by a shape directly"));
        }
        self.list
    }

    /// A material, and whether it scatters on both sides.
    fn read(&mut self, node: Node<'d, 'd>) -> Result<(Material, bool), LoadError> {
        if self.open.contains(&node.id()) {
            return Err(self.reader.error(node, "the BSDF contains itself by its references"));
        }
        if self.open.len() == DEEPEST {
            return Err(self.reader.error(node, format!("BSDFs are nested more than {DEEPEST} deep")));
        }
        self.open.push(node.id());
        let plugin = Plugin::new(self.reader, node)?;
        let read = match plugin.kind.as_str() {
            "diffuse" => {
                let reflectance = plugin.reflectance("reflectance")?.unwrap_or(Rgb::splat(0.5));
                (Material::lambert(reflectance), false)
            }
            "conductor" => (Material::conductor(conductor(&plugin)?, None), false),
            "roughconductor" => {
                let roughness = Some(self.roughness(&plugin)?);
                (Material::conductor(conductor(&plugin)?, roughness), false)
            }
            "dielectric" => (Material::dielectric(relative_ior(&plugin)?, None), false),
            "roughdielectric" => {
                let roughness = Some(self.roughness(&plugin)?);
                (Material::dielectric(relative_ior(&plugin)?, roughness), false)
            }
            "twosided" => (self.two_sided(&plugin)?, true),
            "blendbsdf" => self.blend(&plugin)?,
            _ => return Err(plugin.unknown_kind(&KINDS)),
        };
        plugin.finish()?;
        self.open.pop();
        Ok(read)
    }

    fn two_sided(&mut self, plugin: &Plugin<'_, 'd>) -> Result<Material, LoadError> {
        let (node, place) = match plugin.nested("bsdf").as_slice() {
            [inner] => *inner,
            [_, (_, second), ..] => {
                return Err(self.reader.error(*second, "a different BSDF for the back side is not supported"));
            }
            [] => return Err(plugin.error("the bsdf type `twosided` needs a bsdf")),
        };
        let (material, two_sided) = self.read(node)?;
        if two_sided {
            return Err(self.reader.error(place, "a twosided BSDF inside another"));
        }
        if transmits(&material) {
            return Err(self.reader.error(place, "a dielectric cannot be twosided: it has both sides already"));
        }
        Ok(material)
    }

    fn blend(&mut self, plugin: &Plugin<'_, 'd>) -> Result<(Material, bool), LoadError> {
        let weight = plugin.float("weight")?.ok_or_else(|| plugin.error("the bsdf type `blendbsdf` needs a weight"))?;
        if !(0.0..=1.0).contains(&weight) {
            return Err(plugin.error_at("weight", format!("the parameter `weight` is {weight}, not from 0 to 1")));
        }
        let [(first, _), (second, place)] = plugin.nested("bsdf")[..] else {
            return Err(plugin.error("the bsdf type `blendbsdf` needs two BSDFs"));
        };
        let ((first, first_sides), (second, second_sides)) = (self.read(first)?, self.read(second)?);
        if matches!(first, Material::Mix { .. }) || matches!(second, Material::Mix { .. }) {
            return Err(plugin.error("a blend of blends is not supported"));
        }
        // A dielectric has both sides, whatever is said of the other.
        if first_sides != second_sides && !transmits(&first) && !transmits(&second) {
            return Err(self.reader.error(place, "a blend of a twosided and a one-sided BSDF is not supported"));
        }
        let two_sided = first_sides || second_sides;
        Ok((
            Material::Mix { first: Box::new(first), second: Box::new(second), weight: (weight as f32).into() },
            two_sided,
        ))
    }

    fn roughness(&mut self, plugin: &Plugin) -> Result<Roughness, LoadError> {
        let distribution = match plugin.word("distribution", &["beckmann", "ggx"])? {
            Some("ggx") => Distribution::Ggx,
            _ => Distribution::Beckmann,
        };
        // A way of sampling only; the image is the same.
        plugin.boolean("sample_visible")?;
        let both = plugin.float("alpha")?;
        let alpha = match (plugin.float("alpha_u")?, plugin.float("alpha_v")?) {
            (None, None) => [("alpha", both.unwrap_or(0.1)); 2],
            (Some(_), Some(_)) if both.is_some() => {
                return Err(plugin.error_at("alpha", "`alpha` is given beside `alpha_u` and `alpha_v`"));
            }
            (Some(u), Some(v)) => [("alpha_u", u), ("alpha_v", v)],
            _ => return Err(plugin.error("`alpha_u` and `alpha_v` go together")),
        };
        for (name, value) in alpha {
            if !(0.0..=ALPHA.1).contains(&value) {
                let message = format!("the parameter `{name}` is {value}, not from 0 to {}", ALPHA.1);
                return Err(plugin.error_at(name, message));
            }
            if value < ALPHA.0 {
                let id = plugin.node.attribute("id").unwrap_or("without an id");
                self.notes.push(format!("the BSDF `{id}` is smoother than {name} = {}, which is taken", ALPHA.0));
            }
        }
        let alpha = alpha.map(|(_, value)| value.max(ALPHA.0) as f32);
        Ok(Roughness { distribution, alpha: Vec2::from(alpha) })
    }
}

fn transmits(material: &Material) -> bool {
    match material {
        Material::Dielectric { .. }
        | Material::ThinDielectric { .. }
        | Material::Mask { .. }
        | Material::Principled(_)
        | Material::PrincipledThin(_) => true,
        Material::Relief { material, .. } => transmits(material),
        Material::Mix { first, second, .. } => transmits(first) || transmits(second),
        Material::Lambert { .. } | Material::Conductor { .. } | Material::Plastic { .. } => false,
    }
}

/// By `eta` and `k`, or with `material` `none` all reflected.
fn conductor(plugin: &Plugin) -> Result<ConductorFresnel, LoadError> {
    let material = plugin.text("material")?;
    let tint = plugin.reflectance("specular_reflectance")?.unwrap_or(Rgb::WHITE);
    match (plugin.colour("eta")?, plugin.colour("k")?) {
        (None, None) if material.is_none_or(|m| m.eq_ignore_ascii_case("none")) => Ok(ConductorFresnel::Constant(tint)),
        (None, None) => {
            let message = format!(
                "the conductor `{}` is not known by name; give `eta` and `k`, or the material `none` for a mirror",
                abridged(material.unwrap_or_default())
            );
            Err(plugin.error_at("material", message))
        }
        (Some(_), Some(_)) if material.is_some_and(|m| !m.eq_ignore_ascii_case("none")) => {
            Err(plugin.error_at("material", "`material` is given beside `eta` and `k`"))
        }
        (Some(eta), Some(k)) if k.to_array().iter().all(|c| *c > 0.0) => Ok(ConductorFresnel::Complex { eta, k, tint }),
        (Some(_), Some(_)) => Err(plugin.error_at("k", "the parameter `k` has a component that is not positive")),
        _ => Err(plugin.error("`eta` and `k` go together")),
    }
}

/// Index of refraction inside over outside.
fn relative_ior(plugin: &Plugin) -> Result<f32, LoadError> {
    for name in ["specular_reflectance", "specular_transmittance"] {
        if plugin.reflectance(name)?.is_some_and(|tint| tint != Rgb::WHITE) {
            return Err(plugin.error_at(name, format!("a `{name}` other than 1 is not supported for dielectrics")));
        }
    }
    let eta = ior(plugin, "int_ior", "bk7")? / ior(plugin, "ext_ior", "air")?;
    Ok(eta as f32)
}

fn ior(plugin: &Plugin, name: &'static str, default: &str) -> Result<f64, LoadError> {
    let by_name = |wanted: &str| REFRACTION.iter().find(|(n, _)| n.eq_ignore_ascii_case(wanted)).map(|(_, ior)| *ior);
    let value = match plugin.text_or_float(name)? {
        None => by_name(default),
        Some(text) => number(&text).ok().or_else(|| by_name(&text)),
    };
    match value {
        Some(ior) if (1e-3..=1e3).contains(&ior) => Ok(ior),
        Some(ior) => Err(plugin.error_at(name, format!("the index of refraction {ior} is not from 0.001 to 1000"))),
        None => {
            let known = REFRACTION.map(|(n, _)| n).join(", ");
            Err(plugin.error_at(name, format!("the parameter `{name}` is neither a number nor one of {known}")))
        }
    }
}
