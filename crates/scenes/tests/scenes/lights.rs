//! Emitters, media, groups of shapes.

use crate::{
    files::{Folder, LENIENT, described, flaw},
    images::encoded,
};
use etendue_core::{
    camera::Crop,
    lights::environment::{Environment, Rows},
    rgb::Rgb,
    scene::{DeltaLight, ObjectShape, SceneDescription},
    texture::{Texel, Texture, TexturePoint},
};
use glam::{DVec3, UVec2, Vec2};
use image::ImageFormat;
use std::f32::consts::PI;

fn light(inner: &str) -> DeltaLight {
    let folder = Folder::new().with("q.png", encoded(ImageFormat::Png, true)).scene(inner);
    folder.load().description.lights[0].kind.clone()
}

const IMAGE: &str = "<texture name=\"NAME\" type=\"bitmap\"><string name=\"filename\" value=\"q.png\"/>\
                     <boolean name=\"raw\" value=\"true\"/><string name=\"filter_type\" value=\"nearest\"/></texture>";

fn at<T: Texel>(texture: &Texture<T>, u: f32, v: f32) -> T {
    texture.at(&TexturePoint { uv: Vec2::new(u, v), color: Rgb::WHITE })
}

const RED: Rgb = Rgb::new(1.0, 0.0, 0.0);
const GREEN: Rgb = Rgb::new(0.0, 1.0, 0.0);
const BLUE: Rgb = Rgb::new(0.0, 0.0, 1.0);

/// Mitsuba 3.9.1, `sample_direction` of a `spot` and a `projector` with this image: the spot's first texel lies at -x and -y of
/// its own space, the projector's at +x and +y, and x is to the left.
#[test]
fn images_of_spots_and_projectors_stand_as_in_mitsuba() {
    let spot = format!("<emitter type=\"spot\">{}</emitter>", IMAGE.replace("NAME", "texture"));
    let DeltaLight::Spot { image: Some((image, up)), .. } = light(&spot) else { panic!() };
    assert_eq!(up, DVec3::Y);
    assert_eq!([at(&image, 0.75, 0.25), at(&image, 0.25, 0.25), at(&image, 0.75, 0.75)], [RED, GREEN, BLUE]);

    // Mirrored, its x is to the right.
    let mirrored = spot.replace("</emitter>", "<transform name=\"to_world\"><scale x=\"-1\"/></transform></emitter>");
    let DeltaLight::Spot { image: Some((image, _)), .. } = light(&mirrored) else { panic!() };
    assert_eq!([at(&image, 0.25, 0.25), at(&image, 0.75, 0.25)], [RED, GREEN]);

    let projector = format!(
        "<emitter type=\"projector\"><float name=\"fov\" value=\"60\"/><float name=\"scale\" value=\"2\"/>{}</emitter>",
        IMAGE.replace("NAME", "irradiance")
    );
    let DeltaLight::Projector { fov_x, aspect, irradiance, .. } = light(&projector) else { panic!() };
    assert_eq!((fov_x, aspect), (60f64.to_radians(), 1.0));
    let found = [at(&irradiance, 0.25, 0.75), at(&irradiance, 0.75, 0.75), at(&irradiance, 0.25, 0.25)];
    assert_eq!(found, [RED, GREEN, BLUE].map(|c| c * (2.0 * PI)));
}

/// Mitsuba 3.9.1: an `irradiance` of 2 gives 6.28319 on the axis at distance 1; without a field of view half of it is
/// 17.0 degrees, that of a lens of 50 mm.
#[test]
fn projectors_have_mitsubas_defaults() {
    let kind = light("<emitter type=\"projector\"><rgb name=\"irradiance\" value=\"2\"/></emitter>");
    let DeltaLight::Projector { fov_x, aspect, irradiance, .. } = kind else { panic!() };
    assert_eq!((aspect, irradiance), (1.0, Texture::Constant(Rgb::splat(2.0 * PI))));
    assert!((fov_x.to_degrees() / 2.0 - 17.0).abs() < 0.02, "{}", fov_x.to_degrees());
}

#[test]
fn areas_shine_by_texture_and_by_reference() {
    let folder = Folder::new().with("q.png", encoded(ImageFormat::Png, true));
    let scene = folder
        .scene(&format!(
            "<shape type=\"rectangle\"><emitter type=\"area\">{}</emitter></shape><shape type=\"cube\"><ref id=\"e\"/></shape>\
             <emitter type=\"area\" id=\"e\"><spectrum name=\"radiance\" value=\"400:0, 500:8, 600:15.6, 700:18.4\"/></emitter>",
            IMAGE.replace("NAME", "radiance")
        ))
        .load()
        .description;
    assert_eq!(at(scene.objects[0].emission.as_ref().unwrap(), 0.25, 0.25), RED);
    let Some(Texture::Constant(lamp)) = scene.objects[1].emission else { panic!() };
    // Mitsuba 3.9.1, scalar_rgb, `traverse` of such an emitter.
    assert!(lamp.to_array().iter().zip([20.7108, 10.8546, 2.77115]).all(|(a, b)| (a / b - 1.0).abs() < 1e-5));
}

fn environment(inner: &str) -> (Environment, Vec<String>) {
    let scene = Folder::new().scene(inner).load();
    (scene.description.environment.unwrap(), scene.notes)
}

/// The brightest direction of an environment.
fn brightest(environment: &Environment) -> DVec3 {
    let Environment::LatLong { image, to_world, rows, .. } = environment else { panic!("{environment:?}") };
    assert_eq!(*rows, Rows::Centred);
    let index = (0..image.texels.len())
        .max_by(|a, b| image.texels[*a].luminance().total_cmp(&image.texels[*b].luminance()))
        .unwrap();
    let (x, y) = (index % image.width as usize, index / image.width as usize);
    let phi = (x as f64 + 0.5) / f64::from(image.width) * std::f64::consts::TAU;
    let theta = (y as f64 + 0.5) / f64::from(image.height) * std::f64::consts::PI;
    *to_world * DVec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin())
}

/// Mitsuba 3.9.1, `eval` of `sunsky`: its own z is up, and the sun's direction is one in the world.
#[test]
fn the_sun_stands_where_mitsuba_has_it() {
    let sun = DVec3::new(-0.865804, 0.416766, -0.276929);
    let direction = "<vector name=\"sunDirection\" x=\"-0.865804\" y=\"0.416766\" z=\"-0.276929\"/>";
    let upright = "<transform name=\"to_world\"><rotate x=\"1\" angle=\"-90\"/></transform>";
    let (sky, notes) = environment(&format!("<emitter type=\"sunsky\">{direction}{upright}</emitter>"));
    assert!(brightest(&sky).dot(sun) > 0.99999);
    assert_eq!(
        notes,
        ["sunsky in line 2: the daylight is that of Preetham, Shirley and Smits, which differs from Mitsuba's"]
    );
    // `traverse` of a `sunsky` without parameters: the sun of Tokyo, to the digits of another formula.
    let (sky, _) = environment("<emitter type=\"sunsky\"/>");
    assert!(brightest(&sky).dot(DVec3::new(0.0513854, 0.691748, 0.720308)) > 0.9999);
    let both = "<emitter type=\"constant\"/>\n<emitter type=\"sky\"/>";
    assert_eq!(flaw(both), "scene.xml:3:1: a second environment; a scene has one `constant`, `envmap` or sky at most");
    let lenient = Folder::new().scene(both).load_with(LENIENT);
    assert!(matches!(lenient.description.environment, Some(Environment::Constant(_))));
}

#[test]
fn groups_are_placed_by_instances() {
    let group = "<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"/><shape type=\"cube\"><transform name=\"to_world\">\
                 <scale value=\"2\"/></transform></shape></shape>";
    let instance =
        "<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><translate x=\"3\"/></transform></shape>";
    // An instance may stand before its group.
    for text in [format!("{group}{instance}{instance}"), format!("{instance}{group}{instance}")] {
        let scene = described(&text);
        assert_eq!((scene.objects.len(), scene.groups.len(), scene.instances.len()), (0, 1, 2));
        assert_eq!(scene.groups[0].objects.len(), 2);
        assert_eq!(scene.instances[0].to_world.translation, DVec3::X * 3.0);
        assert_eq!(scene.groups[0].objects[1].to_world.matrix3.x_axis, DVec3::X * 2.0);
    }
    for (text, expected) in [
        ("<shape type=\"instance\"/>".to_owned(), "2:1: the shape type `instance` needs one group of shapes"),
        (
            "<shape type=\"instance\"><shape type=\"cube\"/></shape>".to_owned(),
            "2:24: an instance is of a `shapegroup`, not of a `cube`",
        ),
        (
            group.replace("<shape type=\"sphere\"/>", "<shape type=\"instance\"/>"),
            "2:33: a group of shapes holds no `instance`",
        ),
        (
            group.replace("<shape type=\"sphere\"/>", "<shape type=\"cube\"><emitter type=\"area\"/></shape>"),
            "2:33: a shape in a group emits light, which is not supported",
        ),
    ] {
        assert_eq!(flaw(&text), format!("scene.xml:{expected}"));
    }
}

#[test]
fn cylinders() {
    let of = |inner: &str| described(&format!("<shape type=\"cylinder\">{inner}</shape>")).objects.remove(0).shape;
    let ObjectShape::Cylinder { from, to, radius, inverted } = of("") else { panic!() };
    assert_eq!((from, to, radius, inverted), (DVec3::ZERO, DVec3::Z, 1.0, false));
    let given = "<point name=\"p0\" x=\"1\"/><point name=\"p1\" value=\"1 2 3\"/><float name=\"radius\" value=\".5\"/>\
                 <boolean name=\"flipNormals\" value=\"true\"/>";
    let ObjectShape::Cylinder { from, to, radius, inverted } = of(given) else { panic!() };
    assert_eq!((from, to, radius, inverted), (DVec3::X, DVec3::new(1.0, 2.0, 3.0), 0.5, true));
    let flat = "<shape type=\"cylinder\"><point name=\"p1\" value=\"0 0 0\"/></shape>";
    assert_eq!(flaw(flat), "scene.xml:2:1: the ends `p0` and `p1` of the cylinder are the same");
}

fn absorption(scene: &SceneDescription) -> Option<Rgb> {
    scene.objects[0].absorption
}

#[test]
fn media_that_absorb() {
    let medium = |inner: &str| {
        format!(
            "<shape type=\"sphere\"><bsdf type=\"dielectric\"/><medium name=\"interior\" type=\"homogeneous\">{inner}</medium></shape>"
        )
    };
    let none = "<float name=\"albedo\" value=\"0\"/>";
    for (inner, expected) in [
        (none.to_owned(), Rgb::WHITE),
        (
            format!("{none}<rgb name=\"sigma_t\" value=\"1 2 3\"/><float name=\"scale\" value=\"2\"/>"),
            Rgb::new(2.0, 4.0, 6.0),
        ),
        (
            "<rgb name=\"sigmaA\" value=\"1 2 3\"/><rgb name=\"sigmaS\" value=\"0\"/>".to_owned(),
            Rgb::new(1.0, 2.0, 3.0),
        ),
        (
            "<volume name=\"albedo\" type=\"constvolume\"><float name=\"value\" value=\"0\"/></volume>\
             <volume name=\"sigma_t\" type=\"constvolume\"><rgb name=\"value\" value=\"0.5\"/></volume>"
                .to_owned(),
            Rgb::splat(0.5),
        ),
    ] {
        assert_eq!(absorption(&described(&medium(&inner))), Some(expected), "{inner}");
    }
    let declared = "<medium type=\"homogeneous\" id=\"m\"><float name=\"albedo\" value=\"0\"/></medium>\
                    <shape type=\"sphere\"><ref name=\"interior\" id=\"m\"/></shape>";
    assert_eq!(absorption(&described(declared)), Some(Rgb::WHITE));
    for (text, expected) in [
        (medium(""), "2:47: a medium that scatters light is not supported; one of albedo 0 is"),
        (
            medium("<float name=\"sigma_s\" value=\"1\"/>"),
            "2:47: a medium that scatters light is not supported; one of albedo 0 is",
        ),
        (
            medium(none).replace("homogeneous", "heterogeneous"),
            "2:77: the medium type `heterogeneous` is not supported (did you mean `homogeneous`?); supported: homogeneous",
        ),
        (
            medium(none).replace("interior", "exterior"),
            "2:47: a medium outside of a shape is not supported; one inside has the name `interior`",
        ),
    ] {
        assert_eq!(flaw(&text), format!("scene.xml:{expected}"));
        let scene = Folder::new().scene(&text).load_with(LENIENT);
        assert_eq!(absorption(&scene.description), None);
        assert!(scene.notes[0].ends_with(&format!("{expected}; the medium is left out")), "{:?}", scene.notes);
    }
}

#[test]
fn crops() {
    let film = |inner: &str| {
        let text = format!(
            "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\"><film type=\"hdrfilm\">\
             <integer name=\"width\" value=\"100\"/><integer name=\"height\" value=\"80\"/>{inner}</film></sensor></scene>"
        );
        Folder::new().with("scene.xml", text).load().description.camera.unwrap()
    };
    assert_eq!(film("").crop, None);
    let camera = film(
        "<integer name=\"cropOffsetX\" value=\"10\"/><integer name=\"crop_offset_y\" value=\"20\"/>\
         <integer name=\"crop_width\" value=\"30\"/><integer name=\"crop_height\" value=\"40\"/>",
    );
    assert_eq!(camera.resolution, UVec2::new(100, 80));
    assert_eq!(camera.crop, Some(Crop { offset: UVec2::new(10, 20), size: UVec2::new(30, 40) }));
}
