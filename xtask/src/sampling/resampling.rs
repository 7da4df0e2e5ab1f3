//! The variance of resampled importance sampling against its number of candidates.

use super::{Measured, Study};
use crate::error::Error;
use etendue_core::{
    independent::Independent,
    sampler::{Purpose, Sampler},
    statistics::moments::Moments,
};
use etendue_sampling::{
    integrands::Integrand,
    ris::{Candidate, resample},
};
use rayon::prelude::*;
use serde::Serialize;

/// The integrand: a bump.
const F: Integrand = Integrand::Gaussian;
/// Numbers of candidates.
const CANDIDATES: [u32; 9] = [1, 2, 4, 8, 16, 32, 64, 128, 256];
/// Steps of this part.
pub const STEPS: u32 = Target::ALL.len() as u32;

/// What candidates are kept in proportion to.
#[derive(Clone, Copy, Debug)]
enum Target {
    /// The integrand: the estimate is the mean of the candidates'.
    Integrand,
    /// The integrand's square root, a wider bump: near it.
    Good,
    /// Small where the integrand is large.
    Bad,
}

impl Target {
    const ALL: [Target; 3] = [Target::Integrand, Target::Good, Target::Bad];

    fn name(self) -> &'static str {
        match self {
            Target::Integrand => "the integrand",
            Target::Good => "good: its square root",
            Target::Bad => "bad: 1.1 less the integrand",
        }
    }

    fn at(self, x: &[f64; 2]) -> f64 {
        let f = F.evaluate(x);
        match self {
            Target::Integrand => f,
            Target::Good => f.sqrt(),
            Target::Bad => 1.1 - f,
        }
    }
}

/// A number of candidates.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// M.
    pub candidates: u32,
    /// As measured.
    pub variance: Measured,
    /// As the formula gives it.
    pub theory: f64,
}

/// A target.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// The target.
    pub target: &'static str,
    /// By number of candidates.
    pub levels: Vec<Level>,
}

pub(super) fn measure(study: &Study) -> Result<Vec<Series>, Error> {
    let series = |(index, target): (usize, Target)| {
        study.step(&format!("resampling, {}", target.name()))?;
        let levels = CANDIDATES.iter().map(|&m| Level {
            candidates: m,
            variance: Measured::of(&variance(study, index as u64, target, m)),
            theory: theory(target, m),
        });
        Ok(Series { target: target.name(), levels: levels.collect() })
    };
    Target::ALL.into_iter().enumerate().map(series).collect()
}

/// Squared errors with `m` uniform candidates.
fn variance(study: &Study, index: u64, target: Target, m: u32) -> Moments {
    let exact = F.exact();
    let seed = study.seed(3 << 48 | index << 32 | u64::from(m), 0);
    let trial = |trial: u32| {
        let mut sampler = Independent::new(seed);
        sampler.start_sample(trial, 0);
        let candidates: Vec<_> = (0..m)
            .map(|k| sampler.get_2d(k, Purpose::LightPoint).to_array().map(f64::from))
            .map(|x| Candidate::identical(x, 1.0, m.into()))
            .collect();
        let mut k = 0;
        let choice = || {
            k += 1;
            sampler.get_1d(k, Purpose::LightCandidate)
        };
        let kept = resample(candidates, |x| target.at(x), choice);
        (kept.map_or(0.0, |kept| F.evaluate(&kept.sample) * kept.contribution) - exact).powi(2)
    };
    let squares: Vec<f64> = (0..study.trials.saturating_mul(16)).into_par_iter().map(trial).collect();
    squares.into_iter().collect()
}

/// With uniform candidates, `E[F^2] = I(f^2) / M + (1 - 1 / M) I(t) I(f^2 / t)`, I being the integral over the square and
/// t the target: of the sum of weights and the kept one's, either they are the same candidate's or two independent ones.
fn theory(target: Target, m: u32) -> f64 {
    const SIDE: u32 = 400;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let points = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [at(x), at(y)]));
    let (mut squares, mut targets, mut quotients) = (0.0, 0.0, 0.0);
    for x in points {
        let (f, t) = (F.evaluate(&x), target.at(&x));
        squares += f * f;
        targets += t;
        quotients += f * f / t;
    }
    let cells = f64::from(SIDE * SIDE);
    let (squares, targets, quotients) = (squares / cells, targets / cells, quotients / cells);
    let same = 1.0 / f64::from(m);
    squares * same + (1.0 - same) * targets * quotients - F.exact().powi(2)
}
