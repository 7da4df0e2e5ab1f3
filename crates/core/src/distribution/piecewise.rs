//! Piecewise constant densities on the unit interval and square.

use super::probabilities;
use glam::Vec2;

/// A density on `[0, 1)` that is constant on each of equal cells, sampled by inversion.
///
/// ```
/// use etendue_core::distribution::Piecewise1d;
/// let density = Piecewise1d::new(&[1.0, 0.0, 3.0, 0.0]).unwrap();
/// assert_eq!(density.sample(0.625), (0.625, 3.0));
/// assert_eq!(density.pdf(0.3), 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise1d {
    /// Probability below each cell, and 1.
    cdf: Vec<f64>,
    /// Where to start looking for a quantile, see [`push_guide`].
    guide: Vec<u32>,
}

/// A density on the unit square that is constant on each of equal cells, sampled by inversion: first the row (`y`), then
/// the column in it (`x`).
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise2d {
    columns: usize,
    rows: Piecewise1d,
    /// For each row, `columns + 1` numbers as in [`Piecewise1d`]; all zero in a row without probability.
    cdfs: Vec<f64>,
    /// For each row, `columns` numbers as in [`Piecewise1d`].
    guides: Vec<u32>,
    /// The density in each cell, row by row.
    pdf: Vec<f32>,
}

/// Most cells along an axis: more, and an `f32` could not tell neighbours apart.
const CELLS_LIMIT: usize = 1 << 22;

impl Piecewise1d {
    /// The density proportional to `weights`, one for each cell. `None` if there are none or over `2^22`, one is
    /// negative or not finite, or all are zero. A cell whose probability is below `f32::MIN_POSITIVE` is taken as zero.
    pub fn new(weights: &[f64]) -> Option<Piecewise1d> {
        if weights.len() > CELLS_LIMIT {
            return None;
        }
        let mut cdf = Vec::with_capacity(weights.len() + 1);
        push_cdf(&probabilities(weights.iter().copied())?, &mut cdf);
        let mut guide = Vec::with_capacity(weights.len());
        push_guide(&cdf, &mut guide);
        Some(Piecewise1d { cdf, guide })
    }

    /// A place distributed as the density, and the density there, for `u` in `[0, 1)`. The place is in `[0, 1)` and in a
    /// cell of positive density.
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, f32) {
        let (cell, x) = invert(&self.cdf, &self.guide, u);
        (x, self.density(cell))
    }

    /// The density at a place in `[0, 1)`; elsewhere it is 0.
    #[inline]
    pub fn pdf(&self, x: f32) -> f32 {
        if (0.0..1.0).contains(&x) { self.density(cell_of(x, self.cells())) } else { 0.0 }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.cdf.len() - 1
    }

    #[inline]
    fn density(&self, cell: usize) -> f32 {
        ((self.cdf[cell + 1] - self.cdf[cell]) * self.cells() as f64) as f32
    }
}

impl Piecewise2d {
    /// The density proportional to `weights`, given row by row, `columns` in each. `None` if `columns` does not divide
    /// their number, either side has none or over `2^22` cells, a weight is negative or not finite, or all are zero. A
    /// cell whose probability is below `f32::MIN_POSITIVE` is taken as zero.
    pub fn new(weights: &[f64], columns: usize) -> Option<Piecewise2d> {
        if columns == 0 || columns > CELLS_LIMIT || !weights.len().is_multiple_of(columns) {
            return None;
        }
        let probabilities = probabilities(weights.iter().copied())?;
        let row_sums: Vec<f64> = probabilities.chunks(columns).map(|row| row.iter().sum()).collect();
        let rows = Piecewise1d::new(&row_sums)?;
        let mut cdfs = Vec::with_capacity((columns + 1) * row_sums.len());
        let mut guides = Vec::with_capacity(weights.len());
        let mut pdf = Vec::with_capacity(weights.len());
        for (row, &sum) in probabilities.chunks(columns).zip(&row_sums) {
            let conditional: Vec<f64> = row.iter().map(|&p| if p > 0.0 { p / sum } else { 0.0 }).collect();
            let first = cdfs.len();
            push_cdf(&conditional, &mut cdfs);
            push_guide(&cdfs[first..], &mut guides);
            pdf.extend(row.iter().map(|&p| (p * weights.len() as f64) as f32));
        }
        Some(Piecewise2d { columns, rows, cdfs, guides, pdf })
    }

    /// A place distributed as the density, and the density there, for `u` in `[0, 1)^2`. The place is in `[0, 1)^2` and
    /// in a cell of positive density.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (row, y) = invert(&self.rows.cdf, &self.rows.guide, u.y);
        let (cdf, guide) = self.row(row);
        let (column, x) = invert(cdf, guide, u.x);
        (Vec2::new(x, y), self.pdf[row * self.columns + column])
    }

    /// The cell that [`Piecewise2d::sample`] finds its place in: column, row, and where in the cell, in `[0, 1)^2` and
    /// with all the precision that is left of `u`.
    #[inline]
    pub fn sample_cell(&self, u: Vec2) -> (usize, usize, Vec2) {
        let (row, y) = invert_in_cell(&self.rows.cdf, &self.rows.guide, u.y);
        let (cdf, guide) = self.row(row);
        let (column, x) = invert_in_cell(cdf, guide, u.x);
        let within = Vec2::new(x as f32, y as f32);
        (column, row, within.min(Vec2::splat(1.0_f32.next_down())))
    }

    /// The density at a place in `[0, 1)^2`; elsewhere it is 0.
    #[inline]
    pub fn pdf(&self, p: Vec2) -> f32 {
        if !((0.0..1.0).contains(&p.x) && (0.0..1.0).contains(&p.y)) {
            return 0.0;
        }
        self.pdf[cell_of(p.y, self.rows.cells()) * self.columns + cell_of(p.x, self.columns)]
    }

    /// The running sums of a row and their guide.
    #[inline]
    fn row(&self, row: usize) -> (&[f64], &[u32]) {
        let n = self.columns;
        (&self.cdfs[row * (n + 1)..][..n + 1], &self.guides[row * n..][..n])
    }

    /// Number of columns and rows.
    pub fn cells(&self) -> (usize, usize) {
        (self.columns, self.rows.cells())
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> u64 {
        let doubles = self.cdfs.capacity() + self.rows.cdf.capacity();
        let guides = self.guides.capacity() + self.rows.guide.capacity();
        (doubles * size_of::<f64>() + guides * size_of::<u32>() + self.pdf.capacity() * size_of::<f32>()) as u64
    }
}

/// Appends the running sums of `probabilities`, from 0 to exactly 1 (or to 0, when all are); a cell of zero probability
/// gets equal sums at both ends.
fn push_cdf(probabilities: &[f64], cdf: &mut Vec<f64>) {
    let first = cdf.len();
    let mut sum = 0.0;
    cdf.push(sum);
    for &p in probabilities {
        sum += p;
        cdf.push(sum);
    }
    if sum > 0.0 {
        cdf[first..].iter_mut().for_each(|c| *c /= sum);
    }
}

/// Appends, for each of as many equal parts of the unit interval as there are cells, the cell that its lower end falls in:
/// a search that starts there takes less than two steps on average, whatever the distribution [Chen and Asau 1974].
fn push_guide(cdf: &[f64], guide: &mut Vec<u32>) {
    let cells = cdf.len() - 1;
    let mut cell = 0;
    for part in 0..cells {
        let u = part as f64 / cells as f64;
        while cell + 1 < cells && cdf[cell + 1] <= u {
            cell += 1;
        }
        guide.push(cell as u32);
    }
}

/// The cell of positive probability that holds the quantile `u`, and the quantile's place in the cell, in `[0, 1)`.
#[inline]
fn invert_in_cell(cdf: &[f64], guide: &[u32], u: f32) -> (usize, f64) {
    let mut cell = guide[cell_of(u, guide.len())] as usize;
    let u = f64::from(u);
    // cdf[cell] <= u < cdf[cell + 1], as u is less than 1, which is the last entry. The guide may be one rounding ahead.
    while cdf[cell] > u {
        cell -= 1;
    }
    while cdf[cell + 1] <= u {
        cell += 1;
    }
    (cell, (u - cdf[cell]) / (cdf[cell + 1] - cdf[cell]))
}

/// The cell of positive probability that holds the quantile `u`, and the quantile's place in `[0, 1)`.
#[inline]
fn invert(cdf: &[f64], guide: &[u32], u: f32) -> (usize, f32) {
    let cells = guide.len();
    let (cell, part) = invert_in_cell(cdf, guide, u);
    let mut x = ((cell as f64 + part) / cells as f64) as f32;
    // Rounding may lead to a neighbour, which may have density 0.
    while cell_of(x, cells) > cell {
        x = x.next_down();
    }
    while cell_of(x, cells) < cell {
        x = x.next_up();
    }
    (cell, x)
}

/// The cell that holds a place in `[0, 1)`.
#[inline]
fn cell_of(x: f32, cells: usize) -> usize {
    // Exact: a product of 24 and 22 bits. Below `cells` for any x below 1.
    (f64::from(x) * cells as f64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        independent::Independent,
        sampler::{Purpose, Sampler},
        statistics::chi_square,
    };
    use proptest::prelude::*;

    const SAMPLES: u32 = 400_000;

    fn numbers() -> impl Iterator<Item = Vec2> {
        let mut sampler = Independent::new(5);
        (0..SAMPLES).map(move |index| {
            sampler.start_sample(index, 0);
            sampler.get_2d(0, Purpose::LightPoint)
        })
    }

    #[test]
    fn places_on_the_interval_are_distributed_as_the_density() {
        let weights = [0.0, 1.0, 5.0, 0.0, 0.0, 0.02, 2.0];
        let density = Piecewise1d::new(&weights).unwrap();
        // Four bins a cell: within a cell the density is constant.
        let mut counts = vec![0; 28];
        for u in numbers() {
            let (x, pdf) = density.sample(u.x);
            assert_eq!(pdf, density.pdf(x));
            counts[(x * 28.0) as usize] += 1;
        }
        let expected: Vec<f64> = (0..28).map(|b| weights[b / 4] / 8.02 / 4.0 * f64::from(SAMPLES)).collect();
        let test = chi_square::test(&counts, &expected, 5.0);
        assert!(test.p_value > 1e-4, "{test:?}");
    }

    #[test]
    fn places_on_the_square_are_distributed_as_the_density() {
        let weights = [0.0, 1.0, 5.0, 0.0, 0.0, 0.0, 0.02, 2.0, 0.0, 0.7, 0.0, 3.0];
        let density = Piecewise2d::new(&weights, 3).unwrap();
        assert_eq!(density.cells(), (3, 4));
        let mut counts = vec![0; 12 * 4];
        for u in numbers() {
            let (p, pdf) = density.sample(u);
            assert_eq!(pdf, density.pdf(p));
            counts[(p.y * 8.0) as usize * 6 + (p.x * 6.0) as usize] += 1;
        }
        let expected: Vec<f64> =
            (0..48).map(|b| weights[b / 12 * 3 + b % 6 / 2] / 11.72 / 4.0 * f64::from(SAMPLES)).collect();
        let test = chi_square::test(&counts, &expected, 5.0);
        assert!(test.p_value > 1e-4, "{test:?}");
    }

    #[test]
    fn invalid_weights_make_no_density() {
        for weights in [&[][..], &[0.0, 0.0], &[1.0, -1.0], &[f64::NAN, 1.0], &[f64::INFINITY]] {
            assert_eq!(Piecewise1d::new(weights), None, "{weights:?}");
            assert_eq!(Piecewise2d::new(weights, 1), None, "{weights:?}");
        }
        for columns in [0, 2, 4] {
            assert_eq!(Piecewise2d::new(&[1.0; 3], columns), None);
        }
    }

    #[test]
    fn one_texel_a_million_times_the_others() {
        let mut weights = vec![1e-6; 512 * 256];
        weights[100 * 512 + 300] = 1.0;
        let density = Piecewise2d::new(&weights, 512).unwrap();
        let total: f64 = weights.iter().sum();
        let at = |x: f32, y: f32| f64::from(density.pdf(Vec2::new(x / 512.0, y / 256.0)));
        for (place, weight) in [(at(300.5, 100.5), 1.0), (at(301.5, 100.5), 1e-6), (at(0.0, 255.9), 1e-6)] {
            let pdf = weight / total * f64::from(512 * 256);
            assert!((place - pdf).abs() <= 1e-6 * pdf, "{place} {pdf}");
        }
    }

    fn weights() -> impl Strategy<Value = Vec<f64>> {
        let weight = prop_oneof![4 => Just(0.0), 6 => 0.0..1.0_f64, 1 => 1e-30..1e30_f64, 1 => Just(5e-324), 1 => Just(f64::MAX)];
        prop::collection::vec(weight, 1..300).prop_filter("all are zero", |w| w.iter().any(|&w| w > 0.0))
    }

    fn u() -> impl Strategy<Value = f32> {
        prop_oneof![Just(0.0), Just(1.0_f32.next_down()), Just(f32::MIN_POSITIVE), 0.0..1.0_f32]
    }

    proptest! {
        #[test]
        fn a_sampled_place_has_the_stated_positive_density(weights in weights(), u in (u(), u())) {
            let density = Piecewise1d::new(&weights).unwrap();
            let (x, pdf) = density.sample(u.0);
            prop_assert!((0.0..1.0).contains(&x));
            prop_assert!(pdf > 0.0 && (1.0 / pdf).is_finite());
            prop_assert_eq!(pdf, density.pdf(x));
            for columns in (1..=weights.len()).filter(|&c| weights.len().is_multiple_of(c)) {
                let density = Piecewise2d::new(&weights, columns).unwrap();
                let (p, pdf) = density.sample(u.into());
                prop_assert!((0.0..1.0).contains(&p.x) && (0.0..1.0).contains(&p.y));
                prop_assert!(pdf > 0.0 && (1.0 / pdf).is_finite());
                prop_assert_eq!(pdf, density.pdf(p));
            }
        }

        #[test]
        fn the_density_integrates_to_1(weights in prop::collection::vec(0.0..1.0_f64, 1..200)) {
            prop_assume!(weights.iter().any(|&w| w > 0.0));
            let n = weights.len();
            let density = Piecewise1d::new(&weights).unwrap();
            let mean = (0..n).map(|i| f64::from(density.pdf((i as f32 + 0.5) / n as f32))).sum::<f64>() / n as f64;
            prop_assert!((mean - 1.0).abs() < 1e-6);
            prop_assert_eq!(density.pdf(1.0), 0.0);
            prop_assert_eq!(density.pdf(-f32::MIN_POSITIVE), 0.0);
        }
    }
}
