//! Variances of stratified estimates against their formulas.

use super::{Measured, Study};
use crate::error::Error;
use etendue_core::statistics::moments::Moments;
use etendue_sampling::{
    integrands::Integrand,
    pattern::independent,
    strata::{Stratum, estimate, optimal, proportional},
};
use glam::Vec2;
use rayon::prelude::*;
use serde::Serialize;

const INTEGRANDS: [Integrand; 4] = [Integrand::Smooth2, Integrand::Gaussian, Integrand::Edge, Integrand::Disk];
/// Widths of the strata, columns of the square, in sixteenths, so that proportional numbers are whole.
const WIDTHS: [u32; 5] = [1, 3, 4, 6, 2];
/// Samples in all, and in each stratum of the pilot.
const TOTAL: u32 = 64;
const PILOT: u32 = 256;
/// Steps of this part.
pub const STEPS: u32 = INTEGRANDS.len() as u32;

/// An integrand with an allocation.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The integrand.
    pub integrand: &'static str,
    /// How samples are allotted.
    pub allocation: &'static str,
    /// Samples of each stratum.
    pub counts: Vec<u32>,
    /// As measured.
    pub variance: Measured,
    /// `sum m_i^2 V_i / N_i`; without strata `V / N`.
    pub formula: f64,
    /// `sum N_i V_i / N^2` of proportional allocation.
    pub proportional_formula: Option<f64>,
}

pub(super) fn measure(study: &Study) -> Result<Vec<Row>, Error> {
    let mut rows = Vec::new();
    for (index, integrand) in INTEGRANDS.into_iter().enumerate() {
        study.step(&format!("allocation, {}", integrand.name()))?;
        let seed = |kind: u64, trial: u64| study.seed(4 << 48 | kind << 32 | index as u64, trial);
        let measures = WIDTHS.map(|w| f64::from(w) / 16.0);
        let variances = columns(&measures).map(|c| exact_variance(integrand, c)).collect::<Vec<f64>>();
        let whole = exact_variance(integrand, (0.0, 1.0));
        let pilot = sampled(integrand, &measures, &[PILOT; WIDTHS.len()], seed(0, 0));
        let allotted = [proportional(&measures, TOTAL), optimal(&pilot, TOTAL)];
        let names = ["proportional", "variance-optimal"];
        let mut row = |kind: u64, allocation: &'static str, measures: &[f64], counts: Vec<u32>, variances: &[f64]| {
            let error = |trial: u64| {
                let strata = sampled(integrand, measures, &counts, seed(1 + kind, trial));
                let found = estimate(&strata).map_or(0.0, |e| e.mean);
                (found - integrand.exact()).powi(2)
            };
            let trials = 16 * u64::from(study.trials);
            let squares: Vec<f64> = (0..trials).into_par_iter().map(error).collect();
            let terms = || measures.iter().zip(&counts).zip(variances);
            let formula = terms().map(|((m, n), v)| m * m * v / f64::from(*n)).sum();
            let by_counts: f64 = terms().map(|((_, n), v)| f64::from(*n) * v).sum();
            let variance = Measured::of(&squares.into_iter().collect::<Moments>());
            let proportional_formula = (kind == 1).then_some(by_counts / f64::from(TOTAL * TOTAL));
            rows.push(Row { integrand: integrand.name(), allocation, counts, variance, formula, proportional_formula });
        };
        row(0, "independent", &[1.0], vec![TOTAL], &[whole]);
        for (kind, (name, counts)) in names.into_iter().zip(allotted).enumerate() {
            let counts = counts.expect("measures are positive and the pilot has samples in every stratum");
            row(1 + kind as u64, name, &measures, counts, &variances);
        }
    }
    Ok(rows)
}

/// Low end and width of every column.
fn columns(measures: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    measures.iter().scan(0.0, |low, m| {
        let column = (*low, *m);
        *low += m;
        Some(column)
    })
}

fn sampled(integrand: Integrand, measures: &[f64], counts: &[u32], seed: u64) -> Vec<Stratum> {
    let points = independent(counts.iter().sum(), seed);
    let mut rest = points.as_slice();
    let stratum = |((low, width), count): ((f64, f64), &u32)| {
        let (mine, others) = rest.split_at(*count as usize);
        rest = others;
        let value = |p: &Vec2| integrand.evaluate(&[low + width * f64::from(p.x), p.y.into()]);
        Stratum { measure: width, samples: mine.iter().map(value).collect() }
    };
    columns(measures).zip(counts).map(stratum).collect()
}

/// The variance that one sample has in a column, by the midpoint rule.
fn exact_variance(integrand: Integrand, (low, width): (f64, f64)) -> f64 {
    const SIDE: u32 = 1000;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let points = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [low + width * at(x), at(y)]));
    let values: Moments = points.map(|x| integrand.evaluate(&x)).collect();
    values.variance()
}
