//! Variance against number of samples, and the slopes.

use super::{Measured, Study, index_of};
use crate::error::Error;
use etendue_core::{
    sampler::Purpose,
    statistics::{moments::Moments, slope::fit},
};
use etendue_sampling::{integrands::Integrand, pattern::Pattern};
use rayon::prelude::*;
use serde::Serialize;

/// What patterns of points are held against.
const PLANAR: [Integrand; 6] =
    [Integrand::Smooth1, Integrand::Smooth2, Integrand::Gaussian, Integrand::Edge, Integrand::Corner, Integrand::Disk];

/// What samplers are held against, each pair of numbers being drawn together.
const PRODUCTS: [Integrand; 3] = [Integrand::Product4, Integrand::Product6, Integrand::Product8];

/// All of them.
pub const INTEGRANDS: [Integrand; 9] = [
    Integrand::Smooth1,
    Integrand::Smooth2,
    Integrand::Gaussian,
    Integrand::Edge,
    Integrand::Corner,
    Integrand::Disk,
    Integrand::Product4,
    Integrand::Product6,
    Integrand::Product8,
];

/// The most points of patterns whose time grows faster than their number.
pub const SLOW_MOST: u32 = 1024;

/// Fewer samples than these say nothing of the slope in the end.
pub const FIT_FROM: u32 = 64;

/// A number of samples.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// Samples of an estimate.
    pub samples: u32,
    /// Mean squared error over trials: the variance, as the estimates are unbiased.
    pub variance: Measured,
}

/// A pattern on an integrand.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// The pattern.
    pub pattern: &'static str,
    /// The integrand.
    pub integrand: &'static str,
    /// Its dimensions.
    pub dimensions: usize,
    /// By number of samples.
    pub levels: Vec<Level>,
    /// The exponent of variance over samples, fitted from [`FIT_FROM`] on.
    pub slope: Option<f64>,
    /// Half the width of its interval of 95 %.
    pub half_width: Option<f64>,
}

impl Series {
    fn new(pattern: Pattern, integrand: Integrand, levels: Vec<Level>) -> Series {
        let points = levels.iter().filter(|l| l.samples >= FIT_FROM).map(|l| (l.samples.into(), l.variance.mean));
        let slope = fit(&points.collect::<Vec<_>>(), 0.95).filter(|s| s.half_width.is_finite());
        Series {
            pattern: pattern.name(),
            integrand: integrand.name(),
            dimensions: integrand.dimensions(),
            levels,
            slope: slope.map(|s| s.slope),
            half_width: slope.map(|s| s.half_width),
        }
    }

    /// The slope and its interval.
    pub fn slope_text(&self) -> String {
        match (self.slope, self.half_width) {
            (Some(slope), Some(half)) => format!("{slope:.2} ± {half:.2}").replace('-', "−"),
            _ => "–".into(),
        }
    }
}

/// Numbers of samples: powers of four, for which patterns of squares have the squares they like.
fn counts(most: u32) -> impl Iterator<Item = u32> {
    (1..16).map(|i| 1 << (2 * i)).take_while(move |n| *n <= most)
}

/// How many steps this part has.
pub fn steps(most: u32) -> u32 {
    Pattern::ALL.len() as u32 * 2 * counts(most).count() as u32
}

/// Whether the time of a pattern of points grows faster than their number.
fn is_slow(pattern: Pattern) -> bool {
    matches!(pattern, Pattern::PoissonDisk | Pattern::BestCandidate)
}

/// Fewer trials where each is long.
fn trials(study: &Study, count: u32, free: u32) -> u64 {
    let whole = u64::from(study.trials);
    (whole * u64::from(free) / u64::from(count)).clamp(whole.min(16), whole)
}

pub(super) fn measure(study: &Study) -> Result<Vec<Series>, Error> {
    let mut all = Vec::new();
    for pattern in Pattern::ALL {
        let mut planar: [Vec<Level>; PLANAR.len()] = Default::default();
        let mut products: [Vec<Level>; PRODUCTS.len()] = Default::default();
        for count in counts(study.most) {
            study.step(&format!("{} {count} points", pattern.name()))?;
            if !is_slow(pattern) || count <= SLOW_MOST {
                push(&mut planar, count, &points(study, pattern, count));
            }
            study.step(&format!("{} {count} samples of eight numbers", pattern.name()))?;
            push(&mut products, count, &samples(study, pattern, count));
        }
        let both = PLANAR.into_iter().zip(planar).chain(PRODUCTS.into_iter().zip(products));
        all.extend(both.map(|(integrand, levels)| Series::new(pattern, integrand, levels)));
    }
    Ok(all)
}

fn push<const K: usize>(levels: &mut [Vec<Level>; K], samples: u32, errors: &[[f64; K]]) {
    for (k, levels) in levels.iter_mut().enumerate() {
        let squares: Moments = errors.iter().map(|e| e[k]).collect();
        levels.push(Level { samples, variance: Measured::of(&squares) });
    }
}

/// Squared errors of patterns of points.
fn points(study: &Study, pattern: Pattern, count: u32) -> Vec<[f64; PLANAR.len()]> {
    // The regular grid has nothing random: one trial tells all, and its points are where they should be.
    let (trials, shift) = match pattern {
        Pattern::Grid => (1, 0.0),
        _ => (trials(study, count, if is_slow(pattern) { 64 } else { 4096 }), HALF_STEP),
    };
    let exact = PLANAR.map(Integrand::exact);
    let part = index_of(pattern) << 32 | u64::from(count);
    let trial = |trial: u64| {
        let mut sums = [0.0; PLANAR.len()];
        for p in pattern.points(count, study.seed(part, trial)) {
            let x = p.to_array().map(|x| f64::from(x) + shift);
            for (sum, integrand) in sums.iter_mut().zip(PLANAR) {
                *sum += integrand.evaluate(&x);
            }
        }
        std::array::from_fn(|k| (sums[k] / f64::from(count) - exact[k]).powi(2))
    };
    (0..trials).into_par_iter().map(trial).collect()
}

/// Numbers are multiples of `2^-24`: the middle of their step is meant, or rounding down would show as a bias of `2^-25`,
/// which is all the error that tens of thousands of Sobol points have.
const HALF_STEP: f64 = 0.5 / (1u32 << 24) as f64;

/// Squared errors of samplers.
fn samples(study: &Study, pattern: Pattern, count: u32) -> Vec<[f64; PRODUCTS.len()]> {
    let exact = PRODUCTS.map(Integrand::exact);
    let part = 1 << 48 | index_of(pattern) << 32 | u64::from(count);
    let trial = |trial: u64| {
        let mut sampler = pattern.sampler()(study.seed(part, trial), count);
        let mut sums = [0.0; PRODUCTS.len()];
        for sample in 0..count {
            sampler.start_sample(0, sample);
            let mut x = [0.0; 8];
            for (vertex, pair) in x.chunks_exact_mut(2).enumerate() {
                let point = sampler.get_2d(1 + vertex as u32, Purpose::LightPoint);
                pair.copy_from_slice(&point.to_array().map(|x| f64::from(x) + HALF_STEP));
            }
            for (sum, integrand) in sums.iter_mut().zip(PRODUCTS) {
                *sum += integrand.evaluate(&x);
            }
        }
        std::array::from_fn(|k| (sums[k] / f64::from(count) - exact[k]).powi(2))
    };
    (0..trials(study, count, 1024)).into_par_iter().map(trial).collect()
}
