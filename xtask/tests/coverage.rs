//! Light that a technique cannot render is named, and what is said is so.

use assert_cmd::Command;
use std::{fs, path::Path};

const TECHNIQUES: [&str; 5] = ["path", "light", "bidir", "photon", "sppm"];

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    let output = command.current_dir(folder).args(arguments).arg("--json").assert().success().get_output().clone();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    // A render warns before it begins.
    let said = String::from_utf8(output.stderr).unwrap();
    for gap in report["gaps"].as_array().unwrap().iter().filter(|_| arguments[0] == "render") {
        assert!(said.contains(&format!("warning: {}", gap.as_str().unwrap())), "{said}");
    }
    report
}

fn gaps(report: &serde_json::Value) -> Vec<&str> {
    report["gaps"].as_array().unwrap().iter().map(|g| g.as_str().unwrap()).collect()
}

const LAMP: &str = "<emitter type=\"point\" id=\"lamp\"><point name=\"position\" x=\"0\" y=\"3\" z=\"0\"/>\
                    <rgb name=\"intensity\" value=\"30\"/></emitter>";
const SKY: &str = "<emitter type=\"constant\"/>";
const FLOOR: &str = "<shape type=\"rectangle\"><transform name=\"to_world\"><rotate x=\"1\" angle=\"-90\"/>\
                     <scale value=\"2\"/></transform></shape>";
/// Between the lamp and the floor, wider than both; the camera's sight of the floor passes below it.
const SHEET: &str = "<shape type=\"rectangle\"><transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/>\
                     <scale value=\"40\"/><translate y=\"2.5\"/></transform>BSDF</shape>";
/// In front of the camera, all over the image.
const WINDOW: &str = "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"1\"/>\
                      <translate y=\"1\" z=\"3\"/></transform>BSDF</shape>";
const GLASS: &str = "<bsdf type=\"thindielectric\"/>";
const HOLES: &str = "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.2\"/><bsdf type=\"diffuse\">\
                     <rgb name=\"reflectance\" value=\"0\"/></bsdf></bsdf>";

fn scene(parts: &[&str]) -> String {
    format!(
        "<scene version=\"3.0.0\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"6\"/></integrator>\
         <sensor type=\"perspective\"><float name=\"fov\" value=\"30\"/><transform name=\"to_world\">\
         <lookat origin=\"0,1,3.5\" target=\"0,0,0\" up=\"0,1,0\"/></transform><film type=\"hdrfilm\">\
         <integer name=\"width\" value=\"8\"/><integer name=\"height\" value=\"8\"/></film></sensor>{}</scene>",
        parts.concat()
    )
}

/// The mean of an image of the floor.
fn mean(folder: &Path) -> f32 {
    let picture = xtask::exr_file::read_picture(&folder.join("s.exr")).unwrap();
    picture.pixels.iter().map(|p| p.g).sum::<f32>() / picture.pixels.len() as f32
}

#[test]
fn what_is_left_out_is_black_and_what_is_not_is_said_to_be_is_lit() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let of = |parts: &[&str], material: &str| scene(parts).replace("BSDF", material);
    // The scene, the parts that are rendered, and the techniques that leave the light out.
    let table: [(String, &str, &[&str]); 6] = [
        (of(&[LAMP, FLOOR, SHEET], GLASS), "caustic", &["path"]),
        (of(&[LAMP, FLOOR, SHEET], HOLES), "caustic", &["path"]),
        (of(&[LAMP, FLOOR, SHEET, WINDOW], GLASS), "caustic", &["path", "light", "bidir"]),
        (of(&[LAMP, FLOOR, SHEET, WINDOW], HOLES), "caustic", &["path", "light", "bidir"]),
        (of(&[SKY, FLOOR, WINDOW], GLASS), "environment", &["light"]),
        (of(&[SKY, FLOOR, WINDOW], HOLES), "environment", &["light"]),
    ];
    for (text, part, left_out) in table {
        fs::write(at.join("s.xml"), &text).unwrap();
        for technique in TECHNIQUES {
            let arguments = ["render", "s.xml", "--technique", technique, "--passes", "16", "--parts", part];
            let report = json(at, &[&arguments[..], &["--out", "s.exr"]].concat());
            let (gaps, mean) = (gaps(&report), mean(at));
            let said = gaps.iter().any(|g| g.starts_with(&format!("left out by {technique}: ")));
            let black = mean == 0.0;
            assert_eq!(black, left_out.contains(&technique), "{technique}, {part}: {mean}, {gaps:?}\n{text}");
            assert!(said || !black, "{technique} says nothing of {part} in\n{text}");
            assert!(
                gaps.iter().all(|g| !text.contains("lamp") || g.contains("`lamp`") || g.contains("whatever")),
                "{gaps:?}"
            );
        }
    }
}

#[test]
fn knobs_that_leave_light_out_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("s.xml"), scene(&[LAMP, FLOOR, SHEET]).replace("BSDF", GLASS)).unwrap();
    // Without final gathering too, as it finds a little of it.
    let photon = ["render", "s.xml", "--technique", "photon", "--knob", "indirect=0", "--parts", "caustic"];
    for (knob, left_out) in [("caustic_photons=0", true), ("caustic_photons=1000", false)] {
        let report = json(at, &[&photon[..], &["--passes", "4", "--out", "s.exr", "--knob", knob]].concat());
        assert_eq!((mean(at) == 0.0, gaps(&report).is_empty()), (left_out, !left_out), "{knob}: {report}");
    }
}

#[test]
fn light_that_nothing_renders_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let sun =
        "<emitter type=\"directional\" id=\"sun\"><vector name=\"direction\" x=\"0\" y=\"-0.3\" z=\"-1\"/></emitter>";
    let ball = "<shape type=\"sphere\"><bsdf type=\"dielectric\"/></shape>";
    fs::write(at.join("s.xml"), scene(&[sun, ball])).unwrap();
    for technique in TECHNIQUES {
        let report = json(at, &["render", "s.xml", "--technique", technique, "--passes", "2", "--out", "s.exr"]);
        assert_eq!(mean(at), 0.0);
        let gaps = gaps(&report);
        assert!(gaps.len() == 1 && gaps[0].contains("the directional light `sun`"), "{gaps:?}");
        assert!(
            gaps[0].starts_with(&format!("left out by {technique}")) && gaps[0].contains("no technique"),
            "{gaps:?}"
        );
        // Nothing is missing from what is not asked for, or would be too long.
        for more in [["--parts", "direct"], ["--depth", "1"]] {
            let arguments = ["render", "s.xml", "--technique", technique, "--passes", "1", "--out", "s.exr"];
            assert_eq!(json(at, &[&arguments[..], &more].concat())["gaps"], serde_json::json!([]));
        }
    }
    let report = json(at, &["scene", "s.xml"]);
    assert!(gaps(&report)[0].starts_with("left out by path, light, bidir, photon, sppm: the directional light `sun`"));

    let reference = ["render", "s.xml", "--technique", "sppm", "--passes", "1", "--out", "r.exr"];
    json(at, &reference);
    let study = ["study", "--scenes", "s.xml", "--reference", "r.exr", "--seconds", "0.01", "--replicates", "1"];
    let report = json(at, &[&study[..], &["--techniques", "path,bidir"]].concat());
    let said = gaps(&report);
    assert!(said[0].starts_with("s.xml: left out by path, bidir: ") && said[0].contains("`sun`"), "{said:?}");
    let page = fs::read_to_string(at.join("study/report.html")).unwrap();
    assert!(page.contains("left out by path, bidir: the directional light `sun`"));
}

#[test]
fn nothing_is_said_where_nothing_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for technique in TECHNIQUES {
        let tiny = ["--size", "8", "--passes", "1", "--technique", technique, "--out", "a.exr"];
        assert!(gaps(&json(at, &[&["render", "cornell"], &tiny[..]].concat())).is_empty(), "{technique}");
        // Lights with an extent are found by chance through glass, but not surfaces by light tracing.
        let gaps = gaps(&json(at, &[&["render", "glass-ball"], &tiny[..]].concat())).len();
        assert_eq!(gaps, usize::from(technique == "light"), "{technique}");
    }
}
