//! Strata of equal area in the unit square, for any number of them.

use crate::{
    lattice::{Parts, between},
    permutation::permute_by,
};
use etendue_core::digest::mix;
use glam::Vec2;

/// Cuts the unit square into `count` rectangles of equal area that are as nearly square as it goes.
///
/// If `count` has a divisor in `[sqrt(count / 2), sqrt(count)]`, that is the number of columns, and the rectangles form
/// a grid; this holds for squares and for powers of two. Otherwise (primes) there are `sqrt(count)` columns, rounded, of
/// which the first have one rectangle more than the others and are as much wider.
///
/// ```
/// use etendue_sampling::layout::Layout;
/// assert_eq!((Layout::new(12).columns(), Layout::new(12).is_grid()), (3, true));
/// assert_eq!((Layout::new(7).columns(), Layout::new(7).is_grid()), (3, false));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    count: u32,
    /// A part for each rectangle.
    all: Parts,
    columns: u32,
    /// A part for each rectangle of a column that has none more than the others.
    rows: Parts,
    /// The number of columns that have one more.
    tall: u32,
    /// A part for each rectangle of those.
    tall_rows: Parts,
}

/// A rectangle of a [`Layout`].
struct Cell {
    column: u32,
    row: u32,
    /// A part for each rectangle of its column.
    rows: Parts,
    /// Rectangles in the columns before.
    before: u32,
}

impl Layout {
    /// The layout of `count` rectangles; none for 0. Those of more than `2^27` may be off by `2^-24`.
    pub fn new(count: u32) -> Layout {
        let root = count.isqrt();
        let divisor = (1..=root)
            .rev()
            .take_while(|d| u64::from(*d).pow(2) * 2 >= count.into())
            .find(|d| count.is_multiple_of(*d));
        // Half above the root rounds up: (root + 1/2)^2 = root^2 + root + 1/4.
        let nearest = || root + u32::from(count - root * root > root);
        let columns = divisor.unwrap_or_else(nearest);
        // No columns are of no rectangles.
        let rows = count.checked_div(columns).unwrap_or(0);
        Layout {
            count,
            all: Parts::new(count),
            columns,
            rows: Parts::new(rows),
            tall: count - columns * rows,
            tall_rows: Parts::new(rows + 1),
        }
    }

    /// The number of rectangles.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The number of columns.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Whether all columns have the same number of rectangles.
    pub fn is_grid(&self) -> bool {
        self.tall == 0
    }

    #[inline]
    fn cell(&self, index: u32) -> Cell {
        let in_tall = self.tall * self.tall_rows.count();
        let (rows, before, start) =
            if index < in_tall { (self.tall_rows, 0, 0) } else { (self.rows, in_tall, self.tall) };
        let column = (index - before) / rows.count();
        let first = before + column * rows.count();
        Cell { column: start + column, row: index - first, rows, before: first }
    }

    /// A point of rectangle `index`, column by column; each random number is the share of the way through, times `2^32`.
    #[inline]
    pub fn place(&self, index: u32, random: [u32; 2]) -> Vec2 {
        let cell = self.cell(index);
        Vec2::new(
            self.all.place(cell.before, cell.before + cell.rows.count(), random[0]),
            cell.rows.place(cell.row, cell.row + 1, random[1]),
        )
    }

    /// A point of every rectangle in order, as by [`place`](Layout::place).
    pub(crate) fn place_all(&self, random: impl Fn(u32) -> [u32; 2]) -> Vec<Vec2> {
        let mut points = Vec::with_capacity(self.count as usize);
        let mut left = 0;
        for column in 0..self.columns {
            let rows = if column < self.tall { self.tall_rows } else { self.rows };
            let before = points.len() as u32;
            let right = self.all.boundary(before + rows.count());
            let mut top = 0;
            for row in 0..rows.count() {
                let bottom = rows.boundary(row + 1);
                let [x, y] = random(before + row);
                points.push(Vec2::new(between(left, right, x), between(top, bottom, y)));
                top = bottom;
            }
            left = right;
        }
        points
    }

    /// A number of the `index`-th of as many equal parts of `[0, 1)` as there are rectangles.
    #[inline]
    pub(crate) fn place_1d(&self, index: u32, random: u32) -> f32 {
        self.all.place(index, index + 1, random)
    }

    /// A point of rectangle `index` such that all of them together have one point in each of `count` columns of equal
    /// width and, if the layout is a grid, in each of `count` rows of equal height.
    ///
    /// The points of a column go to its finer columns by a permutation, and those of a row to its finer rows; to each
    /// column and row its own permutation [Chiu, Shirley and Wang 1994] or, `correlated`, to all columns the same and to
    /// all rows the same [Kensler 2013, sec. 2]. In a layout that is no grid, finer rows would not fit the rectangles.
    #[inline]
    pub(crate) fn place_finely(&self, index: u32, random: [u32; 2], key: u64, correlated: bool) -> Vec2 {
        let cell = self.cell(index);
        let of = |line: u32, axis: u64| {
            let line = if correlated { 0 } else { u64::from(line) + 1 };
            mix(key.wrapping_add((line << 1 | axis).wrapping_mul(0xd1b5_4a32_d192_ed03)))
        };
        let finer = cell.before + permute_by(cell.row, cell.rows.count(), of(cell.column, 0));
        let x = self.all.place(finer, finer + 1, random[0]);
        if !self.is_grid() {
            return Vec2::new(x, cell.rows.place(cell.row, cell.row + 1, random[1]));
        }
        let finer = cell.row * self.columns + permute_by(cell.column, self.columns, of(cell.row, 1));
        Vec2::new(x, self.all.place(finer, finer + 1, random[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stratified::jitter;
    use proptest::prelude::*;

    #[test]
    fn known_layouts() {
        let known = |n| {
            let l = Layout::new(n);
            (l.columns, l.rows.count(), l.tall)
        };
        assert_eq!(known(0), (0, 0, 0));
        assert_eq!(known(1), (1, 1, 0));
        assert_eq!(known(2), (1, 2, 0));
        assert_eq!(known(3), (2, 1, 1));
        assert_eq!(known(7), (3, 2, 1));
        assert_eq!(known(8), (2, 4, 0));
        assert_eq!(known(12), (3, 4, 0));
        assert_eq!(known(64), (8, 8, 0));
        assert_eq!(known(127), (11, 11, 6));
        assert_eq!(known(1 << 31), (1 << 15, 1 << 16, 0));
        assert_eq!(known(u32::MAX), (65535, 65537, 0));
    }

    proptest! {
        #[test]
        fn all_points_are_those_of_the_rectangles(count in 0..3000_u32, key: u64) {
            let layout = Layout::new(count);
            let random = |index| jitter(key, index);
            let one_by_one: Vec<Vec2> = (0..count).map(|s| layout.place(s, random(s))).collect();
            prop_assert_eq!(layout.place_all(random), one_by_one);
        }
    }

    #[test]
    fn rectangles_tile_the_square() {
        for count in 1..5000 {
            let layout = Layout::new(count);
            let mut expected = (0, 0);
            for index in 0..count {
                let cell = layout.cell(index);
                assert_eq!((cell.column, cell.row), expected);
                assert_eq!(cell.before + cell.row, index);
                expected =
                    if cell.row + 1 == cell.rows.count() { (cell.column + 1, 0) } else { (cell.column, cell.row + 1) };
                // Width times height, without rounding: rows / count * 1 / rows.
                let (width, height) =
                    (f64::from(cell.rows.count()) / f64::from(count), 1.0 / f64::from(cell.rows.count()));
                // Three rectangles of equal area cannot all be nearly square.
                assert!(count == 3 || (0.5..=2.0).contains(&(width / height)), "{width} by {height} of {count}");
            }
            assert_eq!(expected, (layout.columns, 0));
        }
    }
}
