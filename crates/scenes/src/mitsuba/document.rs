//! The document: places, `$` substitution, identifiers, files.

use super::value::abridged;
use crate::error::{Flaw, LoadError, Place, nearest};
use roxmltree::{Document, Node};
use std::{
    borrow::Cow,
    collections::HashMap,
    path::{Component, Path, PathBuf},
};

/// A parsed scene file with what its elements share.
pub(super) struct Reader<'d> {
    path: &'d Path,
    /// The scene's folder, without links.
    folder: PathBuf,
    document: &'d Document<'d>,
    /// The byte at which each line starts.
    lines: Vec<usize>,
    defaults: HashMap<&'d str, String>,
    by_id: HashMap<String, Node<'d, 'd>>,
}

impl<'d> Reader<'d> {
    /// Collects the defaults and identifiers of a document.
    pub(super) fn new(path: &'d Path, document: &'d Document<'d>) -> Result<Reader<'d>, LoadError> {
        let folder = match path.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let folder = folder.canonicalize().map_err(|source| LoadError::Read { path: folder.to_owned(), source })?;
        let mut reader =
            Reader { path, folder, document, lines: Vec::new(), defaults: HashMap::new(), by_id: HashMap::new() };
        let ends = document.input_text().bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        reader.lines = std::iter::once(0).chain(ends.map(|(at, _)| at + 1)).collect();
        let root = document.root_element();
        for node in root.children().filter(|n| n.has_tag_name("default")) {
            reader.allow_attributes(node, &["name", "value"])?;
            let name = reader.required(node, "name")?;
            // A default may use those before it.
            let value = reader.substituted(node, "value")?.into_owned();
            if reader.defaults.insert(name, value).is_some() {
                return Err(reader.error(node, format!("the default `{name}` is set a second time")));
            }
        }
        for node in root.descendants().filter(|n| n.has_attribute("id") && !n.has_tag_name("ref")) {
            let id = reader.substituted(node, "id")?.into_owned();
            if let Some(first) = reader.by_id.get(&id) {
                let line = reader.line(*first);
                return Err(reader.error(node, format!("the id `{id}` is already taken in line {line}")));
            }
            reader.by_id.insert(id, node);
        }
        Ok(reader)
    }

    /// The line in which an element starts, counted from 1.
    pub(super) fn line(&self, node: Node) -> usize {
        self.lines.partition_point(|start| *start <= node.range().start)
    }

    /// An error at an element.
    pub(super) fn error(&self, node: Node, message: impl Into<String>) -> LoadError {
        self.error_at(node.range().start, message)
    }

    /// An error at the value of an attribute.
    pub(super) fn error_in(&self, node: Node, attribute: &str, message: impl Into<String>) -> LoadError {
        self.error_at(node.attribute_node(attribute).map_or(node.range().start, |a| a.range_value().start), message)
    }

    /// An error at a byte of the document.
    pub(super) fn error_at(&self, byte: usize, message: impl Into<String>) -> LoadError {
        let place = self.document.text_pos_at(byte);
        Flaw::new(Place::Column(place.row, place.col), message).of(self.path)
    }

    /// Refuses attributes other than those named.
    pub(super) fn allow_attributes(&self, node: Node, allowed: &[&str]) -> Result<(), LoadError> {
        for attribute in node.attributes() {
            if !allowed.contains(&attribute.name()) || attribute.namespace().is_some() {
                let message = format!(
                    "<{}> has no attribute `{}`{}; it has {}",
                    node.tag_name().name(),
                    abridged(attribute.name()),
                    suggestion(attribute.name(), allowed.iter().copied()),
                    allowed.join(", ")
                );
                return Err(self.error_at(attribute.range().start, message));
            }
        }
        Ok(())
    }

    /// The text of an attribute as it stands.
    pub(super) fn required(&self, node: Node<'d, 'd>, attribute: &str) -> Result<&'d str, LoadError> {
        let missing = || self.error(node, format!("<{}> lacks the attribute `{attribute}`", node.tag_name().name()));
        node.attribute(attribute).ok_or_else(missing)
    }

    /// The text of an attribute with its `$name`s replaced.
    pub(super) fn substituted(&self, node: Node<'d, 'd>, attribute: &str) -> Result<Cow<'d, str>, LoadError> {
        let text = self.required(node, attribute)?;
        if !text.contains('$') {
            return Ok(Cow::Borrowed(text));
        }
        let mut parts = text.split('$');
        let mut out = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let end = part.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(part.len());
            let (name, rest) = part.split_at(end);
            let Some(value) = self.defaults.get(name) else {
                let known = self.defaults.keys().copied();
                let message = format!("`${}` has no <default>{}", abridged(name), suggestion(name, known));
                return Err(self.error_in(node, attribute, message));
            };
            out.push_str(value);
            out.push_str(rest);
            // Defaults that are made of defaults could double in size with every line.
            if out.len() > 1 << 16 {
                return Err(self.error_in(node, attribute, "grows beyond 65536 bytes when its defaults are put in"));
            }
        }
        Ok(Cow::Owned(out))
    }

    /// The element that a `<ref>` names.
    pub(super) fn referenced(&self, node: Node<'d, 'd>) -> Result<Node<'d, 'd>, LoadError> {
        self.allow_attributes(node, &["id", "name"])?;
        let id = self.substituted(node, "id")?;
        self.by_id.get(id.as_ref()).copied().ok_or_else(|| {
            let known = self.by_id.keys().map(String::as_str);
            self.error_in(node, "id", format!("nothing has the id `{}`{}", abridged(&id), suggestion(&id, known)))
        })
    }

    /// The place of a file that the scene names, which lies in the scene's folder.
    pub(super) fn file(&self, byte: usize, name: &str) -> Result<PathBuf, LoadError> {
        let leaves = || {
            let message = format!("the file `{}` lies outside of the scene's folder, which is refused", abridged(name));
            self.error_at(byte, message)
        };
        let mut depth = 0i64;
        for component in Path::new(name).components() {
            depth += match component {
                Component::Normal(_) => 1,
                Component::CurDir => 0,
                Component::ParentDir => -1,
                Component::RootDir | Component::Prefix(_) => return Err(leaves()),
            };
            if depth < 0 {
                return Err(leaves());
            }
        }
        let path = self.folder.join(name);
        // The name itself stays inside; a link on its way might not.
        let real = path
            .canonicalize()
            .map_err(|e| self.error_at(byte, format!("cannot read the file `{}`: {e}", abridged(name))))?;
        if !real.starts_with(&self.folder) {
            return Err(leaves());
        }
        Ok(real)
    }

    /// The path of the scene.
    pub(super) fn path(&self) -> &Path {
        self.path
    }
}

/// A hint at the most similar of several names.
pub(super) fn suggestion<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, known).map(|n| format!(" (did you mean `{n}`?)")).unwrap_or_default()
}
