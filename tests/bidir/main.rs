//! Light tracing and bidirectional path tracing against path tracing.

mod direct;
mod scenes;
mod weights;

use etendue_core::{
    has,
    rgb::Rgb,
    sampler::Purpose,
    statistics::tiles::{Tiles, WHOLE_IMAGE, compare, replicated_tile_means},
    technique::TechniqueInfo,
    walk::{Vertex, Walk},
};
use etendue_tests::Run;
use glam::Vec2;

/// Two-sided significance of four standard errors.
const SIGNIFICANCE: f64 = 6.334e-5;
/// Pixels of a tile's side.
const TILE: usize = 8;

/// An independent estimate of an image for each seed.
fn images(run: &Run, technique: &TechniqueInfo, first: u64, passes: u32) -> Vec<Vec<Rgb>> {
    run.replicates(technique, first..first + REPLICATES, passes)
}

const REPLICATES: u64 = 16;

/// Holds the means of the tiles that `tested` names, and of the whole image where it names all, against each other.
fn hold(name: &str, width: usize, a: &[Vec<Rgb>], b: &[Vec<Rgb>], tested: impl Fn(usize, usize) -> bool) {
    for tile in [WHOLE_IMAGE, TILE] {
        let of = |images: &[Vec<Rgb>]| {
            replicated_tile_means(&images.iter().map(Vec::as_slice).collect::<Vec<_>>(), width, tile)
        };
        let ((a, a_errors), (b, b_errors)) = (of(a), of(b));
        let chosen: Vec<usize> = if tile == WHOLE_IMAGE {
            vec![0]
        } else {
            (0..a.means.len()).filter(|i| tested(i % a.columns, i / a.columns)).collect()
        };
        let pick =
            |t: &Tiles| Tiles { columns: chosen.len(), rows: 1, means: chosen.iter().map(|i| t.means[*i]).collect() };
        let errors: Vec<_> = chosen.iter().map(|i| [0, 1, 2].map(|c| a_errors[*i][c].hypot(b_errors[*i][c]))).collect();
        let found = compare(&pick(&a), &pick(&b), &errors, (REPLICATES - 1) as f64, SIGNIFICANCE);
        println!(
            "{name}, {} tiles: worst {:?} {:+.2} standard errors, {:+.3} %, error {:.3} %",
            chosen.len(),
            found.worst,
            found.t,
            100.0 * found.relative,
            100.0 * errors[found.worst.0][1] / pick(&b).means[found.worst.0][1]
        );
        if std::env::var_os("CHECK").is_none() {
            assert_eq!(found.failures, 0, "{name}: {found:?}");
        }
    }
}

#[test]
fn explore() {
    let scenes = std::env::var("SCENES").unwrap_or_default();
    for spec in scenes.split_whitespace() {
        let passes = std::env::var("PASSES").map_or(16, |p| p.parse().unwrap());
        if std::env::var_os("SPEED").is_some() {
            let mut run = Run::builtin(spec, 32);
            run.settings.planned_passes = 0;
            for i in 0..5 {
                let t = std::time::Instant::now();
                let c = std::time::Instant::now();
                images(&run, &etendue_bidir::BIDIR, i, passes);
                println!("{spec} {:.3}", t.elapsed().as_secs_f64());
                let _ = c;
            }
            continue;
        }
        let run = Run::builtin(spec, 32);
        let t = std::time::Instant::now();
        let path = images(&run, &etendue_path::INFO, 0, passes * 4);
        let tp = t.elapsed().as_secs_f64() / 4.0;
        let t = std::time::Instant::now();
        let bidir = images(&run, &etendue_bidir::BIDIR, 100, passes);
        let tb = t.elapsed().as_secs_f64();
        println!("{spec}: bidir costs {:.2} path passes, {tb:.2} s", tb / tp);
        hold(&format!("{spec} bidir/path"), 32, &bidir, &path, |_, _| true);
        let light = images(&run, &etendue_bidir::LIGHT, 200, passes);
        hold(&format!("{spec} light/path"), 32, &light, &path, |_, _| true);
    }
}
