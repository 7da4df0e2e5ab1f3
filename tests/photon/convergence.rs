//! Estimates tend to what is true as photons grow.

use etendue_core::{
    film::Film,
    filter::Filter,
    rgb::Rgb,
    scene::*,
    statistics::moments::Moments,
    technique::{Technique, TechniqueInfo},
};
use etendue_photon::{IndirectLight, Options, PHOTON, PhotonMapper, SPPM};
use etendue_tests::{Run, limit, small::*};
use glam::{DVec3, UVec2};
use std::f64::consts::PI;

/// A floor seen from above, and a point light 1 m over its middle: irradiance `h / d³`.
fn floor() -> SceneDescription {
    let lamp = DeltaLight::Point { position: DVec3::Y, intensity: Rgb::WHITE };
    SceneDescription {
        camera: Some(orthographic(DVec3::Y * 0.5, DVec3::ZERO, DVec3::Z, 2.0, 12)),
        lights: vec![LightDescription { name: "lamp".into(), kind: lamp }],
        ..lit_floor(2.0, Vec::new())
    }
}

/// With as many photons in an estimate as the two-thirds power of all, variance and squared bias fall alike: the mean squared
/// error of a smooth density in the plane falls as that power of the number [Silverman 1986, sec. 4.3].
#[test]
fn the_error_falls_as_the_two_thirds_power_of_the_number_of_photons() {
    let run = Run::of(&floor(), Filter::Box, 2);
    let size = run.resolution.as_dvec2();
    let exact: Vec<f64> = (0..size.x as u32 * size.y as u32)
        .map(|i| {
            // The mean over a pixel by 16 x 16 points.
            let pixel = UVec2::new(i % run.resolution.x, i / run.resolution.x).as_dvec2();
            let point = |k: u32| (pixel + (glam::DVec2::new((k % 16) as f64, (k / 16) as f64) + 0.5) / 16.0) / size;
            let value = |p: glam::DVec2| 0.5 / PI * (1.0 + ((p - 0.5) * 2.0).length_squared()).powf(-1.5);
            (0..256).map(|k| value(point(k))).sum::<f64>() / 256.0
        })
        .collect();
    let mut points = Vec::new();
    for photons in [1_000u32, 4_000, 16_000, 64_000, 256_000] {
        let nearest = (0.35 * f64::from(photons).powf(2.0 / 3.0)).round() as usize;
        let options = Options {
            global_photons: photons,
            nearest,
            global_radius: 1.0,
            indirect: IndirectLight::Show,
            kernel: etendue_photon::kernel::Kernel::Disk,
            ..Options::default()
        };
        let mut error = 0.0;
        let seeds = 6;
        for seed in 0..seeds {
            let mut mapper = PhotonMapper::new(run.scene.clone(), run.settings, options);
            let mut film = Film::new(run.resolution, run.filter);
            (0..8).for_each(|pass| mapper.pass(seed, pass, &mut film));
            let squares =
                film.mean_image().iter().zip(&exact).map(|(c, e)| (f64::from(c.g) / e - 1.0).powi(2)).sum::<f64>();
            error += squares / exact.len() as f64 / seeds as f64;
        }
        println!("{photons:7} photons, {nearest:5} in an estimate: relative mean squared error {error:.3e}");
        points.push((f64::from(photons), error));
    }
    let found = slope(&points);
    println!("slope {found:.3}, in theory -0.667");
    assert!((found + 2.0 / 3.0).abs() < 0.12, "{found}");
}

/// Least squares through logarithms.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = logs.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let products: f64 = logs.iter().map(|p| (p.0 - mean.0) * (p.1 - mean.1)).sum();
    products / logs.iter().map(|p| (p.0 - mean.0).powi(2)).sum::<f64>()
}

const REPLICATES: u64 = 8;

fn mean(image: &[Rgb]) -> f64 {
    image.iter().map(|c| f64::from(c.mean())).sum::<f64>() / image.len() as f64
}

/// Means of images of a technique with some knobs set, by their place in its list.
fn means(run: &Run, technique: &TechniqueInfo, knobs: &[(&str, f64)], first: u64, passes: u32) -> Moments {
    let mut values: Vec<f64> = technique.knobs.iter().map(|k| k.default).collect();
    for (name, value) in knobs {
        values[technique.knobs.iter().position(|k| k.name == *name).expect("a knob of the technique")] = *value;
    }
    let mut moments = Moments::default();
    for seed in first..first + REPLICATES {
        let mut running = (technique.build)(run.scene.clone(), run.settings, &values);
        let mut film = Film::new(run.resolution, run.filter);
        (0..passes).for_each(|pass| running.pass(seed, pass, &mut film));
        moments.push(mean(&film.mean_image()));
    }
    moments
}

/// The mean of the image is that of unbiased techniques, within noise and a stated bias.
#[test]
fn images_are_as_bright_as_they_must_be() {
    for (scene, bias) in [("cornell", 0.02), ("glass-ball", 0.02), ("ring", 0.02), ("sky", 0.02)] {
        let run = Run::builtin(scene, 20);
        let truth = means(&run, &etendue_bidir::BIDIR, &[], 50, 64);
        // An image so small has few photons of its own: the progressive form gets as many as a larger one.
        for (technique, knobs) in [(&PHOTON, &[][..]), (&SPPM, &[("photons", 32.0)])] {
            let found = means(&run, technique, knobs, 0, 16);
            let error = truth.standard_error().hypot(found.standard_error());
            let difference = found.mean() - truth.mean();
            println!(
                "{scene}, {}: {:.5} against {:.5}: {:+.2} % +- {:.2} %",
                technique.name,
                found.mean(),
                truth.mean(),
                100.0 * difference / truth.mean(),
                100.0 * error / truth.mean()
            );
            assert!(
                difference.abs() < limit(REPLICATES) * error + bias * truth.mean(),
                "{scene}, {}: {found:?} {truth:?}",
                technique.name
            );
        }
    }
}
