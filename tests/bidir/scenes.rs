//! Scenes for what the built-in ones lack.

use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness},
    camera::Projection,
    material::{Bitangent, Material, Relief},
    rgb::Rgb,
    scene::*,
    texture::{Bitmap, Texture},
};
use etendue_tests::small::*;
use glam::{DAffine3, DVec3, UVec2, Vec2};
use std::sync::Arc;

/// A texture of some noise between 0 and 1.
fn noise() -> Texture<Rgb> {
    let texels = (0..12).map(|i| Rgb::new(i as f32, (i * 5 % 12) as f32, (7 * i % 11) as f32) * (1.0 / 12.0)).collect();
    Texture::bitmap(Arc::new(Bitmap { width: 4, height: 3, texels }))
}

/// Every kind of light in a room without a ceiling under a sky: spheres, textured triangles and cylinders, points, spots with
/// and without a picture, a projector, a sun.
pub fn every_light(projection: Projection) -> SceneDescription {
    let shining = |object: Object| Object { emission: Some(noise()), ..object };
    let (from, to) = (DVec3::new(-1.2, 0.3, 0.8), DVec3::new(-0.5, 0.6, 1.1));
    let tube = ObjectShape::Cylinder { from, to, radius: 0.15, inverted: false };
    let disk = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.3),
        glam::DQuat::from_rotation_arc(DVec3::Z, DVec3::NEG_Y),
        DVec3::new(0.2, 1.6, -0.9),
    );
    let mut scene = lit_floor(
        3.0,
        vec![
            emitting(sphere("lamp", DVec3::new(0.6, 0.7, 0.0), 0.2, 1), 2.0),
            emitting(object("disk", ObjectShape::Disk, disk, 0), 3.0),
            shining(object("tube", tube, DAffine3::IDENTITY, 0)),
            shining(rectangle("panel", DVec3::new(0.0, 1.5, 0.5), DVec3::NEG_Y, (0.5, 0.3), 1)),
            rectangle("wall", DVec3::new(0.0, 1.0, 1.5), DVec3::NEG_Z, (1.5, 1.0), 0),
        ],
    );
    // No more floor than there is to see: rays from the sky fall on a disk as large as the world.
    scene.objects[0].to_world *= DAffine3::from_scale(DVec3::new(0.15, 0.15, 1.0));
    let position = DVec3::new(-1.0, 1.5, -0.5);
    let (beam, cutoff) = (0.3, 0.7);
    let intensity = Rgb::new(1.0, 0.5, 0.25);
    let spot = |image| {
        let direction = DVec3::new(1.0, -1.5, 0.5);
        DeltaLight::Spot { position, direction, intensity, beam, cutoff, image }
    };
    let to_world = look_at(DVec3::new(1.0, 2.0, -0.5), DVec3::new(0.3, 0.0, 0.0), DVec3::Z);
    for (name, kind) in [
        ("point", DeltaLight::Point { position: DVec3::new(0.9, 1.2, 0.9), intensity }),
        ("spot", spot(None)),
        ("picture", spot(Some((noise(), DVec3::Z)))),
        ("projector", DeltaLight::Projector { to_world, fov_x: 0.7, aspect: 1.3, irradiance: noise() }),
        ("sun", DeltaLight::Directional { direction: DVec3::new(0.3, -1.0, 0.2), irradiance: intensity }),
    ] {
        scene.lights.push(LightDescription { name: name.into(), kind });
    }
    scene.objects.push(sphere("ball", DVec3::new(-0.4, 0.4, -0.3), 0.3, 0));
    let camera = scene.camera.as_mut().expect("a camera");
    camera.projection = projection;
    camera.to_world = look_at(DVec3::new(0.0, 3.0, -3.0), DVec3::ZERO, DVec3::Y);
    camera.resolution = UVec2::splat(16);
    SceneDescription { name: "every light".into(), ..under_sky(scene, 0.1) }
}

/// What scatters in ways that the built-in scenes lack, in pairs of a ball's material and the floor's.
pub fn every_material() -> Vec<SceneDescription> {
    let texels: Vec<f32> = (0..35).map(|i| ((i * i * 7 + 3 * i) % 11) as f32 * 0.02).collect();
    let bump = Relief::Bump { height: Texture::bitmap(Arc::new(Bitmap { width: 7, height: 5, texels })), scale: 1.0 };
    let texels = (0..12).map(|i| Rgb::new((i % 5) as f32 * 0.2 + 0.1, (i * 7 % 4) as f32 * 0.3, 0.7)).collect();
    let normals = Texture::bitmap(Arc::new(Bitmap { width: 4, height: 3, texels }));
    let map = Relief::NormalMap { normals, bitangent: Bitangent::RightHanded };
    let on = |relief: &Relief, inner: Material| Material::Relief { relief: relief.clone(), material: Box::new(inner) };
    let white = || Material::lambert(Rgb::splat(0.7));
    let shiny = Roughness { distribution: Distribution::Ggx, alpha: Vec2::new(0.3, 0.2) };
    let fresnel = ConductorFresnel::Constant(Rgb::splat(0.8));
    let metal = || Material::conductor(fresnel, Some(shiny));
    let mask = |material| Material::Mask { opacity: 0.6.into(), material: Box::new(material) };
    let plastic = |roughness| Material::Plastic {
        eta: 1.5,
        diffuse: Rgb::new(0.6, 0.3, 0.2).into(),
        specular: Rgb::WHITE.into(),
        nonlinear: true,
        roughness,
    };
    let sheet = Material::ThinDielectric { eta: 1.5, reflectance: Rgb::WHITE.into(), transmittance: Rgb::WHITE.into() };
    [
        ("plastic", plastic(None), plastic(Some((Distribution::Ggx, 0.2)))),
        ("masks", mask(metal()), mask(white())),
        ("sheets", sheet, white()),
        ("bumpy floor", metal(), on(&bump, white())),
        ("mapped metal", on(&map, metal()), on(&bump, metal())),
        ("mapped mirror", on(&map, Material::conductor(fresnel, None)), on(&bump, white())),
        ("mapped glass", on(&map, Material::dielectric(1.5, None)), white()),
        ("glass that absorbs", Material::dielectric(1.5, None), white()),
        ("rough glass that absorbs", on(&bump, Material::dielectric(1.5, Some(shiny))), on(&map, white())),
    ]
    .into_iter()
    .map(|(name, ball, floor)| {
        let mut scene = lit_floor(3.0, vec![emitting(sphere("lamp", DVec3::new(1.2, 1.6, 0.3), 0.5, 1), 2.0)]);
        scene.materials.extend([material("ball", ball), material("floor", floor)]);
        scene.objects[0].material = 3;
        scene.objects[0].to_world *= DAffine3::from_scale(DVec3::splat(0.2));
        let absorption = name.ends_with("absorbs").then_some(Rgb::new(0.1, 1.0, 3.0));
        scene.objects.push(Object { absorption, ..sphere("ball", DVec3::new(-0.3, 0.7, 0.2), 0.6, 2) });
        // Something inside, for paths that are joined there.
        scene.objects.push(sphere("core", DVec3::new(-0.3, 0.7, 0.2), 0.2, 0));
        let mut scene = under_sky(scene, 0.1);
        let camera = scene.camera.as_mut().expect("a camera");
        camera.projection = Projection::Perspective { fov_x: 0.6 };
        camera.to_world = look_at(DVec3::new(0.0, 2.0, -3.0), DVec3::new(0.0, 0.3, 0.0), DVec3::Y);
        camera.resolution = UVec2::splat(16);
        SceneDescription { name: name.into(), ..scene }
    })
    .collect()
}
