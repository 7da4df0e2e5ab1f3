//! Where the files that a scene names are looked for.

use crate::error::{LoadError, abridged};
use std::path::{Component, Path, PathBuf};

/// The folders in which files are looked for.
pub(crate) struct Folders {
    /// The scene's folder, without links.
    scene: PathBuf,
    /// The first that holds a file of the name is taken; the scene's folder is the last.
    search: Vec<PathBuf>,
    /// Whether files outside of the scene's folder may be read.
    outside: bool,
}

impl Folders {
    /// The folder of a scene file.
    pub(crate) fn of(path: &Path, outside: bool) -> Result<Folders, LoadError> {
        let folder = match path.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let scene = folder.canonicalize().map_err(|source| LoadError::Read { path: path.to_owned(), source })?;
        Ok(Folders { search: vec![scene.clone()], scene, outside })
    }

    /// Adds a folder, relative to that of the file that names it, in front of the others.
    pub(crate) fn add(&mut self, from: &Path, name: &str) -> Result<(), String> {
        let name = name.replace('\\', "/");
        let base = from.parent().and_then(|p| p.canonicalize().ok()).unwrap_or_else(|| self.scene.clone());
        let folder = base.join(&name).canonicalize();
        let folder = folder.map_err(|e| format!("cannot read the folder `{}`: {e}", abridged(&name)))?;
        if !self.outside && !folder.starts_with(&self.scene) {
            return Err(outside("folder", &name));
        }
        self.search.insert(0, folder);
        Ok(())
    }

    /// The place of a file.
    pub(crate) fn find(&self, name: &str) -> Result<PathBuf, String> {
        let name = name.replace('\\', "/");
        let mut failure = None;
        for folder in &self.search {
            let path = folder.join(&name);
            match path.canonicalize() {
                Ok(real) if self.outside || real.starts_with(&self.scene) => return Ok(real),
                // Links are followed first: what counts is where the file really lies.
                Ok(_) => return Err(outside("file", &name)),
                Err(e) if self.outside || without_dots(&path).starts_with(&self.scene) => {
                    failure = Some(format!("cannot read the file `{}`: {e}", abridged(&name)));
                }
                // The same answer whether or not there is such a file, so that nobody can ask for it.
                Err(_) => failure = Some(outside("file", &name)),
            }
        }
        Err(failure.unwrap_or_else(|| outside("file", &name)))
    }
}

fn outside(what: &str, name: &str) -> String {
    let name = abridged(name);
    format!("the {what} `{name}` lies outside of the scene's folder, which is refused without --allow-outside")
}

/// The path with each `..` taken back, as far as its text tells.
fn without_dots(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}
