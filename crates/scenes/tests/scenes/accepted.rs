//! Files as other programs write them and Mitsuba reads them.

use crate::files::{Folder, LENIENT, SETTINGS, described, flaw, material};
use etendue_core::{
    camera::Projection,
    filter::Filter,
    lights::environment::Environment,
    material::Material,
    rgb::Rgb,
    scene::{DeltaLight, ObjectShape},
    texture::Texture,
};
use etendue_scenes::{LoadOptions, LoadedScene};
use glam::{DVec2, DVec3};

const STRICT: LoadOptions = LoadOptions { lenient: false, outside_folder: false };

/// A file that is nothing but what is given.
fn whole(content: impl AsRef<[u8]>) -> Folder {
    Folder::new().with("scene.xml", content)
}

fn loaded(inner: &str) -> LoadedScene {
    whole(format!("<scene version=\"3.0.0\">{inner}</scene>")).load()
}

#[test]
fn a_scene_without_an_integrator_is_path_traced() {
    let scene = loaded("<sensor type=\"perspective\"/>");
    assert_eq!((scene.max_depth, scene.roulette_depth), (u32::MAX, 5));
    assert_eq!(scene.notes, ["the scene has no integrator: path tracing without a bound is taken"]);
}

#[test]
fn emitters_that_were_to_be_hidden_are_told() {
    let scene = |value| {
        let integrator =
            format!("<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"{value}\"/></integrator>");
        loaded(&format!("{integrator}<sensor type=\"perspective\"/>")).notes
    };
    assert_eq!(
        scene("true"),
        ["the integrator's hide_emitters has no effect: the camera sees emitters and the environment"]
    );
    assert!(scene("false").is_empty());
}

#[test]
fn what_does_not_change_the_image_is_passed_over() {
    let path =
        |inner: &str| loaded(&format!("<integrator type=\"path\">{inner}</integrator><sensor type=\"perspective\"/>"));
    let split = "<integer name=\"samples_per_pass\" value=\"3\"/><integer name=\"block_size\" value=\"32\"/>";
    assert!(path(split).notes.is_empty());
    assert_eq!(path("<float name=\"timeout\" value=\"9\"/>").notes, ["the integrator's timeout has no effect"]);
    let weight = "<float name=\"silhouette_sampling_weight\" value=\"1\"/>";
    let flat = "<boolean name=\"face_normals\" value=\"true\"/>";
    let shapes = format!("<shape type=\"sphere\">{weight}</shape><shape type=\"cube\">{flat}</shape>");
    assert_eq!(described(&shapes).objects.len(), 2);
    let notes = |inner: &str| Folder::new().scene(inner).notes(STRICT);
    assert_eq!(
        notes("<sensor type=\"orthographic\"/>"),
        ["the sensor in line 2 is passed over: the first one is taken"]
    );
    assert_eq!(notes("<texture type=\"checkerboard\"/>"), ["the checkerboard in line 2 is not used: it has no id"]);
    let twice = "<default name=\"r\" value=\"2\"/><default name=\"r\" value=\"3\"/>\
                 <shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>";
    assert_eq!(notes(twice), ["the default `r` is set a second time in line 2: the first one counts"]);
    assert!(matches!(described(twice).objects[0].shape, ObjectShape::Sphere { radius, .. } if radius == 2.0));
}

#[test]
fn one_number_counts_for_three() {
    let moved = "<shape type=\"sphere\"><transform name=\"to_world\"><translate value=\"2\"/></transform></shape>";
    assert_eq!(described(moved).objects[0].to_world.translation, DVec3::splat(2.0));
    let placed = "<shape type=\"sphere\"><point name=\"center\" value=\"3\"/></shape>";
    assert!(
        matches!(described(placed).objects[0].shape, ObjectShape::Sphere { center, .. } if center == DVec3::splat(3.0))
    );
}

#[test]
fn merged_shapes_are_shapes() {
    let merge = |inner: &str| format!("<shape type=\"merge\"><shape type=\"cube\"/>{inner}</shape>");
    assert_eq!(described(&merge("<shape type=\"sphere\"/>")).objects.len(), 2);
    let nested = merge(&merge(""));
    assert!(flaw(&nested).ends_with("a `merge` inside another is not supported"), "{}", flaw(&nested));
}

#[test]
fn words_of_truth_in_either_case() {
    let ball = |value| format!("<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"{value}\"/></shape>");
    for (value, truth) in [("True", true), ("TRUE", true), ("true", true), ("False", false), ("FALSE", false)] {
        let scene = described(&ball(value));
        assert!(matches!(scene.objects[0].shape, ObjectShape::Sphere { inverted, .. } if inverted == truth), "{value}");
    }
    assert!(flaw(&ball("1")).ends_with("`1` is neither true nor false"));
}

/// Axes of Mitsuba 3.9.1: the camera's left and up.
#[test]
fn a_view_without_a_way_up_stands_as_in_mitsuba() {
    let half = 0.5f64.sqrt();
    for (target, left, up) in [
        ("0,0,5", [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
        ("0,0,-5", [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
        ("5,0,0", [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]),
        ("-5,0,0", [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]),
        ("0,5,0", [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ("0,-5,0", [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]),
        ("1,2,3", [0.07929, -0.84143, 0.53452], [0.96036, -0.07929, -0.26726]),
        ("-1,2,-3", [0.07929, 0.84143, 0.53452], [0.96036, 0.07929, -0.26726]),
        ("3,-1,0.2", [-0.28106, -0.90631, -0.3156], [0.15681, 0.28106, -0.94679]),
        ("1,1,0", [0.5, -0.5, half], [0.5, -0.5, -half]),
        ("0,-1,-1", [0.0, half, -half], [1.0, 0.0, 0.0]),
    ] {
        for without in ["", "up=\"\"", "up=\"0 0 0\""] {
            let look = format!("<lookat origin=\"0,0,0\" target=\"{target}\" {without}/>");
            let transform = format!("<transform name=\"to_world\">{look}</transform>");
            let scene =
                loaded(&format!("<integrator type=\"path\"/><sensor type=\"perspective\">{transform}</sensor>"));
            let m = scene.description.camera.unwrap().to_world.matrix3;
            for (axis, expected) in [(m.x_axis, left), (m.y_axis, up)] {
                assert!((axis - DVec3::from(expected)).length() < 2e-5, "{target} {axis} {expected:?}");
            }
        }
    }
}

#[test]
fn the_principal_point_may_lie_off_the_middle() {
    let projection = |inner: &str| {
        let sensor = format!("<sensor type=\"perspective\"><float name=\"fov\" value=\"90\"/>{inner}</sensor>");
        loaded(&format!("<integrator type=\"path\"/>{sensor}")).description.camera.unwrap().projection
    };
    let fov_x = 90f64.to_radians();
    let x = "<float name=\"principal_point_offset_x\" value=\".2\"/>";
    let y = "<float name=\"principalPointOffsetY\" value=\"-.1\"/>";
    for (inner, offset) in [(x.to_owned(), [0.2, 0.0]), (y.to_owned(), [0.0, -0.1]), (format!("{x}{y}"), [0.2, -0.1])] {
        match projection(&inner) {
            Projection::OffAxis { fov_x: fov, offset: is } => {
                assert!((fov - fov_x).abs() < 1e-12 && is == DVec2::from(offset), "{fov} {is}");
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(matches!(
        projection("<float name=\"principal_point_offset_x\" value=\"0\"/>"),
        Projection::Perspective { .. }
    ));
}

#[test]
fn filters_with_negative_parts_have_a_stand_in() {
    for (kind, inner) in [
        ("mitchell", "<float name=\"B\" value=\".2\"/><float name=\"C\" value=\".4\"/>"),
        ("catmullrom", ""),
        ("lanczos", "<integer name=\"lobes\" value=\"2\"/>"),
    ] {
        let film = format!("<film type=\"hdrfilm\"><rfilter type=\"{kind}\">{inner}</rfilter></film>");
        let scene = loaded(&format!("<integrator type=\"path\"/><sensor type=\"perspective\">{film}</sensor>"));
        assert_eq!(scene.filter, Filter::Gaussian { stddev: 0.5 });
        let expected = format!(
            "the filter `{kind}` is negative in places, which pixels that are filtered by sampling cannot be: a Gaussian of \
             standard deviation 0.5 stands in for it"
        );
        assert_eq!(scene.notes, [expected]);
    }
}

/// Spectra by type, in every place where Mitsuba 3.9.1 takes one.
#[test]
fn spectra_may_have_types() {
    let even = |tag: &str, kind: &str, inner: &str, name: &str| {
        format!("<{tag} type=\"{kind}\" name=\"{name}\">{inner}</{tag}>")
    };
    for (kind, inner, rgb) in [
        ("uniform", "<float name=\"value\" value=\".7\"/>", Rgb::splat(0.7)),
        ("rawconstant", "<float name=\"value\" value=\".7\"/>", Rgb::splat(0.7)),
        ("d65", "", Rgb::WHITE),
        ("d65", "<float name=\"scale\" value=\".3\"/>", Rgb::splat(0.3)),
        ("srgb", "<rgb name=\"color\" value=\".2 .3 .4\"/>", Rgb::new(0.2, 0.3, 0.4)),
        ("rgb", "<rgb name=\"value\" value=\".2 .3 .4\"/>", Rgb::new(0.2, 0.3, 0.4)),
    ] {
        for tag in ["spectrum", "texture"] {
            let of = |name| even(tag, kind, inner, name);
            let diffuse = format!("<bsdf type=\"diffuse\">{}</bsdf>", of("reflectance"));
            assert_eq!(material(&diffuse).0, Material::lambert(rgb), "{diffuse}");
            let scene = described(&format!("<emitter type=\"constant\">{}</emitter>", of("radiance")));
            assert!(
                matches!(scene.environment, Some(Environment::Constant(is)) if is == rgb),
                "{:?}",
                scene.environment
            );
            let scene = described(&format!("<emitter type=\"point\">{}</emitter>", of("intensity")));
            assert!(matches!(&scene.lights[0].kind, DeltaLight::Point { intensity, .. } if *intensity == rgb));
            let area = format!("<shape type=\"sphere\"><emitter type=\"area\">{}</emitter></shape>", of("radiance"));
            assert_eq!(described(&area).objects[0].emission, Some(Texture::Constant(rgb)));
            let scaled = format!(
                "<texture type=\"scale\" name=\"reflectance\"><float name=\"scale\" value=\"1\"/>{}</texture>",
                of("t")
            );
            assert_eq!(material(&format!("<bsdf type=\"diffuse\">{scaled}</bsdf>")).0, Material::lambert(rgb));
            let shared = format!(
                "{}<shape type=\"sphere\"><bsdf type=\"diffuse\"><ref id=\"s\" name=\"reflectance\"/></bsdf></shape>",
                of("s").replacen("name=\"s\"", "id=\"s\"", 1)
            );
            assert_eq!(described(&shared).materials[0].material, Material::lambert(rgb));
        }
    }
    let alpha = |inner: &str| material(&format!("<bsdf type=\"roughconductor\">{inner}</bsdf>")).0;
    let uniform = "<spectrum type=\"uniform\" name=\"alpha\"><float name=\"value\" value=\".25\"/></spectrum>";
    assert_eq!(alpha(uniform), alpha("<float name=\"alpha\" value=\".25\"/>"));
    assert_eq!(alpha("<rgb name=\"alpha\" value=\".25\"/>"), alpha("<float name=\"alpha\" value=\".25\"/>"));
    let diffuse = |inner: &str| flaw(&format!("<shape type=\"cube\"><bsdf type=\"diffuse\">{inner}</bsdf></shape>"));
    let bright = even("spectrum", "uniform", "<float name=\"value\" value=\"1.7\"/>", "reflectance");
    assert!(diffuse(&bright).ends_with("the spectrum is not from 0 to 1"), "{}", diffuse(&bright));
    let empty = even("spectrum", "uniform", "", "reflectance");
    assert!(
        diffuse(&empty).ends_with("the spectrum type `uniform` needs the parameter `value`"),
        "{}",
        diffuse(&empty)
    );
    let unknown = even("spectrum", "blackbody", "", "reflectance");
    assert!(diffuse(&unknown).contains("the spectrum type `blackbody` is not supported"), "{}", diffuse(&unknown));
}

#[test]
fn scene_files_may_be_in_other_encodings() {
    let text = |name: &str| {
        format!(
            "<?xml version=\"1.0\" encoding=\"{name}\"?><scene version=\"3.0.0\">{SETTINGS}<shape type=\"sphere\" id=\"é\"/></scene>"
        )
    };
    let wide = |name: &str, mark: bool, bytes: fn(u16) -> [u8; 2]| {
        let text = if mark { format!("\u{feff}{}", text(name)) } else { text(name) };
        text.encode_utf16().flat_map(bytes).collect::<Vec<u8>>()
    };
    let narrow = |name: &str| text(name).chars().map(|c| u8::try_from(c).unwrap()).collect::<Vec<u8>>();
    for (what, bytes) in [
        ("marked little end", wide("utf-16", true, u16::to_le_bytes)),
        ("marked big end", wide("UTF-16", true, u16::to_be_bytes)),
        ("little end", wide("utf-16le", false, u16::to_le_bytes)),
        ("big end", wide("utf-16be", false, u16::to_be_bytes)),
        ("Latin", narrow("ISO-8859-1")),
        ("Windows", narrow("windows-1252")),
        ("UTF-8", text("utf-8").into_bytes()),
        ("marked UTF-8", format!("\u{feff}{}", text("utf-8")).into_bytes()),
        ("converted without a new declaration", text("utf-16").into_bytes()),
    ] {
        assert_eq!(whole(bytes).load().description.objects[0].name, "é", "{what}");
    }
    assert_eq!(whole(text("utf-9")).error(), "scene.xml: the encoding `utf-9` is not known");
    let odd = [wide("utf-16", true, u16::to_le_bytes), vec![b'x']].concat();
    assert_eq!(whole(odd).error(), "scene.xml: the text is not UTF-16LE, its encoding");
}

#[test]
fn paths_that_come_back_into_the_folder_are_read() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let folder = || Folder::new().with("t.obj", triangle).with("sub/u.obj", triangle);
    for name in ["../SELF/t.obj", "sub/../t.obj", "../SELF/sub/../sub/u.obj", "sub/../../SELF/t.obj", "ABSOLUTE/t.obj"]
    {
        let folder = folder();
        let real = folder.path().canonicalize().unwrap();
        let name = name.replace("SELF", real.file_name().unwrap().to_str().unwrap());
        let name = name.replace("ABSOLUTE", real.to_str().unwrap());
        let shape = format!("<shape type=\"obj\"><string name=\"filename\" value=\"{name}\"/></shape>");
        let folder = folder.scene(&shape);
        assert_eq!(folder.load().description.objects.len(), 1, "{name}");
        assert!(folder.notes(STRICT).is_empty() && folder.notes(LENIENT).is_empty());
    }
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_of_the_folder_are_refused() {
    let outer = Folder::new().with("secret/t.obj", "v 0 0 0\n").with("scene/inside/none", "");
    std::os::unix::fs::symlink(outer.path().join("secret"), outer.path().join("scene/link")).unwrap();
    for name in
        ["link/t.obj", "inside/../link/t.obj", "../scene/link/t.obj", "link/../secret/t.obj", "link/../none.obj"]
    {
        let text = format!("<shape type=\"obj\"><string name=\"filename\" value=\"{name}\"/></shape>");
        let path = outer.path().join("scene/scene.xml");
        std::fs::write(&path, format!("<scene version=\"3.0.0\">{SETTINGS}{text}</scene>")).unwrap();
        let error = etendue_scenes::load(path.to_str().unwrap()).unwrap_err().to_string();
        let wrong =
            if name.ends_with("none.obj") { "cannot read the file" } else { "lies outside of the scene's folder" };
        assert!(error.contains(wrong), "{name}: {error}");
    }
}
