//! Next-event estimation that resamples its lights: unbiased behind anything, and a mean where nothing is in between.

mod sampling;

use etendue_core::{
    geometry::{Disk, Sphere},
    has::ALL,
    lights::{AreaLight, AreaShape, BoundingSphere, DirectSample, LightChoice, Lights, environment::Environment},
    rgb::Rgb,
    scene::DeltaLight,
};
use glam::{Vec2, Vec3};
use sampling::{Moments, Random};

const WORLD: BoundingSphere = BoundingSphere { center: Vec3::ZERO, radius: 20.0 };
const FROM: Vec3 = Vec3::new(0.2, 0.0, 0.1);

/// A ball, a disk of another colour, a point light and a sky.
fn lights() -> Lights {
    let ball = AreaShape::Sphere(Sphere { center: Vec3::new(0.0, 2.0, 1.0), radius: 0.5, inverted: false });
    let disk = AreaShape::Disk(Disk { center: Vec3::new(1.0, 3.0, 0.0), normal: Vec3::NEG_Y, radius: 0.8 });
    let area = [(ball, Rgb::new(8.0, 1.0, 0.0)), (disk, Rgb::new(0.0, 2.0, 5.0))];
    let area =
        area.map(|(shape, radiance)| AreaLight { shape, emission: radiance.into(), primitive: u32::MAX }).to_vec();
    let point = DeltaLight::Point { position: glam::DVec3::new(-1.0, 1.0, 1.0), intensity: Rgb::new(1.0, 2.0, 0.5) };
    Lights::build(area, vec![point], Some(Environment::Constant(Rgb::splat(0.3))), WORLD, LightChoice::Power)
}

/// Irradiance on a floor through a filter, as an example of scattering.
fn integrand(light: &DirectSample) -> Rgb {
    light.radiance * Rgb::new(0.9, 0.5, 0.1) * light.wi.y.max(0.0)
}

/// A wall on one side.
fn visible(light: &DirectSample) -> bool {
    light.wi.x > -0.1
}

fn kept(lights: &Lights, candidates: u32, random: &mut Random) -> Option<(DirectSample, Rgb)> {
    lights.resample_direct::<ALL>(FROM, candidates, (random.f32(), random.vec2(), random.f32()), integrand)
}

#[test]
fn whatever_is_in_between_the_mean_is_the_same() {
    let (lights, mut random) = (lights(), Random::new(1));
    let mut plain = [(); 3].map(|()| Moments::default());
    for _ in 0..2_000_000 {
        let light = lights.sample_direct::<ALL>(FROM, random.f32(), random.vec2()).filter(visible);
        let value = light.map_or(Rgb::BLACK, |light| integrand(&light) * (1.0 / light.pdf_w));
        (0..3).for_each(|c| plain[c].add(f64::from(value[c])));
    }
    for candidates in [1, 2, 3, 8, 64] {
        let mut resampled = [(); 3].map(|()| Moments::default());
        for _ in 0..200_000 {
            let kept = kept(&lights, candidates, &mut random).filter(|(light, _)| visible(light));
            let value = kept.map_or(Rgb::BLACK, |(_, value)| value);
            (0..3).for_each(|c| resampled[c].add(f64::from(value[c])));
        }
        for c in 0..3 {
            let (a, b) = (&resampled[c], &plain[c]);
            let z = (a.mean() - b.mean()) / a.standard_error().hypot(b.standard_error());
            assert!(z.abs() < 4.0, "{candidates} candidates: {} against {}, z = {z}", a.mean(), b.mean());
        }
    }
}

/// The luminance of what is kept is the candidates' mean, whichever is kept.
#[test]
fn without_anything_in_between_it_is_the_mean_of_the_candidates() {
    let (lights, mut random) = (lights(), Random::new(2));
    for candidates in [1, 5, 64] {
        for _ in 0..1000 {
            let (u_choice, u) = (random.f32(), random.vec2());
            let mut sum = 0.0;
            for u_kept in [0.0, 0.3, 1.0_f32.next_down()] {
                sum = 0.0;
                let mut count = 0;
                let kept = lights.resample_direct::<ALL>(FROM, candidates, (u_choice, u, u_kept), |light| {
                    count += 1;
                    sum += f64::from(integrand(light).luminance()) / f64::from(light.pdf_w);
                    integrand(light)
                });
                assert!(count <= candidates);
                let value = kept.map_or(0.0, |(_, value)| f64::from(value.luminance()));
                let mean = sum / f64::from(candidates);
                assert!((value - mean).abs() <= 1e-6 * mean, "{value} against {mean}");
            }
            if candidates == 1 {
                let light = lights.sample_direct::<ALL>(FROM, u_choice, u);
                let plain = light.map_or(0.0, |l| f64::from(integrand(&l).luminance()) / f64::from(l.pdf_w));
                assert_eq!(plain, sum);
            }
        }
    }
}

/// Which candidate is kept follows the weights: with a number in every cell of a grid, each is kept as often as it should.
#[test]
fn one_number_chooses_among_all_candidates() {
    let lights = lights();
    let numbers = (0.37, Vec2::new(0.6, 0.2));
    let mut weights = Vec::new();
    lights.resample_direct::<ALL>(FROM, 16, (numbers.0, numbers.1, 0.0), |light| {
        weights.push((light.wi, f64::from(integrand(light).luminance()) / f64::from(light.pdf_w)));
        integrand(light)
    });
    let sum: f64 = weights.iter().map(|(_, w)| w).sum();
    let steps = 20_000;
    let mut counts = vec![0; weights.len()];
    for step in 0..steps {
        let u_kept = (step as f32 + 0.5) / steps as f32;
        let (light, _) = lights.resample_direct::<ALL>(FROM, 16, (numbers.0, numbers.1, u_kept), integrand).unwrap();
        counts[weights.iter().position(|(wi, _)| *wi == light.wi).unwrap()] += 1;
    }
    assert!(counts.iter().filter(|c| **c > 0).count() > 4, "{counts:?}");
    for (count, (_, weight)) in counts.into_iter().zip(&weights) {
        // The numbers of one candidate are a few intervals, each of which errs by one step.
        let expected = weight / sum * f64::from(steps);
        assert!((f64::from(count) - expected).abs() < 20.0, "{count} against {expected}");
    }
}

/// All candidates are uniform: shifts move numbers, and lose none.
#[test]
fn candidates_stay_in_the_unit_interval() {
    let (lights, last) = (lights(), 1.0_f32.next_down());
    for u in [0.0, 0.5, last] {
        for candidates in [1, 7, 64] {
            let kept = lights.resample_direct::<ALL>(FROM, candidates, (u, Vec2::splat(u), last), integrand);
            assert!(kept.is_none_or(|(_, value)| value.is_valid()));
        }
    }
}

#[test]
fn no_light_gives_nothing_and_what_is_no_number_goes_on() {
    let none = Lights::build(vec![], vec![], None, WORLD, LightChoice::Power);
    let numbers = (0.1, Vec2::splat(0.2), 0.3);
    assert!(none.resample_direct::<ALL>(FROM, 4, numbers, integrand).is_none());
    assert!(lights().resample_direct::<ALL>(FROM, 4, numbers, |_| Rgb::BLACK).is_none());
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let kept = lights().resample_direct::<ALL>(FROM, 4, numbers, |_| Rgb::splat(bad));
        assert!(!kept.expect("it is handed on").1.is_valid());
    }
}
