//! BSDFs.

mod kinds;
mod metal;
mod nesting;
mod principled;

use super::{document::Reader, plugin::Plugin, tree::Node};
use crate::error::LoadError;
use etendue_core::{
    material::{Material, Relief},
    rgb::Rgb,
    scene::NamedMaterial,
};
use std::collections::HashMap;

const KINDS: [&str; 16] = [
    "diffuse",
    "conductor",
    "roughconductor",
    "dielectric",
    "roughdielectric",
    "thindielectric",
    "plastic",
    "roughplastic",
    "principled",
    "principledthin",
    "twosided",
    "mask",
    "blendbsdf",
    "bumpmap",
    "normalmap",
    "null",
];

/// How deep BSDFs nest at most; no supported material needs more than five.
const DEEPEST: usize = 8;

/// The parts of a material, which files may nest in any order: the core has the relief outermost.
#[derive(Clone)]
struct Parts {
    relief: Option<Relief>,
    /// A mask, a mixture, or neither.
    body: Material,
    /// Whether it scatters on both sides.
    two_sided: bool,
    /// Whether it asks for the colours of a mesh's vertices.
    vertex_colors: bool,
}

impl Parts {
    fn plain(body: Material) -> Parts {
        Parts { relief: None, body, two_sided: false, vertex_colors: false }
    }

    fn diffuse(reflectance: Rgb) -> Parts {
        Parts::plain(Material::lambert(reflectance))
    }

    fn whole(self) -> Material {
        match self.relief {
            Some(relief) => Material::Relief { relief, material: Box::new(self.body) },
            None => self.body,
        }
    }
}

/// What a shape is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Used {
    /// Index of the material.
    pub(super) index: usize,
    /// Whether it asks for the colours of a mesh's vertices.
    pub(super) vertex_colors: bool,
}

/// The materials that shapes use, each read once.
pub(super) struct Materials<'r, 'd> {
    reader: &'r Reader<'d>,
    list: Vec<NamedMaterial>,
    /// Those in the list, by their elements.
    used: HashMap<u32, Used>,
    /// All that have been read.
    read: HashMap<u32, Parts>,
    /// Those that stand in the scene by themselves, checked whether or not a shape uses them.
    declared: Vec<Node<'d>>,
    /// Those that are being read, outermost first: to meet one again is a circle.
    open: Vec<u32>,
    /// Those of shapes without a BSDF, dark and light.
    defaults: [Option<Used>; 2],
}

impl<'r, 'd> Materials<'r, 'd> {
    pub(super) fn new(reader: &'r Reader<'d>) -> Materials<'r, 'd> {
        Materials {
            reader,
            list: Vec::new(),
            used: HashMap::new(),
            read: HashMap::new(),
            declared: Vec::new(),
            open: Vec::new(),
            defaults: [None; 2],
        }
    }

    /// Checks a BSDF that stands in the scene by itself.
    pub(super) fn declare(&mut self, node: Node<'d>) -> Result<(), LoadError> {
        self.declared.push(node);
        self.read(node).map(drop)
    }

    /// A shape's material.
    pub(super) fn of_shape(&mut self, node: Option<Node<'d>>, shape: &str, emits: bool) -> Result<Used, LoadError> {
        let Some(node) = node else {
            // Mitsuba's defaults: diffuse, one-sided, black where it emits.
            let (name, value) = if emits { ("black", 0.0) } else { ("default", 0.5) };
            if let Some(used) = self.defaults[usize::from(emits)] {
                return Ok(used);
            }
            let used = self.add(name.to_owned(), Parts::diffuse(Rgb::splat(value)));
            self.defaults[usize::from(emits)] = Some(used);
            return Ok(used);
        };
        if let Some(used) = self.used.get(&node.key()) {
            return Ok(*used);
        }
        let parts = self.read(node)?;
        let name = node.attribute("id").map_or_else(|| format!("material of {shape}"), str::to_owned);
        let used = self.add(name, parts);
        self.used.insert(node.key(), used);
        Ok(used)
    }

    fn add(&mut self, name: String, parts: Parts) -> Used {
        let (two_sided, vertex_colors) = (parts.two_sided, parts.vertex_colors);
        self.list.push(NamedMaterial { name, material: parts.whole(), two_sided });
        Used { index: self.list.len() - 1, vertex_colors }
    }

    /// The materials in use; those that are not are noted.
    pub(super) fn finish(self) -> Vec<NamedMaterial> {
        for node in self.declared.iter().filter(|n| !self.used.contains_key(&n.key())) {
            let name = node.attribute("id").unwrap_or("without an id");
            // One that is part of another counts as unused by itself.
            self.reader.note(format!("the BSDF `{name}` is not used by a shape directly"));
        }
        self.list
    }

    fn read(&mut self, node: Node<'d>) -> Result<Parts, LoadError> {
        if let Some(parts) = self.read.get(&node.key()) {
            if parts.vertex_colors {
                self.reader.images.meet_vertex_colors();
            }
            return Ok(parts.clone());
        }
        if self.open.contains(&node.key()) {
            return Err(node.error("the BSDF contains itself by its references"));
        }
        if self.open.len() == DEEPEST {
            return Err(node.error(format!("BSDFs are nested more than {DEEPEST} deep")));
        }
        let met = self.reader.images.vertex_colors();
        self.open.push(node.key());
        let read = self.read_anew(node);
        self.open.pop();
        let read = self.reader.forgiven(read, "a grey diffuse material stands in for it")?;
        let mut parts = read.unwrap_or_else(|| Parts::diffuse(Rgb::splat(0.5)));
        parts.vertex_colors = self.reader.images.vertex_colors() > met;
        self.read.insert(node.key(), parts.clone());
        Ok(parts)
    }

    fn read_anew(&mut self, node: Node<'d>) -> Result<Parts, LoadError> {
        let plugin = Plugin::new(self.reader, node)?;
        let parts = match plugin.kind {
            "twosided" => self.two_sided(&plugin)?,
            "blendbsdf" => self.blend(&plugin)?,
            "mask" => self.mask(&plugin)?,
            "bumpmap" | "normalmap" => self.relief(&plugin)?,
            _ => match kinds::plain(&plugin)? {
                Some(material) => Parts::plain(material),
                None => return self.stand_in(&plugin),
            },
        };
        plugin.finish()?;
        Ok(parts)
    }

    /// What comes nearest to a kind that is not supported: what is nested in it, or a diffuse surface of its colour.
    fn stand_in(&mut self, plugin: &Plugin<'_, 'd>) -> Result<Parts, LoadError> {
        let error = plugin.unknown_kind(&KINDS);
        if let Some((inner, _)) = plugin.nested("bsdf").first() {
            self.reader.forgive(error, "the BSDF in it stands in for it")?;
            return self.read(*inner);
        }
        self.reader.forgive(error, "a diffuse material stands in for it")?;
        kinds::diffuse_stand_in(plugin).map(Parts::plain)
    }
}
