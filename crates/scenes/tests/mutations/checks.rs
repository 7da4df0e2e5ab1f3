//! What must hold of any input to a parser: an error, or something whose numbers are finite and whose indices are in range.
//! The targets under `fuzz/` share this file.

use etendue_core::{
    geometry::Mesh,
    rgb::Rgb,
    scene::{ObjectShape, Scene, SceneDescription},
    texture::Bitmap,
};
use etendue_scenes::{gltf, image_file, load, obj, ply, serialized};
use std::{cell::OnceCell, path::Path};

pub fn ply(bytes: &[u8]) {
    if let Ok(mesh) = ply::read(bytes) {
        mesh_is_sound(&mesh);
    }
}

pub fn obj(bytes: &[u8]) {
    if let Ok(mesh) = obj::read(bytes) {
        mesh_is_sound(&mesh);
    }
}

/// The first shapes of a container.
pub fn serialized(bytes: &[u8]) {
    for shape in 0..3 {
        if let Ok(mesh) = serialized::read(bytes, shape) {
            mesh_is_sound(&mesh);
        }
    }
}

pub fn gltf(bytes: &[u8]) {
    if let Ok(scene) = gltf::read(bytes) {
        scene_is_sound(&scene.description);
    }
}

pub fn exr(bytes: &[u8]) {
    if let Ok(image) = image_file::read_exr(bytes) {
        bitmap_is_sound(&image.bitmap);
    }
}

/// An image in Radiance's format.
pub fn hdr(bytes: &[u8]) {
    in_folder("image.hdr", bytes, |path| {
        if let Ok(image) = image_file::read(path) {
            bitmap_is_sound(&image.bitmap);
        }
    });
}

/// A scene in Mitsuba's XML, in a folder with files that it may name.
pub fn xml(bytes: &[u8]) {
    in_folder("scene.xml", bytes, |path| {
        if let Ok(scene) = load(path.to_str().unwrap_or_default()) {
            scene_is_sound(&scene.description);
        }
    });
}

/// Does something with a file in a folder of this thread.
fn in_folder(name: &str, bytes: &[u8], f: impl FnOnce(&Path)) {
    thread_local!(static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() });
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| {
            // In memory, where there is such a place: millions of files are written.
            let memory = Path::new("/dev/shm");
            let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
            let folder = folder.expect("no folder for files");
            for (name, bytes) in crate::seeds::beside_xml() {
                std::fs::write(folder.path().join(name), bytes).expect("a file cannot be written");
            }
            folder
        });
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("the file cannot be written");
        f(&path);
    });
}

fn mesh_is_sound(mesh: &Mesh) {
    let vertices = mesh.positions.len();
    assert!(mesh.positions.iter().chain(&mesh.normals).all(|p| p.is_finite()), "a number is not finite");
    assert!(mesh.uvs.iter().all(|p| p.is_finite()), "a number is not finite");
    assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < vertices), "an index is out of range");
    for list in [mesh.normals.len(), mesh.uvs.len(), mesh.colors.len()] {
        assert!(list == 0 || list == vertices, "{list} for {vertices} vertices");
    }
}

fn bitmap_is_sound(bitmap: &Bitmap<Rgb>) {
    assert_eq!(bitmap.texels.len(), bitmap.width as usize * bitmap.height as usize);
    assert!(bitmap.texels.iter().all(|t| t.is_valid()), "a texel is not valid");
}

fn scene_is_sound(scene: &SceneDescription) {
    for object in scene.objects.iter().chain(scene.groups.iter().flat_map(|g| &g.objects)) {
        assert!(object.to_world.is_finite(), "a transform is not finite");
        assert!(object.material < scene.materials.len(), "a material is out of range");
        if let ObjectShape::Mesh(mesh) = &object.shape {
            mesh_is_sound(mesh);
        }
    }
    for instance in &scene.instances {
        assert!(instance.group < scene.groups.len(), "a group is out of range");
        assert!(instance.to_world.is_finite(), "a transform is not finite");
    }
    assert!(scene.camera.as_ref().is_some_and(|c| c.to_world.is_finite()), "the camera's transform is not finite");
    // What it holds may be refused; building it must not fail in another way.
    let _ = Scene::new(scene);
}
