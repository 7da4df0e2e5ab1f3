//! Agreement with another renderer: the seven peer scenes against their references, image means and 16x16 blocks.
//!
//! The standard error of a block is ours, from replicates, plus the reference's, from the relative error that is stated
//! with it. `ETENDUE_PEER_PASSES` sets the passes a replicate (default 3, or 18 with weak caustics everywhere),
//! `ETENDUE_PEER_REPLICATES` their number (default 32); the figures of each scene are printed.

use etendue_core::{
    rgb::Rgb,
    statistics::tiles::{Tiles, WHOLE_IMAGE, compare, replicated_tile_means, tile_means},
};
use etendue_path::INFO;
use etendue_tests::{Run, shared};
use std::path::Path;
use xtask::exr_file::read_picture;

const BLOCK: usize = 16;
/// Passes a replicate.
const FEW: u32 = 3;
/// The same where weak caustics lie everywhere (mirror and glass balls in closed rooms): with fewer passes most replicates
/// find none in a block, and their scatter says nothing of its error.
const MANY: u32 = 18;
/// Two-sided significance of the test of all blocks of a scene, Sidak-corrected for their number: that of four standard
/// errors. The seeds are fixed, so that a pass stays a pass.
const SIGNIFICANCE: f64 = 6.334e-5;

/// Blocks of glass-caustic, and their neighbours, of which more than 15 % of the light in the reference comes to a rough
/// surface straight from the lamp by way of glass or mirror (384 passes of all other parts of the light were taken from
/// the reference). A path tracer finds such light by running into the small lamp, so that its error has no reliable
/// estimate from few replicates.
const GLASS_CAUSTIC: [&str; 16] = [
    ".###############",
    ".###############",
    "..##############",
    "...############.",
    "................",
    "................",
    "................",
    "................",
    "................",
    ".....###........",
    ".....###.....###",
    ".....###..######",
    "........########",
    "........########",
    "........########",
    "................",
];

/// As [`GLASS_CAUSTIC`] for ring-caustic, with a share of 2 %: there a block has such light or none.
const RING_CAUSTIC: [&str; 16] = [
    "....########....",
    "...##########...",
    "..############..",
    ".##############.",
    ".#####....#####.",
    ".####......####.",
    ".###........###.",
    ".####......####.",
    ".##############.",
    ".##############.",
    ".##############.",
    ".#############..",
    ".############...",
    ".###########....",
    "..###.....###...",
    "..###.....###...",
];

/// Whether a block is masked.
fn in_mask(mask: &[&str; 16], column: usize, row: usize) -> bool {
    mask[row].as_bytes()[column] == b'#'
}

fn setting(name: &str, default: u32) -> u32 {
    std::env::var(name).map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} is a number")))
}

/// Standard errors of the reference's tile means. Its stated relMSE is the mean of `variance / (ref² + 0.01)`; the variance
/// is taken to be spread over pixels and channels as that denominator is, and independent from pixel to pixel.
fn reference_errors(reference: &[Rgb], width: usize, tile: usize, relmse: f64) -> Vec<[f64; 3]> {
    let variance: Vec<Rgb> = reference.iter().map(|c| (*c * *c + Rgb::splat(0.01)) * relmse as f32).collect();
    let pixels = tile.min(width).pow(2) as f64;
    tile_means(&variance, width, tile).means.iter().map(|m| m.map(|v| (v / pixels).sqrt())).collect()
}

/// Compares a scene with its reference; `masked` tells which blocks (column, row) hold a caustic that path tracing finds
/// by chance only, so that its error has no reliable estimate there.
fn agrees(name: &str, passes: u32, masked: impl Fn(usize, usize) -> bool) {
    let Some(peers) = shared("peers") else { return };
    let file = peers.join(format!("scenes/{name}.xml"));
    let run = Run::new(&etendue_scenes::load(file.to_str().expect("a UTF-8 path")).expect("the scene loads"));
    let (reference, relmse) = reference(&peers, name);
    let width = run.resolution.x as usize;
    let (passes, replicates) = (setting("ETENDUE_PEER_PASSES", passes), setting("ETENDUE_PEER_REPLICATES", 32));
    let images = run.replicates(&INFO, 100..100 + u64::from(replicates), passes);
    let images: Vec<&[Rgb]> = images.iter().map(Vec::as_slice).collect();
    let degrees = f64::from(replicates - 1);

    let combined = |tile: usize| {
        let (ours, errors) = replicated_tile_means(&images, width, tile);
        let theirs = reference_errors(&reference, width, tile, relmse);
        let both = errors.iter().zip(&theirs).map(|(a, b)| [0, 1, 2].map(|c| a[c].hypot(b[c]))).collect::<Vec<_>>();
        (ours, tile_means(&reference, width, tile), errors, theirs, both)
    };
    let (ours, theirs, our_errors, their_errors, errors) = combined(WHOLE_IMAGE);
    let mean = |v: [f64; 3]| v.iter().sum::<f64>() / 3.0;
    // Channels of a path are all but fully correlated: the error of their mean is the mean of their errors.
    let (a, b, error) = (mean(ours.means[0]), mean(theirs.means[0]), mean(errors[0]));
    println!(
        "{name}: mean ratio {:.5} +- {:.5} (ours) +- {:.5} (theirs), {:.2} standard errors",
        a / b,
        mean(our_errors[0]) / b,
        mean(their_errors[0]) / b,
        (a - b) / error
    );
    let (ours, theirs, .., errors) = combined(BLOCK);
    let tested: Vec<usize> = (0..errors.len()).filter(|i| !masked(i % ours.columns, i / ours.columns)).collect();
    let pick = |tiles: &Tiles| Tiles {
        columns: tested.len(),
        rows: 1,
        means: tested.iter().map(|i| tiles.means[*i]).collect(),
    };
    let errors: Vec<_> = tested.iter().map(|i| errors[*i]).collect();
    let blocks = compare(&pick(&ours), &pick(&theirs), &errors, degrees, SIGNIFICANCE);
    let worst = tested[blocks.worst.0];
    println!(
        "{name}: worst of {} blocks at ({}, {}), {:+.2} standard errors, {:+.3} % ({} fail)",
        tested.len(),
        worst % ours.columns,
        worst / ours.columns,
        blocks.t,
        100.0 * blocks.relative,
        blocks.failures
    );
    assert!((a - b).abs() < 4.0 * error, "{name}: image mean {a} against {b}");
    assert_eq!(blocks.failures, 0, "{name}: {blocks:?}");
}

/// The reference image and the relMSE that it has itself.
fn reference(peers: &Path, name: &str) -> (Vec<Rgb>, f64) {
    let image = read_picture(&peers.join(format!("reference/{name}.exr"))).expect("the reference is readable");
    let text = std::fs::read_to_string(peers.join("reference/reference.json")).expect("reference.json is readable");
    let entries: serde_json::Value = serde_json::from_str(&text).expect("reference.json is JSON");
    (image.pixels, entries[name]["ref_relmse"].as_f64().expect("a number"))
}

#[test]
fn cornell_agrees() {
    agrees("cornell", FEW, |_, _| false);
}

#[test]
fn veach_mis_agrees() {
    agrees("veach-mis", FEW, |_, _| false);
}

#[test]
fn many_lights_agrees() {
    agrees("many-lights", FEW, |_, _| false);
}

#[test]
fn env_diffuse_agrees() {
    agrees("env-diffuse", FEW, |_, _| false);
}

#[test]
fn ajar_door_agrees() {
    agrees("ajar-door", MANY, |_, _| false);
}

#[test]
fn glass_caustic_agrees_outside_its_caustics() {
    agrees("glass-caustic", MANY, |column, row| in_mask(&GLASS_CAUSTIC, column, row));
}

#[test]
fn ring_caustic_agrees_outside_its_caustics() {
    agrees("ring-caustic", FEW, |column, row| in_mask(&RING_CAUSTIC, column, row));
}
