//! Lenient loading: what is not supported is left out, and each is said.

use crate::files::{Folder, LENIENT, SETTINGS};
use etendue_core::{material::Material, rgb::Rgb};

#[test]
fn what_is_left_out_is_said_with_its_place() {
    let scene = Folder::new().scene(
        "<shape type=\"hair\"/>\n<shape type=\"obj\"><string name=\"filename\" value=\"none.obj\"/></shape>\n\
         <emitter type=\"laser\"/>\n<shape type=\"cube\"><float name=\"spin\" value=\"1\"/></shape>\n\
         <shape type=\"cube\"><bsdf type=\"ward\"><rgb name=\"diffuse_reflectance\" value=\".1\"/><float name=\"alpha\" \
         value=\"1\"/></bsdf></shape>\n\
         <shape type=\"cube\"><bsdf type=\"coating\"><bsdf type=\"diffuse\"><float name=\"reflectance\" value=\".3\"/></bsdf>\
         </bsdf></shape>\n<shape type=\"cube\"><bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"wood\"/></bsdf></shape>\n\
         <gadget/>",
    );
    let loaded = scene.load_with(LENIENT);
    let d = &loaded.description;
    assert_eq!(d.objects.len(), 4);
    let grey = |v| Material::lambert(Rgb::splat(v));
    let materials: Vec<_> = d.objects.iter().map(|o| d.materials[o.material].material.clone()).collect();
    assert_eq!(materials, [grey(0.5), grey(0.1), grey(0.3), grey(0.5)]);
    let notes = scene.notes(LENIENT);
    let expected = [
        ("scene.xml:2:14: the shape type `hair` is not supported", "it is left out"),
        ("scene.xml:3:50: cannot read the file `none.obj`", "it is left out"),
        ("scene.xml:4:16: the emitter type `laser` is not supported", "it is left out"),
        ("scene.xml:5:33: the shape type `cube` has no parameter `spin`", "it is passed over"),
        ("scene.xml:6:32: the bsdf type `ward` is not supported", "a diffuse material stands in for it"),
        ("scene.xml:7:32: the bsdf type `coating` is not supported", "the BSDF in it stands in for it"),
        ("scene.xml:8:75: the texture type `wood` is not supported", "the parameter's default is taken"),
        ("scene.xml:9:1: <gadget> is not supported in a scene", "it is left out"),
    ];
    assert_eq!(notes.len(), expected.len(), "{notes:#?}");
    for (note, (start, end)) in notes.iter().zip(expected) {
        assert!(note.starts_with(start) && note.ends_with(&format!("; {end}")), "{note}");
    }
}

#[test]
fn what_cannot_be_done_without_is_still_an_error() {
    for text in [
        "<scene version=\"3.0.0\"><integrator type=\"path\"/></scene>".to_owned(),
        format!("<scene version=\"3.0.0\">{SETTINGS}<include filename=\"none.xml\"/></scene>"),
        format!("<scene version=\"3.0.0\">{SETTINGS}"),
        "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"fisheye\"/></scene>".to_owned(),
    ] {
        let folder = Folder::new().with("scene.xml", &text);
        let spec = folder.path().join("scene.xml");
        assert!(etendue_scenes::load_with(spec.to_str().unwrap(), LENIENT).is_err(), "{text}");
    }
}

#[test]
fn a_scene_that_is_wholly_supported_is_the_same_either_way() {
    let folder = Folder::new().scene("<shape type=\"cube\"><bsdf type=\"plastic\"/></shape><emitter type=\"point\"/>");
    let (strict, lenient) = (folder.load(), folder.load_with(LENIENT));
    assert_eq!(format!("{strict:?}"), format!("{lenient:?}"));
}
