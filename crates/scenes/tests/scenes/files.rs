//! Scene files for tests.

use etendue_core::{material::Material, scene::SceneDescription};
use etendue_scenes::{LoadOptions, LoadedScene, load, load_with};
use std::{fs, path::Path};
use tempfile::TempDir;

/// What every scene needs.
pub(crate) const SETTINGS: &str = "<integrator type=\"path\"/><sensor type=\"perspective\"/>";

pub(crate) const LENIENT: LoadOptions = LoadOptions { lenient: true, outside_folder: false };

/// A folder of files, of which `scene.xml` is to be loaded.
pub(crate) struct Folder(pub(crate) TempDir);

impl Folder {
    pub(crate) fn new() -> Folder {
        Folder(TempDir::new().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn with(self, name: &str, content: impl AsRef<[u8]>) -> Folder {
        let path = self.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
        self
    }

    /// Adds the scene's file; what is given starts in its line 2.
    pub(crate) fn scene(self, inner: &str) -> Folder {
        self.with("scene.xml", format!("<scene version=\"3.0.0\">{SETTINGS}\n{inner}\n</scene>\n"))
    }

    fn spec(&self) -> String {
        self.path().join("scene.xml").to_str().unwrap().to_owned()
    }

    pub(crate) fn load(&self) -> LoadedScene {
        load(&self.spec()).unwrap_or_else(|e| panic!("{e}"))
    }

    pub(crate) fn load_with(&self, options: LoadOptions) -> LoadedScene {
        load_with(&self.spec(), options).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The error, with the names of files without their folder.
    pub(crate) fn error(&self) -> String {
        let error = load(&self.spec()).expect_err("an error").to_string();
        self.shortened(&error)
    }

    /// The notes, with the names of files without their folder.
    pub(crate) fn notes(&self, options: LoadOptions) -> Vec<String> {
        self.load_with(options).notes.iter().map(|n| self.shortened(n)).collect()
    }

    fn shortened(&self, text: &str) -> String {
        let real = self.path().canonicalize().unwrap();
        let without = text.replace(&format!("{}/", real.display()), "");
        without.replace(&format!("{}/", self.path().display()), "")
    }
}

/// The scene with this in it.
pub(crate) fn described(inner: &str) -> SceneDescription {
    Folder::new().scene(inner).load().description
}

/// The error of a scene with this in it, from its line 2 on.
pub(crate) fn flaw(inner: &str) -> String {
    Folder::new().scene(inner).error()
}

/// A material and whether it is two-sided.
pub(crate) fn material(bsdf: &str) -> (Material, bool) {
    let scene = described(&format!("<shape type=\"cube\">{bsdf}</shape>"));
    assert_eq!(scene.materials.len(), 1);
    (scene.materials[0].material.clone(), scene.materials[0].two_sided)
}
