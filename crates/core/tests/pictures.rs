//! Spot lights with an image, and projectors.

mod sampling;

use etendue_core::{
    has::ALL,
    lights::{BoundingSphere, LightChoice, Lights},
    rgb::Rgb,
    scene::DeltaLight,
    texture::{Bitmap, Interpolation, Texture, Wrap},
};
use glam::{Affine2, DAffine3, DMat3, DVec3, Vec2, Vec3};
use sampling::{Cap, Moments, Random};
use std::{f64::consts::PI, sync::Arc};

const WORLD: BoundingSphere = BoundingSphere { center: Vec3::ZERO, radius: 20.0 };
const POSITION: DVec3 = DVec3::new(1.0, 2.0, 3.0);

/// Mitsuba's `look_at` from (1, 2, 3) to (0, 0.5, 0), up (0.1, 1, 0.2).
fn to_world() -> DAffine3 {
    let forward = (DVec3::new(0.0, 0.5, 0.0) - POSITION).normalize();
    let left = DVec3::new(0.1, 1.0, 0.2).cross(forward).normalize();
    DAffine3 { matrix3: DMat3::from_cols(left, forward.cross(left), forward), translation: POSITION }
}

fn image(texels: &[Rgb], width: u32, interpolation: Interpolation) -> Texture<Rgb> {
    let bitmap = Arc::new(Bitmap { width, height: texels.len() as u32 / width, texels: texels.to_vec() }).into();
    Texture::Bitmap { bitmap, interpolation, wrap: Wrap::Clamp, to_uv: Affine2::IDENTITY }
}

fn spot(image: Texture<Rgb>, up: DVec3, beam: f64, cutoff: f64) -> DeltaLight {
    let direction = to_world().matrix3.z_axis * 2.0;
    DeltaLight::Spot {
        position: POSITION,
        direction,
        intensity: Rgb::splat(2.0),
        beam,
        cutoff,
        image: Some((image, up)),
    }
}

fn projector(irradiance: Texture<Rgb>, fov_x: f64, aspect: f64) -> DeltaLight {
    DeltaLight::Projector { to_world: to_world(), fov_x, aspect, irradiance }
}

fn lights(light: DeltaLight) -> Lights {
    Lights::build(vec![], vec![light], None, WORLD, LightChoice::Power)
}

fn at(lights: &Lights, p: Vec3) -> Option<Rgb> {
    Some(lights.sample_direct::<ALL>(p, 0.5, Vec2::splat(0.5))?.radiance)
}

/// Mitsuba 3.9.1 (`scalar_rgb`), `emitter.sample_direction` of a `spot` (intensity 2, cutoff_angle 30, beam_width 20) and of
/// a `projector` (fov 50, scale 3) from some points. Both throw an image of 3 x 2 texels, red 1 to 6, green 1, blue 0.5,
/// nearest and bilinear. It says of a point what the spot's red and green are there, and the projector's.
type Row = ([f32; 3], [f32; 2], [f32; 2]);
#[rustfmt::skip]
const NEAREST: [Row; 7] = [
    ([0.2, 0.1, -0.3], [0.264_200_78, 0.132_100_39], [3.160_023_7, 0.632_004_74]),
    ([-0.3, 0.3, 0.5], [0.369_344_4, 0.184_672_2], [4.547_491, 0.909_498_2]),
    ([0.5, 0.3, 0.1], [0.346_320_27, 0.173_160_14], [4.232_75, 0.846_55]),
    ([0.0, 0.8, 0.0], [0.874_125_7, 0.174_825_15], [1.663_689_4, 0.831_844_7]),
    ([0.9, 1.4, 1.0], [1.830_663_4, 0.457_665_86], [7.388_274, 2.462_758]),
    ([-0.4, 0.9, 0.3], [0.956_022_86, 0.191_204_58], [1.885_586_3, 0.942_793_13]),
    ([0.6, -0.2, 0.2], [0.311_526_48, 0.155_763_24], [4.086_69, 0.817_338]),
];
#[rustfmt::skip]
const BILINEAR: [Row; 7] = [
    ([0.2, 0.1, -0.3], [0.390_967_4, 0.132_100_39], [2.768_882_8, 0.632_004_74]),
    ([-0.3, 0.3, 0.5], [0.603_183_27, 0.184_672_2], [3.771_596_7, 0.909_498_2]),
    ([0.5, 0.3, 0.1], [0.472_470_46, 0.173_160_14], [3.991_856_3, 0.846_55]),
    ([0.0, 0.8, 0.0], [0.686_293_2, 0.174_825_15], [2.258_153_7, 0.831_844_7]),
    ([0.9, 1.4, 1.0], [1.652_207, 0.457_665_86], [7.074_334_6, 2.462_758]),
    ([-0.4, 0.9, 0.3], [0.830_642, 0.191_204_58], [2.052_590_8, 0.942_793_13]),
    ([0.6, -0.2, 0.2], [0.300_981_7, 0.155_763_24], [4.494_814, 0.817_338]),
];

#[test]
fn pictures_stand_and_shine_as_in_mitsuba() {
    for (interpolation, rows) in [(Interpolation::Nearest, NEAREST), (Interpolation::Bilinear, BILINEAR)] {
        let texels: Vec<Rgb> = (1..=6).map(|red| Rgb::new(red as f32, 1.0, 0.5)).collect();
        // Mitsuba's spot shows its image standing on its head.
        let down = -to_world().matrix3.y_axis * 3.0;
        let (beam, cutoff) = (20f64.to_radians(), 30f64.to_radians());
        let spot = lights(spot(image(&texels, 3, interpolation), down, beam, cutoff));
        // What Mitsuba calls irradiance is pi times less.
        let texels: Vec<Rgb> = texels.iter().map(|t| *t * (3.0 * PI as f32)).collect();
        let projector = lights(projector(image(&texels, 3, interpolation), 50f64.to_radians(), 1.5));
        for (p, by_spot, by_projector) in rows {
            for (name, lights, [red, green]) in [("spot", &spot, by_spot), ("projector", &projector, by_projector)] {
                let found = at(lights, Vec3::from(p)).expect("in the picture");
                let close = |x: f32, y: f32| (x - y).abs() < 2e-5 * y;
                assert!(close(found.r, red) && close(found.g, green), "{name} at {p:?}: {found:?}");
                assert_eq!(found.b, 0.5 * found.g);
            }
        }
    }
}

/// The projector's field of view, its shape, its scale; a reflection; nothing past the picture and behind.
#[test]
fn projectors_fill_their_field_of_view() {
    let one = |to_world| {
        let texels = [Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, 1.0, 0.0)];
        let irradiance = image(&texels, 2, Interpolation::Nearest);
        lights(DeltaLight::Projector { to_world, fov_x: PI / 2.0, aspect: 2.0, irradiance })
    };
    let lights = one(DAffine3::from_scale(DVec3::splat(3.0)));
    // On planes at right angles to the axis the irradiance is the same all over, and falls with the distance squared.
    for (x, y) in [(0.1, 0.1), (0.99, 0.49), (0.5, -0.49), (0.99, -0.2)] {
        for distance in [1.0f32, 2.0, 10.0] {
            let p = Vec3::new(x, y, 1.0) * distance;
            let cos = p.normalize().z;
            let left = at(&lights, p).expect("in the picture");
            assert!((left.r * cos * distance * distance - 1.0).abs() < 1e-5 && left.g == 0.0, "{p}: {left:?}");
            let right = at(&lights, p * Vec3::new(-1.0, 1.0, 1.0)).expect("in the picture");
            assert!((right.g * cos * distance * distance - 1.0).abs() < 1e-5 && right.r == 0.0, "{p}: {right:?}");
        }
    }
    for (x, y, z) in [(1.01, 0.1, 1.0), (0.1, 0.51, 1.0), (-0.1, -0.51, 1.0), (0.1, 0.1, -1.0), (0.1, 0.1, 0.0)] {
        assert_eq!(at(&lights, Vec3::new(x, y, z)), None, "{x} {y} {z}");
    }
    assert_eq!(at(&lights, Vec3::ZERO), None);
    let mirrored = one(DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
    assert!(at(&mirrored, Vec3::new(0.5, 0.1, 1.0)).expect("in the picture").g > 0.0);
}

fn noise(width: u32, height: u32, interpolation: Interpolation) -> Texture<Rgb> {
    let mut random = Random::new(50);
    let texels: Vec<Rgb> = (0..width * height)
        .map(|i| {
            let bright = if i % 17 == 3 { 20.0 } else { 1.0 };
            Rgb::new(random.f32(), random.f32(), random.f32()) * (bright * f32::from(u8::from(i % 3 != 1)))
        })
        .collect();
    image(&texels, width, interpolation)
}

/// One bright texel, between whose neighbours nothing is.
fn spark(size: u32) -> Texture<Rgb> {
    let mut texels = vec![Rgb::BLACK; (size * size) as usize];
    texels[(size * (size / 3) + size / 2) as usize] = Rgb::WHITE;
    image(&texels, size, Interpolation::Nearest)
}

fn cases() -> Vec<(&'static str, DeltaLight, f64)> {
    let up = DVec3::new(0.1, 1.0, 0.2);
    let stripes = |scale| {
        let to_uv = Affine2::from_scale(Vec2::splat(scale));
        Texture::Checkerboard { even: Rgb::WHITE, odd: Rgb::BLACK, to_uv }
    };
    // The largest angle to the axis that there is any light at.
    vec![
        ("spot", spot(noise(9, 7, Interpolation::Bilinear), up, 0.3, 0.5), 0.5),
        ("wide spot", spot(noise(40, 64, Interpolation::Nearest), up, 0.1, 1.2), 1.2),
        ("spot with a checkerboard", spot(stripes(3.3), up, 0.4, 0.4), 0.4),
        ("projector", projector(noise(9, 7, Interpolation::Bilinear), 0.8, 1.3), 0.6),
        ("wide projector", projector(noise(40, 64, Interpolation::Nearest), 2.2, 0.7), 1.4),
        ("projector of a checkerboard", projector(stripes(1.0), 0.8, 1.0), 0.6),
        ("projector of one colour", projector(Rgb::WHITE.into(), 0.8, 1.0), 0.6),
        ("projector of a spark", projector(spark(64), 0.8, 1.0), 0.6),
        ("projector of a spark in many texels", projector(spark(1500), 0.8, 1.0), 0.6),
    ]
}

/// Emitted rays carry the intensity that points see, and follow their density.
#[test]
fn rays_from_pictures_follow_their_density() {
    let axis = to_world().matrix3.z_axis;
    for (name, light, angle) in cases() {
        let lights = lights(light);
        let mut random = Random::new(51);
        let mut direction = || {
            let s = lights.sample_emission::<ALL>(random.f32(), random.vec2(), random.vec2())?;
            let density = lights.emission_density(0, s.normal, s.direction);
            assert_eq!((density.choice, density.pdf_a, density.pdf_w), (1.0, 1.0, s.pdf_w));
            assert!(s.delta_position && !s.delta_direction && !s.infinite && s.p == POSITION.as_vec3());
            let seen = at(&lights, s.p + s.direction).unwrap_or(Rgb::BLACK);
            // Where rounding puts the direction over the edge between two texels, another is seen.
            let same = (seen.g - s.radiance.g).abs() <= 1e-3 * s.radiance.g;
            Some((s.direction.as_dvec3(), same))
        };
        let (mut lost, mut carried, mut different) = (0.0, 0.0, 0.0);
        let n = 100_000u32;
        let samples: Vec<DVec3> = (0..n)
            .filter_map(|_| {
                let Some((d, same)) = direction() else {
                    lost += 1.0;
                    return None;
                };
                carried += 1.0;
                different += f64::from(u8::from(!same));
                Some(d)
            })
            .collect();
        assert!(different < 1e-3 * carried, "{name}: {different} of {carried}");
        // Most rays carry light, even of a picture that is black nearly everywhere; where a cell of the density has some nine
        // texels, one in nine or so.
        let most = if name.contains("many texels") { 0.93 } else { 0.5 };
        assert!(lost < most * f64::from(n), "{name}: {lost} carry nothing");
        let cap = Cap::of_angle(axis, angle, 12, 24);
        let mut samples = samples.into_iter();
        // Rays that carry nothing are not emitted: the density is that of the others.
        let pdf = |w: DVec3| {
            let lit = at(&lights, (POSITION + w).as_vec3()).is_some();
            f64::from(lights.emission_density(0, Vec3::ZERO, w.as_vec3()).pdf_w) * f64::from(u8::from(lit))
        };
        if !name.contains("spark") {
            cap.chi_square(name, n as usize, 96, || samples.next(), pdf);
        }
    }
}

/// The mean weight is the flux: of a projector the mean of its image times its area on the plane at distance 1.
#[test]
fn pictures_carry_their_flux() {
    for (name, light, angle) in cases() {
        let exact = match &light {
            DeltaLight::Projector { fov_x, aspect, irradiance, .. } => {
                let mean = match irradiance {
                    Texture::Bitmap { bitmap, interpolation: Interpolation::Nearest, .. } => {
                        let sum: f64 = bitmap.values().iter().map(|t| f64::from(t.g)).sum();
                        Some(sum / bitmap.len() as f64)
                    }
                    Texture::Constant(value) => Some(f64::from(value.g)),
                    Texture::Checkerboard { .. } => Some(0.5),
                    _ => None,
                };
                mean.map(|mean| mean * 4.0 * (0.5 * fov_x).tan().powi(2) / aspect)
            }
            _ => None,
        };
        let lights = lights(light);
        // Over a cap about the axis by the midpoint rule, where there is no formula.
        let by_points = || {
            let axis = to_world().matrix3.z_axis;
            let (s, t) = axis.any_orthonormal_pair();
            let (rings, sectors) = (800, 1600);
            let height = 1.0 - angle.cos();
            let mut sum = 0.0;
            for (i, j) in (0..rings).flat_map(|i| (0..sectors).map(move |j| (i, j))) {
                let cos = 1.0 - height * (f64::from(i) + 0.5) / f64::from(rings);
                let (sin, phi) = ((1.0 - cos * cos).sqrt(), 2.0 * PI * (f64::from(j) + 0.5) / f64::from(sectors));
                let w = axis * cos + (s * phi.cos() + t * phi.sin()) * sin;
                sum += at(&lights, (POSITION + w).as_vec3()).map_or(0.0, |r| f64::from(r.g));
            }
            sum * 2.0 * PI * height / f64::from(rings * sectors)
        };
        let flux = exact.unwrap_or_else(by_points);
        let (mut random, mut moments) = (Random::new(52), Moments::default());
        for _ in 0..200_000 {
            let sample = lights.sample_emission::<ALL>(random.f32(), random.vec2(), random.vec2());
            moments.add(sample.map_or(0.0, |s| f64::from(s.weight().g)));
        }
        let (error, deviation) = (moments.standard_error(), (moments.mean() - flux).abs());
        // What the midpoint rule leaves, at the edges of texels above all.
        let rule = if exact.is_some() { 2e-6 } else { 1e-3 };
        assert!(deviation < 4.0 * error + rule * flux, "{name}: {} instead of {flux}", moments.mean());
    }
}

/// A picture of one colour is a plain spot light.
#[test]
fn a_constant_image_changes_nothing_but_the_colour() {
    let image = Texture::Constant(Rgb::new(0.5, 1.0, 0.25));
    let with = lights(spot(image, DVec3::X, 0.3, 0.5));
    let DeltaLight::Spot { position, direction, intensity, beam, cutoff, .. } =
        spot(Rgb::WHITE.into(), DVec3::X, 0.3, 0.5)
    else {
        unreachable!()
    };
    let intensity = intensity * Rgb::new(0.5, 1.0, 0.25);
    let plain = lights(DeltaLight::Spot { position, direction, intensity, beam, cutoff, image: None });
    for p in [Vec3::ZERO, Vec3::new(0.3, 0.8, 0.1), Vec3::new(0.9, 1.4, 1.0)] {
        assert_eq!(at(&with, p), at(&plain, p));
    }
}

/// Black pictures are never chosen; one that is black nearly everywhere is.
#[test]
fn pictures_are_chosen_by_what_they_emit() {
    let both = |first, second| Lights::build(vec![], vec![first, second], None, WORLD, LightChoice::Power);
    let plain = || projector(Rgb::WHITE.into(), 0.8, 1.0);
    let black = projector(image(&[Rgb::BLACK; 4], 2, Interpolation::Nearest), 0.8, 1.0);
    assert_eq!(both(black, plain()).choice_probability(0), 0.0);
    // Texels are found wherever they are: the share of one among many.
    let texels = 64.0 * 64.0;
    let p = both(projector(spark(64), 0.8, 1.0), plain()).choice_probability(0);
    assert!((f64::from(p) * texels - 1.0).abs() < 0.01, "{p}");
    // Between the points that are looked at, where a picture is repeated very often.
    let Texture::Bitmap { bitmap, interpolation, wrap: _, .. } = spark(64) else { unreachable!() };
    let to_uv = Affine2::from_scale(Vec2::splat(1e4));
    let often = Texture::Bitmap { bitmap, interpolation, wrap: Wrap::Repeat, to_uv };
    assert!(both(projector(often, 0.8, 1.0), plain()).choice_probability(0) > 0.0);
}
