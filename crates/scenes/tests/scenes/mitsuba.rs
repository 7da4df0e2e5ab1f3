//! Mitsuba's conventions and defaults.

use etendue_core::{
    bsdf::{ConductorFresnel, Distribution},
    camera::Projection,
    filter::Filter,
    lights::environment::{Environment, Rows},
    material::{Material, RoughnessTexture},
    rgb::Rgb,
    scene::{DeltaLight, ObjectShape},
    texture::Texture,
};
use etendue_scenes::{LoadedScene, load};
use glam::{DMat3, DVec3, Vec3};
use std::fs;
use tempfile::TempDir;

const SETTINGS: &str = "<integrator type=\"path\"/><sensor type=\"perspective\"/>";

fn scene_in(folder: &TempDir, text: &str) -> LoadedScene {
    let path = folder.path().join("scene.xml");
    fs::write(&path, format!("<scene version=\"3.0.0\">{text}</scene>")).unwrap();
    load(path.to_str().unwrap()).unwrap_or_else(|e| panic!("{e}"))
}

fn scene(text: &str) -> LoadedScene {
    scene_in(&TempDir::new().unwrap(), text)
}

/// The scene's one material.
fn material(bsdf: &str) -> Material {
    let scene = scene(&format!("{SETTINGS}<shape type=\"cube\">{bsdf}</shape>"));
    assert_eq!(scene.description.materials.len(), 1);
    scene.description.materials[0].material.clone()
}

fn fov_x(sensor: &str) -> f64 {
    let scene = scene(&format!("<integrator type=\"path\"/>{sensor}"));
    match scene.description.camera.unwrap().projection {
        Projection::Perspective { fov_x } | Projection::ThinLens { fov_x, .. } => fov_x.to_degrees(),
        other => panic!("{other:?}"),
    }
}

fn rough(distribution: Distribution, [u, v]: [f32; 2]) -> RoughnessTexture {
    RoughnessTexture { distribution, alpha_u: u.into(), alpha_v: v.into() }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs().max(1.0)
}

#[test]
fn defaults_are_mitsubas() {
    let scene = scene(SETTINGS);
    assert_eq!((scene.max_depth, scene.roulette_depth, scene.samples), (u32::MAX, 5, Some(4)));
    assert_eq!(scene.filter, Filter::Gaussian { stddev: 0.5 });
    assert_eq!(scene.description.camera.unwrap().resolution.to_array(), [768, 576]);
}

#[test]
fn materials_have_mitsubas_defaults() {
    assert_eq!(material(""), Material::lambert(Rgb::splat(0.5)));
    assert_eq!(material("<bsdf type=\"diffuse\"/>"), Material::lambert(Rgb::splat(0.5)));
    let mirror = ConductorFresnel::Constant(Rgb::WHITE);
    assert_eq!(material("<bsdf type=\"conductor\"/>"), Material::conductor(mirror, None));
    let eta = (1.5046 / 1.000277) as f32;
    assert_eq!(material("<bsdf type=\"dielectric\"/>"), Material::dielectric(eta, None));
    for (bsdf, is_conductor) in [("roughconductor", true), ("roughdielectric", false)] {
        let (roughness, conducts) = match material(&format!("<bsdf type=\"{bsdf}\"/>")) {
            Material::Conductor { roughness, .. } => (roughness.unwrap(), true),
            Material::Dielectric { roughness, .. } => (roughness.unwrap(), false),
            other => panic!("{other:?}"),
        };
        assert_eq!(conducts, is_conductor);
        assert_eq!(roughness, rough(Distribution::Beckmann, [0.1; 2]));
    }
}

#[test]
fn materials_take_their_parameters() {
    let gold = "<bsdf type=\"roughconductor\"><rgb name=\"eta\" value=\".2 .9 1.1\"/><rgb name=\"k\" value=\"3.9 2.5 2.1\"/>\
                <float name=\"alphaU\" value=\"0.05\"/><float name=\"alphaV\" value=\"0.2\"/>\
                <string name=\"distribution\" value=\"GGX\"/><float name=\"specularReflectance\" value=\"0.3\"/></bsdf>";
    let Material::Conductor { fresnel, tint, roughness: Some(roughness) } = material(gold) else { panic!() };
    let (eta, k) = (Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.5, 2.1));
    assert_eq!(fresnel, ConductorFresnel::Complex { eta, k, tint: Rgb::WHITE });
    assert_eq!(tint, Texture::Constant(Rgb::splat(0.3)));
    assert_eq!(roughness, rough(Distribution::Ggx, [0.05, 0.2]));
    let water = "<bsdf type=\"dielectric\"><string name=\"intIOR\" value=\"water\"/><float name=\"extIOR\" value=\"1\"/></bsdf>";
    assert_eq!(material(water), Material::dielectric(1.333, None));
    let blend = "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.25\"/><bsdf type=\"diffuse\"/><bsdf type=\"conductor\"/></bsdf>";
    let Material::Mix { first, second, weight } = material(blend) else { panic!() };
    assert!(matches!((*first, *second), (Material::Lambert { .. }, Material::Conductor { .. })));
    assert_eq!(weight, Texture::Constant(0.25));
}

#[test]
fn materials_are_shared_and_unused_ones_noted() {
    let scene = scene(&format!(
        "{SETTINGS}<shape type=\"cube\"><ref id=\"late\"/></shape><shape type=\"cube\"><ref id=\"late\"/></shape>\
         <shape type=\"cube\"/><shape type=\"cube\"/><bsdf type=\"twosided\" id=\"late\"><bsdf type=\"diffuse\"/></bsdf>\
         <bsdf type=\"diffuse\" id=\"idle\"/>"
    ));
    let d = &scene.description;
    assert_eq!(d.objects.iter().map(|o| o.material).collect::<Vec<_>>(), [0, 0, 1, 1]);
    assert_eq!(
        d.materials.iter().map(|m| (m.name.as_str(), m.two_sided)).collect::<Vec<_>>(),
        [("late", true), ("default", false)]
    );
    assert_eq!(scene.notes, ["the BSDF `idle` is not used by a shape directly"]);
}

#[test]
fn shapes_without_an_id_are_named_by_their_line() {
    let scene = scene(&format!(
        "\n{SETTINGS}\n\n<shape type=\"cube\"/><shape type=\"disk\" id=\"lid\"/>\n<emitter type=\"point\"/>"
    ));
    let names: Vec<_> = scene.description.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["cube in line 4", "lid"]);
    assert_eq!(scene.description.lights[0].name, "point in line 5");
}

#[test]
fn very_smooth_metals_are_noted() {
    let text = "<shape type=\"cube\"><bsdf type=\"roughconductor\" id=\"m\"><float name=\"alpha\" value=\"1e-6\"/></bsdf></shape>";
    let scene = scene(&format!("{SETTINGS}{text}"));
    let Material::Conductor { roughness: Some(r), .. } = &scene.description.materials[0].material else { panic!() };
    assert_eq!(*r, rough(Distribution::Beckmann, [1e-4; 2]));
    assert!(scene.notes[0].starts_with("the BSDF `m` is smoother than alpha = "), "{:?}", scene.notes);
}

#[test]
fn fields_of_view() {
    let film = |w: u32, h: u32| {
        format!(
            "<film type=\"hdrfilm\"><integer name=\"width\" value=\"{w}\"/><integer name=\"height\" value=\"{h}\"/></film>"
        )
    };
    let fov = |axis: &str, film: String| {
        fov_x(&format!(
            "<sensor type=\"perspective\"><float name=\"fov\" value=\"90\"/><string name=\"fov_axis\" value=\"{axis}\"/>{film}</sensor>"
        ))
    };
    let degrees = |tan: f64| 2.0 * tan.atan().to_degrees();
    for (axis, wide, tall) in [
        ("x", 1.0, 1.0),
        ("y", 2.0, 0.5),
        ("smaller", 2.0, 1.0),
        ("larger", 1.0, 0.5),
        ("diagonal", 2.0 / 5f64.sqrt(), 1.0 / 5f64.sqrt()),
    ] {
        assert!(near(fov(axis, film(200, 100)), degrees(wide)), "{axis}");
        assert!(near(fov(axis, film(100, 200)), degrees(tall)), "{axis}");
    }
    // 50 mm: the diagonal of 36 x 24 mm film, laid on a 3:2 image, gives back its width.
    let lens = fov_x(&format!("<sensor type=\"perspective\">{}</sensor>", film(300, 200)));
    assert!(near(lens, degrees(36.0 / 100.0)), "{lens}");
}

#[test]
fn thin_lens_and_parallel_cameras() {
    let lens = "<sensor type=\"thinlens\"><float name=\"fov\" value=\"40\"/><float name=\"aperture_radius\" value=\"0.1\"/>\
                <float name=\"focusDistance\" value=\"3\"/></sensor>";
    let camera = scene(&format!("<integrator type=\"path\"/>{lens}")).description.camera.unwrap();
    let Projection::ThinLens { fov_x, aperture_radius, focus_distance } = camera.projection else { panic!() };
    assert!(near(fov_x, 40f64.to_radians()));
    assert_eq!((aperture_radius, focus_distance), (0.1, 3.0));
    let parallel = "<sensor type=\"orthographic\"><transform name=\"to_world\"><scale x=\"5\" y=\"5\"/>\
                    <lookat origin=\"0 0 4\" target=\"0 0 0\" up=\"0 1 0\"/></transform></sensor>";
    let camera = scene(&format!("<integrator type=\"path\"/>{parallel}")).description.camera.unwrap();
    assert_eq!(camera.projection, Projection::Orthographic { width: 10.0 });
    assert_eq!(camera.to_world.matrix3, DMat3::from_diagonal(DVec3::new(-1.0, 1.0, -1.0)));
    assert_eq!(camera.to_world.translation, DVec3::Z * 4.0);
}

#[test]
fn transforms_apply_in_file_order() {
    let scene = scene(&format!(
        "{SETTINGS}<shape type=\"rectangle\"><transform name=\"toWorld\"><scale x=\"2\"/><rotate y=\"3\" angle=\"90\"/>\
         <translate value=\"1, 2, 3\"/><matrix value=\"1 0 0 10  0 1 0 20  0 0 1 30  0 0 0 1\"/></transform></shape>"
    ));
    let m = scene.description.objects[0].to_world;
    // x is doubled, then turned to -z, then moved twice.
    assert_eq!(m.transform_point3(DVec3::X), DVec3::new(11.0, 22.0, 31.0));
    assert_eq!(m.matrix3.z_axis, DVec3::X);
}

#[test]
fn defaults_are_put_in() {
    let scene = scene(
        "<default name=\"depth\" value=\"7\"/><default name=\"kind\" value=\"path\"/><default name=\"both\" value=\"$depth.5\"/>\
         <integrator type=\"$kind\"><integer name=\"max_depth\" value=\"$depth\"/></integrator><sensor type=\"perspective\"/>\
         <shape type=\"sphere\"><float name=\"radius\" value=\"$both\"/></shape>",
    );
    assert_eq!(scene.max_depth, 7);
    assert!(matches!(scene.description.objects[0].shape, ObjectShape::Sphere { radius: 7.5, .. }));
}

#[test]
fn normals_flip() {
    let shape = |text: &str| scene(&format!("{SETTINGS}{text}")).description.objects.remove(0);
    let flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
    let mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
    for (text, expected) in [
        ("<shape type=\"sphere\"/>".to_owned(), false),
        (format!("<shape type=\"sphere\">{flip}</shape>"), true),
        // In Mitsuba a reflection turns the normals of a sphere.
        (format!("<shape type=\"sphere\">{mirror}</shape>"), true),
        (format!("<shape type=\"sphere\">{mirror}{flip}</shape>"), false),
    ] {
        assert!(matches!(shape(&text).shape, ObjectShape::Sphere { inverted, .. } if inverted == expected), "{text}");
    }
    // A rectangle's normal follows the inverse transpose: a mirrored x leaves it, a flip turns it.
    for (inner, expected) in [("", 1.0), (flip, -1.0), (mirror, 1.0)] {
        let rectangle = shape(&format!("<shape type=\"rectangle\">{inner}</shape>"));
        let normal = rectangle.to_world.matrix3.inverse().transpose() * DVec3::Z;
        assert_eq!(normal, DVec3::Z * expected, "{inner}");
    }
    assert!(matches!(shape("<shape type=\"cube\"/>").shape, ObjectShape::Cube));
    let ObjectShape::Mesh(cube) = shape(&format!("<shape type=\"cube\">{flip}</shape>")).shape else { panic!() };
    for t in &cube.triangles {
        let p = t.map(|i| cube.positions[i as usize]);
        assert!((p[1] - p[0]).cross(p[2] - p[0]).dot(p[0]) < 0.0);
    }
}

#[test]
fn meshes_get_the_normals_that_mitsuba_gives_them() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("bare.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nf 1/1 2/1 3/1\n").unwrap();
    fs::write(folder.path().join("full.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 1\nvn 0 0 0\nf 1//1 2//2 3//1\n")
        .unwrap();
    let mesh = |file: &str, inner: &str| {
        let text = format!("{SETTINGS}<shape type=\"obj\"><string name=\"filename\" value=\"{file}\"/>{inner}</shape>");
        match scene_in(&folder, &text).description.objects.remove(0).shape {
            ObjectShape::Mesh(mesh) => mesh,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(mesh("bare.obj", "").normals, [Vec3::Z; 3]);
    assert_eq!(mesh("bare.obj", "").uvs[0].y, 0.75);
    assert!(mesh("bare.obj", "<boolean name=\"face_normals\" value=\"true\"/>").normals.is_empty());
    // A normal of no length gives way to that of the face.
    assert_eq!(mesh("full.obj", "").normals, [Vec3::new(1.0, 0.0, 1.0), Vec3::Z, Vec3::new(1.0, 0.0, 1.0)]);
    let flipped = mesh("full.obj", "<boolean name=\"flip_normals\" value=\"true\"/>");
    assert_eq!((flipped.triangles[0], flipped.normals[1]), ([0, 2, 1], -Vec3::Z));
}

#[test]
fn lights_without_an_extent() {
    let scene = scene(&format!(
        "{SETTINGS}<emitter type=\"point\"><point name=\"position\" x=\"1\" z=\"2\"/><rgb name=\"intensity\" value=\"3\"/></emitter>\
         <emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"0 5 0\" target=\"0 0 0\" up=\"1 0 0\"/></transform>\
         </emitter><emitter type=\"directional\"><vector name=\"direction\" value=\"0 -2 0\"/></emitter>"
    ));
    let lights: Vec<_> = scene.description.lights.iter().map(|l| l.kind.clone()).collect();
    let DeltaLight::Point { position, intensity } = lights[0].clone() else { panic!() };
    assert_eq!((position, intensity), (DVec3::new(1.0, 0.0, 2.0), Rgb::splat(3.0)));
    let DeltaLight::Spot { position, direction, beam, cutoff, .. } = lights[1].clone() else { panic!() };
    assert_eq!((position, direction), (DVec3::Y * 5.0, -DVec3::Y));
    assert!(near(beam.to_degrees(), 15.0) && near(cutoff.to_degrees(), 20.0));
    let DeltaLight::Directional { direction, irradiance } = lights[2].clone() else { panic!() };
    assert_eq!((direction, irradiance), (-DVec3::Y, Rgb::WHITE));
}

#[test]
fn environments() {
    let folder = TempDir::new().unwrap();
    let texels = |x: usize, y: usize| (x as f32, y as f32, if (x, y) == (1, 1) { f32::NAN } else { 1.0 });
    fs::write(folder.path().join("e.exr"), crate::meshes::exr_bytes(4, 3, texels)).unwrap();
    let load = |inner: &str| {
        let text =
            format!("{SETTINGS}<emitter type=\"envmap\"><string name=\"filename\" value=\"e.exr\"/>{inner}</emitter>");
        let scene = scene_in(&folder, &text);
        match scene.description.environment {
            Some(Environment::LatLong { image, scale, to_world, rows }) => {
                assert_eq!(rows, Rows::PoleToPole);
                (image, scale, to_world, scene.notes)
            }
            other => panic!("{other:?}"),
        }
    };
    let (image, scale, to_world, notes) = load("<float name=\"scale\" value=\"2\"/>");
    assert_eq!((image.width, image.height, scale, to_world), (4, 3, 2.0, DMat3::IDENTITY));
    assert_eq!(image.texels[2].to_array(), [2.0, 0.0, 1.0]);
    assert!(image.texels[5].is_black());
    assert!(notes[0].ends_with("e.exr: 1 texels were negative, infinite or not a number and are black"), "{notes:?}");

    // Mirrored in x, the image is read from right to left and nothing is left of the reflection.
    let (image, _, to_world, _) = load("<transform name=\"to_world\"><scale x=\"-1\"/></transform>");
    assert_eq!(to_world, DMat3::IDENTITY);
    assert_eq!(image.texels[1].to_array(), [2.0, 0.0, 1.0]);
    let (_, _, to_world, _) = load("<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/></transform>");
    assert_eq!(to_world * DVec3::Z, DVec3::X);
}
