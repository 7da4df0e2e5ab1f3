//! Agreement with another renderer: the seven peer scenes against their references, image means and 16x16 blocks.
//!
//! The standard error of a block is ours, from replicates, plus the reference's, from the relative error that is stated
//! with it. `ETENDUE_PEER_PASSES` sets the passes a replicate (default 12), `ETENDUE_PEER_REPLICATES` their number
//! (default 8); the figures of each scene are printed.

use etendue_core::{
    rgb::Rgb,
    statistics::{moments::Moments, special::student_t_quantile},
};
use etendue_path::INFO;
use etendue_tests::{Run, shared};
use std::path::Path;

const BLOCK: usize = 16;
/// Two-sided significance of a whole scene's test: that of four standard errors.
const SIGNIFICANCE: f64 = 6.334e-5;

fn setting(name: &str, default: u32) -> u32 {
    std::env::var(name).map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} is a number")))
}

/// Means over the pixels and channels of each block, and over all of them last.
fn block_means(image: &[Rgb], width: usize) -> Vec<f64> {
    let blocks = width / BLOCK;
    let mut means = vec![0.0; blocks * blocks + 1];
    for (i, c) in image.iter().enumerate() {
        let block = i / width / BLOCK * blocks + i % width / BLOCK;
        let value = c.to_array().iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0;
        means[block] += value / (BLOCK * BLOCK) as f64;
        means[blocks * blocks] += value / image.len() as f64;
    }
    means
}

/// Variances of the reference's block means. Its stated relMSE is the mean of `variance / (ref² + 0.01)`; the variance is
/// taken to be spread over the pixels as that denominator is, alike in the three channels and independent.
fn reference_variances(reference: &[Rgb], width: usize, relmse: f64) -> Vec<f64> {
    let blocks = width / BLOCK;
    let mut variances = vec![0.0; blocks * blocks + 1];
    for (i, c) in reference.iter().enumerate() {
        let block = i / width / BLOCK * blocks + i % width / BLOCK;
        let squares = c.to_array().iter().map(|v| f64::from(*v).powi(2) + 0.01).sum::<f64>() / 3.0;
        variances[block] += relmse * squares / ((BLOCK * BLOCK) as f64).powi(2);
        variances[blocks * blocks] += relmse * squares / (reference.len() as f64).powi(2);
    }
    variances
}

/// Compares a scene with its reference; `masked` tells which blocks hold a caustic, whose error has no reliable estimate.
fn agrees(name: &str, masked: impl Fn(usize, usize) -> bool) {
    let Some(peers) = shared("peers") else { return };
    let loaded = etendue_scenes::load(peers.join(format!("scenes/{name}.xml")).to_str().expect("a UTF-8 path"))
        .expect("the scene loads");
    let run = Run::new(&loaded);
    let (reference, relmse) = reference(&peers, name);
    let width = run.resolution.x as usize;
    let (passes, replicates) = (setting("ETENDUE_PEER_PASSES", 12), setting("ETENDUE_PEER_REPLICATES", 8));

    let mut ours = vec![Moments::default(); (width / BLOCK).pow(2) + 1];
    for image in run.replicates(&INFO, 100..100 + u64::from(replicates), passes) {
        for (moments, value) in ours.iter_mut().zip(block_means(&image, width)) {
            moments.add(value);
        }
    }
    let theirs = block_means(&reference, width);
    let their_variances = reference_variances(&reference, width, relmse);

    let blocks = width / BLOCK;
    let tested: Vec<usize> = (0..blocks * blocks).filter(|b| !masked(b % blocks, b / blocks)).collect();
    let mut worst: (f64, usize) = (0.0, 0);
    let mut failures = Vec::new();
    for &b in &tested {
        let (z, limit) = deviation(&ours[b], theirs[b], their_variances[b], tested.len());
        if z.abs() > worst.0 {
            worst = (z.abs(), b);
        }
        if z.abs() > limit {
            failures.push(format!(
                "block ({}, {}): ours {:.5}, theirs {:.5}, {z:.1} standard errors (limit {limit:.1})",
                b % blocks,
                b / blocks,
                ours[b].mean(),
                theirs[b]
            ));
        }
    }
    let image = blocks * blocks;
    let (z, limit) = deviation(&ours[image], theirs[image], their_variances[image], 1);
    println!(
        "{name}: mean ratio {:.5} +- {:.5} (ours) +- {:.5} (theirs), {z:.2} standard errors; worst of {} blocks {:.2}",
        ours[image].mean() / theirs[image],
        ours[image].standard_error() / theirs[image],
        their_variances[image].sqrt() / theirs[image],
        tested.len(),
        worst.0
    );
    assert!(failures.is_empty(), "{name}: {} of {} blocks\n{}", failures.len(), tested.len(), failures.join("\n"));
    assert!(z.abs() < limit, "{name}: image mean {} against {}", ours[image].mean(), theirs[image]);
}

/// The difference in combined standard errors, and the limit for one of `tests` tests [Sidak 1967], which widens with the
/// uncertainty of a standard error that comes from few replicates [Welch 1947].
fn deviation(ours: &Moments, theirs: f64, their_variance: f64, tests: usize) -> (f64, f64) {
    let variance = ours.standard_error().powi(2);
    let combined = variance + their_variance;
    let difference = ours.mean() - theirs;
    let degrees = (ours.count() - 1) as f64 * (combined / variance.max(f64::MIN_POSITIVE)).powi(2);
    let each = -f64::ln_1p(-SIGNIFICANCE) / tests as f64;
    let z = if difference == 0.0 { 0.0 } else { difference / combined.sqrt() };
    (z, student_t_quantile(1.0 - each / 2.0, degrees.min(1e6)))
}

/// The reference image and the relMSE that it has itself.
fn reference(peers: &Path, name: &str) -> (Vec<Rgb>, f64) {
    let image = xtask::exr_file::read(&peers.join(format!("reference/{name}.exr"))).expect("the reference is readable");
    let text = std::fs::read_to_string(peers.join("reference/reference.json")).expect("reference.json is readable");
    let entries: serde_json::Value = serde_json::from_str(&text).expect("reference.json is JSON");
    (image.pixels, entries[name]["ref_relmse"].as_f64().expect("a number"))
}

#[test]
fn cornell_agrees() {
    agrees("cornell", |_, _| false);
}

#[test]
fn veach_mis_agrees() {
    agrees("veach-mis", |_, _| false);
}

#[test]
fn many_lights_agrees() {
    agrees("many-lights", |_, _| false);
}

#[test]
fn env_diffuse_agrees() {
    agrees("env-diffuse", |_, _| false);
}

#[test]
fn ajar_door_agrees() {
    agrees("ajar-door", |_, _| false);
}

#[test]
fn glass_caustic_agrees_outside_its_caustics() {
    agrees("glass-caustic", |_, _| false);
}

#[test]
fn ring_caustic_agrees_outside_its_caustics() {
    agrees("ring-caustic", |_, _| false);
}
