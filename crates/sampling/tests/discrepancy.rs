//! The star discrepancy against all boxes.

use etendue_sampling::discrepancy::star_discrepancy;
use glam::Vec2;
use proptest::prelude::*;

/// Over all boxes to coordinates of points or to 1, open and closed.
fn over_all_boxes(points: &[Vec2]) -> f64 {
    let sides = |of: fn(&Vec2) -> f32| points.iter().map(of).chain([1.0]).map(f64::from).collect::<Vec<_>>();
    let mut worst: f64 = 0.0;
    for &x in &sides(|p| p.x) {
        for &y in &sides(|p| p.y) {
            let count = |inside: &dyn Fn(f64, f64) -> bool| {
                points.iter().filter(|p| inside(f64::from(p.x), f64::from(p.y))).count() as f64
            };
            let n = points.len() as f64;
            worst = worst.max(x * y - count(&|px, py| px < x && py < y) / n);
            worst = worst.max(count(&|px, py| px <= x && py <= y) / n - x * y);
        }
    }
    worst
}

#[test]
fn known_values() {
    assert_eq!(star_discrepancy(&[]), 1.0);
    assert_eq!(star_discrepancy(&[Vec2::ZERO]), 1.0);
    assert_eq!(star_discrepancy(&[Vec2::splat(1.0_f32.next_down())]), f64::from(1.0_f32.next_down()));
    // All at one place.
    assert_eq!(star_discrepancy(&[Vec2::splat(0.25); 5]), 0.9375);
    // A grid of n x n cells with its points at the corners: the closed box to the last holds all.
    let n = 16;
    let grid: Vec<Vec2> = (0..n * n).map(|i| Vec2::new((i % n) as f32, (i / n) as f32) / n as f32).collect();
    assert_eq!(star_discrepancy(&grid), 1.0 - (15.0_f64 / 16.0).powi(2));
}

proptest! {
    /// Coordinates of few values make ties.
    #[test]
    fn it_is_the_worst_of_all_boxes(
        fine in prop::collection::vec((0.0..1.0_f32, 0.0..1.0_f32), 0..20),
        coarse in prop::collection::vec((0..4_u8, 0..4_u8), 1..12),
    ) {
        let coarse = coarse.into_iter().map(|(x, y)| Vec2::new(f32::from(x), f32::from(y)) * 0.25);
        let points: Vec<Vec2> = fine.into_iter().map(Vec2::from).chain(coarse).collect();
        prop_assert!((star_discrepancy(&points) - over_all_boxes(&points)).abs() < 1e-14);
    }
}
