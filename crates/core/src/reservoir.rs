//! Weighted reservoir sampling.

/// One of a stream of candidates, kept with probability proportional to its weight, in constant memory
/// [Chao 1982; Bitterli et al. 2020, alg. 2].
///
/// Weights are summed in `f64`, so every `f32` weight counts, subnormal ones included, and none overflows the sum.
///
/// ```
/// use etendue_core::reservoir::Reservoir;
/// let mut reservoir = Reservoir::default();
/// for (candidate, weight, u) in [("a", 1.0, 0.3), ("b", 0.0, 0.0), ("c", 3.0, 0.7)] {
///     reservoir.update(candidate, weight, u);
/// }
/// assert_eq!(reservoir.sample(), Some(&"c")); // 0.7 < 3 / (1 + 3)
/// assert_eq!((reservoir.weight_sum(), reservoir.count()), (4.0, 3));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Reservoir<T> {
    sample: Option<T>,
    weight_sum: f64,
    count: u64,
    rejected: u64,
}

impl<T> Default for Reservoir<T> {
    fn default() -> Reservoir<T> {
        Reservoir { sample: None, weight_sum: 0.0, count: 0, rejected: 0 }
    }
}

impl<T> Reservoir<T> {
    /// Streams a candidate; `u` in `[0, 1)` decides whether it replaces the sample, which is returned.
    ///
    /// A candidate of weight 0 is never kept but counts, as an estimator over the candidates must see it. One whose
    /// weight is negative, not finite, or too large for the sum is treated as of weight 0, and counted as rejected.
    #[inline]
    pub fn update(&mut self, candidate: T, weight: f64, u: f32) -> bool {
        self.count = self.count.saturating_add(1);
        let kept = self.accept(weight) && self.replaces(weight, u);
        if kept {
            self.sample = Some(candidate);
        }
        kept
    }

    /// Streams all that another reservoir has seen, as one candidate [Bitterli et al. 2020, alg. 4, for one and the same
    /// target]: the sample is then distributed as if both streams had run through one reservoir.
    pub fn merge(&mut self, other: Reservoir<T>, u: f32) {
        self.count = self.count.saturating_add(other.count);
        self.rejected = self.rejected.saturating_add(other.rejected);
        if self.accept(other.weight_sum) && self.replaces(other.weight_sum, u) {
            self.sample = other.sample;
        }
    }

    /// The candidate kept; none before the first of positive weight.
    #[inline]
    pub fn sample(&self) -> Option<&T> {
        self.sample.as_ref()
    }

    /// [`Reservoir::sample`], taken out.
    #[inline]
    pub fn into_sample(self) -> Option<T> {
        self.sample
    }

    /// Sum of the weights.
    #[inline]
    pub fn weight_sum(&self) -> f64 {
        self.weight_sum
    }

    /// Number of candidates, those of weight 0 and the rejected included: the literature's M.
    #[inline]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Number of candidates whose weight was refused.
    #[inline]
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Adds a weight to the sum; false if it was refused.
    #[inline]
    fn accept(&mut self, weight: f64) -> bool {
        let sum = self.weight_sum + weight;
        let accepted = weight >= 0.0 && sum.is_finite();
        if accepted {
            self.weight_sum = sum;
        } else {
            self.rejected = self.rejected.saturating_add(1);
        }
        accepted
    }

    /// Whether a candidate whose weight is in the sum already replaces the sample.
    #[inline]
    fn replaces(&self, weight: f64, u: f32) -> bool {
        // The first one does for any u: a product with a subnormal sum may round up to the sum.
        weight > 0.0 && (self.sample.is_none() || f64::from(u) * self.weight_sum < weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        independent::Independent,
        sampler::{Purpose, Sampler},
        statistics::chi_square,
    };

    fn assert_distribution(weights: &[f64], mut run: impl FnMut(&mut dyn FnMut() -> f32) -> usize) {
        const RUNS: u32 = 200_000;
        let mut counts = vec![0; weights.len()];
        let mut sampler = Independent::new(1);
        for index in 0..RUNS {
            sampler.start_sample(index, 0);
            let mut vertex = 0;
            counts[run(&mut || {
                vertex += 1;
                sampler.get_1d(vertex, Purpose::LightChoice)
            })] += 1;
        }
        let sum: f64 = weights.iter().sum();
        let expected: Vec<f64> = weights.iter().map(|w| w / sum * f64::from(RUNS)).collect();
        let test = chi_square::test(&counts, &expected, 5.0);
        assert!(test.p_value > 1e-4, "{test:?} {counts:?}");
    }

    #[test]
    fn the_sample_is_distributed_as_the_weights() {
        for weights in [vec![1.0, 2.0, 0.0, 4.0, 0.5], vec![1e-45, 2e-45, 0.0, 3e-45], vec![1e30, 1e30, 5e29, 1e-45]] {
            assert_distribution(&weights, |u| {
                let mut reservoir = Reservoir::default();
                for (i, &w) in weights.iter().enumerate() {
                    reservoir.update(i, w, u());
                }
                *reservoir.sample().unwrap()
            });
        }
    }

    #[test]
    fn merging_is_like_one_stream() {
        let weights = [3.0, 0.0, 1.0, 2.0, 0.25, 4.0, 0.0];
        assert_distribution(&weights, |u| {
            let mut parts = [(); 3].map(|()| Reservoir::default());
            for (i, &w) in weights.iter().enumerate() {
                parts[i % 3].update(i, w, u());
            }
            let [mut all, b, c] = parts;
            all.merge(b, u());
            all.merge(c, u());
            assert_eq!((all.count(), all.weight_sum(), all.rejected()), (7, 10.25, 0));
            *all.sample().unwrap()
        });
    }

    #[test]
    fn weights_that_are_none_are_refused_and_counted() {
        let mut reservoir = Reservoir::default();
        for weight in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
            assert!(!reservoir.update("bad", weight, 0.0));
        }
        assert_eq!((reservoir.sample(), reservoir.weight_sum()), (None, 0.0));
        assert_eq!((reservoir.count(), reservoir.rejected()), (4, 4));
        assert!(reservoir.update("good", f64::MAX, 0.9));
        assert!(!reservoir.update("too much", f64::MAX, 0.0));
        assert_eq!((reservoir.sample(), reservoir.weight_sum()), (Some(&"good"), f64::MAX));
        assert_eq!((reservoir.count(), reservoir.rejected()), (6, 5));
    }

    #[test]
    fn weight_0_counts_and_is_never_kept() {
        let mut reservoir = Reservoir::default();
        for weight in [0.0, -0.0] {
            assert!(!reservoir.update((), weight, 0.0));
        }
        reservoir.merge(reservoir.clone(), 0.0);
        assert_eq!((reservoir.sample(), reservoir.count(), reservoir.rejected()), (None, 4, 0));
        assert!(!{
            reservoir.update((), 1.0, 0.5);
            reservoir.update((), 0.0, 0.0)
        });
    }

    #[test]
    fn the_first_weight_is_kept_for_any_u() {
        for weight in [5e-324, 1e-45, 1e30, f64::MAX] {
            assert!(Reservoir::default().update((), weight, 1.0_f32.next_down()));
        }
    }
}
