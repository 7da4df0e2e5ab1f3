//! Path tracing that resamples its lights renders what path tracing does.

use etendue_core::{
    film::Film,
    filter::Filter,
    material::Material,
    rgb::Rgb,
    scene::{DeltaLight, LightDescription, Object},
    statistics::tiles::{WHOLE_IMAGE, compare, replicated_tile_means},
    technique::{Knob, Part, Parts, TechniqueInfo},
};
use etendue_tests::{Run, small::*};
use glam::{DVec3, UVec2};

/// Path tracing with so many candidates.
fn resampled(candidates: u32) -> TechniqueInfo {
    let knob = Knob { default: f64::from(candidates), ..etendue_path::INFO.knobs[0] };
    assert_eq!(knob.name, "light_candidates");
    TechniqueInfo { knobs: Box::leak(Box::new([knob])), ..etendue_path::INFO }
}

/// The image's mean and its tiles agree with those of one candidate. Replicates of one seed share their paths, so that the
/// differences scatter by less than the images.
fn agree(name: &str, run: &Run, candidates: &[u32], passes: u32) {
    let replicates = 24;
    let width = run.resolution.x as usize;
    let one = run.replicates(&etendue_path::INFO, 0..replicates, passes);
    for candidates in candidates {
        let several = run.replicates(&resampled(*candidates), 0..replicates, passes);
        let pairs = one.iter().zip(&several);
        let differences: Vec<Vec<Rgb>> = pairs.map(|(a, b)| a.iter().zip(b).map(|(a, b)| *b - *a).collect()).collect();
        for tile in [WHOLE_IMAGE, 8] {
            let of = |images: &[Vec<Rgb>]| {
                replicated_tile_means(&images.iter().map(Vec::as_slice).collect::<Vec<_>>(), width, tile)
            };
            let ((a, _), (b, _), (_, errors)) = (of(&several), of(&one), of(&differences));
            let found = compare(&a, &b, &errors, (replicates - 1) as f64, 6.334e-5);
            println!(
                "{name}, {candidates} candidates, tiles of {tile}: {:+.2} errors, {:+.2} %",
                found.t,
                100.0 * found.relative
            );
            assert_eq!(found.failures, 0, "{name}, {candidates} candidates: {found:?}");
        }
    }
}

#[test]
fn the_built_in_scenes_keep_their_image() {
    agree("cornell", &Run::builtin("cornell", 16), &[4, 16], 32);
    agree("veach-mis", &Run::builtin("veach-mis", 16), &[4, 16], 32);
    agree("many-lights", &Run::builtin("many-lights:n=64", 16), &[4, 16], 32);
    agree("sky", &Run::builtin("sky", 16), &[4, 16], 32);
}

/// Every kind of light at once, over glass that absorbs and something glossy.
#[test]
fn every_kind_of_light_keeps_its_image() {
    let lamp = emitting(sphere("lamp", DVec3::new(0.5, 1.0, 0.0), 0.2, 1), 2.0);
    let mut scene = lit_floor(3.0, vec![lamp]);
    scene.materials.push(material("glass", Material::dielectric(1.5, None)));
    let glass = sphere("glass", DVec3::new(-0.6, 0.4, 0.3), 0.4, 2);
    scene.objects.push(Object { absorption: Some(Rgb::new(0.1, 1.0, 3.0)), ..glass });
    let intensity = Rgb::new(1.0, 0.5, 0.25);
    let position = DVec3::new(-1.0, 1.5, -0.5);
    let direction = DVec3::new(1.0, -1.5, 0.5);
    for (name, kind) in [
        ("point", DeltaLight::Point { position, intensity }),
        ("spot", DeltaLight::Spot { position, direction, intensity, beam: 0.3, cutoff: 0.7, image: None }),
        ("sun", DeltaLight::Directional { direction: DVec3::new(0.3, -1.0, 0.2), irradiance: intensity }),
    ] {
        scene.lights.push(LightDescription { name: name.into(), kind });
    }
    let camera = scene.camera.as_mut().expect("a camera");
    *camera = pinhole(DVec3::new(0.0, 3.0, -3.0), DVec3::ZERO, 0.9, 16);
    agree("every kind", &Run::of(&under_sky(scene, 0.05), Filter::Box, 6), &[2, 63], 32);
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let run = Run::builtin("many-lights:n=64", 16);
    let technique = resampled(4);
    let on = |threads: usize| -> Film {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run.film(&technique, 5, 0..4))
    };
    assert!(on(1) == on(3));
    assert!(on(1) != run.film(&etendue_path::INFO, 5, 0..4));
}

/// Which parts of the light are rendered does not change which light is kept.
#[test]
fn parts_of_the_light_add_up() {
    let mut run = Run::builtin("sky", 16);
    let technique = resampled(4);
    let whole = run.film(&technique, 3, 0..8);
    let films = Part::ALL.map(|part| {
        run.settings.parts = Parts::NONE.with(part);
        run.film(&technique, 3, 0..8)
    });
    for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))) {
        let pixel = UVec2::new(x, y);
        let sum = films.iter().map(|f| f.mean(pixel)).fold(Rgb::BLACK, |a, b| a + b);
        let all = whole.mean(pixel);
        assert!((0..3).all(|c| (sum[c] - all[c]).abs() <= 1e-5 * all[c].abs()), "{pixel}: {sum:?} {all:?}");
    }
}
