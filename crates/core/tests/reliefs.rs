//! Reliefs: the frames and values of Mitsuba, and paths from lights that find what paths from the camera do.

mod sampling;

use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness, TransportMode},
    camera::{CameraDescription, Projection},
    has::ALL,
    independent::independent,
    material::{Bitangent, Material, Relief},
    ray::Ray,
    rgb::Rgb,
    sampler::Sampler,
    scene::{NamedMaterial, Object, ObjectShape, Scene, SceneDescription},
    statistics::render::Rays,
    texture::{Bitmap, Interpolation, Texel, Texture, Wrap},
    walk::{Limits, SurfaceVertex, Vertex, Walk},
};
use glam::{Affine2, DAffine3, DMat3, DQuat, DVec3, Mat2, UVec2, Vec2, Vec3};
use sampling::{Cap, Moments, Random};
use std::{f64::consts::PI, sync::Arc};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Bump,
    Map,
}
use Kind::*;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Sphere,
    Rectangle,
    Cube,
}
use Shape::*;

#[derive(Clone, Copy, Debug, PartialEq)]
enum On {
    Lambert,
    Stretched,
}
use On::*;

#[rustfmt::skip]
const HEIGHTS: [f32; 20] = [
    0.22, 0.87, 0.21, 0.92, 0.49, 0.61, 0.77, 0.52, 0.3, 0.19, 0.08, 0.74, 0.44, 0.16, 0.88, 0.27, 0.41, 0.3, 0.63, 0.58,
];
#[rustfmt::skip]
const NORMALS: [[f32; 3]; 12] = [
    [0.58, 0.31, 0.43], [0.3, 0.36, 0.32], [0.23, 0.87, 0.97], [0.25, 0.12, 0.36], [0.66, 0.72, 0.22], [0.56, 0.1, 0.61],
    [0.61, 0.89, 0.41], [0.74, 0.8, 0.94], [0.1, 0.48, 0.99], [0.42, 0.75, 0.64], [0.72, 0.49, 0.22], [0.17, 0.19, 0.4],
];

/// Mitsuba's images have their first row at `v = 0`.
fn texture<T: Texel>(texels: Vec<T>, width: u32) -> Texture<T> {
    let bitmap = Arc::new(Bitmap { width, height: texels.len() as u32 / width, texels }).into();
    let to_uv = Affine2 { matrix2: Mat2::from_diagonal(Vec2::new(1.0, -1.0)), translation: Vec2::Y };
    Texture::Bitmap { bitmap, interpolation: Interpolation::Bilinear, wrap: Wrap::Repeat, to_uv }
}

fn relief(kind: Kind, bitangent: Bitangent) -> Relief {
    match kind {
        Bump => Relief::Bump { height: texture(HEIGHTS.to_vec(), 5), scale: 0.8 },
        Map => {
            let texels = NORMALS.map(|[r, g, b]| Rgb::new(r, g, b)).to_vec();
            Relief::NormalMap { normals: texture(texels, 3), bitangent }
        }
    }
}

fn on(material: On) -> Material {
    let roughness = Roughness { distribution: Distribution::Ggx, alpha: Vec2::new(0.5, 0.2) };
    match material {
        Lambert => Material::lambert(Rgb::WHITE),
        Stretched => Material::conductor(ConductorFresnel::Constant(Rgb::WHITE), Some(roughness)),
    }
}

fn rough_glass() -> Material {
    let roughness = Roughness { distribution: Distribution::Ggx, alpha: Vec2::new(0.5, 0.2) };
    Material::dielectric(1.5, Some(roughness))
}

/// A shape scaled by 1.5, turned by 40 degrees about (1, 2, 3) and moved, seen by a camera of one pixel.
fn scene(shape: Shape, material: Material, two_sided: bool, from: DVec3, to: DVec3) -> Scene {
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 40f64.to_radians());
    let to_world = DAffine3::from_scale_rotation_translation(DVec3::splat(1.5), rotation, DVec3::new(0.3, -0.2, 0.5));
    let forward = (to - from).normalize();
    let left = forward.any_orthonormal_vector();
    let axes = DMat3::from_cols(left, forward.cross(left), forward);
    let shape = match shape {
        Sphere => ObjectShape::Sphere { center: DVec3::ZERO, radius: 1.0, inverted: false },
        Rectangle => ObjectShape::Rectangle,
        Cube => ObjectShape::Cube,
    };
    Scene::new(&SceneDescription {
        camera: Some(CameraDescription {
            projection: Projection::Perspective { fov_x: 0.1 },
            to_world: DAffine3::from_mat3_translation(axes, from),
            resolution: UVec2::ONE,
            crop: None,
        }),
        materials: vec![NamedMaterial { name: "relief".into(), material, two_sided }],
        objects: vec![Object { name: "shape".into(), shape, to_world, material: 0, emission: None, absorption: None }],
        ..SceneDescription::default()
    })
    .expect("the scene is valid")
}

const LIMITS: Limits = Limits { max_depth: 2, roulette_depth: 9 };

fn seen(scene: &Scene) -> SurfaceVertex {
    let mut walk = Walk::<ALL>::from_camera(scene, LIMITS, Vec2::splat(0.5), Vec2::ZERO);
    match walk.trace(&mut Rays::default()) {
        Vertex::Surface(vertex) => vertex,
        Vertex::Escaped(_) => panic!("nothing is seen"),
    }
}

/// Mitsuba 3.9.1 (`scalar_rgb`), `bsdf.eval` and `bsdf.pdf` of a `bumpmap` (scale 0.8) and a `normalmap` on `diffuse` and on
/// `roughconductor` (ggx, alpha_u 0.5, alpha_v 0.2, all reflected), seen from the first point towards the second, for light from
/// the direction after. What is seen from behind is `twosided`. Bump maps on stretched highlights are left out: there Mitsuba
/// takes a tangent of the world for one of the surface.
type Row = (Kind, Shape, On, [f64; 3], [f64; 3], [f32; 3], f32, f32);
#[expect(clippy::approx_constant, reason = "a coordinate happens to be 3.14")]
#[rustfmt::skip]
const MITSUBA: [Row; 36] = [
    (Bump, Sphere, Lambert, [1.62, 4.46, 4.04], [1.33, 0.71, 0.9], [-0.2308889, -0.0689668, 0.9705328], 0.04493423, 0.05154373),
    (Bump, Sphere, Lambert, [-4.87, 2.85, 0.69], [-0.09, 0.45, 0.27], [-0.8811366, -0.4400682, 0.1730268], 0.01690279, 0.01740869),
    (Bump, Sphere, Lambert, [3.89, 4.35, 2.06], [0.9, 0.97, 1.89], [0.7306804, 0.6047355, -0.3168614], 0.024151, 0.1224684),
    (Bump, Sphere, Lambert, [0.56, -4.77, 4.38], [0.47, 0.08, 0.05], [0.4949292, -0.6099128, 0.6189115], 0.2579439, 0.2580256),
    (Bump, Rectangle, Lambert, [4.76, -2.19, 3.99], [0.16, 0.08, 0.09], [0.1580874, 0.9575297, 0.2411334], 0.1383461, 0.1483416),
    (Bump, Rectangle, Lambert, [4.15, -3.11, 4.06], [0.41, -1.05, 1.83], [-0.1980214, -0.9781056, 0.06400691], 0.05905412, 0.1667651),
    (Bump, Rectangle, Lambert, [4.91, 2.25, 3.46], [1.7, -0.03, 0.8], [-0.1530534, -0.9833432, -0.09803422], 0.0, 0.0),
    (Bump, Rectangle, Lambert, [3.86, -4.01, 3.46], [0.51, -0.93, 0.55], [0.8761906, -0.2830616, 0.3900849], 0.2831913, 0.2850693),
    (Bump, Rectangle, Lambert, [4.34, -2.59, -3.23], [0.37, 0.71, 1.47], [-0.8834816, 0.2651445, -0.3862105], 0.181393, 0.1833609),
    (Bump, Rectangle, Lambert, [-4.64, 2.31, -1.8], [-0.25, 0.33, 0.43], [-0.5332013, 0.7162704, -0.45017], 0.2406612, 0.2416952),
    (Bump, Cube, Lambert, [0.14, 3.48, 5.23], [1.26, 1.13, 0.54], [-0.3469093, 0.7168126, 0.6048419], 0.2771994, 0.277384),
    (Bump, Cube, Lambert, [-1.81, 4.74, -2.16], [-0.95, 0.63, 0.78], [0.05497293, 0.761625, 0.6456821], 0.2609531, 0.2622197),
    (Bump, Cube, Lambert, [-1.38, -3.11, -4.47], [0.3, -0.51, 0.79], [0.01700794, -0.8513977, -0.5242449], 0.1579647, 0.1632832),
    (Bump, Cube, Lambert, [2.15, 5.21, 2.32], [0.18, 0.75, 0.7], [0.3740933, 0.6671665, 0.6441607], 0.2524165, 0.2548636),
    (Map, Sphere, Lambert, [-0.72, -5.68, -1.73], [-0.08, -0.21, 0.07], [-0.4609433, -0.4499447, 0.7649059], 0.086851, 0.1108838),
    (Map, Sphere, Lambert, [-1.94, 0.84, -4.97], [0.19, -0.56, 0.17], [-0.1120586, -0.9935197, 0.01900994], 0.0, 0.0),
    (Map, Sphere, Lambert, [0.55, 3.32, 5.35], [0.58, 0.54, -1.42], [0.3620367, 0.7320743, 0.5770586], 0.0002828055, 0.0003007939),
    (Map, Sphere, Lambert, [2.67, -0.3, -5.01], [0.08, 0.1, 0.15], [0.1429376, -0.4498037, 0.8816153], 0.0, 0.0),
    (Map, Sphere, Stretched, [3.09, 0.77, 5.72], [0.91, -0.13, 1.3], [0.9503626, 0.3111187, 0.004001527], 0.008163855, 0.008714646),
    (Map, Sphere, Stretched, [-5.54, 0.82, 1.43], [-0.37, 0.89, 0.5], [-0.931047, -0.3630183, -0.03700187], 0.00415807, 0.01774817),
    (Map, Sphere, Stretched, [1.43, -5.79, -1.35], [1.31, -0.02, 0.52], [0.5300665, -0.2600326, -0.8071013], 0.2738639, 0.2871358),
    (Map, Sphere, Stretched, [5.21, -3.64, 0.86], [0.6, -1.13, -0.22], [-0.2189576, -0.3749275, 0.9008257], 0.0, 0.0),
    (Map, Rectangle, Lambert, [-3.16, -0.68, 5.38], [0.6, 0.61, -0.03], [0.2529356, 0.3799033, 0.8897736], 0.3030159, 0.3046816),
    (Map, Rectangle, Lambert, [4.3, 2.67, 3.93], [-0.27, 0.15, -0.32], [0.5843917, -0.498334, 0.6404292], 0.2294003, 0.2301282),
    (Map, Rectangle, Lambert, [-4.23, 0.35, 4.39], [0.75, 0.7, -0.24], [0.6528871, -0.398931, 0.6438886], 0.0, 0.0),
    (Map, Rectangle, Lambert, [3.45, 1.42, 5.34], [0.81, -0.07, 0.97], [-0.4420765, 0.8511473, 0.283049], 0.01172692, 0.2455156),
    (Map, Rectangle, Stretched, [-2.26, 0.07, 5.92], [0.54, -0.25, 0.89], [-0.09900564, 0.614035, 0.7830446], 0.00206962, 0.003632402),
    (Map, Rectangle, Stretched, [3.07, 5.03, 1.47], [-0.47, -0.24, 0.01], [-0.1580183, 0.302035, 0.9401091], 0.0009125689, 0.003761682),
    (Map, Rectangle, Stretched, [-3.49, 0.02, 5.15], [0.68, -0.72, 0.64], [0.316907, 0.882741, -0.3468982], 0.0, 0.0),
    (Map, Rectangle, Stretched, [1.23, -5.29, 3.53], [0.64, -0.95, 0.07], [-0.9704931, -0.0720366, 0.2301169], 0.0, 0.0),
    (Map, Rectangle, Lambert, [-4.38, -1.49, -3.02], [0.1, 0.27, -0.09], [0.01999435, 0.6568145, -0.7537871], 0.1084928, 0.109502),
    (Map, Rectangle, Lambert, [-4.17, -2.6, -2.7], [0.51, -0.47, 0.85], [-0.8906678, -0.4468334, -0.08396869], 0.0, 0.0),
    (Map, Cube, Lambert, [5.09, -3.81, 0.49], [0.98, 0.07, 1.6], [0.4321277, -0.6011777, 0.6721987], 0.2196288, 0.2360818),
    (Map, Cube, Lambert, [-2.91, 4.87, 0.37], [1.14, -2.16, 1.03], [-0.09999555, 0.6919692, 0.7149682], 0.2907003, 0.293213),
    (Map, Cube, Lambert, [6.25, -0.99, 0.62], [-0.4, -0.27, 0.57], [0.3028942, 0.8007202, -0.5168194], 0.1913829, 0.1936297),
    (Map, Cube, Lambert, [-3.63, 3.49, 3.14], [1.08, 0.75, 0.35], [-0.8623601, -0.2110881, -0.4601922], 0.0, 0.0),
];

#[test]
fn reliefs_scatter_as_in_mitsuba() {
    let (mut turned, mut dark) = (0, 0);
    for (kind, shape, material, from, to, light, value, density) in MITSUBA {
        let nested =
            Material::Relief { relief: relief(kind, Bitangent::RightHanded), material: Box::new(on(material)) };
        let scene = scene(shape, nested, true, from.into(), to.into());
        let vertex = seen(&scene);
        let light = Vec3::from(light);
        let (found, pdf) = vertex.eval_pdf::<ALL>(light, TransportMode::Radiance);
        let what = format!("{kind:?} {shape:?} {material:?} {from:?} {light}");
        assert!((found.g - value).abs() < 1e-4 * (1.0 + value), "{what}: {} instead of {value}", found.g);
        // Its density for metals is another, of visible normals alone; ours is tested by itself.
        if material == Lambert && value > 0.0 {
            assert!((pdf - density).abs() < 1e-4, "{what}: density {pdf} instead of {density}");
        }
        let tilt = vertex.tilt.expect("a relief");
        turned += usize::from(vertex.frame.normal != tilt.normals(vertex.wo)[0]);
        dark += usize::from(value == 0.0);
    }
    assert!(turned > 5 && dark > 0, "{turned} turned, {dark} dark");
}

/// Where a walk that came along `ray` goes on to, and its throughput then.
fn scattered(scene: &Scene, mode: TransportMode, ray: Ray, sampler: &mut dyn Sampler) -> Option<(Vec3, f32)> {
    let mut walk = Walk::<ALL>::new(scene, mode, LIMITS, ray, Rgb::WHITE, 1.0);
    let Vertex::Surface(vertex) = walk.trace(&mut Rays::default()) else { panic!("nothing is met") };
    if !walk.scatter(&vertex, sampler) {
        return None;
    }
    match walk.trace(&mut Rays::default()) {
        Vertex::Escaped(end) => Some((end.direction, end.beta.g)),
        Vertex::Surface(_) => panic!("the shape is convex"),
    }
}

/// Directions are sampled with the density that is said, carry in the mean what the values integrate to, and not more than
/// came; from the camera and from lights.
#[test]
fn reliefs_are_sampled_as_they_scatter() {
    // Straight on, aslant, grazing: towards the middle of the rectangle, all of which they meet.
    let to = [0.3, -0.2, 0.5];
    let rays = [([3.0, 2.0, 4.0], to), ([-4.0, 1.0, 3.5], to), ([1.0, -5.0, 1.0], to)];
    for kind in [Bump, Map] {
        for (material, shape, (from, to)) in [
            (Lambert, Sphere, rays[0]),
            (Lambert, Rectangle, rays[1]),
            (Lambert, Rectangle, rays[2]),
            (Stretched, Sphere, rays[2]),
            (Stretched, Rectangle, rays[0]),
        ] {
            let nested = Material::Relief { relief: relief(kind, Bitangent::AlongV), material: Box::new(on(material)) };
            let scene = scene(shape, nested, true, from.into(), to.into());
            let ray = scene.camera().sample_ray(Vec2::splat(0.5), Vec2::ZERO);
            for mode in [TransportMode::Radiance, TransportMode::Importance] {
                let what = format!("{kind:?} {material:?} {shape:?} {from:?} {mode:?}");
                let mut walk = Walk::<ALL>::new(&scene, mode, LIMITS, ray, Rgb::WHITE, 1.0);
                let Vertex::Surface(vertex) = walk.trace(&mut Rays::default()) else { panic!("nothing is met") };
                let mut sampler = independent(70, 0);
                let (mut sampled, mut next) = (Moments::default(), 0);
                let mut direction = || {
                    sampler.start_sample(next, 0);
                    next += 1;
                    let found = scattered(&scene, mode, ray, &mut *sampler);
                    sampled.add(found.map_or(0.0, |(_, beta)| f64::from(beta)));
                    found.map(|(direction, _)| direction.as_dvec3())
                };
                // What carries nothing is not followed.
                let pdf = |w: DVec3| {
                    let (value, pdf) = vertex.eval_pdf::<ALL>(w.as_vec3(), mode);
                    if value.is_black() { 0.0 } else { f64::from(pdf) }
                };
                Cap::sphere(vertex.surface.ng.as_dvec3()).chi_square(&what, 100_000, 24, &mut direction, pdf);
                let (mut integral, mut random) = (Moments::default(), Random::new(71));
                for _ in 0..400_000 {
                    let u = random.vec2();
                    let (z, (sin, cos)) = (1.0 - 2.0 * u.x, (2.0 * PI as f32 * u.y).sin_cos());
                    let r = (1.0 - z * z).max(0.0).sqrt();
                    let (value, _) = vertex.eval_pdf::<ALL>(Vec3::new(r * cos, r * sin, z), mode);
                    assert!(value.is_valid());
                    integral.add(f64::from(value.g) * 4.0 * PI);
                }
                let error = sampled.standard_error().hypot(integral.standard_error());
                let (a, b) = (sampled.mean(), integral.mean());
                assert!((a - b).abs() < 4.0 * error && b > 0.02, "{what}: {a} sampled, {b} by values, {error}");
                // A light's path is worth more than came where shading normals gather light: a bound for the camera alone.
                assert!(mode == TransportMode::Importance || a < 1.0 + 4.0 * error, "{what}: {a}");
            }
        }
    }
}

/// What a path from the camera says of light from there is what a path from there says of the camera, but for the cosines
/// that belong to the ends: `f |cos|` over the geometric cosine.
#[test]
fn both_directions_say_the_same() {
    let (from, to) = (DVec3::new(3.0, 2.0, 4.0), DVec3::new(0.3, -0.2, 0.5));
    for (kind, material, two_sided) in [Bump, Map].into_iter().flat_map(|kind| {
        [
            (kind, on(Lambert), true),
            (kind, on(Stretched), true),
            (kind, on(Stretched), false),
            (kind, rough_glass(), true),
        ]
    }) {
        for shape in [Sphere, Rectangle] {
            let nested =
                Material::Relief { relief: relief(kind, Bitangent::AlongV), material: Box::new(material.clone()) };
            let scene = scene(shape, nested, two_sided, from, to);
            let middle = scene.camera().position() + scene.camera().forward() * from.distance(to) as f32;
            let mut random = Random::new(72);
            let (mut compared, mut lit) = (0, 0);
            for _ in 0..20_000 {
                let mut unit = || {
                    let u = random.vec2();
                    let (z, (sin, cos)) = (1.0 - 2.0 * u.x, (2.0 * PI as f32 * u.y).sin_cos());
                    let r = (1.0 - z * z).max(0.0).sqrt();
                    Vec3::new(r * cos, r * sin, z)
                };
                let (axis, across, light) = (unit(), unit(), unit());
                let target = middle + across * if shape == Sphere { 1.4 } else { 0.9 };
                let origin = target + axis * 5.0;
                let ray = Ray::new(origin, (target - origin).normalize());
                let look = |ray: Ray, mode| match Walk::<ALL>::new(&scene, mode, LIMITS, ray, Rgb::WHITE, 1.0)
                    .trace(&mut Rays::default())
                {
                    Vertex::Surface(vertex) => Some(vertex),
                    Vertex::Escaped(_) => None,
                };
                let Some(camera) = look(ray, TransportMode::Radiance) else { continue };
                let p = camera.surface.p;
                let Some(back) = look(Ray::new(p + light * 3.0, -light), TransportMode::Importance) else { continue };
                // The point again, unless the shape itself is between.
                if back.surface.p.distance(p) > 1e-5 || light.dot(camera.surface.ng).abs() < 0.05 {
                    continue;
                }
                let (by_camera, _) = camera.eval_pdf::<ALL>(light, TransportMode::Radiance);
                let (by_light, _) = back.eval_pdf::<ALL>(camera.wo, TransportMode::Importance);
                let ng = camera.surface.ng;
                let a = by_camera.g * camera.wo.dot(ng).abs();
                let b = by_light.g * light.dot(ng).abs();
                compared += 1;
                lit += usize::from(a > 0.0);
                assert!((a - b).abs() < 1e-3 * (a + b) + 1e-5, "{kind:?} {material:?} {shape:?} {two_sided}: {a} {b}");
            }
            assert!(compared > 1000 && lit > 300, "{kind:?} {material:?} {shape:?}: {lit} of {compared}");
        }
    }
}

/// A flat relief is none, and one that holds no direction changes nothing.
#[test]
fn flat_reliefs_change_nothing() {
    let (from, to) = (DVec3::new(3.0, 2.0, 4.0), DVec3::new(0.6, 0.3, 0.9));
    let plain = seen(&scene(Rectangle, on(Lambert), true, from, to));
    let map = |color: Rgb| Relief::NormalMap { normals: color.into(), bitangent: Bitangent::RightHanded };
    for relief in [Relief::Bump { height: 0.7.into(), scale: 3.0 }, map(Rgb::new(0.5, 0.5, 1.0)), map(Rgb::splat(0.5))]
    {
        let nested = Material::Relief { relief, material: Box::new(on(Lambert)) };
        let vertex = seen(&scene(Rectangle, nested, true, from, to));
        assert!((vertex.frame.normal - plain.frame.normal).length() < 1e-6);
        for wi in [Vec3::new(0.3, 0.2, 0.9), Vec3::new(-0.2, 0.8, 0.3)].map(Vec3::normalize) {
            for mode in [TransportMode::Radiance, TransportMode::Importance] {
                let (a, b) = (vertex.eval_pdf::<ALL>(wi, mode), plain.eval_pdf::<ALL>(wi, mode));
                assert!((a.0.g - b.0.g).abs() < 1e-5 && (a.1 - b.1).abs() < 1e-5, "{a:?} {b:?}");
            }
        }
    }
}

/// Mirrored texture coordinates mirror a map that follows them, and leave one that does not.
#[test]
fn normal_maps_follow_mirrored_coordinates_or_not() {
    // Each face of the cube has mirrored coordinates.
    let (from, to) = (DVec3::new(0.14, 3.48, 5.23), DVec3::new(1.26, 1.13, 0.54));
    let green = |bitangent| {
        let relief = Relief::NormalMap { normals: Rgb::new(0.5, 0.9, 0.9).into(), bitangent };
        let nested = Material::Relief { relief, material: Box::new(on(Lambert)) };
        let vertex = seen(&scene(Cube, nested, true, from, to));
        vertex.tilt.expect("a relief").normals(vertex.wo)[0].dot(vertex.surface.dpdv.normalize())
    };
    let expected = 0.5f32.sqrt();
    assert!((green(Bitangent::AlongV) - expected).abs() < 1e-5);
    assert!((green(Bitangent::RightHanded) + expected).abs() < 1e-5);
}
