//! Aimed emission: what a projection map does, for lights of every kind.
//!
//! Instead of casters' outlines seen from a light, what is kept is which random numbers of the emission led to photons: those of
//! the point on the light (for light from infinity, on the disk that it comes through), and those of the direction. A pilot
//! fills the two tables; the emission then takes half of its numbers by them and half as they are, and weights by the density
//! of both together, so that nothing is lost that the pilot has missed [Jensen 1996, sec. 3.1, for the purpose].

use etendue_core::distribution::Piecewise2d;
use glam::Vec2;

/// Cells in a row and a column of each table.
const CELLS: usize = 32;
/// What is put into every cell before, over the mean worth: a pilot that has hardly found anything says little of where there
/// is nothing.
const DOUBT: f64 = 0.1;

/// How emission is aimed; without tables it is not.
#[derive(Clone, Debug, Default)]
pub struct Aim {
    tables: Option<(Piecewise2d, Piecewise2d)>,
}

/// Numbers of an emission's point and direction, and what it is worth: how many photons it led to, or how much they matter.
pub type Worth = (Vec2, Vec2, f64);

/// Random numbers of an emission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aimed {
    /// For the point.
    pub point: Vec2,
    /// For the direction.
    pub direction: Vec2,
    /// Density of both together, between 1/2 and infinity; 1 where nothing is aimed.
    pub density: f32,
}

impl Aim {
    /// Aims at the numbers that a pilot has found fruitful, each with what it is worth. None: at nothing.
    pub fn at(fruitful: &[Worth]) -> Aim {
        let total: f64 = fruitful.iter().map(|f| f.2).sum();
        let doubt = DOUBT * total / fruitful.len() as f64;
        if !(doubt.is_finite() && doubt > 0.0) {
            return Aim::default();
        }
        let table = |of: &dyn Fn(&Worth) -> Vec2| {
            let mut cells = vec![doubt; CELLS * CELLS];
            for entry in fruitful {
                let at = (of(entry) * CELLS as f32).as_uvec2().min(glam::UVec2::splat(CELLS as u32 - 1));
                // The cells around as well: a pilot has few samples in each.
                for y in at.y.saturating_sub(1)..(at.y + 2).min(CELLS as u32) {
                    for x in at.x.saturating_sub(1)..(at.x + 2).min(CELLS as u32) {
                        cells[y as usize * CELLS + x as usize] += entry.2;
                    }
                }
            }
            // A cell that is sampled with density q adds p / q to the variance if a share p of its numbers is fruitful: the
            // least sum has q go as the root of p.
            cells.iter_mut().for_each(|cell| *cell = cell.sqrt());
            Piecewise2d::new(&cells, CELLS)
        };
        Aim { tables: table(&|e| e.0).zip(table(&|e| e.1)) }
    }

    /// Whether it aims at anything.
    pub fn is_aimed(&self) -> bool {
        self.tables.is_some()
    }

    /// Turns uniform numbers into aimed ones; `u_choice` says whether the tables are used.
    #[inline]
    pub fn sample(&self, u_choice: f32, u_point: Vec2, u_direction: Vec2) -> Aimed {
        let Some((points, directions)) = &self.tables else {
            return Aimed { point: u_point, direction: u_direction, density: 1.0 };
        };
        let (point, direction) = if u_choice < 0.5 {
            (points.sample(u_point).0, directions.sample(u_direction).0)
        } else {
            (u_point, u_direction)
        };
        Aimed { point, direction, density: self.density(point, direction) }
    }

    /// The density of numbers.
    #[inline]
    pub fn density(&self, point: Vec2, direction: Vec2) -> f32 {
        match &self.tables {
            None => 1.0,
            Some((points, directions)) => 0.5 + 0.5 * points.pdf(point) * directions.pdf(direction),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn aiming_changes_no_mean_and_finds_more() {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(1);
        let mut pair = || Vec2::new(rng.random(), rng.random());
        // What is looked for: a spot in either square.
        let hit = |p: Vec2, d: Vec2| (p - 0.3).length() < 0.1 && (d - 0.8).length() < 0.15;
        let exact = std::f64::consts::PI.powi(2) * 0.01 * 0.0225;
        let pilot: Vec<_> = (0..20_000).map(|_| (pair(), pair(), 1.0)).filter(|(p, d, _)| hit(*p, *d)).collect();
        let aim = Aim::at(&pilot);
        assert!(aim.is_aimed() && !Aim::at(&[]).is_aimed());
        let n = 200_000;
        let (mut sum, mut squares, mut hits) = (0.0, 0.0, 0);
        for _ in 0..n {
            let choice = pair().x;
            let Aimed { point, direction, density } = aim.sample(choice, pair(), pair());
            assert!(density >= 0.5 && density == aim.density(point, direction));
            let value = if hit(point, direction) { 1.0 / f64::from(density) } else { 0.0 };
            hits += u32::from(value > 0.0);
            sum += value;
            squares += value * value;
        }
        let (n, mean) = (f64::from(n), sum / f64::from(n));
        let error = ((squares / n - mean * mean) / n).sqrt();
        assert!((mean - exact).abs() < 4.0 * error, "{mean} {exact} {error}");
        // Some fourteen times: half of the numbers are as they are, and roots, doubt and cells around spread the others.
        assert!(f64::from(hits) / n > 10.0 * exact, "{hits}");
    }
}
