//! Mean and variance of a stream.

/// Running mean and sum of squared deviations of numbers [Welford 1962], which does not cancel as sums of squares do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    deviations: f64,
}

impl Moments {
    /// Adds a number.
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.deviations += before * (value - self.mean);
    }

    /// Adds what another has seen [Chan, Golub and LeVeque 1979, eq. 2.1].
    pub fn merge(&mut self, other: &Moments) {
        if other.count == 0 {
            return;
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let apart = other.mean - self.mean;
        self.count += other.count;
        self.mean += apart * m / (n + m);
        self.deviations += other.deviations + apart * apart * n * m / (n + m);
    }

    /// How many numbers.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; 0 without any.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased estimate of the variance that one number has; infinite with fewer than two.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::INFINITY } else { self.deviations / (self.count - 1) as f64 }
    }

    /// Standard error of the mean; infinite with fewer than two numbers.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count.max(1) as f64).sqrt()
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Moments {
        let mut moments = Moments::default();
        values.into_iter().for_each(|v| moments.push(v));
        moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn known_values_far_from_zero() {
        let moments: Moments = [4.0, 7.0, 13.0, 16.0].into_iter().map(|v| v + 1e9).collect();
        assert_eq!((moments.count(), moments.mean(), moments.variance()), (4, 1e9 + 10.0, 30.0));
        assert_eq!(moments.standard_error(), 7.5_f64.sqrt());
    }

    #[test]
    fn too_few_numbers_say_nothing_of_the_error() {
        assert_eq!((Moments::default().mean(), Moments::default().standard_error()), (0.0, f64::INFINITY));
        let one: Moments = [3.0].into_iter().collect();
        assert_eq!((one.mean(), one.variance(), one.standard_error()), (3.0, f64::INFINITY, f64::INFINITY));
    }

    proptest! {
        #[test]
        fn merging_is_like_one_stream(a in prop::collection::vec(-1e3..1e3_f64, 0..50), b in prop::collection::vec(-1e3..1e3_f64, 0..50)) {
            let all: Moments = a.iter().chain(&b).copied().collect();
            let mut merged: Moments = a.iter().copied().collect();
            merged.merge(&b.iter().copied().collect());
            prop_assert_eq!(merged.count(), all.count());
            prop_assert!((merged.mean() - all.mean()).abs() <= 1e-11);
            if all.count() >= 2 {
                prop_assert!((merged.variance() - all.variance()).abs() <= 1e-10 * (1.0 + all.variance()));
            }
        }
    }
}
