//! What the elements of a scene share: identifiers, files, notes, and whether what is not supported is an error.

use super::{
    ahead::Ahead,
    images::Images,
    tree::{Node, Tree},
};
use crate::{
    LoadOptions,
    error::{LoadError, abridged, nearest},
    folders::Folders,
};
use std::{
    cell::RefCell,
    collections::{HashMap, HashSet},
    path::PathBuf,
};

/// A scene's elements with what they share.
pub(super) struct Reader<'d> {
    by_id: HashMap<&'d str, Node<'d>>,
    folders: &'d Folders,
    lenient: bool,
    /// Whether the file is of a version before 1.
    pub(super) older: bool,
    notes: RefCell<Notes>,
    /// The meshes and images that the scene names.
    pub(super) ahead: Ahead,
    /// The images as textures use them.
    pub(super) images: Images,
}

#[derive(Default)]
struct Notes {
    list: Vec<String>,
    /// Those in the list: each is said once.
    said: HashSet<String>,
}

impl<'d> Reader<'d> {
    /// Collects the identifiers and reads the files.
    pub(super) fn new(tree: &'d Tree, folders: &'d Folders, options: LoadOptions) -> Result<Reader<'d>, LoadError> {
        let mut by_id: HashMap<&str, Node> = HashMap::new();
        for node in tree.nodes() {
            let id = match node.tag() {
                "ref" => continue,
                "alias" => {
                    node.allow_attributes(&["id", "as"])?;
                    let target = referenced(&by_id, node)?;
                    identify(&mut by_id, node, node.required("as")?, target)?;
                    continue;
                }
                _ => node.attribute("id"),
            };
            if let Some(id) = id {
                identify(&mut by_id, node, id, node)?;
            }
        }
        let older = tree.node(0).attribute("version").is_some_and(|v| v.trim().starts_with("0."));
        let ahead = Ahead::read(tree, folders);
        let notes = RefCell::new(Notes::default());
        Ok(Reader { by_id, folders, lenient: options.lenient, older, notes, ahead, images: Images::default() })
    }

    /// The element that a `<ref>` names.
    pub(super) fn referenced(&self, node: Node<'d>) -> Result<Node<'d>, LoadError> {
        node.allow_attributes(&["id", "name"])?;
        referenced(&self.by_id, node)
    }

    /// The place of a file that an element names.
    pub(super) fn file(&self, name: &str) -> Result<PathBuf, String> {
        self.folders.find(name)
    }

    /// Something that a user should know.
    pub(super) fn note(&self, note: impl Into<String>) {
        let (note, mut notes) = (note.into(), self.notes.borrow_mut());
        if notes.said.insert(note.clone()) {
            notes.list.push(note);
        }
    }

    /// What has been noted.
    pub(super) fn notes(self) -> Vec<String> {
        self.notes.into_inner().list
    }

    /// Lets something pass that is wrong or not supported: noted, with what is done instead, where loading is lenient; an error
    /// otherwise.
    pub(super) fn forgive(&self, error: LoadError, instead: &str) -> Result<(), LoadError> {
        if !self.lenient {
            return Err(error);
        }
        self.note(format!("{error}; {instead}"));
        Ok(())
    }

    /// As [`Reader::forgive`] where there may be nothing to forgive: none if there is.
    pub(super) fn forgiven<T>(&self, result: Result<T, LoadError>, instead: &str) -> Result<Option<T>, LoadError> {
        result.map(Some).or_else(|error| self.forgive(error, instead).map(|()| None))
    }
}

fn identify<'d>(
    by_id: &mut HashMap<&'d str, Node<'d>>,
    node: Node<'d>,
    id: &'d str,
    target: Node<'d>,
) -> Result<(), LoadError> {
    match by_id.insert(id, target) {
        None => Ok(()),
        Some(first) => {
            Err(node.error(format!("the id `{}` is already taken in {}", abridged(id), first.whereabouts())))
        }
    }
}

fn referenced<'d>(by_id: &HashMap<&'d str, Node<'d>>, node: Node<'d>) -> Result<Node<'d>, LoadError> {
    let id = node.required("id")?;
    by_id.get(id).copied().ok_or_else(|| {
        let guess = suggestion(id, by_id.keys().copied());
        node.error_in("id", format!("nothing has the id `{}`{guess}", abridged(id)))
    })
}

/// A hint at the most similar of several names.
pub(super) fn suggestion<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, known).map(|n| format!(" (did you mean `{n}`?)")).unwrap_or_default()
}
