use super::*;
use proptest::prelude::*;

fn brute<P>(tree: &KdTree<P>, from: Vec3, radius: f32) -> Vec<(f32, u32)> {
    let r2 = radius * radius;
    let mut all: Vec<(f32, u32)> = (0..tree.len() as u32)
        .map(|i| {
            let d = tree.position(i) - from;
            (d.x * d.x + d.y * d.y + d.z * d.z, i)
        })
        .filter(|(d2, _)| radius >= 0.0 && *d2 <= r2)
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    all
}

/// Every query against looking at all points; distances bit by bit, and that each point is found where it is, once.
fn check(points: &[Vec3], from: Vec3, k: usize, radius: f32) {
    let tree = KdTree::new(points.iter().copied().zip(0u32..).collect());
    let mut seen: Vec<u32> = tree.payloads().to_vec();
    seen.sort_unstable();
    assert!(seen.iter().copied().eq(0..points.len() as u32), "every point is in the tree once");
    assert!((0..points.len() as u32).all(|i| tree.position(i) == points[*tree.payload(i) as usize]));

    let expected = brute(&tree, from, radius);
    let mut within = Vec::new();
    tree.within(from, radius, |n| within.push((n.distance_squared(), n.index())));
    within.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    assert_eq!(within, expected);

    let mut room = Neighbours::default();
    let mut check_nearest = |expected: &[(f32, u32)], keep: &dyn Fn(u32) -> bool| {
        let nearest = tree.k_nearest_where(from, k, radius, &mut room, keep);
        let mut indices: Vec<u32> = nearest.iter().map(|n| n.index()).collect();
        indices.sort_unstable();
        indices.dedup();
        assert_eq!(indices.len(), nearest.len(), "no point is found twice");
        let mut found: Vec<(f32, u32)> = nearest.iter().map(|n| (n.distance_squared(), n.index())).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(found.iter().all(|n| expected.contains(n)));
        assert!(found.iter().map(|n| n.0).eq(expected.iter().take(k).map(|n| n.0)));
    };
    check_nearest(&expected, &|_| true);
    let odd: Vec<_> = expected.iter().copied().filter(|n| n.1 % 2 == 1).collect();
    check_nearest(&odd, &|i| i % 2 == 1);
}

/// Points as tests want them, `n` at random in the unit cube to start from.
fn arranged(kind: u32, points: Vec<Vec3>) -> Vec<Vec3> {
    let center = |p: Vec3| (p * 3.0).floor() / 3.0;
    points
        .into_iter()
        .map(|p| match kind {
            0 => p,
            // Small clumps far apart.
            1 => center(p) + (p - center(p)) * 1e-3,
            // A line.
            2 => Vec3::new(0.3, 0.5, 0.1) + Vec3::new(1.0, -2.0, 0.5) * p.x,
            // A line along an axis, with many equal points.
            3 => Vec3::X * (p.x * 8.0).floor(),
            // All one point.
            _ => Vec3::new(0.25, 0.5, 0.75),
        })
        .collect()
}

fn point() -> impl Strategy<Value = Vec3> {
    (0.0..1.0f32, 0.0..1.0f32, 0.0..1.0f32).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn queries_find_what_looking_at_all_points_finds(
        kind in 0..5u32,
        points in prop_oneof![
            proptest::collection::vec(point(), 0..4),
            proptest::collection::vec(point(), 0..300),
            proptest::collection::vec(point(), 2000..2600),
        ],
        from in prop_oneof![point(), point().prop_map(|p| p * 1e3), point().prop_map(|p| (p * 8.0).floor())],
        k in prop_oneof![0..3usize, 0..80usize, Just(5000)],
        radius in prop_oneof![Just(0.0f32), 0.0..0.3f32, 0.0..4.0f32, Just(f32::INFINITY), Just(-1.0)],
    ) {
        check(&arranged(kind, points), from, k, radius);
    }
}

fn random_points(n: usize, seed: u64) -> Vec<Vec3> {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_pcg::Pcg64::seed_from_u64(seed);
    (0..n).map(|_| Vec3::new(rng.random(), rng.random(), rng.random())).collect()
}

#[test]
fn a_point_is_its_own_neighbour_at_radius_zero() {
    for kind in 0..5 {
        let points = arranged(kind, random_points(500, 3));
        check(&points, points[123], 2, 0.0);
    }
}

#[test]
fn what_is_not_finite_is_never_found() {
    let mut points = random_points(100, 4);
    points[17].y = f32::NAN;
    points[60] = Vec3::INFINITY;
    let tree = KdTree::new(points.iter().copied().zip(0u32..).collect());
    let mut room = Neighbours::default();
    let found = tree.k_nearest(Vec3::ZERO, 100, f32::INFINITY, &mut room);
    let mut payloads: Vec<u32> = found.iter().map(|n| *tree.payload(n.index())).collect();
    payloads.sort_unstable();
    assert!(payloads.iter().copied().eq((0..100).filter(|i| *i != 17 && *i != 60)));
    assert!(tree.k_nearest(Vec3::NAN, 100, f32::INFINITY, &mut room).is_empty());
}

#[test]
fn the_wide_and_the_plain_search_find_the_same_bits() {
    for kind in 0..5 {
        let points = arranged(kind, random_points(5000, 5));
        let tree = KdTree::new(points.iter().copied().zip(0u32..).collect());
        let (mut room, mut plain) = (Neighbours::default(), Vec::new());
        for from in arranged(kind, random_points(200, 6)) {
            for (k, radius) in [(1, 1.0), (50, 0.1), (50, f32::INFINITY), (300, 0.3)] {
                let wide = tree.k_nearest(from, k, radius, &mut room);
                let count = search::k_nearest(&tree, from, k, radius, &mut plain, |_| true);
                assert_eq!(wide, &plain[..count]);
                let (mut a, mut b) = (Vec::new(), Vec::new());
                tree.within(from, radius.min(0.2), |n| a.push(n));
                search::within(&tree, from, radius.min(0.2), |n| b.push(n));
                assert_eq!(a, b);
            }
        }
    }
}

#[test]
fn a_point_takes_at_most_20_bytes_beside_its_payload() {
    for n in [1_000, 1_025, 4_097, 32_769, 100_000] {
        let tree = KdTree::new(random_points(n, 7).into_iter().map(|p| (p, ())).collect());
        let each = tree.structure_bytes() as f64 / n as f64;
        assert!(each <= 20.0, "{n} points: {each} bytes each");
    }
}

#[test]
fn large_and_coincident_trees_build_and_answer() {
    // The recursion is as deep as the logarithm of the number, however points lie.
    for kind in 0..5 {
        let points = arranged(kind, random_points(200_000, 8));
        let tree = KdTree::new(points.iter().map(|p| (*p, ())).collect());
        let mut room = Neighbours::default();
        assert_eq!(tree.k_nearest(points[5], 50, f32::INFINITY, &mut room).len(), 50);
    }
}
