//! Alias tables: a choice among n in constant time.

use crate::warp::ONE_MINUS_EPSILON;

/// A discrete distribution that is sampled in constant time [Walker 1977; Vose 1991].
#[derive(Clone, Debug)]
pub struct AliasTable {
    bins: Vec<Bin>,
    pmf: Vec<f32>,
}

#[derive(Clone, Copy, Debug)]
struct Bin {
    threshold: f32,
    alias: u32,
}

impl AliasTable {
    /// A table from weights in any scale, built in linear time. `None` if there is no weight, if they are all zero, or
    /// if one is negative or not finite.
    pub fn new(weights: &[f64]) -> Option<AliasTable> {
        let n = weights.len();
        let heaviest = (0..n).max_by(|&i, &j| weights[i].total_cmp(&weights[j]))?;
        let max = weights[heaviest];
        if weights.iter().any(|w| !(w.is_finite() && *w >= 0.0)) || max == 0.0 || u32::try_from(n).is_err() {
            return None;
        }
        // Scaled by the largest first, so that the sum cannot overflow.
        let sum: f64 = weights.iter().map(|w| w / max).sum();
        let pmf: Vec<f32> = weights.iter().map(|w| (w / max / sum) as f32).collect();
        let mut scaled: Vec<f64> = weights.iter().map(|w| w / max / sum * n as f64).collect();
        let mut bins = vec![Bin { threshold: 1.0, alias: heaviest as u32 }; n];
        let (mut small, mut large): (Vec<u32>, Vec<u32>) = (0..n as u32).partition(|&i| scaled[i as usize] < 1.0);
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            let rest = scaled[s as usize];
            bins[s as usize] = Bin { threshold: rest as f32, alias: l };
            scaled[l as usize] -= 1.0 - rest;
            if scaled[l as usize] < 1.0 {
                large.pop();
                small.push(l);
            }
        }
        // What rounding left over is 1 up to rounding, except that a weight of zero must never be chosen.
        for &i in small.iter().filter(|&&i| weights[i as usize] == 0.0) {
            bins[i as usize].threshold = 0.0;
        }
        Some(AliasTable { bins, pmf })
    }

    /// Chooses by one number in `[0, 1)`: the index, its probability, and a number in `[0, 1)` that is independent of
    /// the index.
    ///
    /// A 24-bit `u` has few bits left to tell an entry from its alias when there are very many entries; then use
    /// [`AliasTable::choose`].
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        let (i, remapped) = self.pick(f64::from(u));
        (i, self.pmf[i], (remapped as f32).min(ONE_MINUS_EPSILON))
    }

    /// Chooses by one number in `[0, 1)` with more bits than an `f32` has.
    #[inline]
    pub fn choose(&self, u: f64) -> usize {
        self.pick(u).0
    }

    #[inline]
    fn pick(&self, u: f64) -> (usize, f64) {
        let x = u * self.bins.len() as f64;
        let i = (x as usize).min(self.bins.len() - 1);
        let (rest, Bin { threshold, alias }) = (x - i as f64, self.bins[i]);
        let threshold = f64::from(threshold);
        if rest < threshold { (i, rest / threshold) } else { (alias as usize, (rest - threshold) / (1.0 - threshold)) }
    }

    /// Probability of an index.
    #[inline]
    pub fn pmf(&self, i: usize) -> f32 {
        self.pmf[i]
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.bins.len()
    }

    /// Whether there are none: never.
    pub fn is_empty(&self) -> bool {
        self.bins.is_empty()
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> u64 {
        (self.bins.capacity() * size_of::<Bin>() + self.pmf.capacity() * size_of::<f32>()) as u64
    }
}
