//! Piecewise constant distributions over a grid.

use crate::warp::ONE_MINUS_EPSILON;
use glam::Vec2;

/// A distribution over the cells of a grid, sampled by inversion: first the row, then the column, both in order, so
/// that well-spread numbers give well-spread cells.
#[derive(Clone, Debug)]
pub struct Piecewise2d {
    width: usize,
    /// Upper end of each row's share.
    rows: Vec<f32>,
    /// Upper end of each cell's share in its row, row by row.
    columns: Vec<f32>,
}

/// A sampled cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellSample {
    /// Column.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// Two numbers in `[0, 1)` that are independent of the cell.
    pub within: Vec2,
    /// Probability of the cell.
    pub pmf: f32,
}

impl Piecewise2d {
    /// A distribution from the cells' weights, row by row, in any scale. `None` if the size does not fit, if all
    /// weights are zero, or if one is negative or not finite.
    pub fn new(width: usize, height: usize, weights: &[f64]) -> Option<Piecewise2d> {
        let max = weights.iter().copied().fold(0.0, f64::max);
        let valid = weights.iter().all(|w| w.is_finite() && *w >= 0.0);
        if width.checked_mul(height) != Some(weights.len()) || !valid || max == 0.0 {
            return None;
        }
        let mut columns = vec![0.0; weights.len()];
        let sums: Vec<f64> = weights
            .chunks(width)
            .zip(columns.chunks_mut(width))
            .map(|(row, ends)| accumulate(row, max, ends))
            .collect();
        let mut rows = vec![0.0; height];
        accumulate(&sums, 1.0, &mut rows);
        Some(Piecewise2d { width, rows, columns })
    }

    /// Samples a cell by two numbers in `[0, 1)`.
    #[inline]
    pub fn sample(&self, u: Vec2) -> CellSample {
        let (y, v, row) = invert(&self.rows, u.y);
        let (x, u, column) = invert(&self.columns[y * self.width..][..self.width], u.x);
        CellSample { x, y, within: Vec2::new(u, v), pmf: row * column }
    }

    /// Probability of a cell.
    #[inline]
    pub fn pmf(&self, x: usize, y: usize) -> f32 {
        share(&self.rows, y) * share(&self.columns[y * self.width..][..self.width], x)
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> u64 {
        ((self.rows.capacity() + self.columns.capacity()) * size_of::<f32>()) as u64
    }
}

/// Writes the upper end of each weight's share and returns the sum of the weights over `scale`.
fn accumulate(weights: &[f64], scale: f64, ends: &mut [f32]) -> f64 {
    let sum: f64 = weights.iter().map(|w| w / scale).sum();
    let mut running = 0.0;
    for (end, w) in ends.iter_mut().zip(weights) {
        running += w / scale;
        *end = if sum > 0.0 { ((running / sum) as f32).min(1.0) } else { 1.0 };
    }
    // The last weight that is not zero ends at 1 exactly, whatever rounding made of the sum.
    if let Some(last) = weights.iter().rposition(|w| *w > 0.0) {
        ends[last..].fill(1.0);
    }
    sum
}

#[inline]
fn lower_end(ends: &[f32], i: usize) -> f32 {
    if i == 0 { 0.0 } else { ends[i - 1] }
}

#[inline]
fn share(ends: &[f32], i: usize) -> f32 {
    ends[i] - lower_end(ends, i)
}

/// The index whose share holds `u`, where `u` lies in it, and the share.
#[inline]
fn invert(ends: &[f32], u: f32) -> (usize, f32, f32) {
    let i = ends.partition_point(|end| *end <= u).min(ends.len() - 1);
    let (low, share) = (lower_end(ends, i), share(ends, i));
    (i, ((u - low) / share).clamp(0.0, ONE_MINUS_EPSILON), share)
}
