//! The arrows of the workspace: external crates, then the core, then everything else, then xtask, then these tests.
//! No technique knows another.

use std::{fs, path::Path};

/// The `etendue-*` packages among a manifest's dependencies (not its dev-dependencies).
fn own_dependencies(manifest: &str) -> Vec<String> {
    let mut inside = false;
    let mut found = Vec::new();
    for line in manifest.lines().map(str::trim) {
        if line.starts_with('[') {
            inside = line == "[dependencies]" || line.starts_with("[dependencies.") || line.ends_with(".dependencies]");
        }
        let name: String = line.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '-').collect();
        if inside && (name.starts_with("etendue-") || name == "xtask") {
            found.push(name);
        }
    }
    found
}

#[test]
fn a_technique_depends_on_the_core_alone() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let mut seen = 0;
    for entry in fs::read_dir(&crates).expect("crates/ is there") {
        let folder = entry.expect("crates/ can be listed").path();
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).expect("every crate has a manifest");
        let expected: &[&str] = if folder.ends_with("core") { &[] } else { &["etendue-core"] };
        assert_eq!(own_dependencies(&manifest), expected, "{}", folder.display());
        seen += 1;
    }
    assert!(seen >= 3, "only {seen} crates found");
}

#[test]
fn the_core_and_the_techniques_stay_light() {
    // No files, no command line, no plots: what a person adds to their own renderer.
    let heavy = ["clap", "image", "exr", "serde", "serde_json", "indicatif", "plotters", "roxmltree", "gltf"];
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    for entry in fs::read_dir(crates).expect("crates/ is there") {
        let folder = entry.expect("crates/ can be listed").path();
        if folder.ends_with("scenes") {
            continue;
        }
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).expect("every crate has a manifest");
        let dependencies = manifest.split("[dev-dependencies]").next().unwrap_or_default();
        for name in heavy {
            let used =
                dependencies.lines().any(|l| l.starts_with(&format!("{name}.")) || l.starts_with(&format!("{name} ")));
            assert!(!used, "{} depends on {name}", folder.display());
        }
    }
}
