//! Renders in parts, with samplers that relate the passes of a pixel to each other.

use assert_cmd::Command;
use std::path::Path;
use xtask::{exr_file::ExrFile, samplers::SAMPLERS};

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    let output = command.current_dir(folder).args(arguments).arg("--json").assert().success().get_output().clone();
    serde_json::from_slice(&output.stdout).unwrap()
}

fn render(folder: &Path, more: &[&str]) -> serde_json::Value {
    json(folder, &[&["render", "cornell", "--size", "8x6", "--depth", "3"], more].concat())
}

fn channels(folder: &Path, name: &str) -> std::collections::BTreeMap<String, Vec<f32>> {
    ExrFile::read(&folder.join(name)).unwrap().channels
}

#[test]
fn parts_have_the_bits_of_one_render_unless_the_sampler_plans() {
    // 16 passes is where sequences change their order if they are told.
    for sampler in SAMPLERS.iter().filter(|s| !s.plans) {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let of = |more: &[&str]| render(at, &[&["--sampler", sampler.name], more].concat());
        of(&["--passes", "40", "--out", "whole.exr"]);
        of(&["--passes", "5", "--out", "a.exr"]);
        of(&["--passes", "33", "--out", "a.exr", "--resume"]);
        of(&["--first-pass", "33", "--passes", "7", "--out", "b.exr"]);
        let merged = json(at, &["merge", "m.exr", "b.film", "a.film"]);
        assert_eq!(merged["runs"], serde_json::json!([{ "seed": 0, "first": 0, "end": 40 }]));
        assert_eq!(channels(at, "m.exr"), channels(at, "whole.exr"), "{}", sampler.name);
    }
    assert!(SAMPLERS.iter().any(|s| s.name == xtask::samplers::DEFAULT && !s.plans));
}

#[test]
fn films_of_other_seeds_add_up_to_their_mean() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for seed in ["1", "2"] {
        let report = render(at, &["--passes", "16", "--seed", seed, "--out", &format!("{seed}.exr")]);
        assert_eq!(report["sampler"], xtask::samplers::DEFAULT);
    }
    json(at, &["merge", "m.exr", "1.film", "2.film"]);
    let [one, two, merged] = ["1.exr", "2.exr", "m.exr"].map(|name| channels(at, name));
    assert_ne!(one, two);
    for (name, values) in &merged {
        for ((m, a), b) in values.iter().zip(&one[name]).zip(&two[name]) {
            assert!((m - 0.5 * (a + b)).abs() <= 1e-6 * (1.0 + m), "{name}: {m} of {a} and {b}");
        }
    }
    // By seconds no number of passes is planned.
    assert!(render(at, &["--seconds", "0.01", "--out", "s.exr"])["passes"].as_u64().unwrap() >= 1);
}
