//! Sampling of tabulated distributions.

mod alias;
mod piecewise;

pub use alias::{AliasSample, AliasTable};
pub use piecewise::{Piecewise1d, Piecewise2d};

/// Probabilities of weights; `None` unless all are finite and not negative, and one is positive.
///
/// A probability below the normal range of `f32` is taken as 0, so that a picked entry's inverse probability is finite.
fn probabilities(weights: impl Iterator<Item = f64> + Clone) -> Option<Vec<f64>> {
    let mut largest = 0.0_f64;
    for w in weights.clone() {
        if !(w.is_finite() && w >= 0.0) {
            return None;
        }
        largest = largest.max(w);
    }
    if largest == 0.0 {
        return None;
    }
    // Each is divided by the largest first: the sum of the weights themselves might overflow.
    let sum: f64 = weights.clone().map(|w| w / largest).sum();
    let probability = |w: f64| Some(w / largest / sum).filter(|&p| p >= f64::from(f32::MIN_POSITIVE)).unwrap_or(0.0);
    Some(weights.map(probability).collect())
}
