//! The commands as a user types them.

use assert_cmd::{Command, assert::Assert};
use std::{
    fs,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

fn xtask(folder: &Path, arguments: &[&str]) -> Assert {
    Command::new(env!("CARGO_BIN_EXE_xtask")).current_dir(folder).args(arguments).assert()
}

/// Runs with `--json` and returns what stands alone on standard output.
fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let arguments = [arguments, &["--json"]].concat();
    let output = xtask(folder, &arguments).success().get_output().stdout.clone();
    serde_json::from_slice(&output).unwrap()
}

/// What the command says when it refuses: one line, exit code 2, no panic.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = xtask(folder, arguments).code(2).get_output().clone();
    assert!(output.stdout.is_empty(), "{arguments:?} printed something");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.starts_with("error: ") && !text.contains("panicked"), "{arguments:?}: {text}");
    text
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn read(folder: &TempDir, name: &str) -> xtask::exr_file::ExrFile {
    xtask::exr_file::ExrFile::read(&folder.path().join(name)).unwrap()
}

const TINY: [&str; 4] = ["render", "cornell", "--size", "16x12"];

fn render(folder: &TempDir, more: &[&str]) -> serde_json::Value {
    json(folder.path(), &[&TINY, more].concat())
}

#[test]
fn every_command_helps() {
    let folder = folder();
    xtask(folder.path(), &["--help"]).success();
    for command in [
        "study",
        "render",
        "pyramid",
        "merge",
        "compare",
        "reference",
        "sampling",
        "scene",
        "scenes",
        "techniques",
        "check",
    ] {
        let output = xtask(folder.path(), &[command, "--help"]).success().get_output().stdout.clone();
        assert!(String::from_utf8(output).unwrap().contains("Examples:"), "{command}");
    }
}

#[test]
fn lists() {
    let folder = folder();
    let names = |list: serde_json::Value| -> Vec<String> {
        list.as_array().unwrap().iter().map(|e| e["name"].as_str().unwrap().to_owned()).collect()
    };
    let scenes = names(json(folder.path(), &["scenes"]));
    for scene in xtask::cli::QUICK_SCENES {
        assert!(scenes.iter().any(|s| s == scene), "{scene}");
    }
    assert!(names(json(folder.path(), &["techniques"])).contains(&"path".to_owned()));
    xtask(folder.path(), &["scenes"]).success();
    xtask(folder.path(), &["techniques"]).success();
    let steps = xtask(folder.path(), &["check", "--list"]).success().get_output().stdout.clone();
    assert!(String::from_utf8(steps).unwrap().contains("cargo clippy"));
}

#[test]
fn a_scene_is_described() {
    let folder = folder();
    let report = json(folder.path(), &["scene", "cornell"]);
    assert_eq!((&report["scene"], &report["width"], &report["depth"]), (&"cornell".into(), &128.into(), &12.into()));
    assert_eq!((&report["lights"]["area"], &report["lights"]["area_elements"]), (&1.into(), &2.into()));
    assert!(report["triangles"].as_u64().unwrap() > 0);
    for positive in ["/load/seconds", "/build/seconds", "/memory/geometry_bytes", "/memory/bytes_per_triangle"] {
        assert!(report.pointer(positive).unwrap().as_f64().unwrap() > 0.0, "{positive}");
    }
    let effects = report["effects"].as_array().unwrap();
    assert!(effects.iter().any(|line| line.as_str().unwrap().starts_with("caustics: none")), "{effects:?}");
    let text = xtask(folder.path(), &["scene", "sky:width=64"]).success().get_output().stdout.clone();
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("images     1, 2048 texels, 24.6 kB") && text.contains("1 environment"), "{text}");
}

#[test]
fn what_a_file_has_that_is_not_supported_is_left_out_if_that_is_asked_for() {
    let folder = folder();
    fs::create_dir(folder.path().join("scene")).unwrap();
    let text = "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\"/>\n\
                <shape type=\"hair\"/><emitter type=\"constant\"/><shape type=\"obj\"><string name=\"filename\" \
                value=\"../t.obj\"/></shape></scene>";
    fs::write(folder.path().join("scene/s.xml"), text).unwrap();
    fs::write(folder.path().join("t.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert!(refusal(folder.path(), &["scene", "scene/s.xml"]).contains("scene/s.xml:2:14: the shape type `hair`"));
    let lenient = json(folder.path(), &["scene", "scene/s.xml", "--lenient"]);
    let notes: Vec<_> = lenient["notes"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    assert!(notes[0].starts_with("scene/s.xml:2:14: ") && notes[0].ends_with("it is left out"), "{notes:?}");
    assert!(notes[1].contains("without --allow-outside"), "{notes:?}");
    assert_eq!((&lenient["triangles"], &lenient["lights"]["environment"]), (&0.into(), &true.into()));
    let outside = json(folder.path(), &["scene", "scene/s.xml", "--lenient", "--allow-outside"]);
    assert_eq!((&outside["triangles"], outside["notes"].as_array().unwrap().len()), (&1.into(), 1));
    let tiny = ["--size", "8x8", "--passes", "1"];
    assert!(refusal(folder.path(), &[&["render", "scene/s.xml"], &tiny[..]].concat()).contains("hair"));
    json(folder.path(), &[&["render", "scene/s.xml", "--lenient", "--allow-outside"], &tiny[..]].concat());
}

#[test]
fn bad_input_is_refused() {
    let folder = folder();
    let at = |name: &str| -> PathBuf { folder.path().join(name) };
    render(&folder, &["--passes", "2", "--out", "good.exr"]);
    json(folder.path(), &["render", "cornell", "--size", "8x8", "--passes", "1", "--out", "small.exr"]);
    let good = fs::read(at("good.exr")).unwrap();
    fs::write(at("cut.exr"), &good[..good.len() / 2]).unwrap();
    fs::write(at("empty.exr"), []).unwrap();
    let film = fs::read(at("good.film")).unwrap();
    fs::write(at("cut.film"), &film[..film.len() - 100]).unwrap();
    fs::write(at("noise.film"), vec![7; 4096]).unwrap();
    fs::write(at("broken.xml"), "<scene version=\"3.0.0\"><nonesuch/></scene>").unwrap();
    fs::write(at("mask.png"), b"not a png").unwrap();
    let table: &[(&[&str], &[&str])] = &[
        (&["compare", "missing.exr", "good.exr"], &["missing.exr"]),
        (&["compare", "cut.exr", "good.exr"], &["cut.exr"]),
        (&["compare", "good.exr", "empty.exr"], &["empty.exr"]),
        (&["compare", "good.exr", "broken.xml"], &["broken.xml"]),
        (&["compare", "good.exr", "small.exr"], &["16x12", "8x8"]),
        (&["compare", "good.exr", "good.exr", "--mask", "mask.png"], &["mask.png"]),
        (&["compare", "good.exr", "good.exr", "--mask", "small.exr"], &["small.exr", "8x8"]),
        (&["compare", "good.exr", "good.exr", "--out", "no/where/a.png"], &["no/where"]),
        (&["render", "nonesuch"], &["nonesuch"]),
        (&["render", "missing.xml"], &["missing.xml"]),
        (&["render", "broken.xml"], &["broken.xml", "nonesuch"]),
        (&["render", "many-lights:n=none"], &["none"]),
        (&["render", "many-lights:m=3"], &["m"]),
        (&["render", "cornell", "--technique", "nonesuch"], &["nonesuch", "path"]),
        (&["render", "cornell", "--sampler", "nonesuch"], &["nonesuch", "independent"]),
        (&["render", "cornell", "--knob", "nonesuch=1"], &["nonesuch"]),
        (&["render", "cornell", "--knob", "nonesuch"], &["nonesuch"]),
        (&["study", "--techniques", "path", "--knob", "sppm.alpha=0.5"], &["sppm.alpha=0.5", "not studied"]),
        (&["study", "--knob", "alpha=0.5"], &["alpha=0.5", "technique.name=value"]),
        (&["study", "--knob", "path.nonesuch=1"], &["nonesuch", "light_candidates"]),
        (&["render", "cornell", "--parts", "direct,nonesuch"], &["nonesuch"]),
        (&["render", "cornell", "--size", "0x0"], &["0x0", "at least 1"]),
        (&["render", "cornell", "--size", "100000x100000"], &["100000x100000"]),
        (&["render", "cornell", "--depth", "0"], &["depth"]),
        (&["render", "cornell", "--passes", "0"], &["passes"]),
        (&["render", "cornell", "--seconds=-1"], &["seconds"]),
        (&["render", "cornell", "--seconds", "NaN"], &["seconds"]),
        (&["render", "cornell", "--first-pass", "4294967295", "--passes", "2"], &["first-pass"]),
        (&["render", "cornell", "--out", "no/where/a.exr"], &["no/where"]),
        (&["render", "cornell", "--out", "a.tiff"], &["a.tiff", ".exr"]),
        (&["merge", "m.exr", "missing.film"], &["missing.film"]),
        (&["merge", "m.exr", "cut.film"], &["cut.film", "truncated"]),
        (&["merge", "m.exr", "noise.film"], &["noise.film", "not a film"]),
        (&["merge", "m.exr", "good.film", "good.film"], &["good.film", "pass 0 of seed 0"]),
        (&["merge", "m.exr", "good.film", "small.film"], &["small.film", "size"]),
        (&["merge", "no/where/m.exr", "good.film"], &["no/where"]),
        (&["study", "--scenes", "cornell,nonesuch", "--out", "s"], &["nonesuch"]),
        (&["study", "--scenes", "cornell", "--techniques", "nonesuch", "--out", "s"], &["nonesuch"]),
        (&["study", "--scenes", "cornell", "--reference", "missing.exr", "--out", "s"], &["missing.exr"]),
        (&["study", "--scenes", "cornell", "--reference", "good.exr", "--size", "8", "--out", "s"], &["16x12", "8x8"]),
        (&["study", "--scenes", "cornell,sky", "--reference", "good.exr", "--out", "s"], &["--reference"]),
        (&["study", "--scenes", "cornell", "--out", "good.exr/s"], &["good.exr/s"]),
        (&["reference", "--scenes", "nonesuch", "--out", "r"], &["nonesuch"]),
        (&["scene", "nonesuch"], &["nonesuch"]),
        (&["scene", "broken.xml"], &["broken.xml", "nonesuch"]),
        (&["pyramid", "nonesuch"], &["nonesuch"]),
        (&["pyramid", "cornell", "--out", "no/where/a.exr"], &["no/where"]),
        (&["pyramid", "cornell", "--out", "a.png"], &["a.png", ".exr"]),
        (&["pyramid", "cornell", "--heuristic", "nonesuch"], &["nonesuch", "balance"]),
        (&["pyramid", "cornell", "--depth", "0"], &["depth"]),
        (&["pyramid", "cornell", "--size", "4096", "--depth", "32"], &["4 GiB"]),
        (&["study", "--scenes", "cornell", "--region", "caustic:2", "--out", "s"], &["share"]),
        (&["reference", "--technique", "nonesuch", "--out", "r"], &["nonesuch"]),
        (&["nonesuch"], &["nonesuch"]),
    ];
    for (arguments, said) in table {
        let text = refusal(folder.path(), arguments);
        for word in *said {
            assert!(text.contains(word), "{arguments:?} should say `{word}`: {text}");
        }
    }
    let leftovers = fs::read_dir(folder.path())
        .unwrap()
        .filter(|e| e.as_ref().unwrap().file_name().to_string_lossy().starts_with(".etendue"));
    assert_eq!(leftovers.count(), 0);
}

#[test]
fn a_render_says_where_it_comes_from_and_what_it_cost() {
    use xtask::exr_file::Attribute;
    let folder = folder();
    let report =
        render(&folder, &["--passes", "3", "--seed", "18446744073709551615", "--depth", "4", "--out", "a.exr"]);
    assert_eq!((&report["passes"], &report["depth"], &report["width"]), (&3.into(), &4.into(), &16.into()));
    assert_eq!(report["rays"]["camera"], 3 * 16 * 12);
    for positive in ["seconds", "cpu_seconds", "rays_per_second", "rays_total"] {
        assert!(report[positive].as_f64().unwrap() > 0.0, "{positive}");
    }
    assert_eq!((&report["rejected"], &report["interrupted"]), (&0.into(), &false.into()));
    let file = read(&folder, "a.exr");
    let text = |t: &str| Attribute::Text(t.into());
    assert_eq!(file.attributes["scene"], text("cornell"));
    assert_eq!(file.attributes["technique"], text("path"));
    assert_eq!(file.attributes["seed"], text("18446744073709551615"));
    assert_eq!(file.attributes["passes"], Attribute::Whole(3));
    assert_eq!(file.attributes["depth"], Attribute::Whole(4));
    assert!(matches!(file.attributes["seconds"], Attribute::Number(s) if s > 0.0));
    let png = image::open(folder.path().join("a.png")).unwrap();
    assert_eq!((png.width(), png.height()), (16, 12));
}

#[test]
fn a_pyramid_adds_up_to_the_image() {
    let folder = folder();
    let tiny = ["--size", "12x8", "--depth", "4", "--passes", "3", "--seed", "5"];
    let pyramid = |threads: &str, out: &str| {
        let arguments = [&["pyramid", "cornell"][..], &tiny, &["--threads", threads, "--out", out]].concat();
        json(folder.path(), &arguments)
    };
    let report = pyramid("1", "a.exr");
    pyramid("3", "b.exr");
    let file = read(&folder, "a.exr");
    assert_eq!(file.channels, read(&folder, "b.exr").channels);
    let strategies = report["strategies"].as_array().unwrap();
    assert_eq!((strategies.len(), &report["rejected"]), (1 + 3 + 4 + 5, &0.into()));
    let mut sum = vec![0.0; 12 * 8];
    for v in strategies {
        let layer = |name: &str| file.layer(&format!("s{}t{}.{name}.", v["s"], v["t"])).unwrap();
        for ((sum, unweighted), weighted) in sum.iter_mut().zip(layer("unweighted")).zip(layer("weighted")) {
            assert!(weighted.g >= 0.0 && weighted.g <= unweighted.g * 1.0001, "{v}");
            *sum += weighted.g;
        }
        // Every strategy finds light alone, but so few samples may all miss the lamp.
        let found = ["unweighted_mean", "weighted_mean"].iter().all(|mean| v[mean].as_f64().unwrap() > 0.0);
        assert!(found || v["s"] == 0, "{v}");
    }
    // These are the paths of the technique, which leaves out a choice of connections that contribute little.
    let bidir = ["render", "cornell", "--technique", "bidir", "--sampler", "independent"];
    let arguments = [&bidir[..], &tiny, &["--out", "image.exr"]].concat();
    json(folder.path(), &arguments);
    let (image, whole) = (read(&folder, "image.exr").layer("").unwrap(), file.layer("").unwrap());
    let (mut mean, mut whole_mean) = (0.0, 0.0);
    for ((image, whole), sum) in image.iter().zip(&whole).zip(&sum) {
        assert!((whole.g - sum).abs() <= 1e-5 * (1.0 + sum), "{whole:?} {sum}");
        mean += image.g;
        whole_mean += whole.g;
    }
    assert!((mean / whole_mean - 1.0).abs() < 0.03, "{mean} {whole_mean}");
    let png = image::open(folder.path().join("a.png")).unwrap();
    let height = 4 * (85 + 4) - 4;
    assert_eq!((png.width(), png.height()), (5 * (128 + 4) - 4, 2 * height + 24));
    xtask(folder.path(), &["pyramid", "furnace", "--size", "4", "--passes", "1"]).success();
    assert!(folder.path().join("furnace-pyramid.exr").exists() && folder.path().join("furnace-pyramid.png").exists());
}

#[test]
fn parts_rendered_apart_have_the_bits_of_one_render() {
    let folder = folder();
    render(&folder, &["--passes", "8", "--out", "whole.exr", "--threads", "1"]);
    render(&folder, &["--passes", "4", "--out", "a.exr", "--threads", "2"]);
    render(&folder, &["--first-pass", "4", "--passes", "4", "--out", "b.exr", "--threads", "2"]);
    let report = json(folder.path(), &["merge", "merged.exr", "b.film", "a.film"]);
    assert_eq!(report["runs"], serde_json::json!([{ "seed": 0, "first": 0, "end": 8 }]));
    let (whole, merged) = (read(&folder, "whole.exr"), read(&folder, "merged.exr"));
    assert_eq!(whole.channels, merged.channels);
    assert_ne!(whole.channels, read(&folder, "a.exr").channels);
    // Another seed is other passes, and adds up too.
    render(&folder, &["--seed", "1", "--passes", "8", "--out", "c.exr"]);
    let report = json(folder.path(), &["merge", "more.exr", "merged.film", "c.film"]);
    assert_eq!(report["passes"], 16);
    assert!(refusal(folder.path(), &["merge", "m.exr", "whole.film", "b.film"]).contains("pass 4 of seed 0"));
}

#[test]
fn a_resumed_render_has_the_bits_of_one_render() {
    let folder = folder();
    render(&folder, &["--passes", "6", "--out", "whole.exr"]);
    let first = render(&folder, &["--passes", "2", "--out", "a.exr", "--resume"]);
    assert_eq!(first["passes"], 2);
    let all = render(&folder, &["--passes", "6", "--out", "a.exr", "--resume"]);
    assert_eq!(all["passes"], 6);
    assert!(all["seconds"].as_f64() > first["seconds"].as_f64());
    assert_eq!(read(&folder, "a.exr").channels, read(&folder, "whole.exr").channels);
    // Nothing is left to do.
    assert_eq!(render(&folder, &["--passes", "6", "--out", "a.exr", "--resume"])["passes"], 6);
    for (option, value, said) in [("--seed", "5", "seed"), ("--depth", "3", "depth"), ("--size", "8x8", "size")] {
        let arguments = ["render", "cornell", "--size", "16x12", "--out", "a.exr", "--resume", option, value];
        let arguments =
            if option == "--size" { [&arguments[..2], &arguments[4..]].concat() } else { arguments.to_vec() };
        assert!(refusal(folder.path(), &arguments).contains(said), "{option}");
    }
    let film = fs::read(folder.path().join("a.film")).unwrap();
    fs::write(folder.path().join("a.film"), &film[..film.len() - 1]).unwrap();
    assert!(refusal(folder.path(), &[&TINY[..], &["--out", "a.exr", "--resume"]].concat()).contains("a.film"));
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_is_saved_and_goes_on() {
    let folder = folder();
    let arguments = [&TINY[..], &["--passes", "100000000", "--out", "a.exr", "--json"]].concat();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_xtask"));
    let command = command.current_dir(folder.path()).args(&arguments).stdout(std::process::Stdio::piped());
    let child = command.spawn().unwrap();
    // Whenever the signal comes, something must be right: before the handler stands it ends the process, before the first
    // pass nothing is saved. A second is ample for some passes of so few pixels, and what comes is checked below.
    std::thread::sleep(std::time::Duration::from_secs(1));
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{:?}", output.status);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["interrupted"], true);
    let passes = report["passes"].as_u64().unwrap();
    let target = (passes + 3).to_string();
    assert_eq!(render(&folder, &["--passes", &target, "--out", "a.exr", "--resume"])["passes"], passes + 3);
}

#[test]
fn comparison_gives_the_figures_and_names_what_is_no_number() {
    let folder = folder();
    let size = glam::UVec2::new(4, 2);
    let write = |name: &str, pixel: [f32; 3], bad: Option<f32>| {
        let mut file = xtask::exr_file::ExrFile { size, ..Default::default() };
        file.add_layer("", std::iter::repeat_n(pixel, 8));
        if let Some(bad) = bad {
            file.channels.get_mut("G").unwrap()[6] = bad;
        }
        file.write(&folder.path().join(name)).unwrap();
    };
    write("a.exr", [1.5; 3], None);
    write("b.exr", [1.0; 3], None);
    write("nan.exr", [1.0; 3], Some(f32::NAN));
    let report = json(folder.path(), &["compare", "a.exr", "b.exr", "--out", "map.png"]);
    let close = |name: &str, value: f64| {
        assert!((report[name].as_f64().unwrap() - value).abs() < 1e-12, "{name}: {}", report[name]);
    };
    close("mse", 0.25);
    close("relmse", 0.25 / 1.01);
    close("relmse_trimmed", 0.25 / 1.01);
    close("trimmed_share", 0.0);
    close("smape", 0.5 / 2.51);
    close("mean_error", 0.5);
    close("mean_error_relative", 0.5);
    assert!(folder.path().join("map.png").exists());

    let output = xtask(folder.path(), &["compare", "nan.exr", "b.exr", "--json"]).code(1).get_output().clone();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report["mse"].is_null());
    assert_eq!((&report["not_finite"][0]["channel"], &report["not_finite"][0]["nan"]), (&"G".into(), &1.into()));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("nan.exr: channel G holds 1 NaN") && said.contains("x 2, y 1"), "{said}");

    // Outside the mask nothing is looked at.
    let mut mask = image::RgbImage::from_pixel(4, 2, image::Rgb([255; 3]));
    mask.put_pixel(2, 1, image::Rgb([0; 3]));
    mask.save(folder.path().join("mask.png")).unwrap();
    let report = json(folder.path(), &["compare", "nan.exr", "b.exr", "--mask", "mask.png"]);
    assert_eq!((&report["pixels"], &report["mse"]), (&7.into(), &0.0.into()));
}

#[test]
fn sampling_is_studied() {
    let folder = folder();
    let tiny = ["sampling", "--trials", "4", "--most", "16", "--out", "s"];
    let summary = json(folder.path(), &tiny);
    // Twelve patterns on nine integrands.
    assert_eq!(summary["slopes"].as_array().unwrap().len(), 108);
    let at = |name: &str| folder.path().join("s").join(name);
    let page = fs::read_to_string(at("report.html")).unwrap();
    assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n") && !page.contains("NaN"));
    for pattern in etendue_sampling::pattern::Pattern::ALL {
        assert!(page.contains(pattern.name()), "{}", pattern.name());
    }
    roxmltree::Document::parse(&fs::read_to_string(at("slopes.svg")).unwrap()).unwrap();
    assert!(fs::read(at("patterns.png")).unwrap().starts_with(b"\x89PNG"));
    let results = |name: &str| -> serde_json::Value { serde_json::from_slice(&fs::read(at(name)).unwrap()).unwrap() };
    let first = results("results.json");
    let figures = |v: &serde_json::Value| {
        let mut v = v.clone();
        v.as_object_mut().unwrap().remove("command");
        v
    };
    // Whatever the number of threads.
    let output = xtask(folder.path(), &[&tiny[..], &["--threads", "1"]].concat()).success().get_output().stdout.clone();
    assert!(String::from_utf8(output).unwrap().contains("smooth-2d"));
    assert_eq!(figures(&first), figures(&results("results.json")));
    let left: Vec<_> = fs::read_dir(at("")).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left.len(), 4, "{left:?}");
}

#[test]
fn sampling_refuses_what_makes_no_sense() {
    let folder = folder();
    fs::write(folder.path().join("file"), b"").unwrap();
    for arguments in [
        ["--trials", "1"],
        ["--trials", "many"],
        ["--most", "3"],
        ["--most", "-4"],
        ["--seed", "x"],
        ["--threads", "0"],
        ["--out", "file"],
    ] {
        let arguments = [&["sampling"], &arguments[..]].concat();
        assert!(!refusal(folder.path(), &arguments).is_empty());
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
