//! Slopes of errors over cost.

use super::special::student_t_quantile;

/// A power law `y = factor x^slope`, fitted to points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// The exponent.
    pub slope: f64,
    /// Half the width of the exponent's confidence interval; infinite for two points.
    pub half_width: f64,
    /// The factor's natural logarithm.
    pub ln_factor: f64,
}

/// Fits a straight line to the logarithms of `points`, `(x, y)`, by least squares, with an interval that holds the true
/// slope with probability `confidence` if the logarithms of `y` scatter independently, normally and alike.
///
/// Points that are not positive and finite have no logarithm, and are left out. `None` if fewer than two different `x`
/// are left.
pub fn fit(points: &[(f64, f64)], confidence: f64) -> Option<Slope> {
    let usable = |v: f64| v.is_finite() && v > 0.0;
    let logs: Vec<(f64, f64)> =
        points.iter().filter(|(x, y)| usable(*x) && usable(*y)).map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / n;
    if !logs.iter().any(|p| p.0 != logs[0].0) {
        return None;
    }
    let xx: f64 = logs.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    let xy: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let slope = xy / xx;
    let ln_factor = mean_y - slope * mean_x;
    let half_width = if logs.len() == 2 {
        f64::INFINITY
    } else {
        let residual: f64 = logs.iter().map(|p| (p.1 - ln_factor - slope * p.0).powi(2)).sum();
        let standard_error = (residual / (n - 2.0) / xx).sqrt();
        student_t_quantile(0.5 + 0.5 * confidence, n - 2.0) * standard_error
    };
    Some(Slope { slope, half_width, ln_factor })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        independent::Independent,
        sampler::{Purpose, Sampler},
    };

    #[test]
    fn an_exact_power_law() {
        let points: Vec<(f64, f64)> = (0..8).map(|i| 2.0_f64.powi(i)).map(|x| (x, 3.0 * x.powf(-1.5))).collect();
        let fit = fit(&points, 0.95).unwrap();
        assert!((fit.slope + 1.5).abs() < 1e-14 && (fit.ln_factor - 3.0_f64.ln()).abs() < 1e-14);
        assert!(fit.half_width < 1e-13);
    }

    #[test]
    fn too_few_points() {
        assert_eq!(fit(&[], 0.95), None);
        assert_eq!(fit(&[(1.0, 1.0)], 0.95), None);
        assert_eq!(fit(&[(1.0, 1.0), (1.0, 2.0)], 0.95), None);
        assert_eq!(fit(&[(1.0, 1.0), (2.0, 0.0), (0.0, 1.0), (3.0, f64::NAN)], 0.95), None);
        let two = fit(&[(1.0, 4.0), (4.0, 1.0)], 0.95).unwrap();
        assert!((two.slope + 1.0).abs() < 1e-15 && two.half_width.is_infinite());
    }

    #[test]
    fn the_interval_holds_the_slope_as_often_as_it_says() {
        let mut sampler = Independent::new(4);
        let runs = 4000;
        let held = (0..runs)
            .filter(|&index| {
                sampler.start_sample(index, 0);
                let mut normal = |i: u32| -> f64 {
                    (0..12).map(|j| f64::from(sampler.get_1d(12 * i + j, Purpose::Lobe)) - 0.5).sum()
                };
                let points: Vec<(f64, f64)> = (0..6)
                    .map(|i| (2.0_f64.powi(i), (-f64::from(i) * 2.0_f64.ln() + 0.2 * normal(i as u32)).exp()))
                    .collect();
                let fit = fit(&points, 0.9).unwrap();
                (fit.slope + 1.0).abs() <= fit.half_width
            })
            .count();
        let z = (held as f64 - 0.9 * f64::from(runs)) / (0.09 * f64::from(runs)).sqrt();
        assert!(z.abs() < 4.0, "{held} of {runs}");
    }
}
