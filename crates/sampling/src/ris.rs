//! Resampled importance sampling: one sample of a hard density out of many candidates of easy ones.
//!
//! Candidates `x_1 .. x_M` come from distributions that can be sampled. One of them, `X`, is kept with probability
//! proportional to its resampling weight
//!
//! ```text
//! w_i = m_i(x_i) p^(x_i) W_i                    [Lin et al. 2022, sec. 4]
//! ```
//!
//! where `p^` is the target, any function that is not negative; `W_i` is the candidate's contribution weight, `1 / p_i(x_i)`
//! for a fresh sample of density `p_i`; and `m_i` is its resampling MIS weight. These sum to 1 over the candidates that
//! could have been any given `x`. For `M` candidates of one distribution they are `1 / M` [Talbot et al. 2005]; for
//! `n_k` candidates from each of several distributions `p_k` the balance heuristic is
//!
//! ```text
//! m_k(x) = p_k(x) / sum_j n_j p_j(x)            [Veach 1997, eq. 9.8]
//! ```
//!
//! so that `m_k W_k = 1 / sum_j n_j p_j(x)` whichever distribution the candidate came from. The sample that is kept has the
//! unbiased contribution weight
//!
//! ```text
//! W = (w_1 + .. + w_M) / p^(X)                  [Bitterli et al. 2020, eq. 6]
//! ```
//!
//! that stands for the reciprocal of the unknown density of `X`: for any `f`, `E[f(X) W]` is the integral of `f` over the
//! places where `p^` is positive and some candidate can be; no sample counts as 0. Candidates need not be independent
//! of each other. With `f = p^` the estimate is the candidates' own Monte Carlo (or multi-sample MIS) estimate, and as
//! `M` grows, `X` tends to the density proportional to `p^`.
//!
//! ```
//! use etendue_core::{independent::Independent, sampler::{Purpose, Sampler}};
//! use etendue_sampling::ris::{Candidate, resample};
//! // Uniform candidates, resampled towards x^2; the integral of x^3 over [0, 1] is 1/4.
//! let mut sampler = Independent::new(1);
//! let (mut sum, trials) = (0.0, 10_000);
//! for trial in 0..trials {
//!     sampler.start_sample(trial, 0);
//!     let candidates = (0..16).map(|k| Candidate::identical(f64::from(sampler.get_1d(k, Purpose::LightPoint)), 1.0, 16));
//!     let candidates: Vec<_> = candidates.collect();
//!     let mut k = 0;
//!     let choice = || { k += 1; sampler.get_1d(k, Purpose::LightChoice) };
//!     if let Some(kept) = resample(candidates, |x| x * x, choice) {
//!         sum += kept.sample.powi(3) * kept.contribution;
//!     }
//! }
//! assert!((sum / f64::from(trials) - 0.25).abs() < 0.01);
//! ```
//!
//! Source: Talbot, Cline and Egbert, "Importance Resampling for Global Illumination" (2005); Bitterli et al.,
//! "Spatiotemporal reservoir resampling for real-time ray tracing with dynamic direct lighting" (2020); Lin et al.,
//! "Generalized Resampled Importance Sampling: Foundations of ReSTIR" (2022).

use etendue_core::reservoir::Reservoir;

/// A sample that may be kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate<T> {
    /// The sample.
    pub sample: T,
    /// Its resampling MIS weight times its contribution weight, `m_i(x_i) W_i`: in units of the domain's measure.
    pub weight: f64,
}

/// A distribution that candidates come from, as seen from one candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// How many of the candidates come from it.
    pub count: u64,
    /// Its density at the candidate; 0 where it never samples.
    pub pdf: f64,
}

impl<T> Candidate<T> {
    /// One of `count` candidates that are all distributed alike, with density `pdf` at this one.
    ///
    /// Where their number is only known in the end, give 1 here and divide the contribution by it then.
    #[inline]
    pub fn identical(sample: T, pdf: f64, count: u64) -> Candidate<T> {
        Candidate { sample, weight: 1.0 / (count as f64 * pdf) }
    }

    /// A candidate from any of several distributions, by the balance heuristic. `sources` holds all of them, those that
    /// cannot have made this candidate too.
    #[inline]
    pub fn balanced(sample: T, sources: &[Source]) -> Candidate<T> {
        Candidate { sample, weight: 1.0 / sources.iter().map(|s| s.count as f64 * s.pdf).sum::<f64>() }
    }
}

/// The candidate that was kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resampled<T> {
    /// The sample.
    pub sample: T,
    /// The target at the sample, positive.
    pub target: f64,
    /// The unbiased contribution weight, positive: it stands for one over the density of `sample`.
    pub contribution: f64,
}

/// Resampling in a stream, in constant memory.
///
/// ```
/// use etendue_sampling::ris::{Candidate, Resampling};
/// let mut resampling = Resampling::default();
/// for (x, u) in [(0.25, 0.5), (0.75, 0.6)] {
///     resampling.update(Candidate::identical(x, 1.0, 2), /* target */ x, u);
/// }
/// let kept = resampling.finish().unwrap(); // 0.6 < 0.75 / (0.25 + 0.75)
/// assert_eq!((kept.sample, kept.target * kept.contribution), (0.75, 0.5));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Resampling<T> {
    reservoir: Reservoir<(T, f64)>,
}

impl<T> Default for Resampling<T> {
    fn default() -> Resampling<T> {
        Resampling { reservoir: Reservoir::default() }
    }
}

impl<T> Resampling<T> {
    /// Streams a candidate with the target's value at it; `u` in `[0, 1)`, independent from candidate to candidate, decides
    /// whether it is kept for now, which is returned.
    ///
    /// A candidate of target 0 counts and is never kept. One whose target or weight is negative or not finite is treated
    /// alike, and counted as rejected; so is a weight too large for the sum.
    #[inline]
    pub fn update(&mut self, candidate: Candidate<T>, target: f64, u: f32) -> bool {
        let weight = resampling_weight(target, candidate.weight);
        self.reservoir.update((candidate.sample, target), weight, u)
    }

    /// Number of candidates: M.
    #[inline]
    pub fn count(&self) -> u64 {
        self.reservoir.count()
    }

    /// Number of candidates that were refused.
    #[inline]
    pub fn rejected(&self) -> u64 {
        self.reservoir.rejected()
    }

    /// The candidate kept in the end; `None` where no candidate had a positive weight, which counts as 0 in an estimate.
    #[inline]
    pub fn finish(self) -> Option<Resampled<T>> {
        let weight_sum = self.reservoir.weight_sum();
        let (sample, target) = self.reservoir.into_sample()?;
        // [Bitterli et al. 2020, eq. 6]
        let contribution = weight_sum / target;
        contribution.is_finite().then_some(Resampled { sample, target, contribution })
    }
}

/// Keeps one of `candidates` in proportion to `target` in one stream. `u` gives a fresh number in `[0, 1)` for
/// each candidate. `None` without a candidate of positive weight: it counts as 0 in an estimate.
///
/// ```
/// use etendue_sampling::ris::{Candidate, Source, resample};
/// // Two techniques, of densities 1 and 2x on [0, 1], with two candidates and one.
/// let balanced = |x: f64| Candidate::balanced(x, &[Source { count: 2, pdf: 1.0 }, Source { count: 1, pdf: 2.0 * x }]);
/// let kept = resample([balanced(0.25), balanced(0.5), balanced(0.75)], |x| *x, || 0.99).unwrap();
/// assert_eq!(kept.sample, 0.25); // the first is always kept at first
/// assert!((kept.target * kept.contribution - (0.25 / 2.5 + 0.5 / 3.0 + 0.75 / 3.5)).abs() < 1e-15);
/// assert!(resample(Vec::<Candidate<f64>>::new(), |x| *x, || 0.5).is_none());
/// ```
pub fn resample<T>(
    candidates: impl IntoIterator<Item = Candidate<T>>,
    target: impl Fn(&T) -> f64,
    mut u: impl FnMut() -> f32,
) -> Option<Resampled<T>> {
    let mut resampling = Resampling::default();
    for candidate in candidates {
        let value = target(&candidate.sample);
        resampling.update(candidate, value, u());
    }
    resampling.finish()
}

/// `w_i`; not a number where it is to be refused.
#[inline]
fn resampling_weight(target: f64, weight: f64) -> f64 {
    match (target >= 0.0 && target.is_finite(), weight >= 0.0 && weight.is_finite()) {
        (true, true) => target * weight,
        _ => f64::NAN,
    }
}
