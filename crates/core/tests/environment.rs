//! Light from infinity: look-ups as in Mitsuba, and sampling that follows them exactly.

mod sampling;

use etendue_core::{
    has::ALL,
    lights::{
        BoundingSphere, LightChoice, Lights,
        environment::{Environment, Rows},
    },
    rgb::Rgb,
    texture::Bitmap,
};
use glam::{DMat3, DVec3, Vec2, Vec3};
use sampling::{Cap, Moments, Random};
use std::{f64::consts::PI, sync::Arc};

const WORLD: BoundingSphere = BoundingSphere { center: Vec3::ZERO, radius: 3.0 };

fn lat_long(width: u32, texels: Vec<Rgb>, to_world: DMat3, rows: Rows) -> Environment {
    let height = texels.len() as u32 / width;
    Environment::LatLong { image: Arc::new(Bitmap { width, height, texels }), scale: 2.0, to_world, rows }
}

fn lights(environment: &Environment) -> Lights {
    Lights::build(vec![], vec![], Some(environment.clone()), WORLD, LightChoice::Power)
}

fn rotation() -> DMat3 {
    DMat3::from_rotation_y(30f64.to_radians()) * DMat3::from_rotation_x(20f64.to_radians())
}

/// Values of Mitsuba 3.9.1, `scalar_rgb`: `envmap` with `scale` 2 over a 4 x 3 image with the values
/// `(k * k) % 29 + 1`, k = 1, 2 .. 36; without a transform, and with `rotate(y, 30) @ rotate(x, 20)`.
#[test]
fn look_ups_agree_with_mitsuba() {
    let texels = (0..12).map(|i| Rgb::from([1, 2, 3].map(|c| ((3 * i + c) * (3 * i + c) % 29 + 1) as f32))).collect();
    let image: Vec<Rgb> = texels;
    type Values = [([f32; 3], [f32; 3]); 7];
    let plain: Values = [
        ([0.6, 0.48, -0.64], [35.3837, 34.1194, 38.0457]),
        ([1.0, 0.0, 0.0], [50.0, 52.0, 29.0]),
        ([-0.8, 0.0, 0.6], [29.2647, 45.1093, 17.4327]),
        ([0.36, 0.8, 0.48], [40.1671, 52.0615, 16.1418]),
        ([-0.64, -0.6, -0.48], [43.7958, 17.8545, 45.5808]),
        ([0.0, -0.96, 0.28], [12.7814, 18.5881, 17.916]),
        ([-0.28, 0.96, 0.0], [35.0, 16.4327, 49.3866]),
    ];
    let rotated: Values = [
        ([0.6, 0.48, -0.64], [40.6175, 41.5705, 34.0505]),
        ([1.0, 0.0, 0.0], [47.6471, 54.5386, 18.0756]),
        ([-0.8, 0.0, 0.6], [34.0476, 33.7455, 30.8462]),
        ([0.36, 0.8, 0.48], [37.8339, 41.9227, 24.2663]),
        ([-0.64, -0.6, -0.48], [47.0222, 17.9144, 42.9969]),
        ([0.0, -0.96, 0.28], [18.6765, 28.4489, 19.6669]),
        ([-0.28, 0.96, 0.0], [30.4151, 15.1386, 50.7783]),
    ];
    for (to_world, values) in [(DMat3::IDENTITY, plain), (rotation(), rotated)] {
        let lights = lights(&lat_long(4, image.clone(), to_world, Rows::PoleToPole));
        for (direction, expected) in values {
            let found = lights.environment_radiance(Vec3::from(direction)).to_array();
            let error = (0..3).map(|c| (found[c] - expected[c]).abs()).fold(0.0, f32::max);
            assert!(error < 2e-4, "{direction:?}: {found:?} instead of {expected:?}");
        }
    }
}

/// With rows between the poles, the middle of the image's texel (column, row) has that texel's value.
#[test]
fn centred_rows_have_their_values_at_their_centres() {
    let texels: Vec<Rgb> = (0..15).map(|i| Rgb::splat(i as f32)).collect();
    let lights = lights(&lat_long(5, texels, rotation(), Rows::Centred));
    for (column, row) in (0..5).flat_map(|x| (0..3).map(move |y| (x, y))) {
        let (phi, theta) = (2.0 * PI * (f64::from(column) + 0.5) / 5.0, PI * (f64::from(row) + 0.5) / 3.0);
        let d = rotation() * DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
        let found = lights.environment_radiance(d.as_vec3()).g;
        assert!((found - 2.0 * (5 * row + column) as f32).abs() < 1e-4, "{column}, {row}: {found}");
    }
}

/// Images that are random, of one row or one texel, dark but for one texel, and with a sun.
fn images() -> Vec<(&'static str, u32, Vec<Rgb>)> {
    let mut random = Random::new(20);
    let mut noise =
        |n: usize| -> Vec<Rgb> { (0..n).map(|_| Rgb::new(random.f32(), random.f32(), random.f32())).collect() };
    let mut one = vec![Rgb::BLACK; 40];
    one[19] = Rgb::WHITE;
    let mut pole = vec![Rgb::BLACK; 40];
    pole[3] = Rgb::WHITE;
    let mut sun = noise(64 * 32);
    sun[12 * 64 + 40] = Rgb::splat(1e6);
    vec![
        ("noise", 8, noise(40)),
        ("one row", 8, noise(8)),
        ("two rows", 3, noise(6)),
        ("one texel", 1, noise(1)),
        ("one column", 1, noise(5)),
        ("one bright texel", 8, one),
        ("one bright texel at the pole", 8, pole),
        ("sun", 64, sun),
    ]
}

#[test]
fn directions_follow_the_image() {
    for rows in [Rows::Centred, Rows::PoleToPole] {
        for (name, width, texels) in images() {
            let environment = lat_long(width, texels.clone(), rotation(), rows);
            let lights = lights(&environment);
            let what = format!("{name}, {rows:?}");
            let peak = texels.iter().map(|c| c.max_element()).fold(0.0, f32::max) * 2.0 * width as f32;
            let mut random = Random::new(21);
            let mut integral = Moments::default();
            let sample = || {
                let s = lights.sample_direct::<ALL>(Vec3::ONE, random.f32(), random.vec2())?;
                assert!(s.infinite && !s.delta && (s.wi.length() - 1.0).abs() < 1e-5);
                // Sampling knows where it is in the image; looking the direction up finds the place again but for the
                // rounding of a direction, which counts by the steepest slope of the image.
                let (radiance, pdf_w) = lights.environment_radiance_and_pdf(s.wi);
                let close = |a: f32, b: f32, peak: f32| (a - b).abs() <= 4e-6 * peak;
                assert!(close(s.radiance.g, radiance.g, peak), "{what}: {s:?} {radiance:?}");
                assert!(
                    close(s.pdf_w / pdf_w, s.radiance.luminance() / radiance.luminance(), 1.0),
                    "{what}: {s:?} {pdf_w}"
                );
                integral.add(f64::from(s.radiance.luminance()) / f64::from(s.pdf_w));
                Some(s.wi.as_dvec3())
            };
            let pdf = |w: DVec3| f64::from(lights.environment_pdf(w.as_vec3()));
            // The sphere, and where the sun is the neighbourhood of its texel.
            if name == "sun" {
                let v = if rows == Rows::Centred { 12.5 / 32.0 } else { 12.0 / 31.0 };
                let (phi, theta) = (2.0 * PI * 40.5 / 64.0, PI * v);
                let axis = rotation() * DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
                Cap::of_angle(axis, 0.15, 16, 32).chi_square(&what, 100_000, 8, sample, pdf);
            } else {
                Cap::sphere(rotation() * DVec3::Y).chi_square(&what, 100_000, 12, sample, pdf);
            }
            // Luminance over density is one number: no fireflies.
            assert!(integral.standard_error() < 1e-7 * integral.mean(), "{what}");
        }
    }
}

#[test]
fn the_integral_of_the_image_is_exact() {
    for rows in [Rows::Centred, Rows::PoleToPole] {
        for (name, width, texels) in images() {
            let lights = lights(&lat_long(width, texels, DMat3::IDENTITY, rows));
            let s = lights.sample_direct::<ALL>(Vec3::ONE, 0.5, Vec2::splat(0.4)).expect("it shines");
            // Midpoint rule in double precision over the sphere; rows as fine as a sun of one texel needs.
            let (nu, nv) = (1024, 1024);
            let mut sum = 0.0;
            for j in 0..nv {
                let theta = (f64::from(j) + 0.5) / f64::from(nv) * PI;
                for i in 0..nu {
                    let phi = (f64::from(i) + 0.5) / f64::from(nu) * 2.0 * PI;
                    let d = DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
                    sum += f64::from(lights.environment_radiance(d.as_vec3()).luminance()) * theta.sin();
                }
            }
            let expected = sum * 2.0 * PI * PI / f64::from(nu * nv);
            let found = f64::from(s.radiance.luminance() / s.pdf_w);
            assert!((found / expected - 1.0).abs() < 1e-3, "{name}, {rows:?}: {found} instead of {expected}");
        }
    }
}

#[test]
fn extreme_numbers_stay_in_the_image() {
    let edges = [0.0, 2f32.powi(-24), 0.25, 0.5, 1.0 - 2f32.powi(-24)];
    for rows in [Rows::Centred, Rows::PoleToPole] {
        for (name, width, mut texels) in images() {
            for factor in [1e-30, 1.0, 1e30] {
                let values = texels.iter().map(|t| *t * factor).collect();
                let lights = lights(&lat_long(width, values, DMat3::IDENTITY, rows));
                for (x, y) in edges.iter().flat_map(|&x| edges.map(|y| (x, y))) {
                    // At u = 0 a cell may begin with the value 0, which cannot be sampled.
                    if let Some(s) = lights.sample_direct::<ALL>(Vec3::ZERO, 0.5, Vec2::new(x, y)) {
                        assert!(s.pdf_w > 0.0 && s.pdf_w.is_finite() && s.radiance.is_valid(), "{name}: {s:?}");
                    } else {
                        assert!(x.min(y) == 0.0 || x.max(y) > 0.9, "{name}, {rows:?}, {factor}: nothing at {x}, {y}");
                    }
                }
                for w in [Vec3::Y, -Vec3::Y, -Vec3::Z, Vec3::new(-0.0, 0.0, -1.0), Vec3::new(-1e-30, -1.0, 0.0)] {
                    let (radiance, pdf) = lights.environment_radiance_and_pdf(w);
                    assert!(radiance.is_valid() && pdf.is_finite() && pdf >= 0.0, "{name} {w}");
                }
            }
            texels.fill(Rgb::BLACK);
            let black = lights(&lat_long(width, texels, DMat3::IDENTITY, rows));
            assert!(black.sample_direct::<ALL>(Vec3::ZERO, 0.5, Vec2::splat(0.5)).is_none());
            assert_eq!(black.environment_radiance_and_pdf(Vec3::X), (Rgb::BLACK, 0.0));
        }
    }
}

#[test]
fn what_is_invalid_is_refused_with_its_place() {
    let check = |i: usize, value: f32| {
        let mut texels = vec![Rgb::WHITE; 12];
        texels[i].g = value;
        lat_long(4, texels, DMat3::IDENTITY, Rows::Centred).check()
    };
    assert_eq!(check(6, 1e30), Ok(12));
    for value in [f32::NAN, f32::INFINITY, -1.0, f32::MAX] {
        let message = check(6, value).expect_err("it is not usable, or not when it is scaled");
        assert!(message.contains("column 2, row 1"), "{message}");
    }
    assert!(Environment::Constant(Rgb::splat(-1.0)).check().is_err());
    assert_eq!(Environment::Constant(Rgb::BLACK).check(), Ok(1));
    for to_world in [DMat3::ZERO, DMat3::from_diagonal(DVec3::new(1.0, 2.0, 1.0)), DMat3::NAN] {
        assert!(lat_long(1, vec![Rgb::WHITE], to_world, Rows::Centred).check().is_err());
    }
    // A mirrored image is not refused.
    let mirrored = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    assert!(lat_long(1, vec![Rgb::WHITE], mirrored, Rows::Centred).check().is_ok());
    let image = Arc::new(Bitmap { width: 2, height: 2, texels: vec![Rgb::WHITE] });
    let odd = Environment::LatLong { image, scale: 1.0, to_world: DMat3::IDENTITY, rows: Rows::Centred };
    assert!(odd.check().is_err());
}
