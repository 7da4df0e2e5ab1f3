//! What belongs to the language rather than to a scene: inclusions, defaults, names, folders.

use crate::files::{Folder, LENIENT, SETTINGS, described, flaw};
use etendue_core::{material::Material, rgb::Rgb, scene::ObjectShape};
use etendue_scenes::LoadOptions;

const OUTSIDE: LoadOptions = LoadOptions { lenient: false, outside_folder: true };

fn radius(shape: &ObjectShape) -> f64 {
    match shape {
        ObjectShape::Sphere { radius, .. } => *radius,
        other => panic!("{other:?}"),
    }
}

#[test]
fn included_files_stand_where_they_are_included() {
    let scene = Folder::new()
        .with(
            "parts/all.xml",
            "<scene version=\"3.0.0\">\n<include filename=\"parts/ball.xml\"/>\n<shape type=\"cube\"/></scene>",
        )
        .with("parts/ball.xml", "<shape type=\"sphere\"/>")
        .with("parts/grey.xml", "<scene version=\"3.0.0\"><ref id=\"grey\"/></scene>")
        .scene(
            "<include filename=\"parts/all.xml\"/>\n<shape type=\"disk\"><include filename=\"parts/grey.xml\"/></shape>\
             <bsdf type=\"diffuse\" id=\"grey\"><rgb name=\"reflectance\" value=\".1\"/></bsdf>",
        )
        .load()
        .description;
    let names: Vec<_> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["sphere in line 1 of ball.xml", "cube in line 3 of all.xml", "disk in line 3"]);
    assert_eq!(scene.materials[scene.objects[2].material].material, Material::lambert(Rgb::splat(0.1)));
}

#[test]
fn a_file_tells_those_that_it_includes_its_defaults() {
    let ball = "<scene version=\"3.0.0\"><default name=\"r\" value=\"1\"/><default name=\"s\" value=\"$r.5\"/>\
                <shape type=\"sphere\"><float name=\"radius\" value=\"$s\"/></shape></scene>";
    let outer = "<default name=\"r\" value=\"7\"/><include filename=\"ball.xml\"/>\
                 <shape type=\"sphere\"><float name=\"radius\" value=\"$s\"/></shape>";
    let scene = Folder::new().with("ball.xml", ball).scene(outer).load().description;
    assert_eq!(scene.objects.iter().map(|o| radius(&o.shape)).collect::<Vec<_>>(), [7.5, 7.5]);
    // A default counts from where it stands, wherever that is.
    let inner = "<shape type=\"sphere\"><default name=\"r\" value=\"3\"/><float name=\"radius\" value=\"$r\"/></shape>";
    assert_eq!(radius(&described(inner).objects[0].shape), 3.0);
    assert_eq!(
        flaw(
            "<shape type=\"sphere\"><float name=\"radius\" value=\"$rad\"/></shape><default name=\"rad\" value=\"1\"/>"
        ),
        "scene.xml:2:50: `$rad` has no <default> before it"
    );
}

#[test]
fn circles_and_depths_of_inclusion_are_refused() {
    let include = |name: &str| format!("<scene version=\"3.0.0\">\n<include filename=\"{name}\"/></scene>");
    let circle = Folder::new().with("a.xml", include("b.xml")).with("b.xml", include("./a.xml"));
    let circle = circle.scene("<include filename=\"a.xml\"/>");
    assert_eq!(circle.error(), "b.xml:2:20: the file includes itself: a.xml -> b.xml -> a.xml");
    let own = Folder::new().scene("<include filename=\"scene.xml\"/>");
    assert_eq!(own.error(), "scene.xml:2:20: the file includes itself: scene.xml -> scene.xml");
    let mut deep = Folder::new().scene("<include filename=\"0.xml\"/>");
    for i in 0..20 {
        deep = deep.with(&format!("{i}.xml"), include(&format!("{}.xml", i + 1)));
    }
    assert_eq!(deep.error(), "14.xml:2:1: files are included more than 15 deep");
    // Twice as many with each file; the depth alone would allow 2^14.
    let mut wide = Folder::new().scene("<include filename=\"0.xml\"/>").with("13.xml", "<scene version=\"3.0.0\"/>");
    for i in 0..13 {
        let next = format!("<include filename=\"{}.xml\"/>", i + 1);
        wide = wide.with(&format!("{i}.xml"), format!("<scene version=\"3.0.0\">{next}{next}</scene>"));
    }
    assert!(wide.error().ends_with("more than 1024 files are included"), "{}", wide.error());
}

#[test]
fn errors_in_included_files_have_their_place() {
    let scene = |part: &str| Folder::new().with("part.xml", part).scene("<include filename=\"part.xml\"/>").error();
    assert_eq!(
        scene("<scene version=\"3.0.0\">\n<shape type=\"cubes\"/></scene>").split(" is not").next().unwrap(),
        "part.xml:2:14: the shape type `cubes`"
    );
    assert_eq!(scene("<scene>"), "part.xml:1:1: not well-formed XML: the root node was opened but never closed");
    assert_eq!(scene("<scene>stray</scene>"), "part.xml:1:8: the text `stray` has no meaning here");
    assert!(flaw("<include filename=\"none.xml\"/>").starts_with("scene.xml:2:20: cannot read the file `none.xml`: "));
    assert_eq!(flaw("<include file=\"a\"/>"), "scene.xml:2:10: <include> has no attribute `file`; it has filename");
    let twice = Folder::new()
        .with("part.xml", "<scene><bsdf type=\"diffuse\" id=\"a\"/></scene>")
        .scene("<include filename=\"part.xml\"/>\n<bsdf type=\"diffuse\" id=\"a\"/>");
    assert_eq!(twice.error(), "scene.xml:3:1: the id `a` is already taken in line 1 of part.xml");
}

#[test]
fn elements_have_other_names() {
    let scene = described(
        "<bsdf type=\"diffuse\" id=\"a\"><rgb name=\"reflectance\" value=\".2\"/></bsdf><alias id=\"a\" as=\"b\"/>\
         <alias id=\"b\" as=\"c\"/><shape type=\"cube\"><ref id=\"c\"/></shape>",
    );
    assert_eq!(scene.materials[0].material, Material::lambert(Rgb::splat(0.2)));
    assert_eq!(flaw("<alias id=\"x\" as=\"y\"/>"), "scene.xml:2:12: nothing has the id `x`");
    assert_eq!(
        flaw("<bsdf type=\"diffuse\" id=\"a\"/><alias id=\"a\" as=\"a\"/>"),
        "scene.xml:2:30: the id `a` is already taken in line 2"
    );
}

#[test]
fn files_are_looked_for_in_the_folders_of_path() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let shape = "<shape type=\"obj\"><string name=\"filename\" value=\"t.obj\"/></shape>";
    let inside = Folder::new().with("deep/er/t.obj", triangle);
    assert_eq!(
        inside
            .scene(&format!("<path value=\"deep\"/><path value=\"deep/er\"/>{shape}"))
            .load()
            .description
            .objects
            .len(),
        1
    );
    // The folder that was named last comes first, and names of other systems count.
    let two = Folder::new().with("a/t.obj", triangle).with("b/t.obj", format!("{triangle}f 1 3 2\n"));
    let two = two.scene(&format!("<path value=\"a\"/><path value=\".\\b\"/>{shape}")).load().description;
    assert!(matches!(&two.objects[0].shape, ObjectShape::Mesh(mesh) if mesh.triangles.len() == 2));
    assert!(flaw("<path value=\"none\"/>").starts_with("scene.xml:2:14: cannot read the folder `none`: "));
}

#[test]
fn what_lies_outside_of_the_folder_is_read_if_that_is_asked_for() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let outer = Folder::new().with("common/t.obj", triangle).with("common/part.xml", "<shape type=\"cube\"/>");
    let refused = |what: &str, name: &str, column: usize| {
        format!(
            "scene/scene.xml:2:{column}: the {what} `{name}` lies outside of the scene's folder, which is refused without \
             --allow-outside"
        )
    };
    let shape = |name: &str| format!("<shape type=\"obj\"><string name=\"filename\" value=\"{name}\"/></shape>");
    let absolute = outer.path().canonicalize().unwrap().join("common/t.obj");
    let absolute = absolute.to_str().unwrap();
    for (inner, what, name, column) in [
        (format!("<path value=\"../common\"/>{}", shape("t.obj")), "folder", "../common", 14),
        (shape("../common/t.obj"), "file", "../common/t.obj", 50),
        (shape(absolute), "file", absolute, 50),
        ("<include filename=\"../common/part.xml\"/>".to_owned(), "file", "../common/part.xml", 20),
    ] {
        let path = outer.path().join("scene/scene.xml");
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, format!("<scene version=\"3.0.0\">{SETTINGS}\n{inner}</scene>")).unwrap();
        let spec = path.to_str().unwrap();
        let error = etendue_scenes::load(spec).unwrap_err().to_string();
        let name: String =
            if name.len() > 40 { name.chars().take(40).chain("...".chars()).collect() } else { name.to_owned() };
        let place = format!("{}/", outer.path().display());
        assert_eq!(error.replacen(&place, "", 1), refused(what, &name, column));
        assert!(etendue_scenes::load_with(spec, LENIENT).is_err() || what == "file");
        assert_eq!(etendue_scenes::load_with(spec, OUTSIDE).unwrap().description.objects.len(), 1, "{inner}");
    }
}

#[test]
fn settings_of_other_kinds_are_noted() {
    let load = |integrator: &str, sampler: &str| {
        let sensor = format!("<sensor type=\"perspective\">{sampler}</sensor>");
        let folder = Folder::new();
        let text = format!("<scene version=\"3.0.0\">{integrator}{sensor}</scene>");
        let scene = folder.with("scene.xml", text).load();
        (scene.max_depth, scene.roulette_depth, scene.samples.unwrap(), scene.notes)
    };
    let depth = "<integer name=\"max_depth\" value=\"6\"/>";
    assert_eq!(
        load(&format!("<integrator type=\"volpath\">{depth}<integer name=\"rrDepth\" value=\"9\"/></integrator>"), ""),
        (6, 9, 4, vec!["the integrator `volpath` is taken as path tracing to the same depth".to_owned()])
    );
    let nested = "<integrator type=\"aov\"><string name=\"aovs\" value=\"dd:depth\"/><integrator type=\"moment\">\
         <integrator type=\"direct\"><integer name=\"emitter_samples\" value=\"3\"/></integrator></integrator></integrator>";
    assert_eq!(
        load(
            nested,
            "<sampler type=\"sobol\"><integer name=\"sampleCount\" value=\"32\"/><integer name=\"scramble\" value=\"1\"/></sampler>"
        ),
        (
            2,
            5,
            32,
            vec![
                "the integrator `aov` has no effect; what is in it is taken".to_owned(),
                "the integrator `moment` has no effect; what is in it is taken".to_owned(),
                "the integrator `direct` is taken as path tracing to depth 2".to_owned(),
                "of the sampler `sobol` only the number of samples is taken".to_owned(),
            ]
        )
    );
}
