//! Scene files that others made. They lie beside the repository, or where `ETENDUE_SHARED` says; without them the tests
//! say so and pass.

use etendue_core::{
    filter::Filter,
    lights::environment::{Environment, Rows},
    scene::ObjectShape,
};
use etendue_scenes::{LoadedScene, load};
use std::path::PathBuf;

fn shared(name: &str) -> Option<LoadedScene> {
    let root = std::env::var_os("ETENDUE_SHARED")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")), PathBuf::from);
    let path = root.join(name);
    if !path.exists() {
        eprintln!("skipped: {} is not there (set ETENDUE_SHARED)", path.display());
        return None;
    }
    Some(load(path.to_str().unwrap()).unwrap_or_else(|e| panic!("{e}")))
}

/// Objects, objects that emit, materials, triangles of meshes from files.
fn counts(scene: &LoadedScene) -> (usize, usize, usize, usize) {
    let d = &scene.description;
    let triangles = |shape: &ObjectShape| match shape {
        ObjectShape::Mesh(mesh) => mesh.triangles.len(),
        _ => 0,
    };
    let lights = d.objects.iter().filter(|o| o.emission.is_some()).count();
    assert!(d.objects.iter().all(|o| o.material < d.materials.len()));
    (d.objects.len(), lights, d.materials.len(), d.objects.iter().map(|o| triangles(&o.shape)).sum())
}

#[test]
fn scenes_for_comparison_load() {
    for (name, expected, max_depth) in [
        ("ajar-door", (15, 1, 6, 0), 12),
        ("cornell", (8, 1, 4, 0), 10),
        ("env-diffuse", (7, 0, 6, 0), 10),
        ("glass-caustic", (8, 1, 6, 0), 12),
        ("many-lights", (365, 64, 5, 8192), 10),
        ("ring-caustic", (3, 1, 3, 3072), 8),
        ("veach-mis", (11, 5, 6, 8), 10),
    ] {
        let Some(scene) = shared(&format!("peers/scenes/{name}.xml")) else { return };
        assert_eq!(counts(&scene), expected, "{name}");
        assert_eq!((scene.max_depth, scene.roulette_depth, scene.samples), (max_depth, 5, Some(64)), "{name}");
        assert_eq!(scene.filter, Filter::Box);
        assert_eq!(scene.description.camera.unwrap().resolution.to_array(), [256, 256]);
        assert_eq!(scene.notes, Vec::<String>::new(), "{name}");
    }
}

#[test]
fn the_environment_for_comparison_loads() {
    let Some(scene) = shared("peers/scenes/env-diffuse.xml") else { return };
    let Some(Environment::LatLong { image, rows, scale, .. }) = scene.description.environment else {
        panic!("no environment")
    };
    assert_eq!((image.width, image.height, rows, scale), (512, 256, Rows::PoleToPole, 1.0));
    assert!(image.texels.iter().all(|t| t.is_valid()));
    assert!(image.texels.iter().any(|t| !t.is_black()));
}

#[test]
fn published_scenes_load() {
    for (name, expected, max_depth, resolution) in [
        ("cornell-box", (8, 1, 8, 0), 30, [1024, 1024]),
        ("veach-mis", (9, 3, 6, 0), 3, [1280, 720]),
        ("veach-bidir", (14, 2, 4, 11540), 7, [1024, 1024]),
    ] {
        let Some(scene) = shared(&format!("scenes/{name}/scene.xml")) else { return };
        assert_eq!(counts(&scene), expected, "{name}");
        assert_eq!(scene.max_depth, max_depth, "{name}");
        assert_eq!(scene.filter, Filter::Tent { radius: 1.0 });
        assert_eq!(scene.description.camera.unwrap().resolution.to_array(), resolution);
    }
}
