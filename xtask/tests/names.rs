//! Scenes and files by names in any script: none is lost, and none is written over another scene's.

use assert_cmd::{Command, assert::Assert};
use std::{fs, path::Path};
use tempfile::TempDir;
use xtask::exr_file::{Attribute, ExrFile};

/// A lit ball; `level` tells scenes apart.
fn scene(level: f32) -> String {
    format!(
        "<scene version=\"3.0.0\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"3\"/></integrator>\
         <sensor type=\"perspective\"><transform name=\"to_world\"><lookat origin=\"0,0,-4\" target=\"0,0,0\" \
         up=\"0,1,0\"/></transform><film type=\"hdrfilm\"><integer name=\"width\" value=\"8\"/>\
         <integer name=\"height\" value=\"6\"/></film></sensor><shape type=\"sphere\"/>\
         <emitter type=\"constant\"><rgb name=\"radiance\" value=\"{level}\"/></emitter></scene>"
    )
}

fn xtask(folder: &Path, arguments: &[&str]) -> Assert {
    Command::new(env!("CARGO_BIN_EXE_xtask")).current_dir(folder).args(arguments).assert()
}

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let arguments = [arguments, &["--json"]].concat();
    serde_json::from_slice(&xtask(folder, &arguments).success().get_output().stdout).unwrap()
}

/// The message of a command that refuses.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = xtask(folder, arguments).code(2).get_output().clone();
    String::from_utf8(output.stderr).unwrap()
}

fn folder_with(scenes: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (i, name) in scenes.iter().enumerate() {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, scene(1.0 + i as f32)).unwrap();
    }
    folder
}

/// The scene that an image says it is of.
fn scene_of(folder: &TempDir, image: &str) -> Attribute {
    ExrFile::read(&folder.path().join(image)).unwrap().attributes["scene"].clone()
}

#[test]
fn every_command_takes_names_in_any_script() {
    for name in ["シーン/scene.xml", "сцена/мяч 1.xml", "é/ü.xml", "🦀/e\u{301}.xml"] {
        let folder = folder_with(&[name]);
        let at = folder.path();
        let render = |more: &[&str]| json(at, &[&["render", name], more].concat());
        let text = Attribute::Text(name.into());

        let report = render(&["--passes", "2", "--out", "画像.exr"]);
        assert_eq!((&report["scene"], &report["out"]), (&name.into(), &"画像.exr".into()));
        assert_eq!(scene_of(&folder, "画像.exr"), text);
        assert_eq!(render(&["--passes", "4", "--out", "画像.exr", "--resume"])["passes"], 4);
        render(&["--passes", "4", "--out", "целое.exr"]);
        render(&["--first-pass", "4", "--passes", "2", "--out", "二.exr"]);
        let merged = json(at, &["merge", "합.exr", "画像.film", "二.film"]);
        assert_eq!((&merged["passes"], scene_of(&folder, "합.exr")), (&6.into(), text.clone()));
        let difference = json(at, &["compare", "画像.exr", "целое.exr", "--out", "σφάλμα.png"]);
        assert_eq!((&difference["mse"], &difference["image"]), (&0.0.into(), &"画像.exr".into()));
        assert_eq!(json(at, &["pyramid", name, "--depth", "2", "--passes", "1", "--out", "π.exr"])["scene"], name);
        assert_eq!(scene_of(&folder, "π.exr"), text);
        assert_eq!(json(at, &["scene", name])["scene"], name);
        json(at, &["reference", "--scenes", name, "--passes", "4", "--size", "8", "--out", "参照"]);
        let study = ["study", "--scenes", name, "--reference", "целое.exr", "--seconds", "0.01", "--replicates", "2"];
        let study = [&study[..], &["--techniques", "path"]].concat();
        let first = json(at, &[&study[..], &["--out", "研究"]].concat());
        assert_eq!((&first["cells_run"], &first["summary"][0]["scene"]), (&2.into(), &name.into()));
        assert_eq!(json(at, &[&study[..], &["--out", "研究"]].concat())["cells_kept"], 2);
        // In words rather than JSON, and under the scene's own name.
        xtask(at, &["render", name, "--passes", "1"]).success();
        xtask(at, &["pyramid", name, "--depth", "2", "--passes", "1"]).success();
        let refused = refusal(at, &["render", name, "--knob", "света=1"]);
        assert!(refused.contains("света=1") && !refused.contains("panicked"), "{refused}");
    }
}

#[test]
#[cfg(unix)]
fn files_whose_names_are_no_text_are_written() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt};
    let folder = folder_with(&["a.xml"]);
    let out = OsStr::from_bytes(b"a\xff.exr");
    for json in [&["--json"][..], &[]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
        command.current_dir(folder.path()).args(["render", "a.xml", "--passes", "1", "--out"]).arg(out).args(json);
        command.assert().success();
        assert!(folder.path().join(out).exists());
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    let study = ["study", "--scenes", "a.xml", "--seconds", "0.01", "--replicates", "1", "--json", "--reference"];
    command.current_dir(folder.path()).args(study).arg(out).arg("--out").arg(OsStr::from_bytes(b"s\xfe"));
    command.assert().success();
}

#[test]
fn scenes_whose_names_are_alike_do_not_write_over_each_other() {
    let folder = folder_with(&["ü.xml", "é.xml", "e\u{301}.xml", "a/scene.xml", "b/scene.xml", "cornell.xml"]);
    let at = folder.path();
    for (name, image) in [("ü.xml", "ü.exr"), ("é.xml", "é.exr"), ("e\u{301}.xml", "e\u{301}.exr")] {
        xtask(at, &["render", name, "--passes", "1"]).success();
        assert_eq!(scene_of(&folder, image), Attribute::Text(name.into()));
    }
    assert_eq!(scene_of(&folder, "ü.exr"), Attribute::Text("ü.xml".into()));

    let refuses = |arguments: &[&str], owner: &str| {
        let text = refusal(at, arguments);
        assert!(text.contains(owner) && text.contains("--out"), "{arguments:?}: {text}");
    };
    xtask(at, &["render", "a/scene.xml", "--passes", "1"]).success();
    let before = fs::read(at.join("scene.exr")).unwrap();
    refuses(&["render", "b/scene.xml", "--passes", "1"], "`a/scene.xml`");
    assert_eq!(fs::read(at.join("scene.exr")).unwrap(), before);
    // The same file by another name, or edited, is the same scene.
    xtask(at, &["render", "./a/../a/scene.xml", "--passes", "1"]).success();
    fs::write(at.join("a/scene.xml"), scene(9.0)).unwrap();
    xtask(at, &["render", "a/scene.xml", "--passes", "1"]).success();
    assert_ne!(fs::read(at.join("scene.exr")).unwrap(), before);
    xtask(at, &["render", "b/scene.xml", "--passes", "1", "--out", "scene.exr"]).success();

    let pyramid = |scene| ["pyramid", scene, "--depth", "2", "--passes", "1", "--size", "8"];
    xtask(at, &pyramid("cornell.xml")).success();
    refuses(&pyramid("cornell"), "`cornell.xml`");
    let ring = ["render", "ring:light=0.5", "--passes", "1", "--size", "8"];
    xtask(at, &ring).success();
    fs::copy(at.join("é.xml"), at.join("ring_light=0.5.xml")).unwrap();
    refuses(&["render", "ring_light=0.5.xml"], "`ring:light=0.5`");

    // A film alone, as an interruption leaves it, and files that no render wrote.
    fs::remove_file(at.join("ring_light=0.5.exr")).unwrap();
    refuses(&["render", "ring_light=0.5.xml"], "`ring:light=0.5`");
    xtask(at, &ring).success();
    for texture in ["wall.png", "wall.exr", "wall.film"] {
        let folder = folder_with(&["wall.xml"]);
        fs::write(folder.path().join(texture), b"a texture").unwrap();
        assert!(refusal(folder.path(), &["render", "wall.xml"]).contains(texture), "{texture}");
        assert_eq!(fs::read(folder.path().join(texture)).unwrap(), b"a texture");
    }
}

#[test]
fn references_of_scenes_whose_names_are_alike_are_kept_apart() {
    let folder = folder_with(&["a/scene.xml", "b/scene.xml", "c/Scene.xml"]);
    let scenes = "a/scene.xml,b/scene.xml,c/Scene.xml";
    for _ in 0..2 {
        let arguments = ["reference", "--scenes", scenes, "--passes", "2", "--size", "8", "--out", "r"];
        let made = json(folder.path(), &arguments);
        assert_eq!(made.as_object().unwrap().len(), 3);
        let list = fs::read(folder.path().join("r/reference.json")).unwrap();
        let list: serde_json::Value = serde_json::from_slice(&list).unwrap();
        for (name, entry) in list.as_object().unwrap() {
            assert_eq!(entry["scene"], made[name]["scene"]);
            assert!(folder.path().join("r").join(format!("{name}.exr")).exists(), "{name}");
        }
        assert_eq!(list.as_object().unwrap().len(), 3);
    }
}
