//! Stratified sampling: estimates over strata, and how many samples each should have.
//!
//! A domain is cut into strata of measure `m_i`. With `N_i` independent samples in each, of mean `F_i` and sample variance
//! `V_i`, the integral and the variance of its estimate are
//!
//! ```text
//! F = sum m_i F_i          V = sum m_i^2 V_i / N_i          [Cochran 1977, ch. 5]
//! ```
//!
//! Where `N_i` is proportional to `m_i` and the measures add up to 1, these are `F = sum N_i F_i / N` and
//! `V = sum N_i V_i / N^2`: never worse than `N` independent samples, whose variance has the scatter of the `F_i` on top.
//! The least variance for `N` samples has `N_i` proportional to `m_i sqrt(V_i)` [Neyman 1934], which a pilot can find out.
//!
//! ```
//! use etendue_core::statistics::moments::Moments;
//! use etendue_sampling::strata::{Stratum, estimate, proportional, optimal};
//! let pilot = [(0.75, [1.0, 1.1, 0.9, 1.0]), (0.25, [2.0, 9.0, 4.0, 5.0])]
//!     .map(|(measure, values)| Stratum { measure, samples: values.into_iter().collect::<Moments>() });
//! assert_eq!(estimate(&pilot).unwrap().mean, 0.75 * 1.0 + 0.25 * 5.0);
//! assert_eq!(proportional(&[0.75, 0.25], 100), Some(vec![75, 25]));
//! assert_eq!(optimal(&pilot, 100), Some(vec![8, 92]));
//! ```
//!
//! Source: Neyman, "On the Two Different Aspects of the Representative Method" (1934); Cochran, "Sampling Techniques"
//! (1977), ch. 5.

use etendue_core::statistics::moments::Moments;

/// A part of the domain and what was sampled in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stratum {
    /// Its measure `m_i`, not negative.
    pub measure: f64,
    /// The integrand at its samples: `N_i`, `F_i` and `V_i`.
    pub samples: Moments,
}

/// An estimate of an integral.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The integral `F`.
    pub mean: f64,
    /// Unbiased estimate of its variance; infinite if some stratum has one sample alone.
    pub variance: f64,
}

/// The integral over all strata. `None` if one of positive measure has no sample: nothing is known of it.
pub fn estimate(strata: &[Stratum]) -> Option<Estimate> {
    let mut sum = Estimate { mean: 0.0, variance: 0.0 };
    for Stratum { measure, samples } in strata.iter().filter(|s| s.measure > 0.0) {
        if samples.count() == 0 {
            return None;
        }
        sum.mean += measure * samples.mean();
        sum.variance += measure * measure * samples.variance() / samples.count() as f64;
    }
    Some(sum)
}

/// `total` samples in proportion to the measures; see [`apportion`].
pub fn proportional(measures: &[f64], total: u32) -> Option<Vec<u32>> {
    apportion(measures, measures, total)
}

/// `total` samples in proportion to measure times standard deviation, as a pilot found it [Neyman 1934]; in proportion to
/// the measures if the pilot saw no variance at all. `None` also if a stratum of positive measure has fewer than two
/// samples. See [`apportion`].
///
/// A stratum in which the pilot saw no variance still gets a sample, so that its mean is estimated.
pub fn optimal(pilot: &[Stratum], total: u32) -> Option<Vec<u32>> {
    let measures: Vec<f64> = pilot.iter().map(|s| s.measure).collect();
    let spread = |s: &Stratum| if s.measure > 0.0 { s.measure * s.samples.variance().sqrt() } else { 0.0 };
    let spreads: Vec<f64> = pilot.iter().map(spread).collect();
    apportion(&measures, if spreads.iter().all(|s| *s == 0.0) { &measures } else { &spreads }, total)
}

/// `total` samples over strata in proportion to `weights`, in whole numbers that add up to `total`: by the largest
/// remainders, where every stratum of positive measure has at least one. If there are not enough for that, those of the
/// largest weight have one each; of equals, the first.
///
/// A stratum of measure 0 has none, so that the numbers add up to 0 if there is no other. `None` if lengths differ or a
/// measure or weight is negative or not finite.
pub fn apportion(measures: &[f64], weights: &[f64], total: u32) -> Option<Vec<u32>> {
    let valid = |v: &f64| v.is_finite() && *v >= 0.0;
    if measures.len() != weights.len() || !measures.iter().chain(weights).all(valid) {
        return None;
    }
    let mut order: Vec<usize> = (0..measures.len()).filter(|&i| measures[i] > 0.0).collect();
    order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]));
    let mut counts = vec![0; measures.len()];
    let total = total as usize;
    if total <= order.len() {
        order[..total].iter().for_each(|&i| counts[i] = 1);
        return Some(counts);
    }
    let Some(&largest) = order.first() else { return Some(counts) };
    // Relative to the largest, so that no sum overflows; all alike if all are 0.
    let scale = weights[largest];
    let relative = |i: usize| if scale > 0.0 { weights[i] / scale } else { 1.0 };

    // The strata whose share is less than one sample have one; the rest is shared by the others.
    let mut sums = Vec::with_capacity(order.len());
    let mut sum = 0.0;
    for &i in &order {
        sum += relative(i);
        sums.push(sum);
    }
    let shared = |others: usize| (total - (order.len() - others)) as f64 / sums[others - 1];
    let others = (1..=order.len()).rev().find(|&k| relative(order[k - 1]) * shared(k) >= 1.0).unwrap_or(1);
    let per_weight = shared(others);
    order[others..].iter().for_each(|&i| counts[i] = 1);

    let mut remainders: Vec<(f64, usize)> = Vec::with_capacity(others);
    let mut left = total - (order.len() - others);
    for &i in &order[..others] {
        let share = relative(i) * per_weight;
        let whole = (share as usize).min(left);
        counts[i] = whole as u32;
        left -= whole;
        remainders.push((share - whole as f64, i));
    }
    remainders.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    // There are fewer left than strata: each was cut by less than one.
    remainders.iter().take(left).for_each(|&(_, i)| counts[i] += 1);
    Some(counts)
}
