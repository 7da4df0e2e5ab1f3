//! Next-event estimation: every sampling routine follows its density, and gives the analytic irradiance.

mod sampling;

use etendue_core::{
    geometry::{Cylinder, Disk, Sphere},
    has::ALL,
    lights::{AreaLight, AreaShape, BoundingSphere, LightChoice, Lights, environment::Environment},
    rgb::Rgb,
    scene::DeltaLight,
};
use glam::{DVec3, Vec2, Vec3};
use sampling::{Cap, Moments, Random, chi_square};
use std::f64::consts::PI;

const WORLD: BoundingSphere = BoundingSphere { center: Vec3::ZERO, radius: 20.0 };

fn area(shape: AreaShape) -> AreaLight {
    AreaLight { shape, emission: Rgb::new(1.0, 2.0, 4.0).into(), primitive: u32::MAX }
}

fn sphere(center: Vec3, radius: f32, inverted: bool) -> AreaLight {
    area(AreaShape::Sphere(Sphere { center, radius, inverted }))
}

fn disk(center: Vec3, normal: Vec3, radius: f32) -> AreaLight {
    area(AreaShape::Disk(Disk { center, normal: normal.normalize(), radius }))
}

fn cylinder(from: Vec3, axis: Vec3, radius: f32, inverted: bool) -> AreaLight {
    area(AreaShape::Cylinder(Cylinder { from, axis, radius, inverted }))
}

fn lights(area: Vec<AreaLight>) -> Lights {
    Lights::build(area, vec![], None, WORLD, LightChoice::Power)
}

/// Where a ray first meets a shape on the side that emits, by double precision; `None` also behind another point.
fn hit(shape: &AreaShape, o: DVec3, d: DVec3) -> Option<(Vec3, Vec3)> {
    let (t, normal) = match shape {
        AreaShape::Triangle(v) => {
            let [p0, p1, p2] = v.map(|p| p.as_dvec3());
            let (e1, e2) = (p1 - p0, p2 - p0);
            let n = e1.cross(e2);
            let t = (p0 - o).dot(n) / d.dot(n);
            let q = o + d * t - p0;
            let (b1, b2) = (q.cross(e2).dot(n) / n.length_squared(), e1.cross(q).dot(n) / n.length_squared());
            if b1 < 0.0 || b2 < 0.0 || b1 + b2 > 1.0 {
                return None;
            }
            (t, n.normalize())
        }
        AreaShape::Disk(disk) => {
            let (c, n) = (disk.center.as_dvec3(), disk.normal.as_dvec3());
            let t = (c - o).dot(n) / d.dot(n);
            if (o + d * t).distance(c) > f64::from(disk.radius) {
                return None;
            }
            (t, n)
        }
        AreaShape::Sphere(s) => {
            let (c, r) = (s.center.as_dvec3() - o, f64::from(s.radius));
            let along = c.dot(d);
            let root = (r * r - (c - d * along).length_squared()).sqrt();
            let t = if along - root > 0.0 { along - root } else { along + root };
            ((t), (d * t - c) / r * if s.inverted { -1.0 } else { 1.0 })
        }
        AreaShape::Cylinder(c) => {
            let (axis, r) = (c.axis.as_dvec3(), f64::from(c.radius));
            let [f, e] = [o - c.from.as_dvec3(), d].map(|v| v - axis * (v.dot(axis) / axis.length_squared()));
            let along = -f.dot(e) / e.length_squared();
            let root = ((r * r - (f + e * along).length_squared()) / e.length_squared()).sqrt();
            // The outer side emits where the line enters, the inner one where it leaves.
            let t = if c.inverted { along + root } else { along - root };
            let height = (o + d * t - c.from.as_dvec3()).dot(axis) / axis.length_squared();
            if !(0.0..=1.0).contains(&height) {
                return None;
            }
            (t, (f + e * t) / r * if c.inverted { -1.0 } else { 1.0 })
        }
    };
    (t > 0.0 && normal.dot(d) < 0.0).then(|| ((o + d * t).as_vec3(), normal.as_vec3()))
}

/// The density of all the lights together, as a path tracer that hits them finds it.
fn pdf_of_hits(lights: &Lights, area: &[AreaLight], from: Vec3, w: DVec3) -> f64 {
    let pdf = |(element, light): (usize, &AreaLight)| {
        let (p, ng) = hit(&light.shape, from.as_dvec3(), w)?;
        Some(f64::from(lights.pdf_direct(element as u32, from, p, ng, w.as_vec3())))
    };
    area.iter().enumerate().filter_map(pdf).sum()
}

#[track_caller]
fn check_directions(what: &str, shapes: Vec<AreaLight>, from: Vec3, cap: &Cap) {
    check_directions_finely(what, shapes, from, cap, 48);
}

/// With the density integrated over `fine` x `fine` points a cell.
#[track_caller]
fn check_directions_finely(what: &str, shapes: Vec<AreaLight>, from: Vec3, cap: &Cap, fine: usize) {
    let lights = lights(shapes.clone());
    let mut random = Random::new(1);
    let sample = || Some(lights.sample_direct::<ALL>(from, random.f32(), random.vec2())?.wi.as_dvec3());
    cap.chi_square(what, 100_000, fine, sample, |w| pdf_of_hits(&lights, &shapes, from, w));
}

const TRIANGLE: AreaShape =
    AreaShape::Triangle([Vec3::new(-1.0, 2.0, -1.0), Vec3::new(1.5, 2.0, -0.5), Vec3::new(0.2, 2.5, 1.5)]);

#[test]
fn directions_to_area_lights_follow_their_density() {
    let up = Cap::sphere(DVec3::Y);
    check_directions("triangle", vec![area(TRIANGLE)], Vec3::ZERO, &up);
    check_directions("triangle from nearby", vec![area(TRIANGLE)], Vec3::new(0.1, 1.9, 0.0), &up);
    // Nearly in the triangle's plane: it is seen as a sliver.
    let flat = AreaShape::Triangle([Vec3::new(0.0, 1.0, 0.0), Vec3::new(3.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 3.0)]);
    let sideways = Cap::of_angle(DVec3::new(1.0, 0.0, 1.0).normalize(), 0.56, 24, 48);
    check_directions_finely("triangle from its plane", vec![area(flat)], Vec3::new(-1.0, 0.9, -1.0), &sideways, 128);
    let tilted = disk(Vec3::new(1.0, 2.0, 0.0), Vec3::new(-1.0, -1.5, 0.3), 0.8);
    check_directions("disk", vec![tilted.clone()], Vec3::new(0.0, 0.3, 0.1), &up);
    check_directions("sphere", vec![sphere(Vec3::new(0.0, 2.0, 1.0), 1.0, false)], Vec3::ZERO, &up);
    let touching = Vec3::new(0.0, 0.999, 0.0);
    check_directions("sphere from nearby", vec![sphere(Vec3::new(0.0, 2.0, 0.0), 1.0, false)], touching, &up);
    check_directions("inside", vec![sphere(Vec3::ZERO, 1.0, true)], Vec3::new(0.3, 0.6, -0.1), &up);
    check_directions("centre", vec![sphere(Vec3::ZERO, 1.0, true)], Vec3::ZERO, &up);
    let tube = |inverted| vec![cylinder(Vec3::new(-1.0, 1.0, 0.5), Vec3::new(2.0, 0.5, 0.3), 0.6, inverted)];
    check_directions("cylinder", tube(false), Vec3::ZERO, &up);
    check_directions("cylinder from nearby", tube(false), Vec3::new(0.0, 0.58, 0.6), &up);
    check_directions("in a cylinder", tube(true), Vec3::new(0.2, 1.4, 0.5), &up);
    check_directions("into a cylinder", tube(true), Vec3::new(-2.0, 1.0, 0.3), &up);
    let several = vec![area(TRIANGLE), tilted, sphere(Vec3::new(-2.0, -1.0, 1.0), 0.7, false)];
    check_directions("several", several, Vec3::ZERO, &up);
}

#[test]
fn directions_to_tiny_lights_follow_their_density() {
    for (radius, distance) in [(1e-2, 10.0), (1e-4, 1.0), (1e-4, 10.0)] {
        // Towards an axis of the world, where single precision resolves a cone of 1e-5.
        let center = Vec3::new(0.0, 0.0, distance);
        let cap = Cap::of_angle(DVec3::Z, 1.0001 * f64::from(radius / distance), 8, 16);
        check_directions("tiny sphere", vec![sphere(center, radius, false)], Vec3::ZERO, &cap);
        check_directions("tiny disk", vec![disk(center, -Vec3::Z, radius)], Vec3::ZERO, &cap);
    }
}

#[test]
fn lights_are_chosen_with_the_probability_that_is_said() {
    let flux = |radius: f32| 4.0 * PI * PI * f64::from(radius).powi(2) * f64::from(Rgb::new(1.0, 2.0, 4.0).luminance());
    let radii: Vec<f32> = (0..300).map(|i| if i % 7 == 3 { 0.0 } else { 0.01 * (i % 50 + 1) as f32 }).collect();
    let all: Vec<_> = radii.iter().map(|&r| sphere(Vec3::new(0.0, 5.0, 0.0), r, false)).collect();
    let total: f64 = radii.iter().map(|&r| flux(r)).sum();
    for choice in [LightChoice::Power, LightChoice::Uniform] {
        let lights = Lights::build(all.clone(), vec![], None, WORLD, choice);
        let lit = radii.iter().filter(|r| **r > 0.0).count() as f64;
        let mut counts = vec![0.0; all.len()];
        let mut random = Random::new(2);
        let n = 300_000;
        for _ in 0..n {
            let sample =
                lights.sample_direct::<ALL>(Vec3::ZERO, random.f32(), random.vec2()).expect("all are in sight");
            counts[sample.element as usize] += 1.0;
        }
        let mut expected = vec![0.0; all.len()];
        for (i, &radius) in radii.iter().enumerate() {
            let p = match choice {
                LightChoice::Power => flux(radius) / total,
                LightChoice::Uniform if radius > 0.0 => 1.0 / lit,
                LightChoice::Uniform => 0.0,
            };
            assert!((f64::from(lights.choice_probability(i as u32)) - p).abs() <= 1e-6 * p);
            expected[i] = p * f64::from(n);
        }
        chi_square("choice", &counts, &expected);
    }
}

/// Among very many lights one 24-bit number alone cannot tell a light from its alias.
#[test]
fn a_million_lights_are_chosen_by_their_power() {
    let n = 1_000_000;
    let triangle = |i: usize| AreaLight {
        shape: AreaShape::Triangle([Vec3::Y, Vec3::Y + Vec3::X, Vec3::Y + Vec3::Z]),
        emission: Rgb::splat(if i.is_multiple_of(100) { 52.0 } else { 1.0 }).into(),
        primitive: u32::MAX,
    };
    let lights = lights((0..n).map(triangle).collect());
    assert!(lights.table_bytes() <= 92 * n as u64);
    let p: f64 = (0..n as u32).step_by(100).map(|i| f64::from(lights.choice_probability(i))).sum();
    assert!((p - 52.0 / 151.0).abs() < 1e-6);
    let mut bright = Moments::default();
    let mut random = Random::new(3);
    for _ in 0..1_000_000 {
        if let Some(sample) = lights.sample_direct::<ALL>(Vec3::new(0.2, 0.0, 0.2), random.f32(), random.vec2()) {
            bright.add(f64::from(u8::from(sample.element % 100 == 0)));
        }
    }
    bright.assert_mean("share of the bright", 52.0 / 151.0);
    // One dim light's own frequency: all 24-bit numbers near its place in the table, with many numbers for its points.
    for light in [12_345u32, 600_001, 999_999] {
        let steps = 2f64.powi(24);
        let first = (f64::from(light) / n as f64 * steps) as u32 - 2;
        let mut own = Moments::default();
        for step in 0..500_000 {
            let u = f64::from(first + step % 20) / steps;
            let chosen =
                lights.sample_direct::<ALL>(Vec3::new(0.2, 0.0, 0.2), u.min(1.0 - 1.0 / steps) as f32, random.vec2());
            own.add(f64::from(u8::from(u < 1.0 && chosen.is_some_and(|s| s.element == light))));
        }
        let p = f64::from(lights.choice_probability(light)) * steps / 20.0;
        own.assert_mean(&format!("light {light}"), p);
    }
}

/// Irradiance at `from` on a plane with normal `n`, as next-event estimation gives it.
fn irradiance(lights: &Lights, from: Vec3, n: Vec3, samples: usize, seed: u64) -> Moments {
    let mut random = Random::new(seed);
    let mut moments = Moments::default();
    for _ in 0..samples {
        let sample = lights.sample_direct::<ALL>(from, random.f32(), random.vec2());
        moments.add(sample.map_or(0.0, |s| {
            assert!(s.pdf_w > 0.0 && s.pdf_w.is_finite() && s.radiance.is_valid());
            assert!((s.wi.length() - 1.0).abs() < 1e-6);
            f64::from(s.radiance.r * s.wi.dot(n).max(0.0) / s.pdf_w)
        }));
    }
    moments
}

/// Irradiance from a polygon of radiance 1 above the horizon [Lambert 1760; Arvo 1994].
fn polygon(vertices: &[DVec3], from: DVec3, n: DVec3) -> f64 {
    let edge = |i: usize| {
        let (a, b) = ((vertices[i] - from).normalize(), (vertices[(i + 1) % vertices.len()] - from).normalize());
        a.angle_between(b) * a.cross(b).normalize().dot(n)
    };
    0.5 * (0..vertices.len()).map(edge).sum::<f64>().abs()
}

#[test]
fn irradiance_of_a_rectangle() {
    let corners = [(-1.0, -2.0), (1.0, -2.0), (1.0, 0.5), (-1.0, 0.5)].map(|(x, z)| Vec3::new(x, 1.5, z));
    let [a, b, c, d] = corners;
    // Normals point down.
    let two = lights(vec![area(AreaShape::Triangle([a, b, c])), area(AreaShape::Triangle([a, c, d]))]);
    for (from, n) in [
        (Vec3::ZERO, Vec3::Y),
        (Vec3::new(0.4, 1.2, 0.1), Vec3::new(0.1, 1.0, 0.05).normalize()),
        (Vec3::new(5.0, -3.0, 2.0), Vec3::new(-1.0, 1.0, -0.2).normalize()),
        (Vec3::new(0.0, 1.5, 1.2), -Vec3::Z),
        (Vec3::new(0.0, 1.499, 1.2), -Vec3::Z),
    ] {
        let exact =
            if from.y < 1.5 { polygon(&corners.map(|c| c.as_dvec3()), from.as_dvec3(), n.as_dvec3()) } else { 0.0 };
        let found = irradiance(&two, from, n, 400_000, 4);
        if exact > 0.0 {
            found.assert_mean(&format!("rectangle from {from}"), exact);
        } else {
            // In the plane itself, what rounding of the points makes of nothing.
            assert!(found.mean() < 1e-7, "{}", found.mean());
        }
    }
    // Nothing behind.
    assert!(two.sample_direct::<ALL>(Vec3::new(0.0, 2.0, 0.0), 0.5, Vec2::splat(0.5)).is_none());
}

#[test]
fn irradiance_of_spheres_and_disks() {
    for (center, radius) in [
        (Vec3::new(0.5, 2.0, -1.0), 1.0),
        (Vec3::new(0.0, 1.001, 0.0), 1.0),
        (Vec3::new(3.0, 9.0, 1.0), 1e-3),
        (Vec3::new(3.0, 9.0, 1.0), 1e-4),
        (Vec3::new(3e4, 1e5, 0.0), 9e4),
    ] {
        let d = center.as_dvec3().length();
        let exact = PI * (f64::from(radius) / d).powi(2) * center.as_dvec3().normalize().y;
        let light = lights(vec![sphere(center, radius, false)]);
        irradiance(&light, Vec3::ZERO, Vec3::Y, 200_000, 5).assert_mean(&format!("sphere of {radius}"), exact);
    }
    // Inside a sphere that emits inwards: a uniform hemisphere, wherever.
    let around = lights(vec![sphere(Vec3::ZERO, 2.0, true)]);
    for from in [Vec3::ZERO, Vec3::new(0.5, -1.2, 0.3), Vec3::new(0.0, 0.0, 1.99)] {
        irradiance(&around, from, Vec3::Y, 400_000, 6).assert_mean("inside", PI);
    }
    // On the axis of a cylinder that emits inwards: what its open end does not take.
    for (radius, height) in [(1.0f32, 2.0f32), (2.0, 0.5)] {
        let axis = Vec3::new(0.0, 2.0 * height, 0.0);
        let exact = PI * f64::from(height * height / (radius * radius + height * height));
        let light = lights(vec![cylinder(-0.5 * axis, axis, radius, true)]);
        irradiance(&light, Vec3::ZERO, Vec3::Y, 400_000, 13).assert_mean("in a cylinder", exact);
    }
    for (radius, distance) in [(1.0, 2.0), (3.0, 0.5), (1e-4, 1.0)] {
        let exact = PI * (radius * radius / (radius * radius + distance * distance));
        let light = lights(vec![disk(Vec3::new(0.0, distance as f32, 0.0), -Vec3::Y, radius as f32)]);
        irradiance(&light, Vec3::ZERO, Vec3::Y, 200_000, 7).assert_mean("disk", exact);
    }
}

#[test]
fn irradiance_of_lights_without_extent_and_of_a_constant_environment() {
    let position = DVec3::new(1.0, 2.0, -0.5);
    let cos3 = |p: DVec3| p.y / p.length().powi(3);
    let delta = |light| Lights::build(vec![], vec![light], None, WORLD, LightChoice::Power);
    let intensity = Rgb::new(5.0, 1.0, 1.0);
    let point = delta(DeltaLight::Point { position, intensity });
    irradiance(&point, Vec3::ZERO, Vec3::Y, 10, 8).assert_mean("point", 5.0 * cos3(position));
    // Values of Mitsuba 3.9.1: a spot light at (0, 3, 0) that looks down, intensity (1, 2, 3), cutoff_angle 40,
    // beam_width 25, `sample_direction` from (x, 0, 0).
    let spot = |beam: f64, cutoff: f64| {
        let (position, direction) = (DVec3::new(0.0, 3.0, 0.0), DVec3::new(0.0, -2.0, 0.0));
        let (beam, cutoff) = (beam.to_radians(), cutoff.to_radians());
        delta(DeltaLight::Spot { position, direction, intensity: Rgb::new(1.0, 2.0, 3.0), beam, cutoff, image: None })
    };
    for (x, red) in [(0.0, 0.111_111_12), (1.0, 0.1), (1.5, 0.079_614_6), (1.8, 0.049_217_008), (2.2, 0.018_045_124)] {
        let s =
            spot(25.0, 40.0).sample_direct::<ALL>(Vec3::new(x, 0.0, 0.0), 0.5, Vec2::splat(0.5)).expect("in the cone");
        assert!((s.radiance.r - red).abs() < 2e-6 && (s.radiance.b - 3.0 * red).abs() < 6e-6, "{x}: {:?}", s.radiance);
        assert!(s.delta && s.pdf_w == 1.0 && s.target_normal == Vec3::ZERO);
    }
    assert!(spot(25.0, 40.0).sample_direct::<ALL>(Vec3::new(2.6, 0.0, 0.0), 0.5, Vec2::splat(0.5)).is_none());
    // No falloff at all: all or nothing.
    let hard = spot(30.0, 30.0);
    let lit = |x: f32| hard.sample_direct::<ALL>(Vec3::new(x, 0.0, 0.0), 0.5, Vec2::ZERO).map(|s| s.radiance.g);
    assert!((lit(1.73).expect("just inside") - 2.0 / (9.0 + 1.73 * 1.73)).abs() < 1e-6 && lit(1.74).is_none());

    let direction = DVec3::new(0.3, -2.0, 0.4);
    let sun = delta(DeltaLight::Directional { direction, irradiance: Rgb::splat(7.0) });
    let exact = -7.0 * direction.normalize().y;
    irradiance(&sun, Vec3::splat(3.0), Vec3::Y, 10, 9).assert_mean("directional", exact);
    assert!(sun.has_infinite() && !point.has_infinite());

    let sky = Lights::build(vec![], vec![], Some(Environment::Constant(Rgb::splat(0.5))), WORLD, LightChoice::Power);
    irradiance(&sky, Vec3::ONE, Vec3::Y, 200_000, 10).assert_mean("constant environment", 0.5 * PI);
    assert_eq!(sky.environment_pdf(Vec3::Y), (0.25 / PI) as f32);
}

#[test]
fn all_kinds_together_add_up() {
    let environment = Some(Environment::Constant(Rgb::splat(0.01)));
    let delta = vec![
        DeltaLight::Point { position: DVec3::new(0.0, 4.0, 0.0), intensity: Rgb::splat(8.0) },
        DeltaLight::Directional { direction: -DVec3::Y, irradiance: Rgb::splat(0.1) },
    ];
    let shapes = vec![sphere(Vec3::new(0.0, 3.0, 0.0), 0.5, false), area(TRIANGLE)];
    let AreaShape::Triangle(vertices) = TRIANGLE else { unreachable!() };
    let triangle = polygon(&vertices.map(|v| v.as_dvec3()), DVec3::ZERO, DVec3::Y);
    // The triangle faces upwards or downwards, as its winding says.
    let exact = PI * 0.25 / 9.0 + triangle + 8.0 / 16.0 + 0.1 + 0.01 * PI;
    for choice in [LightChoice::Power, LightChoice::Uniform] {
        let all = Lights::build(shapes.clone(), delta.clone(), environment.clone(), WORLD, choice);
        assert_eq!(all.len(), 5);
        let sum: f32 = (0..5).map(|i| all.choice_probability(i)).sum();
        assert!((sum - 1.0).abs() < 1e-6 && all.environment_element() == Some(4));
        irradiance(&all, Vec3::ZERO, Vec3::Y, 1_000_000, 11).assert_mean(&format!("{choice:?}"), exact);
    }
}

#[test]
fn the_density_of_a_sample_is_that_of_its_hit() {
    let shapes = vec![
        area(TRIANGLE),
        disk(Vec3::new(1.0, 2.0, 0.0), Vec3::new(-1.0, -1.5, 0.3), 0.8),
        sphere(Vec3::new(-2.0, -1.0, 1.0), 0.7, false),
        sphere(Vec3::ZERO, 9.0, true),
        cylinder(Vec3::new(1.8, -1.0, -1.5), Vec3::new(0.0, 0.5, 2.0), 0.5, false),
    ];
    let lights = lights(shapes);
    let mut random = Random::new(12);
    let mut seen = [0; 5];
    for _ in 0..100_000 {
        let from = (Vec3::new(random.f32(), random.f32(), random.f32()) - 0.5) * 2.0;
        let Some(s) = lights.sample_direct::<ALL>(from, random.f32(), random.vec2()) else { continue };
        let pdf = lights.pdf_direct(s.element, from, s.target, s.target_normal, s.wi);
        assert!((pdf - s.pdf_w).abs() <= 1e-5 * s.pdf_w, "{s:?}: {pdf}");
        let to = s.target - from;
        assert!((to.normalize() - s.wi).length() < 1e-5, "{s:?}");
        assert!(s.target_normal.dot(s.wi) < 1e-4 && s.target_error.max_element() < 1e-4);
        seen[s.element as usize] += 1;
    }
    assert!(seen.iter().all(|n| *n > 100), "{seen:?}");
}

#[test]
fn points_on_lights_and_in_their_planes_give_nothing_or_something_finite() {
    let shapes = vec![
        area(AreaShape::Triangle([Vec3::ZERO, Vec3::X, Vec3::Z])),
        disk(Vec3::ZERO, Vec3::Y, 1.0),
        sphere(Vec3::ZERO, 1.0, false),
        sphere(Vec3::ZERO, 1.0, true),
        cylinder(-Vec3::Y, Vec3::Y * 2.0, 1.0, false),
        cylinder(-Vec3::Y, Vec3::Y * 2.0, 1.0, true),
        area(AreaShape::Triangle([Vec3::ONE; 3])),
        area(AreaShape::Triangle([Vec3::ZERO, Vec3::ONE, Vec3::splat(2.0)])),
    ];
    let points = [
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::new(0.25, 0.0, 0.25),
        Vec3::new(5.0, 0.0, 0.0),
        Vec3::new(0.25, 1e-38, 0.25),
        Vec3::new(0.25, -1e-38, 0.25),
        Vec3::new(0.6, 0.8, 0.0),
        Vec3::ONE,
        Vec3::splat(1e18),
    ];
    let edges = [0.0, 2f32.powi(-24), 0.5, 1.0 - 2f32.powi(-24)];
    for shape in shapes {
        let point = DeltaLight::Point { position: DVec3::X, intensity: Rgb::WHITE };
        let lights = Lights::build(vec![shape.clone()], vec![point], None, WORLD, LightChoice::Uniform);
        for from in points {
            for (c, x, y) in edges.iter().flat_map(|&c| edges.iter().flat_map(move |&x| edges.map(|y| (c, x, y)))) {
                if let Some(s) = lights.sample_direct::<ALL>(from, c, Vec2::new(x, y)) {
                    assert!(s.pdf_w > 0.0 && s.pdf_w.is_finite() && s.radiance.is_valid(), "{shape:?} {from}: {s:?}");
                    assert!((s.wi.length() - 1.0).abs() < 1e-5 && s.target.is_finite(), "{shape:?} {from}: {s:?}");
                }
            }
            for p in points {
                for wi in [Vec3::X, -Vec3::Y, Vec3::Y, (p - from).normalize_or_zero()] {
                    let pdf = lights.pdf_direct(0, from, p, Vec3::Y, wi);
                    assert!(pdf.is_finite() && pdf >= 0.0, "{shape:?} {from} {p} {wi}: {pdf}");
                }
            }
        }
    }
}

#[test]
fn lights_that_emit_nothing_are_never_chosen() {
    let none = lights(vec![]);
    assert!(none.is_empty() && none.sample_direct::<ALL>(Vec3::ZERO, 0.5, Vec2::splat(0.5)).is_none());
    let mut dark = sphere(Vec3::Y, 0.5, false);
    dark.emission = Rgb::BLACK.into();
    let flat = area(AreaShape::Triangle([Vec3::ZERO; 3]));
    let black = Some(Environment::Constant(Rgb::BLACK));
    let off = vec![DeltaLight::Point { position: DVec3::ZERO, intensity: Rgb::BLACK }];
    for choice in [LightChoice::Power, LightChoice::Uniform] {
        let lights = Lights::build(vec![dark.clone(), flat.clone()], off.clone(), black.clone(), WORLD, choice);
        assert!((0..4).all(|i| lights.choice_probability(i) == 0.0));
        assert!(lights.sample_direct::<ALL>(Vec3::ONE, 0.5, Vec2::splat(0.5)).is_none());
        assert!(lights.sample_emission::<ALL>(0.5, Vec2::splat(0.5), Vec2::splat(0.5)).is_none());
        assert_eq!((lights.environment_radiance(Vec3::Y), lights.environment_pdf(Vec3::Y)), (Rgb::BLACK, 0.0));
        let one =
            Lights::build(vec![dark.clone(), flat.clone(), area(TRIANGLE)], off.clone(), black.clone(), WORLD, choice);
        assert_eq!(one.choice_probability(2), 1.0);
    }
}
