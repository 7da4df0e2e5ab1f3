use super::*;
use crate::statistics::render::{RejectedSample, RenderStatistics};
use glam::Vec2;
use proptest::prelude::*;
use std::collections::BTreeSet;

const FILTERS: [Filter; 4] =
    [Filter::Box, Filter::Tent { radius: 1.0 }, Filter::Tent { radius: 1.3 }, Filter::Gaussian { stddev: 0.5 }];

/// A hash as a number in `[0, 1)`.
fn noise(a: u32, b: u32) -> f32 {
    let mut h = u64::from(a) << 32 | u64::from(b) ^ 0x5bd1_e995;
    for _ in 0..3 {
        h = (h ^ h >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    (h >> 40) as f32 / (1 << 24) as f32
}

fn estimate(pixel: UVec2, pass: u32) -> Rgb {
    let v = noise(pixel.y * 1000 + pixel.x, pass);
    Rgb::new(v, v * v * 1e-3, 1e6 * v)
}

fn camera_pass(film: &mut Film, pass: u32) -> RenderStatistics {
    film.add_pass("test", pass, || (), |_, pixel, _| estimate(pixel, pass))
}

/// A pass with light paths, camera paths, splats by both, and some of all kinds rejected.
fn mixed_pass(film: &mut Film, pass: u32) -> RenderStatistics {
    let size = film.resolution().as_vec2();
    let splat = |splats: &Splats, statistics: &mut RenderStatistics, number: u32| {
        let u = Vec2::new(noise(number, 3 * pass), noise(number, 3 * pass + 1));
        let v = if number.is_multiple_of(97) { f32::NAN } else { noise(number, 3 * pass + 2).powi(9) * 1e3 };
        splats.splat(statistics, u * (size + 4.0) - 2.0, Rgb::new(v, 1e-7 * v, 0.1));
        statistics.rays.light += 1;
    };
    film.add_splat_pass(
        "mixed",
        pass,
        5000,
        || (),
        |_, number, splats, statistics| splat(splats, statistics, number),
        |_, pixel, splats, statistics| {
            splat(splats, statistics, 100_000 + pixel.y * 1000 + pixel.x);
            if pixel == UVec2::new(3, 2) { Rgb::splat(-1.0) } else { estimate(pixel, pass) }
        },
    )
}

fn filled(resolution: UVec2, passes: impl IntoIterator<Item = u32>) -> Film {
    let mut film = Film::new(resolution, Filter::Box);
    passes.into_iter().for_each(|pass| _ = camera_pass(&mut film, pass));
    film
}

#[cfg(feature = "parallel")]
#[test]
fn the_number_of_threads_changes_no_bit() {
    for filter in FILTERS {
        let render = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut film = Film::new(UVec2::new(61, 43), filter);
                let mut statistics = mixed_pass(&mut film, 0);
                statistics.merge(&camera_pass(&mut film, 1));
                statistics.merge(&mixed_pass(&mut film, 2));
                (film, statistics)
            })
        };
        let one = render(1);
        assert!(one.1.rejected > 100);
        assert_eq!(one, render(2));
        assert_eq!(one, render(7));
    }
}

#[test]
fn a_state_lasts_for_the_same_pixels_on_any_number_of_threads() {
    let mut film = Film::new(UVec2::new(100, 7), Filter::Box);
    let calls = |calls: &mut u32, pixel: UVec2, _: &mut RenderStatistics| {
        *calls += 1;
        assert_eq!(*calls, (pixel.y * 100 + pixel.x) % 128 + 1);
        Rgb::BLACK
    };
    film.add_pass("test", 0, || 0, calls);
}

#[test]
fn mean_and_variance_are_those_of_the_estimates() {
    let film = filled(UVec2::new(5, 4), 0..50);
    assert_eq!(film.passes(), 50);
    for (index, (mean, variance)) in film.mean_image().into_iter().zip(film.variance_image()).enumerate() {
        let pixel = UVec2::new(index as u32 % 5, index as u32 / 5);
        assert_eq!((film.mean(pixel), film.variance_of_mean(pixel), film.count(pixel)), (mean, variance, 50));
        for c in 0..3 {
            let values: Vec<f64> = (0..50).map(|pass| f64::from(estimate(pixel, pass)[c])).collect();
            let expected = values.iter().sum::<f64>() / 50.0;
            let scatter = values.iter().map(|v| (v - expected).powi(2)).sum::<f64>() / (50.0 * 49.0);
            assert!((f64::from(mean[c]) - expected).abs() <= 6e-8 * expected);
            // The squares' own resolution, of half a unit an estimate, and rounding.
            let rounding = 50.0 * 0.5_f64.powi(44) / (50.0 * 49.0) + 1e-12 * scatter;
            assert!((variance[c] - scatter).abs() <= rounding, "{} {scatter}", variance[c]);
        }
    }
}

#[test]
fn without_passes_nothing_is_known() {
    let film = filled(UVec2::new(2, 2), 0..1);
    assert_eq!(film.variance_of_mean(UVec2::ZERO), [f64::INFINITY; 3]);
    let film = Film::new(UVec2::new(2, 2), Filter::Box);
    assert_eq!((film.passes(), film.mean(UVec2::ONE)), (0, Rgb::BLACK));
}

#[test]
fn equal_estimates_have_next_to_no_variance() {
    let mut film = Film::new(UVec2::ONE, Filter::Box);
    for pass in 0..1000 {
        film.add_pass("test", pass, || (), |_, _, _| Rgb::new(0.1, 1e-3, 12345.678));
    }
    assert_eq!(film.mean(UVec2::ZERO), Rgb::new(0.1, 1e-3, 12345.678));
    for (variance, mean) in film.variance_of_mean(UVec2::ZERO).into_iter().zip([0.1, 1e-3, 12345.678]) {
        // Half a unit of the squares, and the rounding of doubles.
        let resolution = 0.5_f64.powi(44) + mean * mean * f64::EPSILON;
        assert!((0.0..=resolution / 999.0 * 2.0).contains(&variance), "{variance}");
    }
}

#[test]
fn what_is_no_radiance_is_rejected_and_counted() {
    let bad = [f32::NAN, f32::INFINITY, -1e-30, Film::ESTIMATE_LIMIT];
    let value = |pixel: UVec2| {
        let mut value = [1.0; 3];
        if pixel.x < 4 {
            value[pixel.y as usize] = bad[pixel.x as usize];
        }
        Rgb::from(value)
    };
    let rejected_at: Vec<_> =
        (0..12).map(|i| RejectedSample { pass: 7, y: i / 4, x: i % 4, technique: "bad" }).collect();
    let check = |film: &Film, statistics: &RenderStatistics| {
        assert_eq!(statistics.rejected, 12);
        assert_eq!(statistics.rejected_samples, rejected_at);
        for (i, sums) in film.raw().iter().enumerate() {
            assert_eq!(sums.count, 1);
            assert_eq!(sums.mean(), if i % 5 < 4 { Rgb::BLACK } else { Rgb::WHITE });
        }
    };
    let mut film = Film::new(UVec2::new(5, 3), Filter::Box);
    let statistics = film.add_pass("bad", 7, || (), |_, pixel, _| value(pixel));
    check(&film, &statistics);

    let mut film = Film::new(UVec2::new(5, 3), Filter::Box);
    let estimate = |_: &mut (), pixel: UVec2, _: &Splats, _: &mut RenderStatistics| value(pixel);
    let statistics = film.add_splat_pass("bad", 7, 0, || (), |_, _, _, _| (), estimate);
    check(&film, &statistics);

    let mut film = Film::new(UVec2::new(5, 3), Filter::Box);
    let light = |_: &mut (), number: u32, splats: &Splats, statistics: &mut RenderStatistics| {
        let pixel = UVec2::new(number % 5, number / 5);
        splats.splat(statistics, pixel.as_vec2() + 0.5, value(pixel));
    };
    let statistics = film.add_splat_pass("bad", 7, 15, || (), light, |_, _, _, _| Rgb::BLACK);
    check(&film, &statistics);
}

#[test]
fn positions_that_are_nowhere_are_rejected_at_the_nearest_pixel() {
    let mut film = Film::new(UVec2::new(5, 3), Filter::Tent { radius: 1.0 });
    let nowhere = [Vec2::new(f32::NAN, 1.5), Vec2::new(f32::INFINITY, 1.5), Vec2::new(2.5, f32::NEG_INFINITY)];
    let light = |_: &mut (), number: u32, splats: &Splats, statistics: &mut RenderStatistics| {
        splats.splat(statistics, nowhere[number as usize], Rgb::WHITE);
    };
    let statistics = film.add_splat_pass("bad", 0, 3, || (), light, |_, _, _, _| Rgb::BLACK);
    let places: BTreeSet<_> = statistics.rejected_samples.iter().map(|r| (r.x, r.y)).collect();
    assert_eq!(statistics.rejected, 3);
    assert_eq!(places, BTreeSet::from([(0, 1), (4, 1), (2, 0)]));
    assert!(film.mean_image().iter().all(|v| v.is_black()));
}

#[test]
fn a_sum_of_splats_over_the_limit_is_rejected() {
    let mut film = Film::new(UVec2::new(2, 1), Filter::Box);
    let large = Rgb::splat(Film::ESTIMATE_LIMIT.next_down());
    let light = |_: &mut (), number: u32, splats: &Splats, statistics: &mut RenderStatistics| {
        splats.splat(statistics, Vec2::new(if number < 1000 { 0.5 } else { 1.5 }, 0.5), large);
    };
    let statistics = film.add_splat_pass("bad", 0, 1001, || (), light, |_, _, _, _| Rgb::BLACK);
    assert_eq!(statistics.rejected, 1);
    assert_eq!(film.mean_image(), [Rgb::BLACK, large]);
}

#[test]
fn a_full_sum_is_rejected_rather_than_wrapped() {
    let full = PixelSums { sum: [i128::MAX - 5; 3], squares: [0; 3], count: 1 };
    let mut film = Film::from_raw(UVec2::ONE, Filter::Box, vec![full]).unwrap();
    let statistics = film.add_pass("test", 0, || (), |_, _, _| Rgb::WHITE);
    assert_eq!(statistics.rejected, 1);
    assert_eq!(film.raw(), [PixelSums { count: 2, ..full }]);
    let other = film.clone();
    assert_eq!(film.merge(&other), Err(FilmError::Overflow { pixel: UVec2::ZERO }));
    assert_eq!(film, other);
}

#[test]
fn camera_paths_alone_make_the_same_bits_in_either_kind_of_pass() {
    let mut film = Film::new(UVec2::new(40, 30), Filter::Gaussian { stddev: 0.5 });
    let mut camera = film.clone();
    for pass in 0..3 {
        camera_pass(&mut camera, pass);
        film.add_splat_pass("test", pass, 10, || (), |_, _, _, _| (), |_, pixel, _, _| estimate(pixel, pass));
    }
    assert_eq!(film.raw(), camera.raw());
}

fn splatted(filter: Filter, resolution: UVec2, positions: &[Vec2]) -> Film {
    let mut film = Film::new(resolution, filter);
    let light = |_: &mut (), number: u32, splats: &Splats, statistics: &mut RenderStatistics| {
        splats.splat(statistics, positions[number as usize], Rgb::WHITE);
    };
    let statistics = film.add_splat_pass("test", 0, positions.len() as u32, || (), light, |_, _, _, _| Rgb::BLACK);
    assert_eq!(statistics.rejected, 0);
    film
}

fn total(film: &Film) -> f64 {
    film.mean_image().iter().map(|v| f64::from(v.g)).sum()
}

#[test]
fn a_box_gives_every_position_to_one_pixel() {
    let resolution = UVec2::new(4, 3);
    let inside = [0.0, f32::MIN_POSITIVE, 0.5, 1.0_f32.next_down(), 1.0, 1.0_f32.next_up(), 2.0];
    for x in inside.into_iter().chain([4.0_f32.next_down()]) {
        for y in inside.into_iter().chain([3.0_f32.next_down()]) {
            let film = splatted(Filter::Box, resolution, &[Vec2::new(x, y)]);
            assert_eq!(film.mean(UVec2::new(x as u32, y as u32)), Rgb::WHITE, "{x} {y}");
            assert_eq!(total(&film), 1.0);
        }
    }
    for x in [-f32::MIN_POSITIVE, -1e-9, -1.0, 4.0, 1e9, -1e9, f32::MAX, f32::MIN] {
        assert_eq!(total(&splatted(Filter::Box, resolution, &[Vec2::new(x, 1.0)])), 0.0, "{x}");
    }
}

#[test]
fn wide_filters_drop_what_is_outside_and_keep_the_rest() {
    for filter in FILTERS {
        let r = filter.radius();
        let far = [-1.0001 * r + 0.5, 3.5 + 1.0001 * r, 1e9, -1e9, f32::MAX, f32::MIN];
        for x in far {
            assert_eq!(total(&splatted(filter, UVec2::new(4, 4), &[Vec2::new(x, 2.0)])), 0.0, "{filter:?} {x}");
        }
        for position in [Vec2::new(0.0, 0.0), Vec2::new(4.0, 1.0), Vec2::new(2.0, 3.999), Vec2::new(1.5, 1.5)] {
            let film = splatted(filter, UVec2::new(4, 4), &[position]);
            for (i, value) in film.mean_image().into_iter().enumerate() {
                let centre = Vec2::new((i % 4) as f32, (i / 4) as f32) + 0.5;
                let expected = filter.evaluate(position - centre);
                assert!((value.r - expected).abs() <= 1e-6 * expected, "{filter:?} {position} {i}");
            }
        }
    }
}

#[test]
fn splats_spread_evenly_conserve_energy() {
    // Positions on a fine lattice over the film and a border as wide as the filter: every pixel sees the midpoint rule
    // for the integral of its filter.
    const PER_PIXEL: usize = 32;
    for filter in FILTERS {
        let border = filter.radius().ceil();
        let side = (3.0 + 2.0 * border) as usize * PER_PIXEL;
        let at = |i: usize| (i as f32 + 0.5) / PER_PIXEL as f32 - border;
        let positions: Vec<Vec2> = (0..side * side).map(|i| Vec2::new(at(i % side), at(i / side))).collect();
        let film = splatted(filter, UVec2::splat(3), &positions);
        for value in film.mean_image() {
            let integral = value.r / (PER_PIXEL * PER_PIXEL) as f32;
            // Lattice step h, kinks in the filter's slope: an error of at most h^2 / 12 times their sum, on two axes.
            assert!((integral - 1.0).abs() < 1e-3, "{filter:?} {integral}");
        }
    }
}

#[test]
fn a_film_without_pixels_takes_passes() {
    for resolution in [UVec2::ZERO, UVec2::new(0, 5), UVec2::new(5, 0)] {
        let mut film = Film::new(resolution, Filter::Box);
        camera_pass(&mut film, 0);
        mixed_pass(&mut film, 1);
        assert_eq!((film.passes(), film.mean_image().len()), (0, 0));
    }
}

#[test]
fn films_that_differ_are_not_merged() {
    let mut film = filled(UVec2::new(3, 2), 0..2);
    let before = film.clone();
    let (ours, theirs) = (UVec2::new(3, 2), UVec2::new(2, 3));
    assert_eq!(film.merge(&Film::new(theirs, Filter::Box)), Err(FilmError::Resolution { ours, theirs }));
    let tent = Filter::Tent { radius: 1.0 };
    assert_eq!(film.merge(&Film::new(ours, tent)), Err(FilmError::Filter { ours: Filter::Box, theirs: tent }));
    assert_eq!(film, before);
}

#[test]
fn raw_sums_lose_nothing_and_bad_ones_are_refused() {
    let resolution = UVec2::new(6, 5);
    let film = filled(resolution, 0..3);
    let raw = film.raw().to_vec();
    assert_eq!(Film::from_raw(resolution, Filter::Box, raw.clone()), Ok(film));

    let found = raw.len();
    for resolution in [UVec2::new(6, 6), UVec2::MAX, UVec2::ZERO] {
        let error = Film::from_raw(resolution, Filter::Box, raw.clone());
        assert_eq!(error, Err(FilmError::PixelCount { resolution, found }));
    }
    let corruptions: [fn(&mut PixelSums); 3] = [|p| p.sum[1] = -1, |p| p.squares[2] = -1, |p| p.count = 0];
    for corrupt in corruptions {
        let mut raw = raw.clone();
        corrupt(&mut raw[8]);
        let error = Film::from_raw(resolution, Filter::Box, raw);
        assert_eq!(error, Err(FilmError::Corrupt { pixel: UVec2::new(2, 1) }));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn passes_added_apart_and_merged_in_any_order_give_the_same_bits(
        order in Just((0..9_u32).collect::<Vec<_>>()).prop_shuffle(), cuts in (0..9_usize, 0..9_usize),
    ) {
        let resolution = UVec2::new(7, 3);
        let whole = filled(resolution, 0..9);
        let (i, j) = (cuts.0.min(cuts.1), cuts.0.max(cuts.1));
        let films: Vec<Film> =
            [&order[..i], &order[i..j], &order[j..]].map(|part| filled(resolution, part.iter().copied())).into();
        let mut left = films[0].clone();
        left.merge(&films[1]).unwrap();
        left.merge(&films[2]).unwrap();
        let mut right = films[2].clone();
        right.merge(&films[1]).unwrap();
        let mut other = films[0].clone();
        other.merge(&right).unwrap();
        prop_assert_eq!(&left, &whole);
        prop_assert_eq!(&other, &whole);
    }
}
