//! What cylinders, textured lights, pictures, crops and absorbing objects may not be: refused with the name of the thing.

use etendue_core::{
    camera::Crop,
    rgb::Rgb,
    scene::*,
    texture::{Bitmap, Texture},
};
use etendue_tests::small::*;
use glam::{DAffine3, DVec3, UVec2};
use std::sync::Arc;

/// The scene as edited is refused with a message that has all the parts.
fn check(edit: &dyn Fn(&mut SceneDescription), parts: &[&str]) {
    let lamp = emitting(sphere("lamp", DVec3::Y * 3.0, 0.5, 1), 1.0);
    let mut scene = lit_floor(1.0, vec![sphere("ball", DVec3::Y, 0.5, 0), lamp]);
    edit(&mut scene);
    let message = Scene::new(&scene).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(parts.iter().all(|p| message.contains(p)), "{message:?} lacks one of {parts:?}");
}

fn texels(value: Rgb, width: u32) -> Texture<Rgb> {
    Texture::bitmap(Arc::new(Bitmap { width, height: 2, texels: vec![Rgb::WHITE, value, Rgb::WHITE, Rgb::WHITE] }))
}

fn light(kind: DeltaLight) -> impl Fn(&mut SceneDescription) {
    move |s| s.lights.push(LightDescription { name: "bulb".into(), kind: kind.clone() })
}

#[test]
fn cylinders_and_absorption() {
    let cylinder = |from: DVec3, to: DVec3, radius: f64| ObjectShape::Cylinder { from, to, radius, inverted: false };
    check(&|s| s.objects[1].shape = cylinder(DVec3::ZERO, DVec3::Y, 0.0), &["ball", "radius"]);
    check(&|s| s.objects[1].shape = cylinder(DVec3::ZERO, DVec3::Y, f64::NAN), &["ball", "radius"]);
    check(&|s| s.objects[1].shape = cylinder(DVec3::ONE, DVec3::ONE, 1.0), &["ball", "distance between its ends"]);
    check(&|s| s.objects[1].shape = cylinder(DVec3::NAN, DVec3::Y, 1.0), &["ball", "end 0", "not finite"]);
    check(&|s| s.objects[1].shape = cylinder(DVec3::ZERO, DVec3::Y * 1e-30, 1.0), &["ball", "axis in the world"]);
    let squeeze = |s: &mut SceneDescription| {
        s.objects[1].shape = cylinder(DVec3::ZERO, DVec3::Y, 1.0);
        s.objects[1].to_world.matrix3.x_axis *= 2.0;
    };
    check(&squeeze, &["ball", "a cylinder uniformly"]);
    check(&|s| s.objects[1].absorption = Some(Rgb::splat(-1.0)), &["ball", "absorption"]);
    check(&|s| s.objects[1].absorption = Some(Rgb::splat(f32::INFINITY)), &["ball", "absorption", "not finite"]);
}

#[test]
fn textured_emission() {
    check(&|s| s.objects[2].emission = Some(texels(Rgb::splat(-1.0), 2)), &["lamp", "emission"]);
    check(&|s| s.objects[2].emission = Some(texels(Rgb::splat(f32::NAN), 2)), &["lamp", "emission", "not finite"]);
    check(&|s| s.objects[2].emission = Some(texels(Rgb::WHITE, 3)), &["lamp", "3x2", "4 texels"]);
}

#[test]
fn crops() {
    let crop = |x, y, w, h| Some(Crop { offset: UVec2::new(x, y), size: UVec2::new(w, h) });
    for wrong in [crop(0, 0, 0, 4), crop(0, 0, 9, 4), crop(u32::MAX, 0, 2, 2), crop(7, 7, 2, 1)] {
        let edit = |s: &mut SceneDescription| {
            let camera = s.camera.as_mut().unwrap();
            (camera.resolution, camera.crop) = (UVec2::splat(8), wrong);
        };
        check(&edit, &["camera", "crop"]);
    }
}

#[test]
fn projectors() {
    let projector = |to_world, fov_x, aspect, irradiance: Texture<Rgb>| {
        light(DeltaLight::Projector { to_world, fov_x, aspect, irradiance })
    };
    let (here, white) = (DAffine3::IDENTITY, || Texture::from(Rgb::WHITE));
    for fov_x in [0.0, -1.0, std::f64::consts::PI, f64::NAN] {
        check(&projector(here, fov_x, 1.0, white()), &["light 'bulb'", "field of view"]);
    }
    for aspect in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
        check(&projector(here, 1.0, aspect, white()), &["light 'bulb'", "width over its height"]);
    }
    check(&projector(DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0)), 1.0, 1.0, white()), &["bulb", "singular"]);
    let mut skew = here;
    skew.matrix3.y_axis.x = 0.5;
    check(&projector(skew, 1.0, 1.0, white()), &["bulb", "skew"]);
    check(&projector(here, 1.0, 1.0, Rgb::splat(-1.0).into()), &["bulb", "irradiance"]);
    check(&projector(here, 1.0, 1.0, Texture::VertexColor), &["bulb", "no mesh"]);
}

#[test]
fn spots_with_images() {
    let spot = |cutoff, image: Texture<Rgb>, up| {
        let (position, direction) = (DVec3::Y, DVec3::NEG_Y);
        let image = Some((image, up));
        light(DeltaLight::Spot { position, direction, intensity: Rgb::WHITE, beam: 0.2, cutoff, image })
    };
    check(&spot(1.6, Rgb::WHITE.into(), DVec3::X), &["bulb", "cutoff", "below pi / 2"]);
    check(&spot(0.5, Rgb::WHITE.into(), DVec3::Y), &["bulb", "up in its image"]);
    check(&spot(0.5, Rgb::WHITE.into(), DVec3::ZERO), &["bulb", "up in its image"]);
    check(&spot(0.5, Rgb::WHITE.into(), DVec3::NAN), &["bulb", "up in the image", "not finite"]);
    check(&spot(0.5, texels(Rgb::splat(-1.0), 2), DVec3::X), &["bulb", "image"]);
    check(&spot(0.5, Texture::VertexColor, DVec3::X), &["bulb", "no mesh"]);
}

/// What the others are compared with is accepted.
#[test]
fn nothing_is_refused_without_reason() {
    let crop = Some(Crop { offset: UVec2::new(7, 6), size: UVec2::new(1, 2) });
    let edit = |s: &mut SceneDescription| {
        let camera = s.camera.as_mut().unwrap();
        (camera.resolution, camera.crop) = (UVec2::splat(8), crop);
        s.objects[1].shape = ObjectShape::Cylinder { from: DVec3::ZERO, to: DVec3::Y, radius: 1.0, inverted: true };
        s.objects[1].absorption = Some(Rgb::new(0.0, 1e-3, 1e3));
        s.objects[2].emission = Some(texels(Rgb::BLACK, 2));
        let (position, direction, image) = (DVec3::Y, DVec3::NEG_Y, Some((texels(Rgb::BLACK, 2), DVec3::X)));
        light(DeltaLight::Spot { position, direction, intensity: Rgb::WHITE, beam: 0.2, cutoff: 1.5, image })(s);
        let to_world = DAffine3::from_scale(DVec3::new(-3.0, 1.0, 2.0));
        light(DeltaLight::Projector { to_world, fov_x: 3.1, aspect: 1e-3, irradiance: texels(Rgb::BLACK, 2) })(s);
    };
    let mut scene = lit_floor(1.0, vec![sphere("ball", DVec3::Y, 0.5, 0), sphere("lamp", DVec3::Y, 0.5, 0)]);
    edit(&mut scene);
    let built = Scene::new(&scene).expect("nothing is wrong with it");
    assert_eq!(built.camera().resolution(), UVec2::new(1, 2));
}
