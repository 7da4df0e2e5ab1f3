//! Daylight: what the formulas give by hand, what another model gives, and that no power is lost between texels.

use etendue_core::{rgb::Rgb, texture::Bitmap};
use etendue_scenes::sun_sky::{Moment, SUN_APERTURE, SunSky, TURBIDITIES, bake, sun_direction};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// With the sun at an elevation in degrees, in the plane x = 0.
fn at(turbidity: f64, elevation: f64, width: u32) -> SunSky {
    let (sin, cos) = elevation.to_radians().sin_cos();
    SunSky { turbidity, sun_direction: DVec3::new(0.0, sin, -cos), width, ..SunSky::default() }
}

fn luminance(t: Rgb) -> f64 {
    0.2126 * f64::from(t.r) + 0.7152 * f64::from(t.g) + 0.0722 * f64::from(t.b)
}

/// The direction at `u` and `v` of an image.
fn direction(u: f64, v: f64) -> DVec3 {
    let (phi, theta) = (TAU * u, PI * v);
    DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos())
}

/// The integral of a function of luminance and direction over the sphere, the image interpolated bilinearly, with `points`
/// squared points a texel.
fn integral(image: &Bitmap<Rgb>, points: usize, f: impl Fn(f64, DVec3) -> f64) -> f64 {
    let (width, height) = (image.width as usize, image.height as usize);
    let texel = |x: i64, y: i64| {
        let (x, y) = (x.rem_euclid(width as i64) as usize, y.clamp(0, height as i64 - 1) as usize);
        luminance(image.texels[y * width + x])
    };
    let mut sum = 0.0;
    for row in 0..height * points {
        let y = (row as f64 + 0.5) / points as f64 - 0.5;
        let v = (y + 0.5) / height as f64;
        // Most rows of a sun without its sky are black.
        if (0..width as i64).all(|x| texel(x, y.floor() as i64) == 0.0 && texel(x, y.floor() as i64 + 1) == 0.0) {
            continue;
        }
        let area = (PI * v).sin() * TAU * PI / (width * height * points * points) as f64;
        for column in 0..width * points {
            let x = (column as f64 + 0.5) / points as f64 - 0.5;
            let (x0, y0) = (x.floor(), y.floor());
            let (fx, fy, x0, y0) = (x - x0, y - y0, x0 as i64, y0 as i64);
            let value = (texel(x0, y0) * (1.0 - fx) + texel(x0 + 1, y0) * fx) * (1.0 - fy)
                + (texel(x0, y0 + 1) * (1.0 - fx) + texel(x0 + 1, y0 + 1) * fx) * fy;
            if value > 0.0 {
                sum += area * f(value, direction((x + 0.5) / width as f64, v));
            }
        }
    }
    sum
}

/// The luminance of the zenith by the paper's formula, worked out by hand for the turbidity 3 and the sun at 45 degrees:
/// chi = 0.41944 * 1.57080 = 0.65886, 7.1649 tan chi + 1.7727 = 7.3196 kcd/m².
#[test]
fn the_zenith_has_the_papers_luminance() {
    let image = bake(&SunSky { sun_scale: 0.0, ..at(3.0, 45.0, 4096) });
    let zenith = luminance(image.texels[0]) * 683.0 * 106.857;
    assert!((zenith / 7319.6 - 1.0).abs() < 2e-3, "{zenith}");
}

/// Mitsuba 3.9.1's `sunsky` with a black ground: RGB of the sky's irradiance on the ground, and of the sun's on a plane
/// that faces it. Its model is another one: what is held here is the ratio that the documentation states.
#[test]
fn irradiances_compare_to_another_model_as_documented() {
    type Row = (f64, f64, [f32; 3], [f32; 3], f64, f64);
    let rows: [Row; 9] = [
        (2.0, 20.0, [0.08939, 0.14995, 0.23483], [1.34101, 0.99108, 0.56280], 2.12, 0.88),
        (2.0, 45.0, [0.10126, 0.17708, 0.32773], [1.49986, 1.23474, 0.90807], 2.01, 1.01),
        (2.0, 80.0, [0.10981, 0.18676, 0.35212], [1.54301, 1.30748, 1.03077], 1.80, 1.05),
        (3.0, 20.0, [0.11320, 0.16913, 0.24345], [1.28190, 0.94322, 0.53691], 1.64, 0.70),
        (3.0, 45.0, [0.13500, 0.20747, 0.34957], [1.46745, 1.20529, 0.88779], 1.96, 0.90),
        (3.0, 80.0, [0.14237, 0.21715, 0.37212], [1.51903, 1.28508, 1.01390], 2.23, 0.96),
        (6.0, 20.0, [0.21015, 0.23940, 0.26994], [1.03654, 0.74658, 0.42989], 1.43, 0.37),
        (6.0, 45.0, [0.27854, 0.34006, 0.44378], [1.32472, 1.07608, 0.79709], 1.92, 0.66),
        (6.0, 80.0, [0.27913, 0.35555, 0.47271], [1.41133, 1.18467, 0.93850], 2.58, 0.77),
    ];
    for (turbidity, elevation, their_sky, their_sun, sky_ratio, sun_ratio) in rows {
        let params = at(turbidity, elevation, 256);
        let sky = bake(&SunSky { sun_scale: 0.0, ..params.clone() });
        let sky = integral(&sky, 1, |value, d| value * d.y.max(0.0)) / luminance(Rgb::from(their_sky));
        let sun = bake(&SunSky { sky_scale: 0.0, ..params });
        let sun = integral(&sun, 4, |value, _| value) / luminance(Rgb::from(their_sun));
        assert!((sky - sky_ratio).abs() < 0.02, "turbidity {turbidity}, elevation {elevation}: sky {sky}");
        assert!((sun - sun_ratio).abs() < 0.01, "turbidity {turbidity}, elevation {elevation}: sun {sun}");
    }
}

/// Whatever the sun's size and place and the image's resolution.
#[test]
fn the_suns_power_is_the_same_in_every_image() {
    let power = |elevation: f64, turn: f64, aperture: f64, width: u32| {
        let (sin, cos) = elevation.to_radians().sin_cos();
        let sun_direction = DVec3::new(cos * turn.sin(), sin, -cos * turn.cos());
        let sun_aperture = aperture.to_radians();
        let params = SunSky { sky_scale: 0.0, sun_direction, sun_aperture, ..at(3.0, elevation, width) };
        let image = bake(&params);
        // Tents are pieces of parabolas under the sine: 16 points a texel and side integrate them to 1e-3.
        (integral(&image, 16, |value, _| value), integral(&image, 16, |value, d| value * d.dot(sun_direction)))
    };
    for elevation in [3.0, 41.0, 89.9, 90.0] {
        let (expected, _) = power(elevation, 0.0, 0.5358, 256);
        for (turn, aperture, width) in [(0.7, 0.5358, 64), (3.1, 1e-6, 128), (6.2, 10.0, 128), (4.0, 2.0, 64)] {
            let (power, facing) = power(elevation, turn, aperture, width);
            assert!(
                (power / expected - 1.0).abs() < 2e-3,
                "{elevation} {turn} {aperture} {width}: {}",
                power / expected
            );
            // And it stands where it should: the mean cosine to its centre is that of a blurred disc.
            let blur = 0.5 * aperture.to_radians() + 2.0 * TAU / f64::from(width);
            assert!(facing / power > blur.cos(), "{elevation} {turn} {aperture} {width}: {}", facing / power);
        }
    }
}

#[test]
fn a_resolved_disc_has_one_radiance() {
    let params = SunSky { sky_scale: 0.0, sun_aperture: 0.4, ..at(4.0, 50.0, 512) };
    let image = bake(&params);
    let solid_angle = |aperture: f64| TAU * (1.0 - (0.5 * aperture).cos());
    let sun = params.sun_direction;
    let inner: Vec<f64> = (0..image.texels.len())
        .filter(|i| {
            let d = direction((i % 512) as f64 / 512.0 + 1.0 / 1024.0, (i / 512) as f64 / 256.0 + 1.0 / 512.0);
            d.dot(sun) > 0.18f64.cos()
        })
        .map(|i| luminance(image.texels[i]))
        .collect();
    assert!(inner.len() > 300);
    let real = bake(&SunSky { sky_scale: 0.0, sun_aperture: SUN_APERTURE, ..params.clone() });
    let expected = integral(&real, 4, |value, _| value) / solid_angle(0.4);
    for value in inner {
        assert!((value / expected - 1.0).abs() < 0.01, "{value} {expected}");
    }
}

#[test]
fn every_sky_is_usable() {
    for turbidity in [TURBIDITIES.0, 2.0, 4.0, 7.0, TURBIDITIES.1] {
        for elevation in [0.01, 1.0, 10.0, 30.0, 60.0, 89.0, 90.0] {
            let image = bake(&at(turbidity, elevation, 64));
            assert!(image.texels.iter().all(|t| t.is_valid()), "{turbidity} {elevation}");
            let (above, below) = image.texels.split_at(image.texels.len() / 2);
            let dark = above.iter().filter(|t| luminance(**t) <= 0.0).count();
            assert_eq!(dark, 0, "{turbidity} {elevation}");
            // A sun at the horizon shines from just below it, too, as its texels are not cut.
            assert!(elevation < 5.0 || below.iter().all(|t| t.is_black()));
        }
    }
    let set = bake(&SunSky { sun_direction: DVec3::new(1.0, -0.01, 0.0), ..at(3.0, 0.0, 64) });
    assert!(set.texels.iter().all(|t| t.is_black()));
    let beyond = |turbidity: f64| bake(&at(turbidity, 40.0, 64));
    assert_eq!(beyond(0.0), beyond(TURBIDITIES.0));
    assert_eq!(beyond(1e9), beyond(TURBIDITIES.1));
}

#[test]
fn the_sky_is_brightest_at_the_sun_and_scales() {
    let params = SunSky { sun_scale: 0.0, ..at(3.0, 40.0, 256) };
    let image = bake(&params);
    let brightest =
        (0..image.texels.len()).max_by(|a, b| luminance(image.texels[*a]).total_cmp(&luminance(image.texels[*b])));
    let i = brightest.unwrap();
    let d = direction((i % 256) as f64 / 256.0 + 1.0 / 512.0, (i / 256) as f64 / 128.0 + 1.0 / 256.0);
    assert!(d.dot(params.sun_direction) > 0.999, "{d}");
    let double = bake(&SunSky { sky_scale: 2.0, ..params });
    assert!(image.texels.iter().zip(&double.texels).all(|(a, b)| *a * 2.0 == *b));
}

/// Mitsuba 3.9.1, `sunsky` without parameters (x in the south, y in the west, z up): the sun over Tokyo.
#[test]
fn the_sun_stands_where_another_program_has_it() {
    let moment = Moment {
        latitude: 35.6894f64.to_radians(),
        longitude: 139.6917f64.to_radians(),
        timezone: 9.0,
        year: 2010,
        month: 7,
        day: 10,
        hour: 15.0,
    };
    let expected = DVec3::new(-0.691748, 0.720308, 0.0513851);
    assert!((sun_direction(&moment) - expected).length() < 2e-5, "{}", sun_direction(&moment));
}

#[test]
fn the_sun_goes_its_way() {
    let sun = |latitude: f64, month, hour| {
        sun_direction(&Moment {
            latitude: latitude.to_radians(),
            longitude: 0.0,
            timezone: 0.0,
            year: 2010,
            month,
            day: 21,
            hour,
        })
    };
    // In the morning in the east, at noon in the south, in the evening in the west; seen from the south, in the north.
    assert!(sun(50.0, 3, 8.0).x > 0.5 && sun(50.0, 3, 16.0).x < -0.5);
    assert!(sun(50.0, 3, 12.0).z > 0.7 && sun(-50.0, 3, 12.0).z < -0.7);
    assert!(sun(50.0, 6, 12.0).y > sun(50.0, 12, 12.0).y + 0.5);
    // On the day of equal length its elevation at noon is 90 degrees less the latitude.
    let elevation = sun(50.0, 3, 12.12).y.asin().to_degrees();
    assert!((elevation - 40.2).abs() < 0.3, "{elevation}");
    assert!(sun(50.0, 3, 0.0).y < 0.0);
}
