//! An element with a type, the parameters in it and the elements nested in it.

use super::{
    document::{Reader, suggestion},
    transform,
    value::{self, abridged},
};
use crate::error::LoadError;
use etendue_core::rgb::Rgb;
use glam::{DAffine3, DVec3};
use roxmltree::Node;
use std::{
    cell::{Cell, RefCell},
    ops::RangeInclusive,
};

/// Elements that are plugins, nested in others.
const NESTED: [&str; 8] = ["integrator", "sensor", "sampler", "film", "rfilter", "bsdf", "shape", "emitter"];

/// A plugin: what it is and what it was given. Whatever nobody asks for is an error in [`Plugin::finish`].
pub(super) struct Plugin<'r, 'd> {
    pub(super) reader: &'r Reader<'d>,
    pub(super) node: Node<'d, 'd>,
    /// The value of its `type`.
    pub(super) kind: String,
    parameters: Vec<Given<'d>>,
    nested: Vec<Nested<'d>>,
    asked: RefCell<Vec<&'static str>>,
}

struct Given<'d> {
    name: String,
    value: Value,
    node: Node<'d, 'd>,
    used: Cell<bool>,
}

enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Colour(Rgb),
    Vector(DVec3),
    Transform(DAffine3),
}

struct Nested<'d> {
    /// What it is, after a `<ref>` was followed.
    node: Node<'d, 'd>,
    /// Where it stands.
    place: Node<'d, 'd>,
    used: Cell<bool>,
}

impl<'r, 'd> Plugin<'r, 'd> {
    /// Reads the element and its parameters.
    pub(super) fn new(reader: &'r Reader<'d>, node: Node<'d, 'd>) -> Result<Plugin<'r, 'd>, LoadError> {
        reader.allow_attributes(node, &["type", "id", "name"])?;
        let kind = reader.substituted(node, "type")?.into_owned();
        let asked = RefCell::new(Vec::new());
        let mut plugin = Plugin { reader, node, kind, parameters: Vec::new(), nested: Vec::new(), asked };
        for child in elements(reader, node)? {
            let tag = child.tag_name().name();
            if tag == "ref" {
                let node = reader.referenced(child)?;
                plugin.nested.push(Nested { node, place: child, used: Cell::new(false) });
            } else if NESTED.contains(&tag) {
                plugin.nested.push(Nested { node: child, place: child, used: Cell::new(false) });
            } else {
                plugin.add_parameter(child)?;
            }
        }
        Ok(plugin)
    }

    fn add_parameter(&mut self, node: Node<'d, 'd>) -> Result<(), LoadError> {
        let (reader, tag) = (self.reader, node.tag_name().name());
        let text = |parse: &dyn Fn(&str) -> Result<Value, String>| {
            reader.allow_attributes(node, &["name", "value"])?;
            parse(&reader.substituted(node, "value")?).map_err(|m| reader.error_in(node, "value", m))
        };
        let value = match tag {
            "float" => text(&|t| value::number(t).map(Value::Float))?,
            "integer" => text(&|t| value::integer(t).map(Value::Integer))?,
            "boolean" => text(&|t| value::boolean(t).map(Value::Boolean))?,
            "string" => text(&|t| Ok(Value::Text(t.to_owned())))?,
            "rgb" => text(&|t| value::colour(t).map(Value::Colour))?,
            "point" | "vector" if node.has_attribute("value") => text(&|t| value::vector(t).map(Value::Vector))?,
            "point" | "vector" => {
                reader.allow_attributes(node, &["name", "x", "y", "z"])?;
                Value::Vector(transform::components(reader, node, 0.0)?)
            }
            "transform" => Value::Transform(transform::transform(reader, node)?),
            _ => {
                let message = format!("<{}> is not supported here", abridged(tag));
                return Err(reader.error(node, message));
            }
        };
        let name = value::snake_case(reader.required(node, "name")?);
        if self.parameters.iter().any(|p| p.name == name) {
            return Err(reader.error(node, format!("the parameter `{name}` is given a second time")));
        }
        self.parameters.push(Given { name, value, node, used: Cell::new(false) });
        Ok(())
    }

    /// An error at the plugin.
    pub(super) fn error(&self, message: impl Into<String>) -> LoadError {
        self.reader.error(self.node, message)
    }

    /// An error at a parameter, or at the plugin if the parameter is not given.
    pub(super) fn error_at(&self, name: &str, message: impl Into<String>) -> LoadError {
        match self.parameters.iter().find(|p| p.name == name) {
            Some(given) => self.reader.error_in(given.node, "value", message),
            None => self.error(message),
        }
    }

    /// The error of a type that is not supported.
    pub(super) fn unknown_kind(&self, known: &[&str]) -> LoadError {
        let tag = self.node.tag_name().name();
        let kind = abridged(&self.kind);
        let guess = suggestion(&self.kind, known.iter().copied());
        let message = format!("the {tag} type `{kind}` is not supported{guess}; supported: {}", known.join(", "));
        self.reader.error_in(self.node, "type", message)
    }

    fn get(&self, name: &'static str) -> Option<&Given<'d>> {
        self.asked.borrow_mut().push(name);
        let given = self.parameters.iter().find(|p| p.name == name)?;
        given.used.set(true);
        Some(given)
    }

    fn mistyped(&self, given: &Given, wanted: &str) -> LoadError {
        self.reader.error(given.node, format!("the parameter `{}` is given by {wanted}", given.name))
    }

    /// Whether a parameter is given.
    pub(super) fn has(&self, name: &'static str) -> bool {
        self.asked.borrow_mut().push(name);
        self.parameters.iter().any(|p| p.name == name)
    }

    /// A number.
    pub(super) fn float(&self, name: &'static str) -> Result<Option<f64>, LoadError> {
        self.get(name).map_or(Ok(None), |given| match given.value {
            Value::Float(v) => Ok(Some(v)),
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

    /// A colour, by `<rgb>` or as a grey by `<float>`.
    pub(super) fn colour(&self, name: &'static str) -> Result<Option<Rgb>, LoadError> {
        let Some(given) = self.get(name) else { return Ok(None) };
        match given.value {
            Value::Colour(v) => Ok(Some(v)),
            Value::Float(v) => value::grey_or_colour([v; 3]).map(Some).map_err(|m| self.error_at(name, m)),
            _ => Err(self.mistyped(given, "<rgb> or <float>")),
        }
    }

    /// A colour with components of at most 1.
    pub(super) fn reflectance(&self, name: &'static str) -> Result<Option<Rgb>, LoadError> {
        match self.colour(name)? {
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

    /// The parameter `to_world`; the identity when it is not given.
    pub(super) fn to_world(&self) -> Result<DAffine3, LoadError> {
        self.get("to_world").map_or(Ok(DAffine3::IDENTITY), |given| match given.value {
            Value::Transform(v) => Ok(v),
            _ => Err(self.mistyped(given, "<transform>")),
        })
    }

    /// A file that lies in the scene's folder, with the place of its name.
    pub(super) fn file(&self, name: &'static str) -> Result<std::path::PathBuf, LoadError> {
        let text = self.text(name)?.ok_or_else(|| {
            self.error(format!("the {} type `{}` needs the parameter `{name}`", self.tag(), self.kind))
        })?;
        let node = self.parameters.iter().find(|p| p.name == name).map_or(self.node, |p| p.node);
        let byte = node.attribute_node("value").map_or(node.range().start, |a| a.range_value().start);
        self.reader.file(byte, text)
    }

    /// The nested elements of a kind (`bsdf`, `emitter` ...), each with the place where it is nested or referred to.
    pub(super) fn nested(&self, tag: &str) -> Vec<(Node<'d, 'd>, Node<'d, 'd>)> {
        let matching = self.nested.iter().filter(|n| n.node.has_tag_name(tag));
        matching
            .map(|n| {
                n.used.set(true);
                (n.node, n.place)
            })
            .collect()
    }

    /// The one nested element of a kind, if there is one.
    pub(super) fn single(&self, tag: &str) -> Result<Option<Node<'d, 'd>>, LoadError> {
        match self.nested(tag).as_slice() {
            [] => Ok(None),
            [(node, _)] => Ok(Some(*node)),
            [_, (_, second), ..] => {
                let message = format!("the {} type `{}` takes one {tag} only", self.tag(), self.kind);
                Err(self.reader.error(*second, message))
            }
        }
    }

    fn tag(&self) -> &'d str {
        self.node.tag_name().name()
    }

    /// Refuses whatever was given and not asked for.
    pub(super) fn finish(&self) -> Result<(), LoadError> {
        if let Some(nested) = self.nested.iter().find(|n| !n.used.get()) {
            let inner = nested.node.tag_name().name();
            let message = format!("the {} type `{}` takes no {}", self.tag(), self.kind, abridged(inner));
            return Err(self.reader.error(nested.place, message));
        }
        let Some(given) = self.parameters.iter().find(|p| !p.used.get()) else { return Ok(()) };
        let mut known = self.asked.borrow().clone();
        known.sort_unstable();
        known.dedup();
        let guess = suggestion(&given.name, known.iter().copied());
        let message = format!(
            "the {} type `{}` has no parameter `{}`{guess}; {}",
            self.tag(),
            self.kind,
            abridged(&given.name),
            if known.is_empty() { "it has none".to_owned() } else { format!("it has {}", known.join(", ")) }
        );
        Err(self.reader.error_in(given.node, "name", message))
    }
}

/// The elements in an element, between which stands nothing but white space and comments.
pub(super) fn elements<'d>(reader: &Reader<'d>, node: Node<'d, 'd>) -> Result<Vec<Node<'d, 'd>>, LoadError> {
    let mut found = Vec::new();
    for child in node.children() {
        if child.is_element() {
            found.push(child);
        } else if child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()) {
            let text = child.text().unwrap_or_default().trim();
            return Err(reader.error(child, format!("the text `{}` has no meaning here", abridged(text))));
        }
    }
    Ok(found)
}
