//! Spectra against the sums that define them and against expectations in closed form.

use etendue_core::{
    independent::Independent,
    sampler::{Purpose, Sampler},
    statistics::moments::Moments,
};
use etendue_sampling::{pattern::Pattern, spectrum::Spectrum};
use glam::Vec2;
use std::f64::consts::{PI, TAU};

fn independent(count: u32, realisation: u32) -> Vec<Vec2> {
    let mut sampler = Independent::new(1);
    sampler.start_sample(realisation, 0);
    (0..count).map(|i| sampler.get_2d(i, Purpose::Film)).collect()
}

/// A point in each cell of a grid.
fn jittered(side: u32, realisation: u32) -> Vec<Vec2> {
    let cell =
        |(i, u): (usize, Vec2)| (Vec2::new((i as u32 % side) as f32, (i as u32 / side) as f32) + u) / side as f32;
    independent(side * side, realisation).into_iter().enumerate().map(cell).collect()
}

fn mean_of(count: u32, highest: u32, points: impl Fn(u32) -> Vec<Vec2>) -> Spectrum {
    let mut spectrum = Spectrum::new(highest);
    (0..count).for_each(|realisation| spectrum.add(&points(realisation)));
    assert_eq!((spectrum.realisations(), spectrum.highest()), (count, highest));
    spectrum
}

#[test]
fn it_is_the_sum_that_defines_it() {
    for count in [1, 2, 63, 64, 65, 200] {
        let points = independent(count, 0);
        let spectrum = mean_of(1, 9, |_| points.clone());
        for (x, y) in (-9..=9).flat_map(|y| (-9..=9).map(move |x| (x, y))) {
            let angle = |p: &Vec2| TAU * (f64::from(x) * f64::from(p.x) + f64::from(y) * f64::from(p.y));
            let (re, im) = points.iter().fold((0.0, 0.0), |(re, im), p| (re + angle(p).cos(), im - angle(p).sin()));
            let direct = (re * re + im * im) / f64::from(count);
            assert!((spectrum.power(x, y) - direct).abs() < 1e-10 * f64::from(count), "({x}, {y}) of {count}");
        }
    }
}

#[test]
fn realisations_are_averaged_and_the_image_is_symmetric() {
    let [both, first, second] = [0..2, 0..1, 1..2].map(|range| {
        let mut spectrum = Spectrum::new(5);
        range.for_each(|realisation| spectrum.add(&independent(40, realisation)));
        spectrum.image()
    });
    assert_eq!(both.len(), 121);
    for i in 0..121 {
        assert!((both[i] - 0.5 * (first[i] + second[i])).abs() < 1e-12);
        assert_eq!(both[i], both[120 - i]);
    }
    assert!((both[60] - 40.0).abs() < 1e-12);
}

#[test]
fn white_noise_is_white_in_every_direction() {
    let realisations = 20;
    let spectrum = mean_of(realisations, 40, |r| independent(500, r));
    let rings = spectrum.rings();
    assert_eq!(rings.len(), 40);
    // A ring has about pi r frequencies of its own, and each power scatters by its mean.
    let scatter = |radius: u32| (PI * f64::from(radius) * f64::from(realisations)).sqrt().recip();
    for ring in &rings {
        let z = (ring.mean - 1.0) / scatter(ring.radius);
        assert!(z.abs() < 4.5, "{ring:?}: z = {z}");
    }
    let anisotropy: Moments = rings[3..].iter().map(|r| r.anisotropy * f64::from(realisations)).collect();
    assert!((anisotropy.mean() - 1.0).abs() < 4.0 * anisotropy.standard_error(), "{anisotropy:?}");
    let below: f64 = spectrum.mean_below(20.0);
    assert!((below - 1.0).abs() < 4.0 / (0.5 * PI * 400.0 * 20.0_f64).sqrt(), "{below}");
}

/// A point that is uniform in its cell has the characteristic function `sinc(f_x / n) sinc(f_y / n)` about its middle.
#[test]
fn a_jittered_grid_has_the_spectrum_that_theory_gives() {
    let (side, realisations) = (16, 400);
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
    let expected = |x: i32, y: i32| {
        let part = sinc(f64::from(x) / f64::from(side)) * sinc(f64::from(y) / f64::from(side));
        1.0 - part * part
    };
    let spectrum = mean_of(realisations, 24, |r| jittered(side, r));
    for (x, y) in (0..=24).flat_map(|y| (-24..=24).map(move |x| (x, y))).filter(|p| *p != (0, 0)) {
        let (found, expected) = (spectrum.power(x, y), expected(x, y));
        // Nearly exponential, or chi-square with one degree on the axes.
        let z = (found - expected) / (expected * (2.0 / f64::from(realisations)).sqrt());
        assert!(z.abs() < 5.0, "({x}, {y}): {found} against {expected}");
    }
    let low = spectrum.mean_below(0.25 * f64::from(side));
    assert!(low < 0.1, "{low} of white noise's energy");
}

#[test]
fn directions_show_as_anisotropy() {
    let realisations = 10;
    // Jittered in one direction alone.
    let lines = |r: u32| {
        independent(256, r).iter().enumerate().map(|(i, u)| Vec2::new((i as f32 + u.x) / 256.0, u.y)).collect()
    };
    let lined = mean_of(realisations, 20, lines).rings();
    let white = mean_of(realisations, 20, |r| independent(256, r)).rings();
    let db = |rings: &[etendue_sampling::spectrum::Ring]| {
        rings[2..].iter().map(|r| r.anisotropy_db()).sum::<f64>() / (rings.len() - 2) as f64
    };
    assert!((db(&white) + 10.0).abs() < 1.0, "{} dB", db(&white));
    assert!(db(&lined) > db(&white) + 1.0, "{} dB against {} dB", db(&lined), db(&white));
}

#[test]
fn nothing_has_no_power() {
    let mut spectrum = Spectrum::new(3);
    assert_eq!((spectrum.power(1, 1), spectrum.mean_below(3.0)), (0.0, 0.0));
    spectrum.add(&[]);
    assert!(spectrum.image().iter().all(|p| *p == 0.0));
    assert!(spectrum.rings().iter().all(|r| r.mean == 0.0 && r.anisotropy == 0.0));
    let mut constant = Spectrum::new(0);
    constant.add(&independent(7, 0));
    assert_eq!((constant.image(), constant.rings(), constant.mean_below(9.0)), (vec![7.0], vec![], 0.0));
}

/// Every pattern of 256 points, against white noise: below half of the frequency at which a regular grid has its first
/// power, and over directions.
#[test]
fn blue_noise_has_little_at_low_frequencies_and_no_direction() {
    let (count, realisations) = (256, 40);
    let of = |pattern: Pattern| mean_of(realisations, 40, |r| pattern.points(count, 100 + u64::from(r)));
    // What the directions of a ring differ by, in decibels: -10 log10(realisations) without any. Below the frequency of
    // a regular grid, 16, power rises so steeply that a ring is not of one power in any direction.
    let anisotropy = |spectrum: &Spectrum| {
        let rings = spectrum.rings();
        let beyond = rings.iter().filter(|r| r.radius > 16).map(|r| r.anisotropy_db()).collect::<Moments>();
        beyond.mean()
    };
    let isotropic = -10.0 * f64::from(realisations).log10();
    for (pattern, share) in [(Pattern::PoissonDisk, 0.15), (Pattern::BestCandidate, 0.15)] {
        let spectrum = of(pattern);
        let (low, directions) = (spectrum.mean_below(8.0), anisotropy(&spectrum));
        assert!(low < share, "{}: {low} of white noise's energy", pattern.name());
        println!(
            "{}: {low:.3} of white noise's energy, {:.2} dB beyond isotropy",
            pattern.name(),
            directions - isotropic
        );
        assert!(directions < isotropic + 1.0, "{}: {directions} dB", pattern.name());
    }
    let (white, jittered) = (of(Pattern::Independent), of(Pattern::CorrelatedMultiJittered));
    assert!((white.mean_below(8.0) - 1.0).abs() < 0.1, "{}", white.mean_below(8.0));
    assert!((anisotropy(&white) - isotropic).abs() < 1.0, "{} dB", anisotropy(&white));
    assert!(anisotropy(&jittered) > isotropic + 6.0, "{} dB", anisotropy(&jittered));
}
