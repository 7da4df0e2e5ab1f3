//! Textures: where they are looked up and what is read from images.

use crate::{
    files::{Folder, LENIENT, flaw},
    images::encoded,
    meshes::{ASCII_PLY, exr_bytes},
};
use etendue_core::{
    material::{Material, Relief},
    rgb::Rgb,
    texture::{Raster, Texture, TexturePoint},
};
use glam::Vec2;
use image::ImageFormat;
use std::sync::Arc;

fn folder() -> Folder {
    Folder::new()
        .with("q.png", encoded(ImageFormat::Png, true))
        .with("f.exr", exr_bytes(2, 2, |x, y| (2.0 - 2.0 * x as f32, x as f32 - 2.0 * y as f32, y as f32)))
}

/// The reflectance of a diffuse material with such a texture.
fn reflectance(texture: &str) -> Texture<Rgb> {
    let scene = folder().scene(&format!("<shape type=\"cube\"><bsdf type=\"diffuse\">{texture}</bsdf></shape>")).load();
    match scene.description.materials.into_iter().next().unwrap().material {
        Material::Lambert { reflectance } => reflectance,
        other => panic!("{other:?}"),
    }
}

fn bitmap(inner: &str) -> Texture<Rgb> {
    reflectance(&format!(
        "<texture name=\"reflectance\" type=\"bitmap\"><string name=\"filename\" value=\"q.png\"/>\
         <string name=\"filter_type\" value=\"nearest\"/>{inner}</texture>"
    ))
}

fn at<T: etendue_core::texture::Texel>(texture: &Texture<T>, u: f32, v: f32) -> T {
    texture.at(&TexturePoint { uv: Vec2::new(u, v), color: Rgb::WHITE })
}

const RED: Rgb = Rgb::new(1.0, 0.0, 0.0);
const GREEN: Rgb = Rgb::new(0.0, 1.0, 0.0);
const BLUE: Rgb = Rgb::new(0.0, 0.0, 1.0);

/// Mitsuba 3.9.1, `eval` of a `bitmap` of this image: the first row lies at small v.
#[test]
fn images_stand_as_in_mitsuba() {
    let plain = bitmap("");
    assert_eq!([at(&plain, 0.25, 0.25), at(&plain, 0.75, 0.25), at(&plain, 0.25, 0.75)], [RED, GREEN, BLUE]);
    for (mode, expected) in [
        ("repeat", [RED, BLUE, RED, BLUE, RED, BLUE]),
        ("mirror", [BLUE, RED, RED, BLUE, BLUE, RED]),
        ("clamp", [RED, RED, RED, BLUE, BLUE, BLUE]),
    ] {
        let texture = bitmap(&format!("<string name=\"wrap_mode\" value=\"{mode}\"/>"));
        let found = [-0.75, -0.25, 0.25, 0.75, 1.25, 1.75].map(|v| at(&texture, 0.25, v));
        assert_eq!(found, expected, "{mode}");
    }
    let moved = bitmap("<transform name=\"to_uv\"><translate x=\".5\"/></transform>");
    assert_eq!(at(&moved, 0.25, 0.25), GREEN);
    // Mitsuba 3.9.1 upgrades these to the matrix (2 0 1 / 0 3 0): offset first.
    let older = bitmap(
        "<float name=\"uscale\" value=\"2\"/><float name=\"uoffset\" value=\".5\"/><float name=\"vscale\" value=\"3\"/>",
    );
    let matrix = bitmap("<transform name=\"to_uv\"><matrix value=\"2 0 0 1  0 3 0 0  0 0 1 0  0 0 0 1\"/></transform>");
    assert_eq!(older, matrix);
}

#[test]
fn smooth_lookup_and_codings() {
    let smooth = |inner: &str| {
        reflectance(&format!(
            "<texture name=\"reflectance\" type=\"bitmap\"><string name=\"filename\" value=\"q.png\"/>{inner}</texture>"
        ))
    };
    assert_eq!(at(&smooth(""), 0.5, 0.25), Rgb::new(0.5, 0.5, 0.0));
    let grey = |inner: &str| at(&smooth(inner), 0.75, 0.75).r;
    assert!((grey("") - 0.215_860_41).abs() < 2e-7);
    assert!((grey("<boolean name=\"raw\" value=\"true\"/>") - 0.501_960_8).abs() < 2e-7);
    assert!((grey("<float name=\"gamma\" value=\"1\"/>") - 0.501_960_8).abs() < 2e-7);
    assert!((grey("<float name=\"gamma\" value=\"-1\"/>") - 0.215_860_41).abs() < 2e-7);
    assert!((grey("<float name=\"gamma\" value=\"2\"/>") - 0.251_964_64).abs() < 2e-7);
}

#[test]
fn values_beyond_their_bounds_are_moved_and_noted() {
    let texture = "<texture name=\"NAME\" type=\"bitmap\"><string name=\"filename\" value=\"f.exr\"/></texture>";
    let diffuse = format!(
        "<shape type=\"cube\"><bsdf type=\"diffuse\">{}</bsdf></shape>\
         <shape type=\"cube\"><bsdf type=\"bumpmap\">{}<bsdf type=\"diffuse\"/></bsdf></shape>",
        texture.replace("NAME", "reflectance"),
        texture.replace("NAME", "map")
    );
    let scene = folder().scene(&diffuse);
    assert_eq!(scene.notes(Default::default()), ["f.exr: 3 of 4 texels are not from 0 to 1 and are moved there"]);
    let materials = scene.load().description.materials;
    let Material::Lambert { reflectance } = &materials[0].material else { panic!() };
    let values = reflectance.values();
    assert_eq!(values[0], Rgb::new(1.0, 0.0, 0.0));
    assert!(values.iter().all(|v| v.is_valid() && v.max_element() <= 1.0));
    // A height may be anything.
    let Material::Relief { relief: Relief::Bump { height, .. }, .. } = &materials[1].material else { panic!() };
    assert!(height.values().iter().any(|h| *h < 0.0));
}

#[test]
fn numbers_are_luminances() {
    let opacity = "<bsdf type=\"mask\"><texture name=\"opacity\" type=\"bitmap\"><string name=\"filename\" value=\"q.png\"/>\
                   <string name=\"filterType\" value=\"nearest\"/></texture><bsdf type=\"diffuse\"/></bsdf>";
    let scene = folder().scene(&format!("<shape type=\"cube\">{opacity}</shape>")).load();
    let Material::Mask { opacity, .. } = &scene.description.materials[0].material else { panic!() };
    // Mitsuba 3.9.1, `eval_1` of a `bitmap` of this image, whose weights have a digit or two more.
    for ((u, v), expected) in
        [((0.25, 0.25), 0.212_671), ((0.75, 0.25), 0.715_16), ((0.25, 0.75), 0.072_169), ((0.75, 0.75), 0.215_860_41)]
    {
        assert!((at(opacity, u, v) - expected).abs() < 1e-4);
    }
    assert_eq!(scene.notes, Vec::<String>::new());
    // Roughness is kept within what the core allows.
    let rough = "<bsdf type=\"roughconductor\"><texture name=\"alpha\" type=\"bitmap\">\
                 <string name=\"filename\" value=\"f.exr\"/></texture></bsdf>";
    let scene = folder().scene(&format!("<shape type=\"cube\">{rough}</shape>")).load();
    let Material::Conductor { roughness: Some(r), .. } = &scene.description.materials[0].material else { panic!() };
    assert!(r.alpha_u.values().iter().all(|a| (1e-4..=1.0).contains(a)) && r.alpha_u == r.alpha_v);
}

#[test]
fn an_image_is_held_once() {
    let texture = "<texture name=\"reflectance\" type=\"bitmap\"><string name=\"filename\" value=\"q.png\"/></texture>";
    let shape = format!("<shape type=\"cube\"><bsdf type=\"diffuse\">{texture}</bsdf></shape>");
    let scene = folder().scene(&shape.repeat(2)).load().description;
    let held: Vec<_> = scene
        .materials
        .iter()
        .map(|m| match &m.material {
            Material::Lambert { reflectance: Texture::Bitmap { bitmap: Raster::Coded(bitmap), .. } } => bitmap.clone(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(Arc::ptr_eq(&held[0], &held[1]));
}

#[test]
fn vertex_colours_come_from_meshes_that_have_some() {
    let texture = "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"mesh_attribute\">\
                   <string name=\"name\" value=\"vertex_color\"/></texture></bsdf>";
    let colored = ASCII_PLY
        .replace("element face", "property float r\nproperty float g\nproperty float b\nelement face")
        .replace(" 0 0 1\n", " 0 0 1 .5 .25 2\n");
    let shape =
        |file: &str| format!("<shape type=\"ply\"><string name=\"filename\" value=\"{file}\"/><ref id=\"c\"/></shape>");
    let declared = texture.replace("<bsdf ", "<bsdf id=\"c\" ");
    let folder = || Folder::new().with("c.ply", &colored).with("n.ply", ASCII_PLY);
    let scene = folder().scene(&format!("{declared}{}", shape("c.ply")));
    let loaded = scene.load();
    assert_eq!(loaded.description.materials[0].material, Material::Lambert { reflectance: Texture::VertexColor });
    let etendue_core::scene::ObjectShape::Mesh(mesh) = &loaded.description.objects[0].shape else { panic!() };
    assert_eq!(mesh.colors, vec![Rgb::new(0.5, 0.25, 1.0); 4]);
    assert_eq!(loaded.notes, ["ply in line 2: 4 vertex colours are above 1 and are moved there"]);
    // The second shape takes a material that has been read before.
    let bare = folder().scene(&format!("{declared}{}\n{}", shape("c.ply"), shape("n.ply")));
    assert_eq!(bare.error(), "scene.xml:3:1: the mesh has no vertex colours, which its texture asks for");
    assert!(bare.notes(LENIENT).iter().any(|n| n.ends_with("asks for; they count as white")));
    let wrong = format!("<shape type=\"cube\">{texture}</shape>");
    assert_eq!(flaw(&wrong), "scene.xml:2:1: a `cube` has no vertex colours, which its texture asks for");
    let face = wrong.replace("vertex_color", "face_color");
    assert_eq!(flaw(&face), "scene.xml:2:118: the mesh attribute `face_color` is not supported; `vertex_color` is");
}

#[test]
fn textures_that_are_wrong() {
    let inside = |inner: &str| {
        let text = format!("<shape type=\"cube\"><bsdf type=\"diffuse\">\n{inner}</bsdf></shape>");
        folder().scene(&text).error()
    };
    for (texture, expected) in [
        (
            "<texture name=\"reflectance\" type=\"bitmop\"/>",
            "scene.xml:3:35: the texture type `bitmop` is not supported (did you mean `bitmap`?); supported: bitmap, \
             checkerboard, mesh_attribute, scale",
        ),
        (
            "<texture name=\"reflectance\" type=\"bitmap\"/>",
            "scene.xml:3:1: the texture type `bitmap` needs the parameter `filename`",
        ),
        (
            "<texture name=\"reflectance\" type=\"checkerboard\"><float name=\"color0\" value=\"2\"/></texture>",
            "scene.xml:3:77: the parameter `color0` has a component above 1",
        ),
        (
            "<texture name=\"reflectance\" type=\"bitmap\"><string name=\"filename\" value=\"q.png\"/>\
             <string name=\"filter_type\" value=\"cubic\"/></texture>",
            "scene.xml:3:116: the parameter `filter_type` is `cubic`, none of bilinear, nearest, trilinear, ewa",
        ),
    ] {
        assert_eq!(inside(texture), expected);
    }
    let deep = "<texture name=\"reflectance\" type=\"scale\">".repeat(100_000) + &"</texture>".repeat(100_000);
    assert!(inside(&deep).ends_with("textures are nested more than 8 deep"));
    let circle = "<texture type=\"scale\" id=\"t\"><ref id=\"t\"/></texture><bsdf type=\"diffuse\"><ref id=\"t\" name=\"reflectance\"/></bsdf>";
    assert!(flaw(circle).ends_with("textures are nested more than 8 deep"));
}

#[test]
fn scaled_textures_are_textures() {
    let scaled = reflectance(
        "<texture name=\"reflectance\" type=\"scale\"><float name=\"scale\" value=\"3\"/><texture type=\"checkerboard\"/></texture>",
    );
    assert_eq!((at(&scaled, 0.1, 0.1), at(&scaled, 0.6, 0.1)), (Rgb::WHITE, Rgb::splat(0.2 * 3.0)));
}
