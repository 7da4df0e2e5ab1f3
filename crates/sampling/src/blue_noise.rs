//! Point patterns whose points keep apart from each other.

use crate::{
    stratified::GOLDEN,
    torus::{Place, Torus, place, position},
};
use etendue_core::digest::mix;
use glam::Vec2;

/// Mitchell's best candidates: each point is the one of several random points that is farthest from all before
/// [Mitchell 1991, sec. 3].
///
/// There is one candidate more than there are points so far, so that the spectrum keeps its shape: every beginning of the sequence is
/// such a pattern. Distances go around the edges, so patterns may be tiled and shifted. The variance is below that of
/// independent points at small counts, but falls as `N^-1` in the end: low frequencies keep a constant share.
pub fn best_candidate(count: u32, seed: u64) -> Vec<Vec2> {
    best_candidate_places(count, seed).into_iter().map(position).collect()
}

pub(crate) fn best_candidate_places(count: u32, seed: u64) -> Vec<Place> {
    let mut random = Random::new(seed ^ 0x243f_6a88_85a3_08d3);
    let mut torus = Torus::new();
    for n in 0..count {
        let (mut best, mut farthest) = (random.place(), 0);
        if n > 0 {
            farthest = torus.nearest_beyond(best, 0);
        }
        for _ in 0..n {
            let candidate = random.place();
            let distance = torus.nearest_beyond(candidate, farthest);
            if distance > farthest {
                (best, farthest) = (candidate, distance);
            }
        }
        torus.add(best);
    }
    torus.points().to_vec()
}

/// A Poisson-disk pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct PoissonDisk {
    /// The points, in `[0, 1)^2`.
    pub points: Vec<Vec2>,
    /// No two points are nearer to each other than this, around the edges.
    pub radius: f64,
}

/// `count` points no two of which are near each other.
///
/// A Poisson-disk pattern of a given radius has no given number of points. So darts are thrown at a radius that shrinks
/// by 2 % whenever four times as many darts as there are points, and 100 more, have found no room, until there are enough
/// points (relaxation dart throwing) [McCool and Fiume 1992, sec. 3]. Every beginning of the sequence is such a pattern
/// of a larger radius, at least about `0.7 / sqrt(N)`.
///
/// The radius is never more than `0.8 / sqrt(n)` for the `n`-th point, which random darts just reach: at the largest radius
/// that leaves room, each point would have one place alone, and the pattern would be a lattice, with its directions.
pub fn poisson_disk(count: u32, seed: u64) -> PoissonDisk {
    let (places, radius_squared) = poisson_disk_places(count, seed);
    let radius = (radius_squared as f64).sqrt() / 2.0_f64.powi(32);
    PoissonDisk { points: places.into_iter().map(position).collect(), radius }
}

/// The points and their squared radius, in units of `2^-64`.
pub(crate) fn poisson_disk_places(count: u32, seed: u64) -> (Vec<Place>, u64) {
    let mut random = Random::new(seed ^ 0x1319_8a2e_0370_7344);
    let mut torus = Torus::new();
    // The largest distance on the torus is half a diagonal.
    let most = |n: usize| (0.64 / n as f64).min(0.5) * 2.0_f64.powi(64);
    let (mut radius_squared, mut failures) = (u64::MAX, 0);
    while torus.points().len() < count as usize {
        radius_squared = radius_squared.min(most(torus.points().len() + 1) as u64);
        let dart = random.place();
        if torus.nearest_beyond(dart, radius_squared - 1) >= radius_squared {
            torus.add(dart);
            failures = 0;
        } else {
            failures += 1;
            if failures > 100 + 4 * torus.points().len() {
                failures = 0;
                radius_squared = (radius_squared as f64 * (0.98 * 0.98)) as u64;
            }
        }
    }
    (torus.points().to_vec(), radius_squared)
}

/// A stream of random points.
struct Random {
    key: u64,
    drawn: u64,
}

impl Random {
    fn new(seed: u64) -> Random {
        Random { key: mix(seed), drawn: 0 }
    }

    #[inline]
    fn place(&mut self) -> Place {
        self.drawn += 1;
        place(mix(self.key.wrapping_add(self.drawn.wrapping_mul(GOLDEN))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torus::distance_squared;

    fn nearest(points: &[Place], place: Place) -> u64 {
        points.iter().map(|&p| distance_squared(p, place)).min().unwrap_or(0)
    }

    fn smallest_distance(points: &[Place]) -> f64 {
        let smallest = (1..points.len()).map(|i| nearest(&points[..i], points[i])).min().unwrap();
        (smallest as f64).sqrt() / 2.0_f64.powi(32)
    }

    #[test]
    fn best_candidates_are_those_of_a_search_of_all() {
        for seed in 0..4 {
            let mut random = Random::new(seed ^ 0x243f_6a88_85a3_08d3);
            let mut points: Vec<Place> = Vec::new();
            for n in 0..400 {
                let candidates: Vec<Place> = (0..=n).map(|_| random.place()).collect();
                let farthest = candidates.iter().map(|&c| nearest(&points, c)).max().unwrap();
                points.push(*candidates.iter().find(|&&c| nearest(&points, c) == farthest).unwrap());
            }
            assert_eq!(best_candidate_places(400, seed), points);
        }
    }

    #[test]
    fn beginnings_are_patterns() {
        assert_eq!(best_candidate(500, 7)[..100], best_candidate(100, 7));
        let (long, short) = (poisson_disk(500, 7), poisson_disk(100, 7));
        assert_eq!(long.points[..100], short.points);
        assert!(long.radius < short.radius);
    }

    #[test]
    fn points_keep_apart() {
        let independent: Vec<Place> = {
            let mut random = Random::new(1);
            (0..1024).map(|_| random.place()).collect()
        };
        // In units of 1 / sqrt(N), in which the densest packing has 1.07.
        assert!(smallest_distance(&independent) * 32.0 < 0.1);
        for seed in 0..5 {
            for (count, least) in [(2, 0.4), (16, 0.5), (61, 0.6), (1024, 0.7)] {
                let unit = f64::from(count).sqrt();
                let best = smallest_distance(&best_candidate_places(count, seed)) * unit;
                assert!(best > least, "{count}: {best}");
                let (points, radius_squared) = poisson_disk_places(count, seed);
                let radius = poisson_disk(count, seed).radius;
                assert!(smallest_distance(&points) >= (radius_squared as f64).sqrt() / 2.0_f64.powi(32));
                assert!(radius * unit > 0.7 && radius * unit < 1.08, "{count}: {}", radius * unit);
            }
        }
    }
}
