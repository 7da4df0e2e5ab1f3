//! Rays that leave lights: they carry the analytic flux, and follow their densities.

mod sampling;

use etendue_core::{
    geometry::{Cylinder, Disk, Sphere},
    has::ALL,
    lights::{
        AreaLight, AreaShape, BoundingSphere, EmissionSample, LightChoice, Lights,
        environment::{Environment, Rows},
    },
    rgb::Rgb,
    scene::DeltaLight,
    texture::Bitmap,
};
use glam::{DMat3, DVec3, Vec3};
use sampling::{Cap, Moments, Random, chi_square};
use std::{f64::consts::PI, sync::Arc};

const WORLD: BoundingSphere = BoundingSphere { center: Vec3::new(1.0, -2.0, 0.5), radius: 4.0 };
const SPHERE: Sphere = Sphere { center: Vec3::new(0.5, 0.2, 0.1), radius: 0.7, inverted: false };
const DISK: Disk = Disk { center: Vec3::new(0.0, 1.0, 0.0), normal: Vec3::new(0.0, -0.6, 0.8), radius: 0.4 };
const CYLINDER: Cylinder =
    Cylinder { from: Vec3::new(0.5, 0.2, 0.1), axis: Vec3::new(0.6, 0.0, -0.8), radius: 0.3, inverted: false };
const TRIANGLE: [Vec3; 3] = [Vec3::new(-1.0, 2.0, -1.0), Vec3::new(1.5, 2.0, -0.5), Vec3::new(0.2, 2.5, 1.5)];

fn area(shape: AreaShape) -> Lights {
    Lights::build(
        vec![AreaLight { shape, emission: Rgb::WHITE.into(), primitive: u32::MAX }],
        vec![],
        None,
        WORLD,
        LightChoice::Power,
    )
}

fn delta(light: DeltaLight) -> Lights {
    Lights::build(vec![], vec![light], None, WORLD, LightChoice::Power)
}

fn spot(beam: f64, cutoff: f64) -> DeltaLight {
    let (position, direction) = (DVec3::new(0.3, 0.2, 0.1), DVec3::new(1.0, -2.0, 0.5));
    DeltaLight::Spot { position, direction, intensity: Rgb::WHITE, beam, cutoff, image: None }
}

fn noise() -> Environment {
    let mut random = Random::new(30);
    let texels = (0..40).map(|_| Rgb::new(random.f32(), random.f32(), random.f32())).collect();
    let image = Arc::new(Bitmap { width: 8, height: 5, texels });
    Environment::LatLong { image, scale: 3.0, to_world: DMat3::from_rotation_x(0.4), rows: Rows::Centred }
}

fn sky(environment: Environment) -> Lights {
    Lights::build(vec![], vec![], Some(environment), WORLD, LightChoice::Power)
}

fn sample(lights: &Lights, random: &mut Random) -> Option<EmissionSample> {
    let sample = lights.sample_emission::<ALL>(random.f32(), random.vec2(), random.vec2())?;
    let density = lights.emission_density(sample.element, sample.normal, sample.direction);
    assert_eq!((density.choice, density.pdf_a, density.pdf_w), (sample.choice, sample.pdf_a, sample.pdf_w));
    assert!((sample.direction.length() - 1.0).abs() < 1e-5 && sample.weight().is_valid());
    Some(sample)
}

#[test]
fn the_mean_weight_is_the_flux() {
    let disk_of_world = PI * 16.0;
    let inverted = Sphere { inverted: true, ..SPHERE };
    let triangle_area = 0.5 * (TRIANGLE[1] - TRIANGLE[0]).cross(TRIANGLE[2] - TRIANGLE[0]).as_dvec3().length();
    // Integral of the falloff by the midpoint rule.
    let spot_integral = |beam: f64, cutoff: f64| -> f64 {
        let steps = 100_000;
        let term = |i: i32| {
            let theta = cutoff * (f64::from(i) + 0.5) / f64::from(steps);
            let falloff = if theta <= beam { 1.0 } else { (cutoff - theta) / (cutoff - beam) };
            falloff * 2.0 * PI * theta.sin() * cutoff / f64::from(steps)
        };
        (0..steps).map(term).sum()
    };
    let cases = [
        ("triangle", area(AreaShape::Triangle(TRIANGLE)), PI * triangle_area),
        ("sphere", area(AreaShape::Sphere(SPHERE)), 4.0 * PI * PI * 0.49),
        ("inverted sphere", area(AreaShape::Sphere(inverted)), 4.0 * PI * PI * 0.49),
        ("disk", area(AreaShape::Disk(DISK)), PI * PI * 0.16),
        ("cylinder", area(AreaShape::Cylinder(CYLINDER)), 2.0 * PI * PI * 0.3),
        ("point", delta(DeltaLight::Point { position: DVec3::X, intensity: Rgb::WHITE }), 4.0 * PI),
        ("spot", delta(spot(0.4, 0.7)), spot_integral(0.4, 0.7)),
        ("wide spot", delta(spot(0.0, 3.1)), spot_integral(0.0, 3.1)),
        ("hard spot", delta(spot(0.5, 0.5)), 2.0 * PI * (1.0 - 0.5f64.cos())),
        ("laser", delta(spot(1e-3, 2e-3)), spot_integral(1e-3, 2e-3)),
        (
            "directional",
            delta(DeltaLight::Directional { direction: DVec3::ONE, irradiance: Rgb::WHITE }),
            disk_of_world,
        ),
        ("constant environment", sky(Environment::Constant(Rgb::WHITE)), 4.0 * PI * disk_of_world),
    ];
    for (name, lights, flux) in cases {
        let (mut random, mut moments) = (Random::new(31), Moments::default());
        for _ in 0..100_000 {
            moments.add(sample(&lights, &mut random).map_or(0.0, |s| f64::from(s.weight().r)));
        }
        moments.assert_mean(name, flux);
    }
}

#[test]
fn the_weights_of_all_lights_add_up() {
    let shapes = [AreaShape::Sphere(SPHERE), AreaShape::Disk(DISK), AreaShape::Triangle(TRIANGLE)];
    let shapes: Vec<_> = shapes
        .iter()
        .map(|&shape| AreaLight { shape, emission: Rgb::new(1.0, 0.2, 3.0).into(), primitive: u32::MAX })
        .collect();
    let points = vec![spot(0.3, 0.9), DeltaLight::Directional { direction: DVec3::Y, irradiance: Rgb::splat(0.1) }];
    let mut expected = 0.0;
    let (mut random, n) = (Random::new(32), 400_000);
    for single in shapes
        .iter()
        .map(|s| Lights::build(vec![s.clone()], vec![], None, WORLD, LightChoice::Power))
        .chain([delta(points[0].clone()), delta(points[1].clone()), sky(noise())])
    {
        // One light alone: its luminance is the same for every ray.
        let mut alone = Moments::default();
        (0..1000)
            .for_each(|_| alone.add(sample(&single, &mut random).map_or(0.0, |s| f64::from(s.weight().luminance()))));
        assert!(alone.standard_error() < 1e-6 * alone.mean());
        expected += alone.mean();
    }
    for choice in [LightChoice::Power, LightChoice::Uniform] {
        let all = Lights::build(shapes.clone(), points.clone(), Some(noise()), WORLD, choice);
        let mut moments = Moments::default();
        (0..n).for_each(|_| moments.add(sample(&all, &mut random).map_or(0.0, |s| f64::from(s.weight().luminance()))));
        moments.assert_mean(&format!("{choice:?}"), expected);
    }
}

#[test]
fn directions_follow_their_density() {
    // The direction's density and, where the normal varies, the one about it.
    let position = DVec3::ZERO;
    let axis = DVec3::new(1.0, -2.0, 0.5).normalize();
    let cases = [
        ("disk", area(AreaShape::Disk(DISK)), Cap::sphere(DISK.normal.as_dvec3())),
        ("point", delta(DeltaLight::Point { position, intensity: Rgb::WHITE }), Cap::sphere(DVec3::Y)),
        ("spot", delta(spot(0.4, 0.7)), Cap::of_angle(axis, 0.7, 16, 16)),
        ("wide spot", delta(spot(0.2, 3.1)), Cap::sphere(axis)),
        ("hard spot", delta(spot(0.5, 0.5)), Cap::of_angle(axis, 0.5, 16, 16)),
        ("laser", delta(spot(1e-3, 2e-3)), Cap::of_angle(axis, 2e-3, 8, 8)),
        ("constant environment", sky(Environment::Constant(Rgb::WHITE)), Cap::sphere(DVec3::Y)),
        ("environment", sky(noise()), Cap::sphere(DVec3::Y)),
    ];
    for (name, lights, cap) in cases {
        let mut random = Random::new(33);
        let direction = || Some(sample(&lights, &mut random)?.direction.as_dvec3());
        let pdf = |w: DVec3| f64::from(lights.emission_density(0, DISK.normal, w.as_vec3()).pdf_w);
        cap.chi_square(name, 100_000, 24, direction, pdf);
    }
}

/// Directions about the normal of a sphere, and points: both uniform in coordinates of equal measure.
#[test]
fn positions_follow_their_density() {
    let n = 100_000;
    let grid = 16.0;
    let cell = |x: f64, y: f64| ((x * grid).min(grid - 1.0) as usize) * 16 + (y * grid).min(grid - 1.0) as usize;
    let turn = |x: f64, y: f64| (y.atan2(x) / (2.0 * PI)).rem_euclid(1.0);
    let check = |name: &str, lights: Lights, square: &dyn Fn(EmissionSample) -> (f64, f64)| {
        let mut random = Random::new(34);
        let mut counts = vec![0.0; 256];
        for _ in 0..n {
            let (x, y) = square(sample(&lights, &mut random).expect("every ray carries light"));
            assert!((-1e-5..1.0 + 1e-5).contains(&x) && (-1e-5..1.0 + 1e-5).contains(&y), "{name}: {x} {y}");
            counts[cell(x.max(0.0), y.max(0.0))] += 1.0;
        }
        chi_square(name, &counts, &[f64::from(n) / 256.0; 256]);
    };
    // A triangle: barycentrics to the square by the classical map's inverse, b0 = 1 - sqrt(x).
    check("triangle", area(AreaShape::Triangle(TRIANGLE)), &|s| {
        let [p0, p1, p2] = TRIANGLE.map(|p| p.as_dvec3());
        let (e1, e2, q) = (p1 - p0, p2 - p0, s.p.as_dvec3() - p0);
        let normal = e1.cross(e2);
        let (b1, b2) = (q.cross(e2).dot(normal), e1.cross(q).dot(normal));
        let (b1, b2) = (b1 / normal.length_squared(), b2 / normal.length_squared());
        ((b1 + b2).powi(2), b2 / (b1 + b2))
    });
    for inverted in [false, true] {
        check("sphere", area(AreaShape::Sphere(Sphere { inverted, ..SPHERE })), &|s| {
            let q = (s.p - SPHERE.center).as_dvec3() / 0.7;
            let outwards = if inverted { -s.normal } else { s.normal };
            assert!((q - outwards.as_dvec3()).length() < 1e-5 && s.normal.dot(s.direction) > 0.0);
            (0.5 + 0.5 * q.z, turn(q.x, q.y))
        });
        // Cosine about the normal: the squared sine and the azimuth are uniform.
        check("sphere's directions", area(AreaShape::Sphere(Sphere { inverted, ..SPHERE })), &|s| {
            let (d, normal) = (s.direction.as_dvec3(), s.normal.as_dvec3().normalize());
            let (a, b) = normal.any_orthonormal_pair();
            (1.0 - d.dot(normal).powi(2), turn(d.dot(a), d.dot(b)))
        });
    }
    check("disk", area(AreaShape::Disk(DISK)), &|s| {
        let q = (s.p - DISK.center).as_dvec3();
        let (a, b) = DISK.normal.as_dvec3().any_orthonormal_pair();
        (q.length_squared() / 0.16, turn(q.dot(a), q.dot(b)))
    });
    for inverted in [false, true] {
        check("cylinder", area(AreaShape::Cylinder(Cylinder { inverted, ..CYLINDER })), &|s| {
            let (q, axis) = ((s.p - CYLINDER.from).as_dvec3(), CYLINDER.axis.as_dvec3());
            let outwards = s.normal.as_dvec3() * if inverted { -0.3 } else { 0.3 };
            assert!((q - axis * q.dot(axis) - outwards).length() < 1e-6 && s.normal.dot(s.direction) > 0.0);
            let (a, b) = axis.any_orthonormal_pair();
            (q.dot(axis), turn(q.dot(a), q.dot(b)))
        });
    }
    let sun = DeltaLight::Directional { direction: DVec3::new(1.0, 2.0, 3.0), irradiance: Rgb::WHITE };
    for (name, lights) in [("directional", delta(sun)), ("environment", sky(noise()))] {
        check(name, lights, &|s| {
            assert!(s.infinite && s.normal == s.direction);
            let d = s.direction.as_dvec3();
            let q = (s.p - WORLD.center).as_dvec3();
            // On the disk that touches the world's sphere from where the light comes.
            assert!((q.dot(d) + 4.0).abs() < 1e-5);
            let (a, b) = d.any_orthonormal_pair();
            ((q + d * 4.0).length_squared() / 16.0, turn(q.dot(a), q.dot(b)))
        });
    }
}
