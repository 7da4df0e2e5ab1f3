//! The same seed gives the same bits, for any number of threads and any grouping of passes, for every technique.

use etendue_core::{film::Film, technique::Parts};
use etendue_tests::Run;
use glam::UVec2;
use xtask::techniques::TECHNIQUES;

fn on_threads(threads: usize, run: impl FnOnce() -> Film + Send) -> Film {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(run)
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for scene in ["cornell", "glass-caustic", "sky", "many-lights:n=64"] {
        let run = Run::builtin(scene, 32);
        for technique in TECHNIQUES {
            let one = on_threads(1, || run.film(technique, 5, 0..6));
            for threads in [2, 3] {
                let several = on_threads(threads, || run.film(technique, 5, 0..6));
                assert!(one == several, "{} on {scene}: {threads} threads", technique.name);
            }
        }
    }
}

#[test]
fn passes_rendered_apart_and_merged_change_no_bit() {
    for scene in ["cornell", "sky"] {
        let run = Run::builtin(scene, 32);
        for technique in TECHNIQUES {
            let whole = run.film(technique, 9, 0..7);
            let mut parts = [run.film(technique, 9, 5..7), run.film(technique, 9, 0..2), run.film(technique, 9, 2..5)];
            let (first, rest) = parts.split_first_mut().expect("three parts");
            for part in rest {
                first.merge(part).expect("films of one render merge");
            }
            assert!(whole == *first, "{} on {scene}", technique.name);
        }
    }
}

#[test]
fn another_seed_gives_another_image() {
    let run = Run::builtin("cornell", 16);
    for technique in TECHNIQUES {
        assert!(run.film(technique, 1, 0..2) != run.film(technique, 2, 0..2), "{}", technique.name);
    }
}

/// Films of disjoint parts of the light add up to the whole: each path's contributions are the same, so the means differ
/// by the rounding of sums alone.
#[test]
fn parts_of_the_light_add_up() {
    for scene in ["cornell", "glass-caustic", "sky", "ring"] {
        for technique in TECHNIQUES {
            let mut run = Run::builtin(scene, 32);
            let whole = run.film(technique, 3, 0..8);
            let films: Vec<Film> = etendue_core::technique::Part::ALL
                .iter()
                .map(|part| {
                    run.settings.parts = Parts::NONE.with(*part);
                    run.film(technique, 3, 0..8)
                })
                .collect();
            for y in 0..32 {
                for x in 0..32 {
                    let pixel = UVec2::new(x, y);
                    let sum = films.iter().map(|f| f.mean(pixel)).fold(etendue_core::rgb::Rgb::BLACK, |a, b| a + b);
                    let all = whole.mean(pixel);
                    for c in 0..3 {
                        let error = (sum[c] - all[c]).abs();
                        assert!(
                            error <= 1e-5 * all[c].abs(),
                            "{} on {scene} at {pixel}: {sum:?} {all:?}",
                            technique.name
                        );
                    }
                }
            }
        }
    }
}

/// A technique that is handed the next frame's scene renders it as one built for it does.
#[test]
fn the_next_frame_is_rendered_like_a_first_one() {
    let (before, after) = (Run::builtin("sky", 16), Run::builtin("cornell", 16));
    for technique in TECHNIQUES {
        let defaults: Vec<f64> = technique.knobs.iter().map(|k| k.default).collect();
        let mut moved = (technique.build)(before.scene.clone(), before.settings, &defaults);
        moved.pass(1, 0, &mut Film::new(before.resolution, before.filter));
        moved.next_frame(after.scene.clone());
        let mut fresh = (technique.build)(after.scene.clone(), before.settings, &defaults);
        let mut films = [Film::new(after.resolution, after.filter), Film::new(after.resolution, after.filter)];
        moved.pass(2, 0, &mut films[0]);
        fresh.pass(2, 0, &mut films[1]);
        assert!(films[0] == films[1], "{}", technique.name);
    }
}
