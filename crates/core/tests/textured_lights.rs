//! Area lights whose radiance varies: next-event estimation, emission and hits agree, and the choice goes by what is emitted.

mod sampling;

use etendue_core::{
    camera::{CameraDescription, Projection},
    geometry::{Mesh, offset::offset_origin},
    has::{ALL, TEXTURES},
    material::Material,
    ray::Ray,
    rgb::Rgb,
    scene::{NamedMaterial, Object, ObjectShape, Scene, SceneDescription},
    texture::{Bitmap, Interpolation, Texture, Wrap},
};
use glam::{Affine2, DAffine3, DQuat, DVec3, UVec2, Vec2, Vec3};
use sampling::{Moments, Random};
use std::{f64::consts::PI, sync::Arc};

fn scene(objects: Vec<(ObjectShape, DAffine3, Texture<Rgb>)>) -> Scene {
    let camera = CameraDescription {
        projection: Projection::Perspective { fov_x: 1.0 },
        to_world: DAffine3::IDENTITY,
        resolution: UVec2::ONE,
        crop: None,
    };
    let material = Material::lambert(Rgb::splat(0.5));
    let object = |(shape, to_world, emission)| Object {
        name: "light".into(),
        shape,
        to_world,
        material: 0,
        emission: Some(emission),
        absorption: None,
    };
    Scene::new(&SceneDescription {
        camera: Some(camera),
        materials: vec![NamedMaterial { name: "grey".into(), material, two_sided: true }],
        objects: objects.into_iter().map(object).collect(),
        ..SceneDescription::default()
    })
    .expect("the scene is valid")
}

fn noise() -> Texture<Rgb> {
    let mut random = Random::new(60);
    let texels = (0..35).map(|_| Rgb::new(random.f32(), random.f32(), random.f32())).collect();
    let bitmap = Arc::new(Bitmap { width: 7, height: 5, texels }).into();
    let to_uv = Affine2::from_scale_angle_translation(Vec2::new(1.3, 0.8), 0.3, Vec2::new(0.1, 0.2));
    Texture::Bitmap { bitmap, interpolation: Interpolation::Bilinear, wrap: Wrap::Mirror, to_uv }
}

fn mesh(uvs: bool) -> ObjectShape {
    ObjectShape::Mesh(Mesh {
        positions: vec![Vec3::ZERO, Vec3::new(1.0, 0.2, 0.0), Vec3::new(1.1, 1.0, 0.3), Vec3::new(-0.1, 0.9, 0.1)],
        uvs: if uvs { [(0.1, 0.2), (0.9, 0.1), (1.2, 0.8), (0.0, 1.1)].map(Vec2::from).to_vec() } else { vec![] },
        colors: [Rgb::WHITE, Rgb::new(1.0, 0.0, 0.5), Rgb::new(0.1, 0.2, 0.3), Rgb::new(0.0, 2.0, 0.0)].to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    })
}

fn cases() -> Vec<(&'static str, ObjectShape, Texture<Rgb>)> {
    let sphere = |inverted| ObjectShape::Sphere { center: DVec3::new(0.2, 0.0, -0.1), radius: 0.7, inverted };
    let (from, to) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.0, -0.4, 0.9));
    let cylinder = |inverted| ObjectShape::Cylinder { from, to, radius: 0.3, inverted };
    vec![
        ("sphere", sphere(false), noise()),
        ("inverted sphere", sphere(true), noise()),
        ("disk", ObjectShape::Disk, noise()),
        ("cylinder", cylinder(false), noise()),
        ("inverted cylinder", cylinder(true), noise()),
        ("rectangle", ObjectShape::Rectangle, noise()),
        ("cube", ObjectShape::Cube, noise()),
        ("mesh", mesh(true), noise()),
        ("mesh without coordinates", mesh(false), noise()),
        ("vertex colours", mesh(true), Texture::VertexColor),
    ]
}

fn to_world(mirrored: bool) -> DAffine3 {
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let scale = DVec3::new(if mirrored { -1.5 } else { 1.5 }, 1.5, 1.5);
    DAffine3::from_scale_rotation_translation(scale, rotation, DVec3::new(0.3, -0.2, 0.5))
}

/// A sampled point shines as it does when a ray hits it.
#[test]
fn sampled_points_shine_as_hits_do() {
    for ((name, shape, emission), mirrored) in cases().into_iter().flat_map(|c| [(c.clone(), false), (c, true)]) {
        let scene = scene(vec![(shape, to_world(mirrored), emission)]);
        assert_ne!(scene.has() & TEXTURES, 0);
        let mut random = Random::new(61);
        let (mut hits, mut other) = (0, 0);
        let mut check = |from: Vec3, target: Vec3, element: u32, radiance: Rgb| {
            let wi = (target - from).normalize();
            let ray = Ray::new(from, wi);
            let Some(hit) = scene.closest::<ALL>(&ray) else { return };
            let surface = scene.surface::<ALL>(&ray, &hit);
            if (surface.p - target).length() > 1e-4 || surface.ng.dot(wi) > -1e-2 {
                return;
            }
            hits += 1;
            if scene.element(&surface) != Some(element) {
                // At the edge between two triangles.
                other += 1;
                return;
            }
            let seen = scene.lights().emitted::<ALL>(element, &surface, -wi);
            let far = (0..3).map(|i| (seen.to_array()[i] - radiance.to_array()[i]).abs()).fold(0.0, f32::max);
            // What rounding of the point makes of the steepest slope, of 7 texels over the smallest shape.
            assert!(far < 2e-4, "{name}: {seen:?} instead of {radiance:?}");
        };
        for _ in 0..5000 {
            let mut point = || Vec3::new(random.f32(), random.f32(), random.f32()) * 2.0 - 1.0;
            let from = point() * 4.0;
            let inside = point() * 0.3;
            for from in [from, inside] {
                let s = scene.lights().sample_direct::<ALL>(from, random.f32(), random.vec2());
                if let Some(s) = s {
                    check(from, s.target, s.element, s.radiance);
                }
            }
            let s = scene.lights().sample_emission::<ALL>(random.f32(), random.vec2(), random.vec2());
            let s = s.expect("everything emits");
            // Back from a point ahead.
            let ahead = offset_origin(s.p, s.p_error, s.normal, s.direction) + s.direction * 0.05;
            check(ahead, s.p, s.element, s.radiance);
        }
        assert!(hits > 3000 && other < 20, "{name}: {hits} hits, {other} of another element");
    }
}

/// The flux that is emitted is the integral of the texture over the shape, here by hits from all around or by the shape's own
/// measure; and next-event estimation finds as much as hits do.
#[test]
fn what_is_sampled_is_what_is_seen() {
    for (name, shape, emission) in cases() {
        let scene = scene(vec![(shape, to_world(false), emission)]);
        // From a point near the middle of what shines inwards, in the shape's own space.
        let inside = |p: DVec3| (to_world(false).transform_point3(p) - scene.middle()).as_vec3();
        let from = match name {
            "inverted sphere" => inside(DVec3::new(0.3, 0.1, -0.2)),
            "inverted cylinder" => inside(DVec3::new(0.6, -0.1, 0.65)),
            _ => Vec3::new(0.4, 2.5, 3.0),
        };
        let mut random = Random::new(62);
        let (mut sampled, mut seen) = (Moments::default(), Moments::default());
        for _ in 0..300_000 {
            let s = scene.lights().sample_direct::<ALL>(from, random.f32(), random.vec2());
            sampled.add(s.map_or(0.0, |s| {
                let ray = Ray::segment(from, offset_origin(s.target, s.target_error, s.target_normal, -s.wi) - from);
                if scene.occluded::<ALL>(&ray) { 0.0 } else { f64::from(s.radiance.r / s.pdf_w) }
            }));
            // All directions, at the cost of many that see nothing.
            let u = random.vec2();
            let (z, phi) = (1.0 - 2.0 * u.x, 2.0 * PI as f32 * u.y);
            let (sin, cos) = phi.sin_cos();
            let r = (1.0 - z * z).max(0.0).sqrt();
            let wi = Vec3::new(r * cos, r * sin, z);
            let ray = Ray::new(from, wi);
            seen.add(scene.closest::<ALL>(&ray).map_or(0.0, |hit| {
                let surface = scene.surface::<ALL>(&ray, &hit);
                let element = scene.element(&surface).expect("all of it emits");
                4.0 * PI * f64::from(scene.lights().emitted::<ALL>(element, &surface, -wi).r)
            }));
        }
        let error = sampled.standard_error().hypot(seen.standard_error());
        let z = (sampled.mean() - seen.mean()) / error;
        assert!(z.abs() < 4.0 && seen.mean() > 0.0, "{name}: {} sampled, {} seen, {z}", sampled.mean(), seen.mean());
    }
}

#[test]
fn elements_are_chosen_by_what_they_emit() {
    // Stripes: the left half of the square emits, of its two triangles one more than the other; and all of it, elsewhere.
    let to_uv = Affine2 { matrix2: glam::Mat2::from_cols(Vec2::X, Vec2::ZERO), translation: Vec2::new(0.0, 0.25) };
    let half = Texture::Checkerboard { even: Rgb::splat(4.0), odd: Rgb::BLACK, to_uv };
    let apart = DAffine3::from_translation(DVec3::X * 5.0);
    let two = scene(vec![
        (ObjectShape::Rectangle, DAffine3::IDENTITY, half.clone()),
        (ObjectShape::Rectangle, apart, Rgb::splat(2.0).into()),
    ]);
    let p: Vec<f32> = (0..4).map(|i| two.lights().choice_probability(i)).collect();
    // The flux is the same; on the first square three quarters of it come from one triangle.
    assert!((p[0] + p[1] - 0.5).abs() < 0.02 && p[2] == p[3], "{p:?}");
    let share = p[1] / (p[0] + p[1]);
    assert!((share - (0.9 * 0.75 + 0.1 * 0.5)).abs() < 0.05, "{p:?}");
    // One texel of a hundred by a hundred: nothing of it is seen by the points that are looked at, but it is chosen.
    let mut texels = vec![Rgb::BLACK; 10_000];
    texels[4012] = Rgb::splat(1e4);
    let spark = Texture::Bitmap {
        bitmap: Arc::new(Bitmap { width: 100, height: 100, texels }).into(),
        interpolation: Interpolation::Nearest,
        wrap: Wrap::Repeat,
        to_uv: Affine2::IDENTITY,
    };
    let dark = Texture::Checkerboard { even: Rgb::BLACK, odd: Rgb::BLACK, to_uv: Affine2::IDENTITY };
    let lights = scene(vec![
        (ObjectShape::Disk, DAffine3::IDENTITY, spark),
        (ObjectShape::Disk, apart, Rgb::WHITE.into()),
        (ObjectShape::Disk, apart * apart, dark),
    ]);
    let p: Vec<f32> = (0..3).map(|i| lights.lights().choice_probability(i)).collect();
    assert!(p[0] > 0.05 && p[1] > 0.05 && p[2] == 0.0, "{p:?}");
    let mut random = Random::new(63);
    for _ in 0..1000 {
        let sample = lights.lights().sample_direct::<ALL>(Vec3::new(0.2, 0.1, 3.0), random.f32(), random.vec2());
        assert!(sample.is_none_or(|s| s.radiance.is_valid() && s.element < 2));
    }
}

/// A texture that says the same everywhere is the same light.
#[test]
fn constant_textures_are_plain_lights() {
    let plain = scene(vec![(ObjectShape::Disk, DAffine3::IDENTITY, Rgb::splat(3.0).into())]);
    assert_eq!(plain.has() & TEXTURES, 0);
    let texels = vec![Rgb::splat(3.0); 4];
    let same = Texture::bitmap(Arc::new(Bitmap { width: 2, height: 2, texels }));
    let textured = scene(vec![(ObjectShape::Disk, DAffine3::IDENTITY, same)]);
    let mut random = Random::new(64);
    for _ in 0..1000 {
        let (from, c, u) = (Vec3::new(random.f32(), random.f32(), random.f32()) + 0.1, random.f32(), random.vec2());
        let [a, b] =
            [plain.lights().sample_direct::<ALL>(from, c, u), textured.lights().sample_direct::<ALL>(from, c, u)];
        assert_eq!(a, b);
        assert_eq!(plain.lights().sample_direct::<0>(from, c, u), a);
    }
}
