//! An element with a type, the parameters in it and the elements nested in it.

use super::{
    document::{Reader, suggestion},
    spectrum_plugin, transform,
    tree::Node,
    value::{self, Spectral},
};
use crate::{
    error::{LoadError, abridged, read_file},
    spectrum::uniform_emission,
};
use etendue_core::rgb::Rgb;
use glam::{DAffine3, DVec3};
use std::{
    cell::{Cell, RefCell},
    ops::RangeInclusive,
    path::PathBuf,
};

/// Elements that are plugins, nested in others.
const NESTED: [&str; 11] =
    ["integrator", "sensor", "sampler", "film", "rfilter", "bsdf", "shape", "emitter", "texture", "medium", "volume"];

/// The largest file of a spectrum that is read.
const LARGEST_SPECTRUM: u64 = 1 << 20;

/// A plugin: what it is and what it was given. Whatever nobody asks for is an error in [`Plugin::finish`].
pub(super) struct Plugin<'r, 'd> {
    pub(super) reader: &'r Reader<'d>,
    pub(super) node: Node<'d>,
    /// The value of its `type`.
    pub(super) kind: &'d str,
    parameters: Vec<Given<'d>>,
    nested: Vec<Nested<'d>>,
    asked: RefCell<Vec<&'static str>>,
}

struct Given<'d> {
    name: String,
    value: Value,
    node: Node<'d>,
    used: Cell<bool>,
}

enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Colour(Rgb),
    Spectral(Spectral),
    Vector(DVec3),
    Transform(DAffine3),
}

struct Nested<'d> {
    /// What it is, after a `<ref>` was followed.
    node: Node<'d>,
    /// Where it stands.
    place: Node<'d>,
    /// What it is for: the `name` where it stands.
    name: Option<String>,
    used: Cell<bool>,
}

/// What a colour stands for: spectra become RGB in different ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Meaning {
    /// What a surface or medium does to light.
    Reflectance,
    /// Light.
    Emission,
    /// An index of refraction, or extinction.
    Index,
}

impl Nested<'_> {
    /// Returns `true` for an element of a kind; a spectrum is a texture that is the same everywhere.
    fn is(&self, tag: &str) -> bool {
        self.node.tag() == tag || tag == "texture" && self.node.tag() == "spectrum"
    }
}

impl<'r, 'd> Plugin<'r, 'd> {
    /// Reads the element and its parameters.
    pub(super) fn new(reader: &'r Reader<'d>, node: Node<'d>) -> Result<Plugin<'r, 'd>, LoadError> {
        node.allow_attributes(&["type", "id", "name"])?;
        let kind = node.required("type")?;
        let asked = RefCell::new(Vec::new());
        let mut plugin = Plugin { reader, node, kind, parameters: Vec::new(), nested: Vec::new(), asked };
        for child in node.children() {
            let tag = child.tag();
            if tag == "ref" || NESTED.contains(&tag) {
                let node = if tag == "ref" { reader.referenced(child)? } else { child };
                let name = child.attribute("name").map(value::snake_case);
                plugin.nested.push(Nested { node, place: child, name, used: Cell::new(false) });
            } else if tag == "spectrum" && child.attribute("type").is_some() {
                let name = child.attribute("name").map(value::snake_case);
                plugin.nested.push(Nested { node: child, place: child, name, used: Cell::new(false) });
            } else if let Err(error) = plugin.add_parameter(child) {
                reader.forgive(error, "it is passed over")?;
            }
        }
        Ok(plugin)
    }

    fn add_parameter(&mut self, node: Node<'d>) -> Result<(), LoadError> {
        let text = |parse: &dyn Fn(&str) -> Result<Value, String>| {
            node.allow_attributes(&["name", "value"])?;
            parse(node.required("value")?).map_err(|m| node.error_in("value", m))
        };
        let value = match node.tag() {
            "float" => text(&|t| value::number(t).map(Value::Float))?,
            "integer" => text(&|t| value::integer(t).map(Value::Integer))?,
            "boolean" => text(&|t| value::boolean(t).map(Value::Boolean))?,
            "string" => text(&|t| Ok(Value::Text(t.to_owned())))?,
            "rgb" => text(&|t| value::colour(t).map(Value::Colour))?,
            "srgb" => text(&|t| value::srgb(t).map(Value::Colour))?,
            "spectrum" if node.attribute("filename").is_some() => Value::Spectral(self.spectrum_file(node)?),
            "spectrum" => text(&|t| value::spectrum(t).map(Value::Spectral))?,
            "point" | "vector" => {
                node.allow_attributes(&["name", "value", "x", "y", "z"])?;
                Value::Vector(transform::components(node, 0.0)?)
            }
            "transform" => Value::Transform(transform::transform(node)?),
            tag => return Err(node.error(format!("<{}> is not supported here", abridged(tag)))),
        };
        let name = value::snake_case(node.required("name")?);
        if self.parameters.iter().any(|p| p.name == name) {
            return Err(node.error(format!("the parameter `{}` is given a second time", abridged(&name))));
        }
        self.parameters.push(Given { name, value, node, used: Cell::new(false) });
        Ok(())
    }

    fn spectrum_file(&self, node: Node<'d>) -> Result<Spectral, LoadError> {
        node.allow_attributes(&["name", "filename"])?;
        let wrong = |message| node.error_in("filename", message);
        let path = self.reader.file(node.required("filename")?).map_err(wrong)?;
        let bytes = read_file(&path, LARGEST_SPECTRUM)?;
        value::spectrum_file(&String::from_utf8_lossy(&bytes)).map_err(wrong)
    }

    /// An error at the plugin.
    pub(super) fn error(&self, message: impl Into<String>) -> LoadError {
        self.node.error(message)
    }

    /// An error at a parameter, or at the plugin if the parameter is not given.
    pub(super) fn error_at(&self, name: &str, message: impl Into<String>) -> LoadError {
        if let Some(given) = self.parameters.iter().find(|p| p.name == name) {
            return given.node.error_in("value", message);
        }
        let nested = self.nested.iter().find(|n| n.name.as_deref() == Some(name));
        nested.map_or(self.node, |n| n.place).error(message)
    }

    /// The error of a type that is not supported.
    pub(super) fn unknown_kind(&self, known: &[&str]) -> LoadError {
        let kind = abridged(self.kind);
        let guess = suggestion(self.kind, known.iter().copied());
        let message =
            format!("the {} type `{kind}` is not supported{guess}; supported: {}", self.tag(), known.join(", "));
        self.node.error_in("type", message)
    }

    fn get(&self, name: &'static str) -> Option<&Given<'d>> {
        self.asked.borrow_mut().push(name);
        let given = self.parameters.iter().find(|p| p.name == name)?;
        given.used.set(true);
        Some(given)
    }

    fn mistyped(&self, given: &Given, wanted: &str) -> LoadError {
        given.node.error(format!("the parameter `{}` is given by {wanted}", abridged(&given.name)))
    }

    /// Whether a parameter is given.
    pub(super) fn has(&self, name: &'static str) -> bool {
        self.asked.borrow_mut().push(name);
        self.parameters.iter().any(|p| p.name == name)
    }

    /// A number.
    pub(super) fn float(&self, name: &'static str) -> Result<Option<f64>, LoadError> {
        self.get(name).map_or(Ok(None), |given| match given.value {
            Value::Float(v) | Value::Spectral(Spectral::Uniform(v)) => Ok(Some(v)),
            Value::Integer(v) => Ok(Some(v as f64)),
            _ => Err(self.mistyped(given, "<float>")),
        })
    }

    /// A number that is positive.
    pub(super) fn positive(&self, name: &'static str) -> Result<Option<f64>, LoadError> {
        match self.float(name)? {
            Some(v) if v <= 0.0 => Err(self.error_at(name, format!("the parameter `{name}` must be positive"))),
            other => Ok(other),
        }
    }

    /// A number that is not negative.
    pub(super) fn not_negative(&self, name: &'static str) -> Result<Option<f64>, LoadError> {
        match self.float(name)? {
            Some(v) if v < 0.0 => Err(self.error_at(name, format!("the parameter `{name}` is negative"))),
            other => Ok(other),
        }
    }

    /// A whole number in a range.
    pub(super) fn integer(&self, name: &'static str, range: RangeInclusive<i64>) -> Result<Option<i64>, LoadError> {
        let Some(given) = self.get(name) else { return Ok(None) };
        match given.value {
            Value::Integer(v) if range.contains(&v) => Ok(Some(v)),
            Value::Integer(v) => {
                let message = format!("the parameter `{name}` is {v}, not from {} to {}", range.start(), range.end());
                Err(self.error_at(name, message))
            }
            _ => Err(self.mistyped(given, "<integer>")),
        }
    }

    /// True or false.
    pub(super) fn boolean(&self, name: &'static str) -> Result<Option<bool>, LoadError> {
        self.get(name).map_or(Ok(None), |given| match given.value {
            Value::Boolean(v) => Ok(Some(v)),
            _ => Err(self.mistyped(given, "<boolean>")),
        })
    }

    /// A text.
    pub(super) fn text(&self, name: &'static str) -> Result<Option<&str>, LoadError> {
        self.get(name).map_or(Ok(None), |given| match &given.value {
            Value::Text(v) => Ok(Some(v)),
            _ => Err(self.mistyped(given, "<string>")),
        })
    }

    /// A text or a number, as text.
    pub(super) fn text_or_float(&self, name: &'static str) -> Result<Option<String>, LoadError> {
        self.get(name).map_or(Ok(None), |given| match &given.value {
            Value::Text(v) => Ok(Some(v.clone())),
            Value::Float(v) => Ok(Some(v.to_string())),
            Value::Integer(v) => Ok(Some(v.to_string())),
            _ => Err(self.mistyped(given, "<float> or <string>")),
        })
    }

    /// One of several words, whatever their case.
    pub(super) fn word(&self, name: &'static str, options: &[&'static str]) -> Result<Option<&'static str>, LoadError> {
        let Some(text) = self.text(name)? else { return Ok(None) };
        let found = options.iter().find(|o| o.eq_ignore_ascii_case(text)).copied();
        found.map(Some).ok_or_else(|| {
            let message = format!("the parameter `{name}` is `{}`, none of {}", abridged(text), options.join(", "));
            self.error_at(name, message)
        })
    }

    /// A colour, by `<rgb>` or `<spectrum>`, or as a grey by `<float>`.
    pub(super) fn colour(&self, name: &'static str, meaning: Meaning) -> Result<Option<Rgb>, LoadError> {
        let Some(given) = self.get(name) else { return self.nested_spectrum(name) };
        let colour = match (&given.value, meaning) {
            (Value::Colour(v), _) => *v,
            (Value::Float(v), _) => {
                return value::grey_or_colour([*v; 3]).map(Some).map_err(|m| self.error_at(name, m));
            }
            (Value::Integer(v), _) => {
                return value::grey_or_colour([*v as f64; 3]).map(Some).map_err(|m| self.error_at(name, m));
            }
            (Value::Spectral(Spectral::Uniform(v)), Meaning::Emission) => uniform_emission(*v),
            (Value::Spectral(Spectral::Uniform(v)), _) => Rgb::splat(*v as f32),
            (Value::Spectral(Spectral::Points(s)), Meaning::Emission) => s.emission(),
            (Value::Spectral(Spectral::Points(s)), Meaning::Reflectance) => {
                if s.most() > 1.0 {
                    let called = self.node.called();
                    self.reader
                        .note(format!("{called}: the spectrum of {name} is above 1 in places; its RGB is at most 1"));
                }
                s.reflectance()
            }
            (Value::Spectral(Spectral::Points(s)), Meaning::Index) => s.index(),
            _ => return Err(self.mistyped(given, "<rgb>, <spectrum> or <float>")),
        };
        match colour.is_valid() {
            true => Ok(Some(colour)),
            false => Err(self.error_at(name, format!("the parameter `{name}` is beyond single precision"))),
        }
    }

    /// Returns `true` for a parameter that is given as a colour.
    pub(super) fn is_coloured(&self, name: &str) -> bool {
        self.parameters.iter().any(|p| p.name == name && matches!(p.value, Value::Colour(_)))
    }

    /// A colour by a `<spectrum>` of a type.
    fn nested_spectrum(&self, name: &str) -> Result<Option<Rgb>, LoadError> {
        let named = |n: &&Nested| n.is("texture") && n.name.as_deref() == Some(name);
        let spectrum = self.nested.iter().find(named).filter(|n| spectrum_plugin::is_spectrum(n.node));
        spectrum.map_or(Ok(None), |nested| {
            nested.used.set(true);
            spectrum_plugin::rgb(self.reader, nested.node).map(Some)
        })
    }

    /// A colour with components of at most 1.
    pub(super) fn reflectance(&self, name: &'static str) -> Result<Option<Rgb>, LoadError> {
        match self.colour(name, Meaning::Reflectance)? {
            Some(colour) if colour.max_element() > 1.0 => {
                Err(self.error_at(name, format!("the parameter `{name}` has a component above 1")))
            }
            other => Ok(other),
        }
    }

    /// A point or vector.
    pub(super) fn vector(&self, name: &'static str) -> Result<Option<DVec3>, LoadError> {
        self.get(name).map_or(Ok(None), |given| match given.value {
            Value::Vector(v) => Ok(Some(v)),
            _ => Err(self.mistyped(given, "<point> or <vector>")),
        })
    }

    /// A transform.
    pub(super) fn transform(&self, name: &'static str) -> Result<Option<DAffine3>, LoadError> {
        self.get(name).map_or(Ok(None), |given| match given.value {
            Value::Transform(v) => Ok(Some(v)),
            _ => Err(self.mistyped(given, "<transform>")),
        })
    }

    /// The parameter `to_world`; the identity when it is not given.
    pub(super) fn to_world(&self) -> Result<DAffine3, LoadError> {
        Ok(self.transform("to_world")?.unwrap_or(DAffine3::IDENTITY))
    }

    /// A file that the parameter names.
    pub(super) fn file(&self, name: &'static str) -> Result<PathBuf, LoadError> {
        let text = self.text(name)?.ok_or_else(|| {
            self.error(format!("the {} type `{}` needs the parameter `{name}`", self.tag(), abridged(self.kind)))
        })?;
        self.reader.file(text).map_err(|m| self.error_at(name, m))
    }

    /// The nested elements of a kind (`bsdf`, `emitter` ...), each with the place where it is nested or referred to.
    pub(super) fn nested(&self, tag: &str) -> Vec<(Node<'d>, Node<'d>)> {
        let matching = self.nested.iter().filter(|n| n.is(tag));
        matching
            .map(|n| {
                n.used.set(true);
                (n.node, n.place)
            })
            .collect()
    }

    /// The one nested element of a kind, if there is one.
    pub(super) fn single(&self, tag: &str) -> Result<Option<Node<'d>>, LoadError> {
        match self.nested(tag).as_slice() {
            [] => Ok(None),
            [(node, _)] => Ok(Some(*node)),
            [_, (_, second), ..] => {
                Err(second.error(format!("the {} type `{}` takes one {tag} only", self.tag(), abridged(self.kind))))
            }
        }
    }

    /// The nested element of a kind that stands there for `name`.
    pub(super) fn nested_as(&self, tag: &str, name: &'static str) -> Option<Node<'d>> {
        if tag != "medium" {
            self.asked.borrow_mut().push(name);
        }
        let found = self.nested.iter().find(|n| n.is(tag) && n.name.as_deref() == Some(name))?;
        found.used.set(true);
        Some(found.node)
    }

    /// Its element's name.
    pub(super) fn tag(&self) -> &'d str {
        self.node.tag()
    }

    /// Refuses whatever was given and not asked for.
    pub(super) fn finish(&self) -> Result<(), LoadError> {
        for nested in self.nested.iter().filter(|n| !n.used.get()) {
            let inner = abridged(nested.node.tag());
            let message = match &nested.name {
                Some(name) if inner == "texture" => self.unknown_parameter(name),
                _ => format!("the {} type `{}` takes no {inner}", self.tag(), abridged(self.kind)),
            };
            self.reader.forgive(nested.place.error(message), "it is passed over")?;
        }
        for given in self.parameters.iter().filter(|p| !p.used.get()) {
            let error = given.node.error_in("name", self.unknown_parameter(&given.name));
            self.reader.forgive(error, "it is passed over")?;
        }
        Ok(())
    }

    fn unknown_parameter(&self, name: &str) -> String {
        let mut known = self.asked.borrow().clone();
        known.sort_unstable();
        known.dedup();
        let guess = suggestion(name, known.iter().copied());
        let known = if known.is_empty() { "it has none".to_owned() } else { format!("it has {}", known.join(", ")) };
        format!(
            "the {} type `{}` has no parameter `{}`{guess}; {known}",
            self.tag(),
            abridged(self.kind),
            abridged(name)
        )
    }
}
