//! Files that others made. They lie beside the repository, or where `ETENDUE_SHARED` says; without them the tests say so and
//! pass.

use super::mesh;
use etendue_core::{material::Material, texture::Texture};
use etendue_scenes::{LoadedScene, load};
use std::path::PathBuf;

fn shared(name: &str) -> Option<LoadedScene> {
    let root = std::env::var_os("ETENDUE_SHARED")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")), PathBuf::from);
    let path = root.join("scenes").join(name);
    if !path.exists() {
        eprintln!("skipped: {} is not there (set ETENDUE_SHARED)", path.display());
        return None;
    }
    Some(load(path.to_str().unwrap()).unwrap_or_else(|e| panic!("{e}")))
}

/// Objects, those that emit, groups, instances, materials, triangles before they are instanced.
fn counts(scene: &LoadedScene) -> [usize; 6] {
    let d = &scene.description;
    let lights = d.objects.iter().filter(|o| o.emission.is_some()).count();
    let all = d.objects.iter().chain(d.groups.iter().flat_map(|g| &g.objects));
    let triangles = all.map(|o| mesh(o).triangles.len()).sum();
    [d.objects.len(), lights, d.groups.len(), d.instances.len(), d.materials.len(), triangles]
}

#[test]
fn small_files_load() {
    for (name, expected) in [
        ("CornellBox", [6, 1, 0, 0, 5, 36]),
        ("alien", [18, 0, 0, 0, 5, 292]),
        ("tile", [2, 0, 0, 0, 2, 20]),
        ("cakeBirthday", [7, 0, 1, 5, 7, 444]),
    ] {
        let Some(scene) = shared(&format!("gltf-small/{name}.glb")) else { return };
        assert_eq!(counts(&scene), expected, "{name}");
        let lit = scene.notes.iter().any(|n| n.contains("no light"));
        assert_eq!(lit, name != "CornellBox", "{name}: {:?}", scene.notes);
    }
}

#[test]
fn the_flight_helmet_loads() {
    let Some(scene) = shared("gltf-flight-helmet/FlightHelmet.gltf") else { return };
    assert_eq!(counts(&scene), [6, 0, 0, 0, 6, 94722]);
    assert_eq!(scene.notes.len(), 2, "{:?}", scene.notes);
    for object in &scene.description.objects {
        let m = mesh(object);
        assert_eq!((m.normals.len(), m.uvs.len()), (m.positions.len(), m.positions.len()), "{}", object.name);
        let Material::Relief { material, .. } = &scene.description.materials[object.material].material else {
            panic!("{} has no normal map", object.name)
        };
        let (inner, lenses) = match &**material {
            Material::Mask { material, .. } => (&**material, true),
            other => (other, false),
        };
        assert_eq!(lenses, object.name == "Lenses_low");
        let Material::Principled(p) = inner else { panic!("{inner:?}") };
        assert!(matches!(p.base_color, Texture::Bitmap { .. }) && matches!(p.roughness, Texture::Bitmap { .. }));
    }
}
