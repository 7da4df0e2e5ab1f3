//! Each strategy alone, without weights: where nothing but diffuse surfaces and lights with an extent are, all of them can
//! make every path, so all that make paths of one length have the same mean.

use etendue_bidir::{events::Event, strategies::Paths, weights::Heuristic};
use etendue_core::{
    filter::Filter,
    has,
    independent::independent,
    scene::SceneDescription,
    statistics::{moments::Moments, render::Rays},
};
use etendue_tests::{Run, limit, small::*};
use glam::{DVec3, UVec2};

const REPLICATES: u64 = 24;
/// Longest path looked at.
const EDGES: usize = 5;

/// The image means of all strategies, by edges and vertices made from the light, from one seed.
fn means(run: &Run, seed: u64, passes: u32) -> [[f64; EDGES + 2]; EDGES + 1] {
    let pixels = run.resolution.x * run.resolution.y;
    let mut paths = Paths::new(&run.scene, &run.settings, Heuristic::Balance, Filter::Box, pixels);
    let mut sampler = independent(seed, passes);
    let mut sums = [[0.0; EDGES + 2]; EDGES + 1];
    for pass in 0..passes {
        for index in 0..pixels {
            sampler.start_sample(index, pass);
            let pixel = UVec2::new(index % run.resolution.x, index / run.resolution.x);
            paths.sample::<{ has::ALL }>(pixel, &mut *sampler, &mut Rays::default(), &mut |event| {
                let Event::Contribution(c) = event else { return };
                if c.film.is_none_or(|film| run.scene.camera().film_contains(film, 0.0)) {
                    sums[(c.s + c.t - 1) as usize][c.s as usize] += f64::from(c.value.g);
                }
            });
        }
    }
    sums.map(|of| of.map(|sum| sum / (f64::from(pixels) * f64::from(passes))))
}

fn alike(name: &str, run: &mut Run, passes: u32) {
    run.settings.max_depth = EDGES as u32;
    let replicates: Vec<_> = (0..REPLICATES).map(|seed| means(run, seed, passes)).collect();
    for edges in 2..=EDGES {
        let of = |s: usize| replicates.iter().map(|r| r[edges][s]).collect::<Moments>();
        let direct = of(1);
        for s in 0..=edges {
            let strategy = of(s);
            // The same walks stand behind several of them: what is alike in both cancels.
            let difference: Moments = replicates.iter().map(|r| r[edges][s] - r[edges][1]).collect();
            let z = if s == 1 { 0.0 } else { difference.mean() / difference.standard_error() };
            println!(
                "{name}, {edges} edges, s = {s}: {:.6} +- {:.6}, {z:+.2} standard errors",
                strategy.mean(),
                strategy.standard_error()
            );
            assert!(strategy.mean() > 0.0 && z.abs() < limit(REPLICATES), "{name}, {edges} edges, s = {s}: {z}");
            assert!(strategy.standard_error() < 0.2 * direct.mean(), "{name}, {edges} edges, s = {s}: {strategy:?}");
        }
    }
}

#[test]
fn each_alone_has_the_same_mean_under_area_lights() {
    alike("furnace", &mut Run::builtin("furnace", 8), 64);
    let objects = vec![
        rectangle("floor", DVec3::ZERO, DVec3::Y, (1.0, 1.0), 0),
        rectangle("back", DVec3::new(0.0, 1.0, -1.0), DVec3::Z, (1.0, 1.0), 0),
        sphere("ball", DVec3::new(0.4, 0.3, 0.2), 0.3, 0),
        emitting(sphere("lamp", DVec3::new(-0.4, 1.2, 0.2), 0.3, 0), 3.0),
        emitting(rectangle("panel", DVec3::Y * 1.9, DVec3::NEG_Y, (0.5, 0.5), 0), 2.0),
    ];
    let scene = SceneDescription {
        name: "room".into(),
        camera: Some(pinhole(DVec3::new(0.3, 1.0, 3.5), DVec3::new(0.0, 0.8, 0.0), 0.7, 8)),
        materials: vec![grey(0.8)],
        objects,
        ..SceneDescription::default()
    };
    alike("room", &mut Run::of(&scene, Filter::Box, 5), 128);
    let scene = under_sky(SceneDescription { name: "room under a sky".into(), ..scene }, 1.0);
    alike("room under a sky", &mut Run::of(&scene, Filter::Box, 5), 128);
}
