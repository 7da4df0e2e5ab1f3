//! The meshes and images that a scene names, read before its elements are, on all processors.

use super::{
    tree::{Node, Tree},
    value::{self, snake_case},
};
use crate::{
    error::{Flaw, LoadError, read_file},
    folders::Folders,
    image_file::{self, Coding},
    obj, ply, serialized,
};
use etendue_core::{geometry::Mesh, rgb::Rgb, texture::Raster};
use rayon::prelude::*;
use std::{
    cell::RefCell,
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
};

/// The kinds of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum MeshFile {
    Obj,
    Ply,
    /// One of the shapes in it, counted from 0.
    Serialized(usize),
}

impl MeshFile {
    fn parse(self, bytes: &[u8]) -> Result<MeshRead, Flaw> {
        let silent = |mesh| (mesh, Vec::new());
        match self {
            MeshFile::Obj => obj::read_with_notes(bytes),
            MeshFile::Ply => ply::read(bytes).map(silent),
            MeshFile::Serialized(index) => serialized::read(bytes, index).map(silent),
        }
    }
}

/// A mesh as its file has it, and notes of what was passed over.
pub(super) type MeshRead = (Mesh, Vec<String>);

/// An image and how it is decoded.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct ImageFile {
    pub(super) path: PathBuf,
    /// A [`Coding`], with a gamma by its bits.
    coding: (u8, u32),
}

impl ImageFile {
    pub(super) fn new(path: PathBuf, coding: Coding) -> ImageFile {
        let coding = match coding {
            Coding::Srgb => (0, 0),
            Coding::Linear => (1, 0),
            Coding::Gamma(gamma) => (2, gamma.to_bits()),
        };
        ImageFile { path, coding }
    }

    fn read(&self) -> Result<Raster<Rgb>, LoadError> {
        let coding = match self.coding {
            (0, _) => Coding::Srgb,
            (1, _) => Coding::Linear,
            (_, bits) => Coding::Gamma(f32::from_bits(bits)),
        };
        let bytes = read_file(&self.path, image_file::LARGEST_FILE)?;
        image_file::decode(&bytes, &self.path, coding).map_err(|flaw| flaw.of(&self.path))
    }
}

/// Files that were read without a fault. One that is not here is read, and found faulty, when it is asked for.
#[derive(Default)]
pub(super) struct Ahead {
    /// Each with the number of times that it will be asked for.
    meshes: RefCell<HashMap<(MeshFile, PathBuf), (MeshRead, usize)>>,
    images: RefCell<HashMap<ImageFile, Raster<Rgb>>>,
}

enum Task {
    /// What is in a file, with the number of times that each will be asked for.
    Meshes(PathBuf, Vec<(MeshFile, usize)>),
    Image(ImageFile),
}

enum Done {
    Meshes(PathBuf, Vec<(MeshFile, usize, MeshRead)>),
    Image(ImageFile, Raster<Rgb>),
}

/// The largest file of meshes that is read.
const LARGEST_MESH: u64 = {
    assert!(obj::LARGEST_FILE == ply::LARGEST_FILE && ply::LARGEST_FILE == serialized::LARGEST_FILE);
    ply::LARGEST_FILE
};

impl Ahead {
    /// Reads the files that the tree's shapes, textures and emitters name.
    pub(super) fn read(tree: &Tree, folders: &Folders) -> Ahead {
        let mut meshes: HashMap<PathBuf, HashMap<MeshFile, usize>> = HashMap::new();
        let mut images: HashSet<ImageFile> = HashSet::new();
        for node in tree.nodes() {
            let find = || folders.find(parameter(node, "filename")?).ok();
            let mut mesh = |kind| {
                if let Some(path) = find() {
                    *meshes.entry(path).or_default().entry(kind).or_default() += 1;
                }
            };
            match (node.tag(), node.attribute("type").unwrap_or_default()) {
                ("shape", "obj") => mesh(MeshFile::Obj),
                ("shape", "ply") => mesh(MeshFile::Ply),
                ("shape", "serialized") => {
                    let index = parameter(node, "shape_index").map_or(Some(0), |t| t.trim().parse().ok());
                    index.into_iter().for_each(|index| mesh(MeshFile::Serialized(index)));
                }
                ("texture", "bitmap") => {
                    images.extend(find().zip(coding(node)).map(|(path, coding)| ImageFile::new(path, coding)));
                }
                ("emitter", "envmap") => images.extend(find().map(|path| ImageFile::new(path, Coding::Srgb))),
                _ => {}
            }
        }
        let tasks = meshes.into_iter().map(|(path, kinds)| Task::Meshes(path, kinds.into_iter().collect()));
        let mut tasks: Vec<Task> = tasks.chain(images.into_iter().map(Task::Image)).collect();
        // The longest first, so that no processor is left with one at the end.
        tasks.sort_by_cached_key(|task| std::cmp::Reverse(task.effort()));
        let done: Vec<Option<Done>> = tasks.into_par_iter().with_max_len(1).map(Task::run).collect();
        let ahead = Ahead::default();
        for done in done.into_iter().flatten() {
            match done {
                Done::Meshes(path, meshes) => {
                    let meshes = meshes.into_iter().map(|(kind, uses, mesh)| ((kind, path.clone()), (mesh, uses)));
                    ahead.meshes.borrow_mut().extend(meshes);
                }
                Done::Image(file, image) => {
                    ahead.images.borrow_mut().insert(file, image);
                }
            }
        }
        ahead
    }

    /// A mesh as its file has it.
    pub(super) fn mesh(&self, kind: MeshFile, path: PathBuf) -> Result<MeshRead, LoadError> {
        let mut meshes = self.meshes.borrow_mut();
        let key = (kind, path);
        match meshes.get_mut(&key) {
            Some((mesh, uses)) if *uses > 1 => {
                *uses -= 1;
                Ok(mesh.clone())
            }
            Some(_) => Ok(meshes.remove(&key).map(|(mesh, _)| mesh).unwrap_or_default()),
            None => kind.parse(&read_file(&key.1, LARGEST_MESH)?).map_err(|flaw| flaw.of(&key.1)),
        }
    }

    /// An image as its file has it.
    pub(super) fn image(&self, file: &ImageFile) -> Result<Raster<Rgb>, LoadError> {
        if let Some(image) = self.images.borrow().get(file) {
            return Ok(image.clone());
        }
        let image = file.read()?;
        self.images.borrow_mut().insert(file.clone(), image.clone());
        Ok(image)
    }
}

impl Task {
    /// A guess at how long it takes: a byte of an image stands for more than one of a mesh.
    fn effort(&self) -> u64 {
        let size = |path: &Path| std::fs::metadata(path).map_or(0, |m| m.len());
        match self {
            Task::Meshes(path, kinds) if kinds.iter().any(|(kind, _)| *kind == MeshFile::Obj) => 4 * size(path),
            Task::Meshes(path, _) => size(path),
            Task::Image(file) => 10 * size(&file.path),
        }
    }

    fn run(self) -> Option<Done> {
        match self {
            Task::Meshes(path, kinds) => {
                let bytes = read_file(&path, LARGEST_MESH).ok()?;
                let read = |(kind, uses): (MeshFile, usize)| Some((kind, uses, kind.parse(&bytes).ok()?));
                let meshes = kinds.into_par_iter().filter_map(read).collect();
                Some(Done::Meshes(path, meshes))
            }
            Task::Image(file) => {
                let image = file.read().ok()?;
                Some(Done::Image(file, image))
            }
        }
    }
}

/// The text of a parameter.
fn parameter<'d>(node: Node<'d>, name: &str) -> Option<&'d str> {
    let named = |n: &Node| n.attribute("name").is_some_and(|given| snake_case(given) == name);
    node.children().find(named)?.attribute("value")
}

/// How a bitmap texture decodes its image; none if its parameters are wrong.
fn coding(node: Node) -> Option<Coding> {
    let raw = parameter(node, "raw").map_or(Some(false), |t| value::boolean(t).ok())?;
    let gamma = parameter(node, "gamma").map_or(Some(None), |t| value::number(t).ok().map(Some))?;
    Some(coding_of(raw, gamma))
}

/// How a bitmap texture decodes its image. The gamma of older files is -1 for sRGB and 1 for what is linear.
pub(super) fn coding_of(raw: bool, gamma: Option<f64>) -> Coding {
    match gamma {
        _ if raw => Coding::Linear,
        Some(1.0) => Coding::Linear,
        Some(gamma) if gamma > 0.0 => Coding::Gamma(gamma as f32),
        _ => Coding::Srgb,
    }
}
