//! Scene files that others made. They lie beside the repository, or where `ETENDUE_SHARED` says; without them the tests
//! say so and pass.

use etendue_core::{
    filter::Filter,
    lights::environment::{Environment, Rows},
    scene::ObjectShape,
};
use etendue_scenes::{LoadError, LoadOptions, LoadedScene, load, load_with};
use std::path::PathBuf;

/// A path of what others made, if it is there.
fn place(name: &str) -> Option<PathBuf> {
    let root = std::env::var_os("ETENDUE_SHARED")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")), PathBuf::from);
    let path = root.join(name);
    if !path.exists() {
        eprintln!("skipped: {} is not there (set ETENDUE_SHARED)", path.display());
        return None;
    }
    Some(path)
}

fn shared(name: &str) -> Option<LoadedScene> {
    Some(load(place(name)?.to_str().unwrap()).unwrap_or_else(|e| panic!("{e}")))
}

fn shared_with(name: &str, options: LoadOptions) -> Option<Result<LoadedScene, LoadError>> {
    Some(load_with(place(name)?.to_str().unwrap(), options))
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

/// Triangles as Mitsuba 3.9.1 counts them, where the folder's SOURCE.txt says so.
#[test]
fn whole_scenes_load() {
    for (name, expected, max_depth, resolution, lit_from_afar) in [
        ("staircase", (775, 1, 25, 262_661), 65, [720, 1280], false),
        ("living-room", (65, 0, 19, 143_163), 65, [1280, 720], true),
        ("classroom", (79, 0, 44, 103_832), 65, [1280, 720], true),
        ("teapot-env", (3, 0, 2, 126_048), 30, [1280, 720], true),
        ("manylights-pbrt", (901, 880, 22, 0), 16, [800, 800], false),
    ] {
        let Some(scene) = shared(&format!("scenes/{name}/scene.xml")) else { return };
        assert_eq!(counts(&scene), expected, "{name}");
        assert_eq!(scene.max_depth, max_depth, "{name}");
        assert_eq!(scene.description.camera.as_ref().unwrap().resolution.to_array(), resolution, "{name}");
        assert_eq!(scene.description.environment.is_some(), lit_from_afar, "{name}");
        // The staircase has a bump map that no shape uses.
        let expected: &[&str] =
            if name == "staircase" { &["the BSDF `without an id` is not used by a shape directly"] } else { &[] };
        assert_eq!(scene.notes, expected, "{name}");
    }
}

#[test]
fn daylight_loads() {
    let Some(scene) = shared("scenes/classroom/scene_sunsky.xml") else { return };
    assert!(matches!(scene.description.environment, Some(Environment::LatLong { rows: Rows::Centred, .. })));
    assert_eq!(scene.notes.len(), 1, "{:?}", scene.notes);
}

/// Files of version 0.6 whose meshes are not there: refused for it, and leniently without those meshes.
#[test]
fn older_files_load_as_far_as_their_files_are_there() {
    for name in ["living-room", "classroom"] {
        let name = format!("scenes/{name}/scene_v0.6_orig.xml");
        let Some(strict) = shared_with(&name, LoadOptions::default()) else { return };
        assert!(strict.is_err());
        let options = LoadOptions { lenient: true, ..LoadOptions::default() };
        let scene = shared_with(&name, options).unwrap().unwrap_or_else(|e| panic!("{e}"));
        assert!(scene.description.environment.is_some(), "{name}");
        assert!(scene.notes.iter().any(|n| n.contains("sppm")), "{name}: {:?}", scene.notes);
        assert!(scene.notes.iter().any(|n| n.contains("cannot read the file `models/")), "{name}");
    }
}

#[test]
fn scenes_of_every_feature_load() {
    let Some(root) = place("scenes/mitsuba-feature-tests") else { return };
    let mut files = Vec::new();
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && path.file_name().is_some_and(|n| n != "fragments") {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "xml") {
                files.push(path);
            }
        }
    }
    assert_eq!(files.len(), 25);
    for path in files {
        let spec = path.to_str().unwrap();
        let outside = LoadOptions { outside_folder: true, ..LoadOptions::default() };
        let scene = load_with(spec, outside).unwrap_or_else(|e| panic!("{e}"));
        let d = &scene.description;
        assert!(d.camera.is_some() && !(d.objects.is_empty() && d.instances.is_empty()), "{spec}");
        assert!(
            d.environment.is_some() || !d.lights.is_empty() || d.objects.iter().any(|o| o.emission.is_some()),
            "{spec}"
        );
        // What they share lies beside them, except for the Cornell boxes and what has no file.
        if std::fs::read_to_string(&path).unwrap().contains("<path") {
            assert!(load(spec).unwrap_err().to_string().contains("without --allow-outside"), "{spec}");
        }
    }
}
