//! What is said about input that is wrong.

use etendue_scenes::{LoadError, load};
use std::{fs, path::Path};
use tempfile::TempDir;

fn message(spec: &str) -> String {
    load(spec).map(|_| ()).expect_err(spec).to_string()
}

#[test]
fn names_and_parameters() {
    for (spec, expected) in [
        (
            "cornel",
            "unknown scene `cornel` (did you mean `cornell`?); built-in scenes are cornell, furnace, veach-mis, \
             glass-caustic, ring, ajar-door, many-lights, sky, glass-ball, glossy-caustic, pool, studio, hidden-lights, \
             bumpy, and a path to a .xml, .gltf or .glb file is a scene too",
        ),
        ("many-lights:m=3", "scene `many-lights` has no parameter `m`; it has n, seed"),
        ("many-lights:sed=3", "scene `many-lights` has no parameter `sed` (did you mean `seed`?); it has n, seed"),
        ("cornell:x=1", "scene `cornell` has no parameter `x`; it has none"),
        ("many-lights:n=0", "scene `many-lights`: parameter n: `0` is not a whole number from 1 to 1048576"),
        ("many-lights:n", "scene `many-lights`: parameter n: `` is not a whole number from 1 to 1048576"),
        ("many-lights:n=1,n=2", "scene `many-lights`: parameter n: `2` is not allowed: it is given a second time"),
        ("furnace:reflectance=1", "scene `furnace`: parameter reflectance: `1` is not a number from 0 to 0.999"),
        ("furnace:reflectance=nan", "scene `furnace`: parameter reflectance: `nan` is not a number from 0 to 0.999"),
        ("furnace:room=tent", "scene `furnace`: parameter room: `tent` is not one of box, sphere"),
        ("a.gltf/b", "a.gltf/b: scenes are read from .xml, .gltf and .glb files; `no extension` is not supported"),
        (
            "some/scene.pbrt",
            "some/scene.pbrt: scenes are read from .xml, .gltf and .glb files; `.pbrt` is not supported",
        ),
    ] {
        assert_eq!(message(spec), expected);
    }
    assert!(message("zzz").starts_with("unknown scene `zzz`; built-in scenes are cornell, "));
    assert!(matches!(load("no/such/scene.xml"), Err(LoadError::Read { .. })));
    assert!(message("no/such/scene.xml").starts_with("cannot read no/such/scene.xml: "));
    assert!(message("").starts_with("unknown scene ``; "));
}

fn write(folder: &Path, name: &str, text: impl AsRef<[u8]>) {
    fs::write(folder.join(name), text).unwrap();
}

/// The error of a scene that has `middle` in its lines 4 and after, without the file's name.
fn flaw(middle: &str) -> String {
    let folder = TempDir::new().unwrap();
    flaw_in(folder.path(), middle)
}

fn flaw_in(folder: &Path, middle: &str) -> String {
    let text = format!(
        "<scene version=\"3.0.0\">\n<integrator type=\"path\"/>\n<sensor type=\"perspective\"/>\n{middle}\n</scene>\n"
    );
    write(folder, "scene.xml", text);
    let path = folder.join("scene.xml");
    let message = message(path.to_str().unwrap());
    match message.strip_prefix(path.to_str().unwrap()) {
        Some(rest) => rest.strip_prefix(':').unwrap_or(rest).to_owned(),
        None => message,
    }
}

#[test]
fn places_in_scene_files() {
    for (middle, expected) in [
        (
            "<shape type=\"rectangl\"/>",
            "4:14: the shape type `rectangl` is not supported (did you mean `rectangle`?); supported: rectangle, cube, \
             sphere, disk, cylinder, obj, ply, serialized, shapegroup, instance, merge",
        ),
        (
            "<shape type=\"sphere\">\n  <float name=\"radios\" value=\"1\"/>\n</shape>",
            "5:16: the shape type `sphere` has no parameter `radios` (did you mean `radius`?); it has center, \
             flip_normals, radius, silhouette_sampling_weight, to_world",
        ),
        (
            "<shape type=\"cube\"><float name=\"radius\" value=\"1\"/></shape>",
            "4:33: the shape type `cube` has no parameter `radius`; it has face_normals, flip_normals, \
             silhouette_sampling_weight, to_world",
        ),
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"1e400\"/></shape>", "4:50: `1e400` is not finite"),
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"-1\"/></shape>",
            "4:50: the parameter `radius` must be positive",
        ),
        ("<shape type=\"sphere\"><point name=\"center\" value=\"0 NaN 0\"/></shape>", "4:50: `NaN` is not finite"),
        ("<shape type=\"cube\"><ref id=\"a\"/></shape>", "4:29: nothing has the id `a`"),
        (
            "<bsdf type=\"diffuse\" id=\"walls\"/>\n<shape type=\"cube\"><ref id=\"wall\"/></shape>",
            "5:29: nothing has the id `wall` (did you mean `walls`?)",
        ),
        (
            "<bsdf type=\"diffuse\" id=\"a\"/>\n<bsdf type=\"diffuse\" id=\"a\"/>",
            "5:1: the id `a` is already taken in line 4",
        ),
        (
            "<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf>\n<bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf>",
            "4:1: the BSDF contains itself by its references",
        ),
        (
            "<shape type=\"cube\"><emitter type=\"point\"/></shape>",
            "4:35: the emitter type `point` is not supported; supported: area",
        ),
        (
            "<emitter type=\"area\"/>",
            "4:16: the emitter type `area` is not supported; supported: constant, envmap, sunsky, sun, sky, \
             point, spot, projector, directional",
        ),
        (
            "<emitter type=\"constant\"/>\n<emitter type=\"constant\"/>",
            "5:1: a second environment; a scene has one `constant`, `envmap` or sky at most",
        ),
        (
            "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5, 1.5, 0\"/></bsdf>",
            "4:53: the parameter `reflectance` has a component above 1",
        ),
        (
            "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5, 0.5\"/></bsdf>",
            "4:53: a colour has one or three numbers, `0.5, 0.5` has 2",
        ),
        (
            "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" valeu=\"1\"/></bsdf>",
            "4:46: <rgb> has no attribute `valeu` (did you mean `value`?); it has name, value",
        ),
        ("<bsdf type=\"diffuse\"><rgb value=\"1\"/></bsdf>", "4:22: <rgb> lacks the attribute `name`"),
        ("<bsdf type=\"diffuse\"><texture type=\"bitmap\"/></bsdf>", "4:22: the bsdf type `diffuse` takes no texture"),
        (
            "<bsdf type=\"diffuse\"><texture name=\"reflektance\" type=\"bitmap\"/></bsdf>",
            "4:22: the bsdf type `diffuse` has no parameter `reflektance` (did you mean `reflectance`?); it has \
             diffuse_reflectance, reflectance",
        ),
        (
            "<bsdf type=\"diffuse\"><string name=\"reflectance\" value=\"red\"/></bsdf>",
            "4:22: the parameter `reflectance` is given by <rgb>, <spectrum> or <float>",
        ),
        (
            "<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/><float name=\"eta\" value=\"1\"/><float name=\"k\" value=\"1\"/></bsdf>",
            "4:55: `material` is given beside `eta` and `k`",
        ),
        (
            "<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"1.5\"/></bsdf>",
            "4:56: the parameter `alpha` is 1.5, not from 0 to 1",
        ),
        (
            "<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"phong\"/></bsdf>",
            "4:64: the parameter `distribution` is `phong`, none of beckmann, ggx",
        ),
        (
            "<bsdf type=\"twosided\"><bsdf type=\"dielectric\"/></bsdf>",
            "4:23: a BSDF that lets light through cannot be twosided: it has both sides already",
        ),
        ("<integrator type=\"path\"/>", "4:1: a second <integrator>; a scene has one"),
        ("<medium type=\"homogeneous\"/>", "4:1: <medium> is not supported in a scene"),
        ("<shape type=\"cube\">stray</shape>", "4:20: the text `stray` has no meaning here"),
        ("<shape type=\"$kind\"/>", "4:14: `$kind` has no <default> before it"),
        (
            "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"0\"/></transform></shape>",
            "4:20: the transform flattens space: it has no inverse",
        ),
        (
            "<shape type=\"cube\"><transform name=\"to_world\"><spin/></transform></shape>",
            "4:47: <spin> is no step of a transform; steps: translate, rotate, scale, matrix, lookat",
        ),
        (
            "<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 2 3\"/></transform></shape>",
            "4:62: a matrix has 16 or 9 numbers, not 3",
        ),
        (
            "<shape type=\"cube\"><transform name=\"to_world\"><rotate angle=\"3\"/></transform></shape>",
            "4:47: the axis has no direction",
        ),
        (
            "<shape type=\"cube\"><transform name=\"to_world\"><lookat origin=\"0 0 0\" target=\"0 1 0\" up=\"0 1 0\"/></transform></shape>",
            "4:47: origin, target and up do not fix a direction of view",
        ),
        ("<shape type=\"obj\"/>", "4:1: the shape type `obj` needs the parameter `filename`"),
        (
            "<shape type=\"cube\">\n<bsdf type=\"diffuse\"/>\n<bsdf type=\"diffuse\"/>\n</shape>",
            "6:1: the shape type `cube` takes one bsdf only",
        ),
        ("<shape type=\"cube\"><shape type=\"cube\"/></shape>", "4:20: the shape type `cube` takes no shape"),
        ("<shape", "5:1: not well-formed XML: invalid name token"),
    ] {
        assert_eq!(flaw(middle), expected, "{middle}");
    }
}

#[test]
fn nesting_has_a_bound() {
    let deep = "<bsdf type=\"twosided\">\n".repeat(100_000) + &"</bsdf>".repeat(100_000);
    assert_eq!(flaw(&deep), "12:1: BSDFs are nested more than 8 deep");
    let chain: String =
        (0..50).map(|i| format!("<bsdf type=\"twosided\" id=\"b{i}\"><ref id=\"b{}\"/></bsdf>\n", i + 1)).collect();
    assert_eq!(flaw(&format!("{chain}<bsdf type=\"diffuse\" id=\"b50\"/>")), "12:1: BSDFs are nested more than 8 deep");
}

#[test]
fn settings_of_sensor_and_integrator() {
    let with = |integrator: &str, sensor: &str| {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("s.xml");
        write(folder.path(), "s.xml", format!("<scene version=\"3.0.0\">\n{integrator}\n{sensor}\n</scene>"));
        let spec = path.to_str().unwrap();
        message(spec).replace(spec, "")
    };
    let path = "<integrator type=\"path\"/>";
    let pinhole = "<sensor type=\"perspective\"/>";
    assert_eq!(with(path, ""), ":1:1: the scene has no <sensor>");
    assert_eq!(
        with("<integrator type=\"path\"><integer name=\"max_depth\" value=\"-2\"/></integrator>", pinhole),
        ":2:58: the parameter `max_depth` is -2, not from -1 to 4294967295"
    );
    assert_eq!(
        with("<integrator type=\"path\"><integer name=\"maxDepth\" value=\"0\"/></integrator>", pinhole),
        ":2:57: a max_depth of 0 renders nothing; 1 is emission alone"
    );
    let film = |inner: &str| {
        with(path, &format!("<sensor type=\"perspective\"><film type=\"hdrfilm\">{inner}</film></sensor>"))
    };
    assert_eq!(
        with("<integrator type=\"pahth\"/>", pinhole),
        ":2:19: the integrator type `pahth` is not supported (did you mean `path`?); supported: path, volpath, direct, \
         ptracer, bdpt, moment, aov"
    );
    assert_eq!(film("<integer name=\"width\" value=\"0\"/>"), ":3:78: the parameter `width` is 0, not from 1 to 65536");
    assert_eq!(
        film("<rfilter type=\"triangle\"/>"),
        ":3:64: the rfilter type `triangle` is not supported; supported: box, tent, gaussian, mitchell, catmullrom, lanczos"
    );
    let crop = "<integer name=\"width\" value=\"8\"/><integer name=\"crop_offset_x\" value=\"1\"/>";
    assert_eq!(film(crop), ":3:28: a crop of 8 x 576 at 1, 0 leaves the film of 8 x 576");
    assert_eq!(
        with(path, "<sensor type=\"perspective\"><float name=\"fov\" value=\"180\"/></sensor>"),
        ":3:53: the field of view is not between 0 and 180 degrees"
    );
    assert_eq!(
        with(path, "<sensor type=\"perspective\"><sampler type=\"haltom\"/></sensor>"),
        ":3:43: the sampler type `haltom` is not supported (did you mean `halton`?); supported: independent, stratified, \
         multijitter, orthogonal, ldsampler, halton, hammersley"
    );
}

#[test]
fn files_that_a_scene_names() {
    let outer = TempDir::new().unwrap();
    let folder = outer.path().join("scene");
    fs::create_dir(&folder).unwrap();
    write(outer.path(), "secret.obj", "v 0 0 0\n");
    write(&folder, "bad.obj", "v 0 0 0\nv 1 0 x\n");
    write(
        &folder,
        "short.ply",
        "ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
    );
    let shape = |kind: &str, file: &str| {
        flaw_in(&folder, &format!("<shape type=\"{kind}\"><string name=\"filename\" value=\"{file}\"/></shape>"))
    };
    let outside = |file: &str| {
        format!("4:50: the file `{file}` lies outside of the scene's folder, which is refused without --allow-outside")
    };
    assert_eq!(shape("obj", "../secret.obj"), outside("../secret.obj"));
    assert_eq!(shape("obj", "a/../../secret.obj"), outside("a/../../secret.obj"));
    assert_eq!(shape("obj", "/etc/passwd"), outside("/etc/passwd"));
    assert!(shape("obj", "none.obj").starts_with("4:50: cannot read the file `none.obj`: "));
    assert!(shape("obj", "bad.obj").ends_with("bad.obj:2: `x` is not a number"));
    assert!(
        shape("ply", "short.ply").ends_with(
            "short.ply:3: the header claims 1000000000 records of `vertex`, more than the file has room for"
        )
    );
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outer.path().join("secret.obj"), folder.join("link.obj")).unwrap();
        assert_eq!(shape("obj", "link.obj"), outside("link.obj"));
    }
}
