//! A study from its cells to its report, interrupted and gone on with.

use assert_cmd::Command;
use std::{
    fs,
    path::{Path, PathBuf},
};

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    let output =
        command.current_dir(folder).args(arguments).arg("--json").assert().success().get_output().stdout.clone();
    serde_json::from_slice(&output).unwrap()
}

const STUDY: [&str; 17] = [
    "study",
    "--techniques",
    "path",
    "--scenes",
    "furnace",
    "--reference",
    "r/furnace.exr",
    "--seconds",
    "0.05",
    "--replicates",
    "3",
    "--depth",
    "4",
    "--threads",
    "2",
    "--out",
    "s",
];

fn lines(folder: &Path) -> Vec<serde_json::Value> {
    let text = fs::read_to_string(folder.join("s/results.jsonl")).unwrap();
    text.lines().map(|l| serde_json::from_str(l).unwrap()).collect()
}

/// A folder with a reference in it.
fn prepared() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_owned();
    let reference =
        ["reference", "--scenes", "furnace,cornell", "--passes", "8", "--size", "10x8", "--depth", "4", "--out", "r"];
    let made = json(&path, &reference);
    // The furnace's radiance is known, so nothing is rendered and nothing is uncertain; the other scene's is not.
    assert_eq!((&made["furnace"]["passes"], &made["furnace"]["width"]), (&0.into(), &10.into()));
    assert_eq!(made["furnace"]["relmse"].as_f64().unwrap(), 0.0);
    assert_eq!(made["cornell"]["passes"], 8);
    assert!(made["cornell"]["relmse"].as_f64().unwrap() > 0.0);
    assert!(path.join("r/reference.json").exists());
    (folder, path)
}

#[test]
fn a_study_is_run_once_resumed_and_reported() {
    let (_folder, path) = prepared();
    let first = json(&path, &STUDY);
    assert_eq!((&first["cells_run"], &first["cells_kept"]), (&3.into(), &0.into()));
    let results = fs::read(path.join("s/results.jsonl")).unwrap();
    let all = lines(&path);
    for field in [
        "scene",
        "scene_hash",
        "technique",
        "knobs",
        "sampler",
        "size",
        "depth",
        "seed",
        "replicate",
        "passes",
        "build_seconds",
        "seconds",
        "cpu_seconds",
        "rays",
        "mse",
        "relmse",
        "relmse_trimmed",
        "trimmed_share",
        "smape",
        "mean_error",
        "bias2",
        "variance",
        "rejected",
        "peak_bytes",
    ] {
        assert!(all.iter().all(|l| l.get(field).is_some()), "{field}");
    }
    let of =
        |replicate: u32| -> Vec<&serde_json::Value> { all.iter().filter(|l| l["replicate"] == replicate).collect() };
    let passes = |replicate| of(replicate).iter().map(|l| l["passes"].as_u64().unwrap()).collect::<Vec<_>>();
    // Doubling, then the last; all replicates alike.
    assert!(passes(0).windows(3).all(|w| w[1] == 2 * w[0]) && passes(0)[0] == 1, "{:?}", passes(0));
    assert_eq!((passes(1), passes(2)), (passes(0), passes(0)));
    // Squared bias and variance add up to the mean of the replicates' errors, and replicates differ.
    for i in 0..of(0).len() {
        let mse: Vec<f64> = (0..3).map(|r| of(r)[i]["mse"].as_f64().unwrap()).collect();
        let sum = of(0)[i]["bias2"].as_f64().unwrap() + of(0)[i]["variance"].as_f64().unwrap();
        let mean = mse.iter().sum::<f64>() / 3.0;
        assert!((sum - mean).abs() < 1e-6 * mean, "{sum} {mean}");
        assert!(mse[0] != mse[1] && mse[1] != mse[2]);
    }

    // Again: nothing is run and nothing changes.
    let second = json(&path, &STUDY);
    assert_eq!((&second["cells_run"], &second["cells_kept"]), (&0.into(), &3.into()));
    assert_eq!(fs::read(path.join("s/results.jsonl")).unwrap(), results);

    // Interrupted while the last cell was being written: that cell alone is run again.
    fs::write(path.join("s/results.jsonl"), &results[..results.len() - 300]).unwrap();
    let third = json(&path, &STUDY);
    assert_eq!((&third["cells_run"], &third["cells_kept"]), (&1.into(), &2.into()));
    let errors = |lines: &[serde_json::Value]| lines.iter().map(|l| l["mse"].clone()).collect::<Vec<_>>();
    assert_eq!(errors(&lines(&path)), errors(&all));

    // Another key is other cells.
    let deeper: Vec<&str> = STUDY.iter().map(|a| if *a == "4" { "3" } else { a }).collect();
    assert_eq!(json(&path, &deeper)["cells_run"], 3);
    assert_eq!(json(&path, &STUDY)["cells_run"], 0);

    let page = fs::read_to_string(path.join("s/report.html")).unwrap();
    for part in [
        "<svg class=\"chart\"",
        "class=\"slider\"",
        "type=\"range\"",
        "to 10 %<br>",
        "error map",
        "bias²",
        "What the scene calls for",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("<svg class=\"chart\"").count(), 2);
    assert!(page.contains("cargo xtask study --techniques path --scenes furnace"));
    for outside in ["http://", "https://", "src=\"/", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(!page.contains("NaN"));
}

#[test]
fn without_names_every_technique_is_studied_that_shows_what_mirrors_show() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let tiny = ["--passes", "4", "--size", "8", "--depth", "4", "--out", "r"];
    json(at, &[&["reference", "--scenes", "cornell,ring"], &tiny[..]].concat());
    for (scene, left_out) in [("cornell", &[][..]), ("ring", &["light"])] {
        let reference = format!("r/{scene}.exr");
        let study = ["study", "--scenes", scene, "--reference", &reference, "--out", scene, "--depth", "4"];
        let short = [&study[..], &["--seconds", "0.02", "--replicates", "2"]].concat();
        let report = json(at, &short);
        let names: Vec<&str> =
            report["summary"].as_array().unwrap().iter().map(|r| r["technique"].as_str().unwrap()).collect();
        for technique in ["path", "light", "bidir", "photon", "sppm"] {
            let studied = names.iter().any(|name| name.split(' ').next() == Some(technique));
            assert_eq!(studied, !left_out.contains(&technique), "{scene}: {names:?}");
        }
        let gaps: Vec<&str> = report["gaps"].as_array().unwrap().iter().map(|g| g.as_str().unwrap()).collect();
        assert_eq!(gaps.len(), left_out.len(), "{gaps:?}");
        assert!(
            gaps.iter().all(|g| g.starts_with("ring: light is not studied; left out by light: surfaces")),
            "{gaps:?}"
        );

        // What is printed says what the columns mean, and ends with the technique to take.
        let output = Command::new(env!("CARGO_BIN_EXE_xtask")).current_dir(at).args(&short).assert().success();
        let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
        assert!(text.starts_with("to 10 %, 3 %, 1 %: time until the error is that"), "{text}");
        assert_eq!(text.lines().last().unwrap(), report["advice"][0]["text"].as_str().unwrap());
        assert!(text.lines().last().unwrap().starts_with(&format!("{scene}: ")), "{text}");
        // Light tracing is studied where it is asked for.
        let asked = json(at, &[&short[..], &["--techniques", "light"]].concat());
        assert!(asked["summary"].as_array().unwrap().iter().any(|r| r["technique"] == "light"));
    }
}

#[test]
fn two_studies_do_not_write_to_one_folder() {
    let (_folder, path) = prepared();
    fs::create_dir(path.join("s")).unwrap();
    let lock = fs::File::create(path.join("s/.lock")).unwrap();
    lock.lock().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    let output = command.current_dir(&path).args(STUDY).assert().code(2).get_output().clone();
    assert!(String::from_utf8(output.stderr).unwrap().contains("another study"));
}
