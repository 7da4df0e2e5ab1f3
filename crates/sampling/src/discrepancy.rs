//! How far a point set is from uniform.

use glam::Vec2;

/// The star discrepancy of points in the unit square, exactly: the largest difference between the area of a box with one
/// corner at the origin and its share of the points [Niederreiter 1992, def. 2.1].
///
/// It is attained at a box whose sides reach to coordinates of points or to 1, where the points on its far sides count
/// (too many) or do not (too few). Time grows as the square of the number of points. Without points it is 1.
///
/// ```
/// use etendue_sampling::discrepancy::star_discrepancy;
/// use glam::Vec2;
/// assert_eq!(star_discrepancy(&[Vec2::splat(0.5)]), 0.75); // closed, the box to the point holds it all
/// ```
pub fn star_discrepancy(points: &[Vec2]) -> f64 {
    let mut points: Vec<(f64, f64)> = points.iter().map(|p| (f64::from(p.x), f64::from(p.y))).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let share = |count: usize| if points.is_empty() { 0.0 } else { count as f64 / points.len() as f64 };
    // The heights of the points seen so far, in order.
    let mut heights: Vec<f64> = Vec::with_capacity(points.len());
    let mut worst: f64 = 0.0;
    for column in points.chunk_by(|a, b| a.0 == b.0) {
        let width = column[0].0;
        worst = worst.max(too_few(width, &heights, share));
        for (_, height) in column {
            heights.insert(heights.partition_point(|h| h < height), *height);
        }
        // Of points of one height, the last counts them all.
        let too_many = heights.iter().enumerate().map(|(below, height)| share(below + 1) - width * height);
        worst = too_many.fold(worst, f64::max);
    }
    worst.max(too_few(1.0, &heights, share))
}

/// The most that open boxes of a width hold too little.
fn too_few(width: f64, heights: &[f64], share: impl Fn(usize) -> f64) -> f64 {
    // Of points of one height, the first counts none of them.
    let boxes = heights.iter().copied().chain([1.0]).enumerate();
    boxes.map(|(below, height)| width * height - share(below)).fold(0.0, f64::max)
}
