//! From cells to curves: medians and bands over replicates, slopes with intervals, times to reach an error.

use crate::study::results::{Cell, Line};
use etendue_core::statistics::{moments::Moments, slope, special::student_t_quantile};

/// Share of intervals that hold the true slope.
const CONFIDENCE: f64 = 0.95;
/// A checkpoint counts for slopes and times while its error is at least so many times the reference's own.
const CLEAR_OF_NOISE: f64 = 2.0;
/// A slope above this reaches nothing in the time that anybody has.
const FLATTEST_SLOPE: f64 = -0.05;
/// The greatest factor between the times that the ends of a slope's interval tell; beyond it, none is told.
const WIDEST: f64 = 10.0;

/// Replicates at one checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Passes.
    pub passes: u32,
    /// Replicates that have this checkpoint.
    pub replicates: usize,
    /// Median of the seconds, building included.
    pub seconds: f64,
    /// Least, median and greatest relMSE.
    pub relmse: (f64, f64, f64),
    /// Median of the trimmed relMSE.
    pub trimmed: f64,
    /// The line of the replicate whose relMSE is the (lower) median.
    pub typical: Line,
}

/// A slope of relMSE over passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeFit {
    /// The mean over replicates.
    pub slope: f64,
    /// Half the width of its 95 % interval, from the scatter of the replicates; none with one replicate.
    pub half_width: Option<f64>,
}

/// When an error is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// Already at the first checkpoint, after so many seconds.
    AtOnce(f64),
    /// After so many seconds, between checkpoints.
    Within(f64),
    /// Beyond the study's time, if it goes on as it went.
    Beyond(f64),
    /// Not told: the reference's own error is greater.
    BelowNoise,
    /// Not told: the slope is too uncertain to go by.
    Unclear,
    /// Not told: the error does not fall.
    Never,
}

impl Reach {
    /// The seconds, where they are known.
    pub fn seconds(self) -> Option<f64> {
        match self {
            Reach::AtOnce(s) | Reach::Within(s) | Reach::Beyond(s) => Some(s),
            Reach::BelowNoise | Reach::Unclear | Reach::Never => None,
        }
    }
}

/// The median: the mean of the two in the middle for an even count. Zero for nothing.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    if n == 0 { 0.0 } else { 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]) }
}

/// The checkpoints of a group's replicates, together.
pub fn points(cells: &[&Cell]) -> Vec<Point> {
    let mut passes: Vec<u32> = cells.iter().flat_map(|c| c.lines.iter().map(|l| l.passes)).collect();
    passes.sort_unstable();
    passes.dedup();
    let point = |passes: u32| {
        let mut lines: Vec<&Line> = cells.iter().flat_map(|c| &c.lines).filter(|l| l.passes == passes).collect();
        lines.sort_by(|a, b| a.relmse.total_cmp(&b.relmse));
        let (first, last) = (lines[0], lines[lines.len() - 1]);
        Point {
            passes,
            replicates: lines.len(),
            seconds: median(lines.iter().map(|l| l.seconds)),
            relmse: (first.relmse, median(lines.iter().map(|l| l.relmse)), last.relmse),
            trimmed: median(lines.iter().map(|l| l.relmse_trimmed)),
            typical: lines[(lines.len() - 1) / 2].clone(),
        }
    };
    passes.into_iter().map(point).collect()
}

/// An error without what the reference's noise adds to it, if enough is left to tell.
fn own_part(relmse: f64, noise: f64) -> Option<f64> {
    (relmse > 0.0 && relmse >= CLEAR_OF_NOISE * noise).then_some(relmse - noise)
}

/// The slope of relMSE over passes: a line for each replicate, so that the replicates, which are independent, tell the
/// interval; the checkpoints of one replicate are not independent.
pub fn slope_of(cells: &[&Cell], noise: f64) -> Option<SlopeFit> {
    let fit = |cell: &&Cell| {
        let point = |l: &Line| Some((f64::from(l.passes), own_part(l.relmse, noise)?));
        slope::fit(&cell.lines.iter().filter_map(point).collect::<Vec<_>>(), CONFIDENCE).map(|f| f.slope)
    };
    let slopes: Moments = cells.iter().filter_map(fit).collect();
    let n = slopes.count();
    let half_width = || student_t_quantile(0.5 + 0.5 * CONFIDENCE, (n - 1) as f64) * slopes.standard_error();
    (n > 0).then(|| SlopeFit { slope: slopes.mean(), half_width: (n > 1).then(half_width) })
}

/// When the median error reaches a target, on straight lines between checkpoints in log-log; beyond the last, on the
/// fitted slope.
pub fn reach(points: &[Point], slope: Option<SlopeFit>, noise: f64, target: f64) -> Reach {
    let curve: Vec<(f64, f64)> =
        points.iter().filter_map(|p| Some((p.seconds, own_part(p.relmse.1, noise)?))).collect();
    if points.last().is_some_and(|p| p.relmse.1 == 0.0) {
        // Exact: as good as any target from the first exact checkpoint on.
        let exact = points.iter().find(|p| p.relmse.1 == 0.0);
        return exact.map_or(Reach::Never, |p| Reach::AtOnce(p.seconds));
    }
    // The first crossing for good: after it the error stays below the target.
    let after = curve.iter().rposition(|(_, e)| *e > target).map_or(0, |i| i + 1);
    let noisy = points.len() > curve.len();
    match (after.checked_sub(1).map(|i| curve[i]), curve.get(after)) {
        (None, Some((t, _))) => Reach::AtOnce(*t),
        (Some((t0, e0)), Some((t1, e1))) => {
            let share = (target / e0).ln() / (e1 / e0).ln();
            Reach::Within(t0 * (t1 / t0).powf(share))
        }
        _ if target < noise || (curve.is_empty() && noisy) => Reach::BelowNoise,
        (Some(last), None) => slope.map_or(Reach::Never, |fit| extrapolate(last, fit, target)),
        (None, None) => Reach::Never,
    }
}

/// When a target is reached beyond the last point of a curve, along a slope.
fn extrapolate((seconds, error): (f64, f64), fit: SlopeFit, target: f64) -> Reach {
    let at = |slope: f64| seconds * (target / error).powf(1.0 / slope);
    let half_width = fit.half_width.unwrap_or(0.0);
    let (steepest, flattest) = (fit.slope - half_width, fit.slope + half_width);
    if flattest < FLATTEST_SLOPE && at(flattest) < WIDEST * at(steepest) {
        Reach::Beyond(at(fit.slope))
    } else if steepest < FLATTEST_SLOPE {
        Reach::Unclear
    } else {
        Reach::Never
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::results::tests::cell;

    /// Times and errors that follow 0.1 / passes exactly.
    fn exact() -> Vec<Cell> {
        (0..3).map(|r| cell("a", r, 0.1, 8)).collect()
    }

    #[test]
    fn medians() {
        assert_eq!(median([3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median([]), 0.0);
    }

    #[test]
    fn bands_hold_all_replicates() {
        let cells = [cell("a", 0, 0.1, 3), cell("a", 1, 0.3, 3), cell("a", 2, 0.2, 2)];
        let points = points(&cells.iter().collect::<Vec<_>>());
        assert_eq!(points.len(), 3);
        assert_eq!((points[0].replicates, points[2].replicates), (3, 2));
        assert_eq!(points[0].relmse, (0.1, 0.2, 0.3));
        assert_eq!(points[0].typical.replicate, 2);
    }

    #[test]
    fn slopes_are_fitted_beside_the_noise() {
        let mut cells = exact();
        let fit = slope_of(&cells.iter().collect::<Vec<_>>(), 0.0).unwrap();
        assert!((fit.slope + 1.0).abs() < 1e-9 && fit.half_width.unwrap() < 1e-9);
        // The reference's noise bends the curve; taken off, it is straight again.
        cells.iter_mut().flat_map(|c| &mut c.lines).for_each(|l| l.relmse += 1e-3);
        let fit = slope_of(&cells.iter().collect::<Vec<_>>(), 1e-3).unwrap();
        assert!((fit.slope + 1.0).abs() < 1e-6, "{fit:?}");
        assert_eq!(slope_of(&[&cells[0]], 1e-3).unwrap().half_width, None);
        assert_eq!(slope_of(&[], 0.0), None);
    }

    #[test]
    fn times_to_reach() {
        let cells = exact();
        let cells: Vec<&Cell> = cells.iter().collect();
        let (points, slope) = (points(&cells), slope_of(&cells, 0.0));
        let at = |target, noise| reach(&points, slope, noise, target);
        assert_eq!(at(0.2, 0.0), Reach::AtOnce(0.01));
        // error = 1e-3 / seconds
        let Reach::Within(t) = at(1e-2, 0.0) else { panic!("{:?}", at(1e-2, 0.0)) };
        assert!((t - 0.1).abs() < 1e-9, "{t}");
        let Reach::Beyond(t) = at(1e-4, 0.0) else { panic!("{:?}", at(1e-4, 0.0)) };
        assert!((t - 10.0).abs() < 1e-6, "{t}");
        assert_eq!(at(1e-4, 2e-4), Reach::BelowNoise);
        assert_eq!(reach(&points, Some(SlopeFit { slope: 0.1, half_width: None }), 0.0, 1e-6), Reach::Never);
        assert_eq!(reach(&[], None, 0.0, 0.1), Reach::Never);
        let fit = |slope, h| reach(&points, Some(SlopeFit { slope, half_width: Some(h) }), 0.0, 1e-5);
        // A factor of 78 in the error: from -0.7 to -1.3, between 503 and 29 times as long; from -0.9 to -1.1, 127 to 53.
        assert_eq!(fit(-1.0, 0.3), Reach::Unclear);
        assert!(matches!(fit(-1.0, 0.1), Reach::Beyond(_)));
        assert_eq!((fit(-0.1, 0.5), fit(0.5, 0.5)), (Reach::Unclear, Reach::Never));
    }

    #[test]
    fn an_exact_image_reaches_everything() {
        let exact = cell("a", 0, 0.0, 4);
        let points = points(&[&exact]);
        assert_eq!(reach(&points, None, 0.0, 1e-4), Reach::AtOnce(0.01));
    }
}
