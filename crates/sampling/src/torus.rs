//! Points on the unit torus, found by place.
//!
//! Coordinates are multiples of `2^-32`, so that differences wrap around by themselves and distances are exact.

use etendue_core::independent::unit;
use glam::Vec2;

/// A point; only the upper 24 bits of a coordinate are used, those that an `f32` holds.
pub(crate) type Place = [u32; 2];

/// A random word as a point.
#[inline]
pub(crate) fn place(word: u64) -> Place {
    [(word >> 32) as u32 & !255, word as u32 & !255]
}

/// In `[0, 1)^2`.
#[inline]
pub(crate) fn position(place: Place) -> Vec2 {
    Vec2::from(place.map(unit))
}

/// Squared distance the shortest way round, in units of `2^-64`.
#[inline]
pub(crate) fn distance_squared(a: Place, b: Place) -> u64 {
    let along = |i: usize| u64::from((a[i].wrapping_sub(b[i]) as i32).unsigned_abs());
    along(0).pow(2) + along(1).pow(2)
}

/// Points in square cells, about one or two in each.
pub(crate) struct Torus {
    points: Vec<Place>,
    /// `2^bits` cells in a row.
    bits: u32,
    /// For each cell its last point, [`NONE`] if there is none.
    last: Vec<u32>,
    /// For each point the one before it in its cell.
    before: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Torus {
    pub(crate) fn new() -> Torus {
        Torus { points: Vec::new(), bits: 0, last: vec![NONE], before: Vec::new() }
    }

    /// The points in the order in which they were added.
    pub(crate) fn points(&self) -> &[Place] {
        &self.points
    }

    pub(crate) fn add(&mut self, point: Place) {
        self.points.push(point);
        if self.points.len() > 2 * self.last.len() && self.bits < 15 {
            self.bits += 1;
            self.last = vec![NONE; 1 << (2 * self.bits)];
            self.before.clear();
        }
        for i in self.before.len()..self.points.len() {
            let [x, y] = self.points[i].map(|c| self.cell(c));
            let cell = self.index(x, y);
            self.before.push(self.last[cell]);
            self.last[cell] = i as u32;
        }
    }

    #[inline]
    fn cell(&self, coordinate: u32) -> u32 {
        (u64::from(coordinate) >> (32 - self.bits)) as u32
    }

    #[inline]
    fn index(&self, x: u32, y: u32) -> usize {
        let mask = (1 << self.bits) - 1;
        ((y & mask) << self.bits | x & mask) as usize
    }

    /// Squared distance from the nearest point to `place`, if it is larger than `limit`; else some distance of a point
    /// that is not. `u64::MAX` if there is no point.
    #[inline]
    pub(crate) fn nearest_beyond(&self, place: Place, limit: u64) -> u64 {
        let [x, y] = place.map(|c| self.cell(c));
        let size = 1_u64 << (32 - self.bits);
        // How far it is at least to the next cell on any side.
        let inside = |c: u32| {
            let offset = u64::from(c) & (size - 1);
            (offset + 1).min(size - offset)
        };
        let to_edge = inside(place[0]).min(inside(place[1]));
        let mut nearest = u64::MAX;
        let look = |x: u32, y: u32, nearest: &mut u64| {
            let mut i = self.last[self.index(x, y)];
            while i != NONE {
                *nearest = (*nearest).min(distance_squared(self.points[i as usize], place));
                i = self.before[i as usize];
            }
        };
        look(x, y, &mut nearest);
        // Rings of cells around that of the place; the last ones may come round to cells that were looked at.
        for ring in 1..=1_u32 << self.bits >> 1 {
            if nearest <= limit || nearest <= (to_edge + u64::from(ring - 1) * size).pow(2) {
                break;
            }
            for i in 0..=2 * ring {
                let (left, top) = (x.wrapping_sub(ring), y.wrapping_sub(ring));
                look(left.wrapping_add(i), top, &mut nearest);
                look(left.wrapping_add(i), y.wrapping_add(ring), &mut nearest);
                if i > 0 && i < 2 * ring {
                    look(left, top.wrapping_add(i), &mut nearest);
                    look(x.wrapping_add(ring), top.wrapping_add(i), &mut nearest);
                }
            }
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::digest::mix;
    use proptest::prelude::*;

    #[test]
    fn distances_go_the_shortest_way() {
        let quarter = 1 << 30;
        assert_eq!(distance_squared([0, 0], [3 * quarter, 0]), u64::from(quarter).pow(2));
        assert_eq!(distance_squared([0, 0], [2 * quarter; 2]), 2 * (1 << 62));
        assert_eq!(distance_squared([u32::MAX, 5], [0, 4]), 2);
    }

    proptest! {
        #[test]
        fn the_nearest_is_that_of_a_search_of_all(count in 0..300_u64, spread in 0..32_u32, seed: u64) {
            let mut torus = Torus::new();
            for i in 0..count {
                // Some crowded into a corner.
                let shift = if i % 2 == 0 { spread } else { 0 };
                torus.add(place(mix(seed ^ i)).map(|c| c >> shift));
            }
            for i in 0..20 {
                let from = place(mix(!seed ^ i));
                let all = torus.points().iter().map(|&p| distance_squared(p, from)).min().unwrap_or(u64::MAX);
                prop_assert_eq!(torus.nearest_beyond(from, 0), all);
                let limit = mix(i) >> 2;
                let found = torus.nearest_beyond(from, limit);
                prop_assert!(found == all || (all <= limit && found >= all && found <= limit), "{} {} {}", all, found, limit);
            }
        }
    }
}
