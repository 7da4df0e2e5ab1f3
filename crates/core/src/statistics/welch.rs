//! Welch's t-test.

use super::{moments::Moments, special::student_t_two_sided};

/// Outcome of a test of two means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Welch {
    /// Difference of the means in standard errors, positive when the first mean is larger.
    pub t: f64,
    /// Degrees of freedom.
    pub degrees: f64,
    /// Probability of a difference at least this large if the means are equal.
    pub p_value: f64,
}

/// Tests whether two samples, of unequal variances perhaps, have equal means [Welch 1947]. `None` when one has fewer than
/// two numbers. Samples without any scatter have p-value 1 when their means are equal, and 0 otherwise.
pub fn test(a: &Moments, b: &Moments) -> Option<Welch> {
    if a.count() < 2 || b.count() < 2 {
        return None;
    }
    let difference = a.mean() - b.mean();
    let (va, vb) = (a.standard_error().powi(2), b.standard_error().powi(2));
    let variance = va + vb;
    if variance == 0.0 {
        let equal = difference == 0.0;
        let t = if equal { 0.0 } else { f64::INFINITY.copysign(difference) };
        let degrees = (a.count() + b.count() - 2) as f64;
        return Some(Welch { t, degrees, p_value: if equal { 1.0 } else { 0.0 } });
    }
    let t = difference / variance.sqrt();
    // The Welch-Satterthwaite equation [Welch 1947, eq. 28], in shares of the variance: their squares do not underflow.
    let share = |v: f64, m: &Moments| (v / variance).powi(2) / (m.count() - 1) as f64;
    let degrees = 1.0 / (share(va, a) + share(vb, b));
    Some(Welch { t, degrees, p_value: student_t_two_sided(t, degrees) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        independent::Independent,
        sampler::{Purpose, Sampler},
        statistics::chi_square,
    };

    #[test]
    fn known_values() {
        let a: Moments = [27.5, 21.0, 19.0, 23.6, 17.0, 17.9, 16.9, 20.1, 21.9, 22.6, 23.1, 19.6, 19.0, 21.7, 21.4]
            .into_iter()
            .collect();
        let b: Moments = [27.1, 22.0, 20.8, 23.4, 23.4, 23.5, 25.8, 22.0, 24.8, 20.2, 21.9, 22.1, 22.9, 30.5, 24.4]
            .into_iter()
            .collect();
        let test = test(&a, &b).unwrap();
        assert!((test.t - -2.852954870171523).abs() < 1e-11, "{test:?}");
        assert!((test.degrees - 27.88730398842011).abs() < 1e-10, "{test:?}");
        assert!((test.p_value - 0.008071938172194872).abs() < 1e-12, "{test:?}");
    }

    #[test]
    fn without_scatter_or_without_numbers() {
        let constant = |v: f64| [v; 3].into_iter().collect::<Moments>();
        assert_eq!(test(&constant(1.0), &constant(1.0)).unwrap().p_value, 1.0);
        assert_eq!(test(&constant(1.0), &constant(2.0)).unwrap().p_value, 0.0);
        assert_eq!(test(&constant(1.0), &constant(2.0)).unwrap().t, f64::NEG_INFINITY);
        assert_eq!(test(&constant(1.0), &[1.0].into_iter().collect()), None);
    }

    #[test]
    fn p_values_are_uniform_when_the_means_are_equal() {
        let mut sampler = Independent::new(8);
        let mut deciles = [0; 10];
        for index in 0..4000 {
            sampler.start_sample(index, 0);
            // Sums of 12 uniforms are normal enough; the second sample is wider and smaller.
            let mut normal = |vertex: u32, width: f64| {
                (0..12).map(|i| f64::from(sampler.get_1d(12 * vertex + i, Purpose::Lobe)) - 0.5).sum::<f64>() * width
            };
            let a: Moments = (0..20).map(|i| normal(i, 1.0)).collect();
            let b: Moments = (20..28).map(|i| normal(i, 5.0)).collect();
            deciles[((test(&a, &b).unwrap().p_value * 10.0) as usize).min(9)] += 1;
        }
        assert!(chi_square::test(&deciles, &[400.0; 10], 5.0).p_value > 1e-4, "{deciles:?}");
    }
}
