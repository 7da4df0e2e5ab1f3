//! Values that nothing can have: an error or a note, never a silent clamp.

use crate::files::{Folder, LENIENT, described};
use etendue_scenes::{LoadOptions, load_with};

const STRICT: LoadOptions = LoadOptions { lenient: false, outside_folder: false };

/// `true` for a scene that is refused or noted, and the same where loading is lenient.
fn told(inner: &str) -> bool {
    let folder = Folder::new().scene(inner);
    let spec = folder.path().join("scene.xml");
    [STRICT, LENIENT]
        .into_iter()
        .all(|options| load_with(spec.to_str().unwrap(), options).map_or(true, |scene| !scene.notes.is_empty()))
}

fn number(name: &str, value: f64) -> String {
    format!("<float name=\"{name}\" value=\"{value}\"/>")
}

fn colour(name: &str, value: f64) -> String {
    format!("<rgb name=\"{name}\" value=\"{value}\"/>")
}

/// Each way to give a colour.
fn colours(name: &str, value: f64) -> [String; 5] {
    [
        number(name, value),
        colour(name, value),
        format!("<spectrum name=\"{name}\" value=\"{value}\"/>"),
        format!("<spectrum name=\"{name}\" value=\"400:{value} 700:{value}\"/>"),
        format!("<spectrum name=\"{name}\" type=\"uniform\">{}</spectrum>", number("value", value)),
    ]
}

fn bsdf(kind: &str, inner: &str) -> String {
    format!("<shape type=\"sphere\"><bsdf type=\"{kind}\">{inner}</bsdf></shape>")
}

/// Scenes with one value in range, and the same with one out of range.
fn check(of: impl Fn(f64) -> Vec<String>, right: f64, wrong: &[f64]) {
    for scene in of(right) {
        described(&scene);
        assert!(!told(&scene), "{scene}");
    }
    for scene in wrong.iter().flat_map(|value| of(*value)) {
        assert!(told(&scene), "{scene}");
    }
}

#[test]
fn colours_of_materials() {
    let both = ["specular_reflectance", "specular_transmittance"].as_slice();
    for (kind, names) in [
        ("diffuse", ["reflectance"].as_slice()),
        ("conductor", &both[..1]),
        ("roughconductor", &both[..1]),
        ("dielectric", both),
        ("roughdielectric", both),
        ("thindielectric", both),
        ("plastic", &["diffuse_reflectance", "specular_reflectance"]),
        ("roughplastic", &["diffuse_reflectance", "specular_reflectance"]),
        ("principled", &["base_color"]),
        ("principledthin", &["base_color"]),
    ] {
        for name in names {
            check(|v| colours(name, v).iter().map(|c| bsdf(kind, c)).collect(), 0.5, &[1.5, -0.5]);
            let scaled = |factor| {
                let board = "<texture name=\"t\" type=\"checkerboard\"/>";
                let inner = format!("{}{board}", number("scale", factor));
                vec![bsdf(kind, &format!("<texture name=\"{name}\" type=\"scale\">{inner}</texture>"))]
            };
            check(scaled, 0.5, &[3.0, -1.0]);
        }
    }
}

#[test]
fn numbers_of_materials() {
    let one = |kind: &'static str, name: &'static str| move |v| vec![bsdf(kind, &number(name, v))];
    for kind in ["roughconductor", "roughdielectric", "roughplastic"] {
        check(one(kind, "alpha"), 0.3, &[0.0, 1e-6, -0.1, 1.5]);
    }
    for kind in ["roughconductor", "roughdielectric"] {
        check(|v| vec![bsdf(kind, &colours("alpha", v)[4])], 0.3, &[0.0, -0.1, 1.5]);
        check(|v| vec![bsdf(kind, &(number("alpha_u", v) + &number("alpha_v", 0.2)))], 0.3, &[0.0, -0.1, 1.5]);
    }
    for kind in ["dielectric", "roughdielectric", "thindielectric", "plastic", "roughplastic"] {
        check(one(kind, "int_ior"), 1.4, &[0.0, -1.5, 1e9]);
        check(one(kind, "ext_ior"), 1.4, &[0.0, -1.5, 1e9]);
    }
    let shares = ["roughness", "anisotropic", "spec_trans", "spec_tint", "sheen", "sheen_tint", "flatness"];
    for name in shares {
        check(one("principled", name), 0.5, &[-0.5, 1.5]);
        check(one("principledthin", name), 0.5, &[-0.5, 1.5]);
    }
    for name in ["metallic", "clearcoat", "clearcoat_gloss", "specular"] {
        check(one("principled", name), 0.5, &[-0.5, 1.5]);
    }
    check(one("principledthin", "diff_trans"), 1.5, &[-0.5, 2.5]);
    check(one("principled", "eta"), 1.5, &[0.0, -1.0]);
    let inside = "<bsdf type=\"diffuse\"/>";
    check(|v| vec![bsdf("mask", &(number("opacity", v) + inside))], 0.5, &[-0.5, 1.5]);
    check(|v| vec![bsdf("blendbsdf", &(number("weight", v) + inside + inside))], 0.5, &[-0.5, 1.5]);
    check(|v| vec![bsdf("normalmap", &(colour("normalmap", v) + inside))], 0.5, &[-0.5, 1.5]);
}

#[test]
fn lights() {
    let light = |kind: &str, inner: &str| format!("<emitter type=\"{kind}\">{inner}</emitter>");
    for (kind, name) in [
        ("constant", "radiance"),
        ("point", "intensity"),
        ("spot", "intensity"),
        ("directional", "irradiance"),
        ("projector", "irradiance"),
    ] {
        check(|v| colours(name, v).iter().map(|c| light(kind, c)).collect(), 2.0, &[-1.0]);
        check(|v| vec![light(kind, &number("sampling_weight", v))], 1.0, &[0.0, -1.0]);
    }
    let area = |v| {
        colours("radiance", v).iter().map(|c| format!("<shape type=\"sphere\">{}</shape>", light("area", c))).collect()
    };
    check(area, 2.0, &[-1.0]);
    check(|v| vec![light("spot", &number("cutoff_angle", v))], 95.0, &[-10.0, 0.0, 200.0]);
    check(|v| vec![light("spot", &number("beam_width", v))], 5.0, &[-5.0, 30.0]);
    check(|v| vec![light("projector", &number("fov", v))], 40.0, &[-1.0, 0.0, 180.0, 400.0]);
    check(|v| vec![light("projector", &number("scale", v))], 2.0, &[-1.0]);
}

#[test]
fn sizes() {
    for kind in ["sphere", "cylinder"] {
        check(|v| vec![format!("<shape type=\"{kind}\">{}</shape>", number("radius", v))], 0.5, &[0.0, -1.0]);
    }
}
