//! Shading normals far from the geometric one: what is sampled is what the values say, nothing leaks, nothing is black.

mod sampling;

use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness, TransportMode},
    camera::{CameraDescription, Projection},
    geometry::Mesh,
    has::ALL,
    independent::independent,
    material::Material,
    ray::Ray,
    rgb::Rgb,
    sampler::Sampler,
    scene::{NamedMaterial, Object, ObjectShape, Scene, SceneDescription},
    statistics::render::Rays,
    walk::{Limits, SurfaceVertex, Vertex, Walk},
};
use glam::{DAffine3, DVec3, UVec2, Vec2, Vec3};
use sampling::{Cap, Moments, Random};
use std::f64::consts::PI;

const LIMITS: Limits = Limits { max_depth: 2, roulette_depth: 9 };

/// A large triangle in the plane y = 0 whose shading normal is tilted by `degrees` towards +x everywhere.
fn plate(material: Material, two_sided: bool, degrees: f32) -> Scene {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mesh = Mesh {
        positions: vec![Vec3::new(-9.0, 0.0, -9.0), Vec3::new(0.0, 0.0, 9.0), Vec3::new(9.0, 0.0, -9.0)],
        normals: vec![Vec3::new(sin, cos, 0.0); 3],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    Scene::new(&SceneDescription {
        camera: Some(CameraDescription {
            projection: Projection::Perspective { fov_x: 0.1 },
            to_world: DAffine3::from_translation(DVec3::splat(50.0)),
            resolution: UVec2::ONE,
            crop: None,
        }),
        materials: vec![NamedMaterial { name: "plate".into(), material, two_sided }],
        objects: vec![Object {
            name: "plate".into(),
            shape: ObjectShape::Mesh(mesh),
            to_world: DAffine3::IDENTITY,
            material: 0,
            emission: None,
            absorption: None,
        }],
        ..SceneDescription::default()
    })
    .expect("the scene is valid")
}

/// The ray that arrives from the direction `wo`, wherever the middle of the world is.
fn arriving(scene: &Scene, wo: Vec3) -> Ray {
    let middle = scene.camera().position() - Vec3::splat(50.0);
    Ray::new(middle + wo * 3.0, -wo)
}

fn met(scene: &Scene, wo: Vec3, mode: TransportMode) -> SurfaceVertex {
    let mut walk = Walk::<ALL>::new(scene, mode, LIMITS, arriving(scene, wo), Rgb::WHITE, 1.0);
    match walk.trace(&mut Rays::default()) {
        Vertex::Surface(vertex) => vertex,
        Vertex::Escaped(_) => panic!("nothing is met from {wo}"),
    }
}

fn scattered(scene: &Scene, wo: Vec3, mode: TransportMode, sampler: &mut dyn Sampler) -> Option<(Vec3, f32)> {
    let mut walk = Walk::<ALL>::new(scene, mode, LIMITS, arriving(scene, wo), Rgb::WHITE, 1.0);
    let Vertex::Surface(vertex) = walk.trace(&mut Rays::default()) else { panic!("nothing is met") };
    if !walk.scatter(&vertex, sampler) {
        return None;
    }
    match walk.trace(&mut Rays::default()) {
        Vertex::Escaped(end) => Some((end.direction, end.beta.g)),
        Vertex::Surface(_) => panic!("a plate meets itself"),
    }
}

fn rough(alpha: f32) -> Option<Roughness> {
    Some(Roughness { distribution: Distribution::Ggx, alpha: Vec2::splat(alpha) })
}

fn plastic() -> Material {
    Material::Plastic {
        eta: 1.5,
        diffuse: Rgb::splat(0.7).into(),
        specular: Rgb::WHITE.into(),
        nonlinear: false,
        roughness: Some((Distribution::Ggx, 0.3)),
    }
}

fn materials() -> [(&'static str, Material); 5] {
    [
        ("lambert", Material::lambert(Rgb::WHITE)),
        ("conductor", Material::conductor(ConductorFresnel::Constant(Rgb::WHITE), rough(0.4))),
        ("dielectric", Material::dielectric(1.5, rough(0.4))),
        ("plastic", plastic()),
        ("mask", Material::Mask { opacity: 0.6.into(), material: Box::new(Material::lambert(Rgb::WHITE)) }),
    ]
}

/// Directions that both normals see on one side, and such that they see on two; above and below.
const VIEWS: [Vec3; 5] = [
    Vec3::new(0.3, 0.8, 0.52),
    Vec3::new(-0.9, 0.3, 0.316),
    Vec3::new(-0.98, 0.15, -0.13),
    Vec3::new(0.95, -0.2, 0.24),
    Vec3::new(-0.5, -0.7, 0.51),
];
const TILTS: [f32; 3] = [20.0, 50.0, 80.0];

fn unit(random: &mut Random) -> Vec3 {
    let u = random.vec2();
    let (z, (sin, cos)) = (1.0 - 2.0 * u.x, (2.0 * PI as f32 * u.y).sin_cos());
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * cos, r * sin, z)
}

/// Directions are sampled with the density that is said, over the whole support of the values, and carry what the values
/// integrate to.
#[test]
fn directions_are_sampled_as_values_say() {
    for (name, material) in materials() {
        for (tilt, view) in TILTS.into_iter().zip([VIEWS[0], VIEWS[1], VIEWS[3]]) {
            let (scene, wo) = (plate(material.clone(), true, tilt), view.normalize());
            for mode in [TransportMode::Radiance, TransportMode::Importance] {
                let what = format!("{name}, {tilt} degrees, {wo}, {mode:?}");
                let vertex = met(&scene, wo, mode);
                let mut sampler = independent(80, 0);
                let (mut sampled, mut next) = (Moments::default(), 0);
                let straight = |w: Vec3| (w + wo).length() < 1e-5;
                let mut direction = || {
                    sampler.start_sample(next, 0);
                    next += 1;
                    let found = scattered(&scene, wo, mode, &mut *sampler).filter(|(w, _)| !straight(*w));
                    sampled.add(found.map_or(0.0, |(_, beta)| f64::from(beta)));
                    found.map(|(direction, _)| direction.as_dvec3())
                };
                // What carries nothing is not followed.
                let pdf = |w: DVec3| {
                    let (value, pdf) = vertex.eval_pdf::<ALL>(w.as_vec3(), mode);
                    if value.is_black() { 0.0 } else { f64::from(pdf) }
                };
                Cap::sphere(DVec3::Y).chi_square(&what, 100_000, 24, &mut direction, pdf);
                let (mut integral, mut random) = (Moments::default(), Random::new(81));
                for _ in 0..400_000 {
                    let (value, _) = vertex.eval_pdf::<ALL>(unit(&mut random), mode);
                    assert!(value.is_valid());
                    integral.add(f64::from(value.g) * 4.0 * PI);
                }
                let error = sampled.standard_error().hypot(integral.standard_error());
                let (a, b) = (sampled.mean(), integral.mean());
                assert!((a - b).abs() < 4.0 * error && b > 0.02, "{what}: {a} sampled, {b} by values, {error}");
            }
        }
    }
}

/// Both ends of a path agree on what it carries: `f |cos|` over the geometric cosine. The density of the walk the other way
/// is the density of that walk.
#[test]
fn both_directions_say_the_same() {
    let mut random = Random::new(82);
    for (name, material) in materials() {
        for two_sided in [true, false] {
            for tilt in TILTS {
                let scene = plate(material.clone(), two_sided, tilt);
                let mut lit = 0;
                for _ in 0..2000 {
                    let (a, b) = (unit(&mut random), unit(&mut random));
                    if a.y.abs() < 0.02 || b.y.abs() < 0.02 {
                        continue;
                    }
                    let camera = met(&scene, a, TransportMode::Radiance);
                    let light = met(&scene, b, TransportMode::Importance);
                    let (by_camera, camera_pdf) = camera.eval_pdf::<ALL>(b, TransportMode::Radiance);
                    let (by_light, light_pdf) = light.eval_pdf::<ALL>(a, TransportMode::Importance);
                    let (x, y) = (by_camera.g * a.y.abs(), by_light.g * b.y.abs());
                    let what = format!("{name}, {tilt} degrees, {a} {b}");
                    assert!((x - y).abs() < 1e-3 * (x + y) + 1e-6, "{what}: {x} {y}");
                    // Far from the peak, the half vector of a refraction is a small difference of two directions.
                    let same = |p: f32, q: f32| (p - q).abs() < 1e-4 * (p + q) + 1e-6;
                    let reverse = camera.pdf_reverse::<ALL>(b, TransportMode::Radiance);
                    assert!(same(reverse, light_pdf), "{what}: {reverse} {light_pdf}");
                    let reverse = light.pdf_reverse::<ALL>(a, TransportMode::Importance);
                    assert!(same(reverse, camera_pdf), "{what}: {reverse} {camera_pdf}");
                    lit += usize::from(x > 0.0);
                }
                assert!(lit > 100, "{name}: {lit}");
            }
        }
    }
}

/// An opaque surface reflects between all directions on one side of it, and between no others.
#[test]
fn the_surface_itself_decides_what_reflects() {
    let mut random = Random::new(83);
    for tilt in TILTS {
        let white = || Material::lambert(Rgb::WHITE);
        let (both, front) = (plate(white(), true, tilt), plate(white(), false, tilt));
        for _ in 0..5000 {
            let (a, b) = (unit(&mut random), unit(&mut random));
            if a.y.abs() < 0.01 || b.y.abs() < 0.01 {
                continue;
            }
            for mode in [TransportMode::Radiance, TransportMode::Importance] {
                let value = met(&both, a, mode).eval_pdf::<ALL>(b, mode).0;
                assert_eq!(value.g > 0.0, a.y * b.y > 0.0, "{tilt} degrees, {a} {b}: {}", value.g);
                let value = met(&front, a, mode).eval_pdf::<ALL>(b, mode).0;
                assert_eq!(value.g > 0.0, a.y > 0.0 && b.y > 0.0, "{tilt} degrees, {a} {b}: {}", value.g);
            }
        }
    }
}

/// A mirror reflects to its own side from everywhere, in both modes, and keeps all of the light in the sense of each.
#[test]
fn mirrors_are_nowhere_black() {
    let mut random = Random::new(84);
    for tilt in TILTS {
        let scene = plate(Material::conductor(ConductorFresnel::Constant(Rgb::WHITE), None), true, tilt);
        let ns = Vec3::new(tilt.to_radians().sin(), tilt.to_radians().cos(), 0.0);
        for i in 0..2000 {
            let wo = unit(&mut random);
            if wo.y.abs() < 0.02 || wo.dot(ns).abs() < 0.02 {
                continue;
            }
            for mode in [TransportMode::Radiance, TransportMode::Importance] {
                let mut sampler = independent(85, 0);
                sampler.start_sample(i, 0);
                let (wi, beta) = scattered(&scene, wo, mode, &mut *sampler).expect("a mirror reflects");
                assert!(wi.y * wo.y > 0.0, "{wo} to {wi}");
                let expected = match mode {
                    TransportMode::Radiance => 1.0,
                    // [Veach 1997, eq. 5.19], both cosines to the shading normal being the same.
                    TransportMode::Importance => (wi.y / wo.y).abs(),
                };
                assert!((beta - expected).abs() < 2e-3 * expected, "{wo} to {wi}: {beta}, not {expected}");
            }
        }
    }
}

/// The weights of paths from lights are bounded where they scatter: at most twice what arrives on the shading normal.
#[test]
fn weights_of_paths_from_lights_are_bounded() {
    for tilt in TILTS {
        let scene = plate(Material::lambert(Rgb::WHITE), true, tilt);
        let ns = Vec3::new(tilt.to_radians().sin(), tilt.to_radians().cos(), 0.0);
        for view in VIEWS {
            let wo = view.normalize();
            let most = 2.0 * wo.dot(ns).abs() / wo.y.abs();
            let (mut sampler, mut found) = (independent(86, 0), 0.0f32);
            for i in 0..20_000 {
                sampler.start_sample(i, 0);
                let beta = scattered(&scene, wo, TransportMode::Importance, &mut *sampler).map_or(0.0, |(_, b)| b);
                found = found.max(beta);
            }
            assert!(found <= most * 1.001 && found > 0.5 * most, "{tilt} degrees, {wo}: {found} of {most}");
        }
    }
}
