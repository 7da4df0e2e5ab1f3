//! A scene file and those that it includes, as one tree of elements.

use super::document::suggestion;
use crate::error::{Flaw, LoadError, Place, abridged};
use std::path::{Path, PathBuf};

/// A file of the tree.
struct SourceFile {
    path: PathBuf,
    text: String,
    /// The byte at which each line starts.
    lines: Vec<usize>,
}

struct Element {
    tag: Box<str>,
    /// First and one past the last of its attributes.
    attributes: (usize, usize),
    file: u32,
    /// The byte at which it starts.
    start: usize,
    first_child: Option<u32>,
    next: Option<u32>,
}

struct Attribute {
    name: Box<str>,
    value: Box<str>,
    /// The bytes at which the attribute and its value start.
    start: usize,
    value_start: usize,
}

/// An attribute as it is added.
pub(super) struct NewAttribute {
    pub(super) name: String,
    pub(super) value: String,
    /// The bytes at which the attribute and its value start.
    pub(super) start: usize,
    pub(super) value_start: usize,
}

/// Elements of several files, each file's where it is included. Children follow their parents.
#[derive(Default)]
pub(super) struct Tree {
    files: Vec<SourceFile>,
    elements: Vec<Element>,
    attributes: Vec<Attribute>,
    /// The last child of each element, for the next one to follow.
    last_child: Vec<Option<u32>>,
}

impl Tree {
    /// Adds a file; it has no elements yet.
    pub(super) fn add_file(&mut self, path: PathBuf, text: String) -> u32 {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let lines = std::iter::once(0).chain(ends.map(|(at, _)| at + 1)).collect();
        self.files.push(SourceFile { path, text, lines });
        self.files.len() as u32 - 1
    }

    /// Adds an element as the last child of its parent.
    pub(super) fn add(
        &mut self,
        parent: Option<u32>,
        file: u32,
        start: usize,
        tag: &str,
        attributes: Vec<NewAttribute>,
    ) -> u32 {
        let index = self.elements.len() as u32;
        let first = self.attributes.len();
        self.attributes.extend(attributes.into_iter().map(|a| Attribute {
            name: a.name.into(),
            value: a.value.into(),
            start: a.start,
            value_start: a.value_start,
        }));
        let attributes = (first, self.attributes.len());
        self.elements.push(Element { tag: tag.into(), attributes, file, start, first_child: None, next: None });
        self.last_child.push(None);
        if let Some(parent) = parent {
            match self.last_child[parent as usize].replace(index) {
                Some(previous) => self.elements[previous as usize].next = Some(index),
                None => self.elements[parent as usize].first_child = Some(index),
            }
        }
        index
    }

    /// An element.
    pub(super) fn node(&self, index: u32) -> Node<'_> {
        Node { tree: self, index }
    }

    /// Every element, parents before their children.
    pub(super) fn nodes(&self) -> impl Iterator<Item = Node<'_>> {
        (0..self.elements.len() as u32).map(|index| self.node(index))
    }

    /// The path of a file.
    pub(super) fn path(&self, file: u32) -> &Path {
        &self.files[file as usize].path
    }

    /// An error at a byte of a file.
    pub(super) fn error(&self, file: u32, byte: usize, message: impl Into<String>) -> LoadError {
        let source = &self.files[file as usize];
        let line = source.lines.partition_point(|start| *start <= byte);
        let before = source.text.get(source.lines[line - 1]..byte).unwrap_or_default();
        let place = Place::Column(line as u32, before.chars().count() as u32 + 1);
        Flaw::new(place, message).of(&source.path)
    }
}

/// An element of a tree.
#[derive(Clone, Copy)]
pub(super) struct Node<'d> {
    tree: &'d Tree,
    index: u32,
}

impl PartialEq for Node<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

impl<'d> Node<'d> {
    fn element(&self) -> &'d Element {
        &self.tree.elements[self.index as usize]
    }

    fn given(&self, name: &str) -> Option<&'d Attribute> {
        let (first, end) = self.element().attributes;
        self.tree.attributes[first..end].iter().find(|a| *a.name == *name)
    }

    /// What tells it from every other element.
    pub(super) fn key(&self) -> u32 {
        self.index
    }

    /// The name between its brackets.
    pub(super) fn tag(&self) -> &'d str {
        &self.element().tag
    }

    /// The text of an attribute.
    pub(super) fn attribute(&self, name: &str) -> Option<&'d str> {
        self.given(name).map(|a| &*a.value)
    }

    /// The text of an attribute that must be there.
    pub(super) fn required(&self, name: &str) -> Result<&'d str, LoadError> {
        self.attribute(name)
            .ok_or_else(|| self.error(format!("<{}> lacks the attribute `{name}`", abridged(self.tag()))))
    }

    /// The elements in it.
    pub(super) fn children(&self) -> impl Iterator<Item = Node<'d>> + use<'d> {
        let tree = self.tree;
        let first = self.element().first_child;
        std::iter::successors(first, |index| tree.elements[*index as usize].next).map(|index| tree.node(index))
    }

    /// Where it stands, for a name: `line 4`, or `line 4 of part.xml` in a file that is included.
    pub(super) fn whereabouts(&self) -> String {
        let element = self.element();
        let source = &self.tree.files[element.file as usize];
        let line = source.lines.partition_point(|start| *start <= element.start);
        match (element.file, source.path.file_name()) {
            (1.., Some(name)) => format!("line {line} of {}", name.to_string_lossy()),
            _ => format!("line {line}"),
        }
    }

    /// What it is called: its `id`, or what it is and where.
    pub(super) fn called(&self) -> String {
        match self.attribute("id") {
            Some(id) => id.to_owned(),
            None => format!("{} in {}", self.attribute("type").unwrap_or(self.tag()), self.whereabouts()),
        }
    }

    /// The file in which it stands.
    pub(super) fn path(&self) -> &'d Path {
        self.tree.path(self.element().file)
    }

    /// An error at it.
    pub(super) fn error(&self, message: impl Into<String>) -> LoadError {
        let element = self.element();
        self.tree.error(element.file, element.start, message)
    }

    /// An error at the value of an attribute, or at the element if it has none.
    pub(super) fn error_in(&self, attribute: &str, message: impl Into<String>) -> LoadError {
        let element = self.element();
        self.tree.error(element.file, self.given(attribute).map_or(element.start, |a| a.value_start), message)
    }

    /// An error at an attribute.
    pub(super) fn error_on(&self, attribute: &str, message: impl Into<String>) -> LoadError {
        let element = self.element();
        self.tree.error(element.file, self.given(attribute).map_or(element.start, |a| a.start), message)
    }

    /// Refuses attributes other than those named.
    pub(super) fn allow_attributes(&self, allowed: &[&str]) -> Result<(), LoadError> {
        let (first, end) = self.element().attributes;
        match self.tree.attributes[first..end].iter().find(|a| !allowed.contains(&&*a.name)) {
            None => Ok(()),
            Some(other) => {
                let message = format!(
                    "<{}> has no attribute `{}`{}; it has {}",
                    abridged(self.tag()),
                    abridged(&other.name),
                    suggestion(&other.name, allowed.iter().copied()),
                    allowed.join(", ")
                );
                Err(self.tree.error(self.element().file, other.start, message))
            }
        }
    }
}
