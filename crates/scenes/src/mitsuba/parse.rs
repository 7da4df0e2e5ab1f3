//! From files to the tree: `<default>` and `$name`, `<include>`, `<path>`.

use super::{
    document::suggestion,
    encoding,
    tree::{NewAttribute, Tree},
};
use crate::{
    error::{Flaw, LoadError, Place, abridged, read_file},
    folders::Folders,
};
use roxmltree::{Document, ParsingOptions};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// The largest scene file that is read, with those that it includes.
pub const LARGEST_FILE: u64 = 1 << 28;

/// The most elements and texts that a scene file may have, with those that it includes.
const MOST_NODES: u32 = 1 << 22;

/// How deep files include each other at most, and how many there may be.
const DEEPEST: usize = 15;
const MOST_FILES: usize = 1024;

/// A tree with its folders while it grows.
pub(super) struct Parser {
    pub(super) tree: Tree,
    pub(super) folders: Folders,
    /// Notes for the user.
    pub(super) notes: Vec<String>,
    defaults: HashMap<String, Default>,
    /// The files that are being read, outermost first: to meet one again is a circle.
    open: Vec<PathBuf>,
    files: usize,
    bytes: u64,
    nodes: u32,
}

struct Default {
    value: String,
    /// The file that set it, counted by inclusions.
    file: u32,
}

impl Parser {
    /// Reads a scene file and all that it includes.
    pub(super) fn read(path: &Path, outside: bool) -> Result<Parser, LoadError> {
        let folders = Folders::of(path, outside)?;
        let mut parser = Parser {
            tree: Tree::default(),
            folders,
            notes: Vec::new(),
            defaults: HashMap::new(),
            open: Vec::new(),
            files: 0,
            bytes: 0,
            nodes: 0,
        };
        parser.file(path, None)?;
        Ok(parser)
    }

    /// Adds a file's root, or, where it is included, what is in its `<scene>` to the parent.
    fn file(&mut self, path: &Path, parent: Option<u32>) -> Result<(), LoadError> {
        let bytes = read_file(path, LARGEST_FILE - self.bytes)?;
        self.bytes += bytes.len() as u64;
        self.files += 1;
        let text = encoding::text(bytes).map_err(|flaw| flaw.of(path))?;
        let options = ParsingOptions { nodes_limit: MOST_NODES - self.nodes, ..ParsingOptions::default() };
        let document = Document::parse_with_options(&text, options).map_err(|e| {
            let place = Place::Column(e.pos().row, e.pos().col);
            // The parser ends its messages with the place, which stands in front already.
            let message = e.to_string();
            let message = message.rsplit_once(" at ").map_or(message.as_str(), |(m, _)| m);
            Flaw::new(place, format!("not well-formed XML: {message}")).of(path)
        })?;
        self.nodes += document.descendants().count() as u32;
        let file = self.tree.add_file(path.to_owned(), text.clone());
        self.open.push(path.canonicalize().unwrap_or_else(|_| path.to_owned()));
        self.elements(&document, file, parent)?;
        self.open.pop();
        Ok(())
    }

    fn elements(&mut self, document: &Document, file: u32, parent: Option<u32>) -> Result<(), LoadError> {
        let root = document.root_element();
        // Depth first without recursion: a file may nest as deep as it likes.
        let mut todo = match parent {
            Some(parent) if root.has_tag_name("scene") => vec![(root.children(), Some(parent))],
            _ => vec![(document.root().children(), parent)],
        };
        while let Some((children, parent)) = todo.last_mut() {
            let (Some(child), parent) = (children.next(), *parent) else {
                todo.pop();
                continue;
            };
            if let Some(text) = child.text().map(str::trim).filter(|t| child.is_text() && !t.is_empty()) {
                let message = format!("the text `{}` has no meaning here", abridged(text));
                return Err(self.tree.error(file, child.range().start, message));
            }
            if !child.is_element() {
                continue;
            }
            let start = child.range().start;
            let attributes = child.attributes().map(|a| self.attribute(file, &a)).collect::<Result<_, _>>()?;
            let tag = child.tag_name().name();
            // What is about the language itself stands apart from the scene's elements.
            let own_parent = if matches!(tag, "default" | "path" | "include") { None } else { parent };
            let index = self.tree.add(own_parent, file, start, tag, attributes);
            match (tag, parent) {
                ("default", _) => self.default(index, file)?,
                ("path", _) => self.path(index)?,
                ("include", Some(parent)) => self.include(index, parent)?,
                _ => todo.push((child.children(), Some(index))),
            }
        }
        Ok(())
    }

    fn attribute(&self, file: u32, attribute: &roxmltree::Attribute) -> Result<NewAttribute, LoadError> {
        let (start, value_start) = (attribute.range().start, attribute.range_value().start);
        let name = match attribute.namespace() {
            Some(namespace) => format!("{{{namespace}}}{}", attribute.name()),
            None => attribute.name().to_owned(),
        };
        let value = self.substituted(attribute.value()).map_err(|m| self.tree.error(file, value_start, m))?;
        Ok(NewAttribute { name, value, start, value_start })
    }

    /// A text with its `$name`s replaced by the defaults so far.
    fn substituted(&self, text: &str) -> Result<String, String> {
        let mut parts = text.split('$');
        let mut out = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let end = part.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(part.len());
            let (name, rest) = part.split_at(end);
            let Some(default) = self.defaults.get(name) else {
                let known = self.defaults.keys().map(String::as_str);
                return Err(format!("`${}` has no <default> before it{}", abridged(name), suggestion(name, known)));
            };
            out.push_str(&default.value);
            out.push_str(rest);
            // Defaults that are made of defaults could double in size with every line.
            if out.len() > 1 << 16 {
                return Err("grows beyond 65536 bytes when its defaults are put in".to_owned());
            }
        }
        Ok(out)
    }

    /// The first file to set a default decides, so that one that includes others tells them.
    fn default(&mut self, index: u32, file: u32) -> Result<(), LoadError> {
        let node = self.tree.node(index);
        node.allow_attributes(&["name", "value"])?;
        let (name, value) = (node.required("name")?.to_owned(), node.required("value")?.to_owned());
        match self.defaults.get(&name) {
            Some(first) if first.file == file => {
                let place = node.whereabouts();
                self.notes.push(format!("the default `{name}` is set a second time in {place}: the first one counts"));
                Ok(())
            }
            Some(_) => Ok(()),
            None => {
                self.defaults.insert(name, Default { value, file });
                Ok(())
            }
        }
    }

    fn path(&mut self, index: u32) -> Result<(), LoadError> {
        let node = self.tree.node(index);
        node.allow_attributes(&["value"])?;
        let name = node.required("value")?;
        self.folders.add(node.path(), name).map_err(|m| node.error_in("value", m))
    }

    fn include(&mut self, index: u32, parent: u32) -> Result<(), LoadError> {
        let node = self.tree.node(index);
        node.allow_attributes(&["filename"])?;
        let name = node.required("filename")?;
        let path = self.folders.find(name).map_err(|m| node.error_in("filename", m))?;
        if let Some(at) = self.open.iter().position(|open| *open == path) {
            let names = self.open[at..].iter().chain([&path]);
            let names: Vec<_> = names.map(|p| p.file_name().unwrap_or_default().to_string_lossy()).collect();
            return Err(node.error_in("filename", format!("the file includes itself: {}", names.join(" -> "))));
        }
        if self.open.len() > DEEPEST {
            return Err(node.error(format!("files are included more than {DEEPEST} deep")));
        }
        if self.files == MOST_FILES {
            return Err(node.error(format!("more than {MOST_FILES} files are included")));
        }
        self.file(&path, Some(parent))
    }
}
