//! What holds for every sampler.

use crate::{pattern::Pattern, permutation::permute};
use etendue_core::{
    sampler::{Purpose, Sampler},
    statistics::chi_square::{sidak, test},
};
use glam::{UVec2, Vec2};

/// Addresses (vertex, purpose): of the camera, of early and late vertices, of walks from lights.
const ADDRESSES: [(u32, Purpose); 9] = [
    (0, Purpose::Film),
    (0, Purpose::Lens),
    (1, Purpose::LightChoice),
    (1, Purpose::LightPoint),
    (1, Purpose::Direction),
    (2, Purpose::Direction),
    (4, Purpose::Roulette),
    (9, Purpose::Lobe),
    (3, Purpose::LightWalkDirection),
];

const SIZE: u32 = 16;

fn p_value(pairs: impl Iterator<Item = Vec2>) -> f64 {
    let mut counts = vec![0_u64; (SIZE * SIZE) as usize];
    let mut total = 0;
    for p in pairs {
        let cell = (p * SIZE as f32).as_uvec2();
        counts[(cell.y * SIZE + cell.x) as usize] += 1;
        total += 1;
    }
    test(&counts, &vec![f64::from(total) / f64::from(SIZE * SIZE); counts.len()], 5.0).p_value
}

fn assert_all_pass(p_values: &[(f64, String)]) {
    let worst = p_values.iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    assert!(worst.0 > sidak(1e-4, p_values.len()), "{} of {}: {:e}", worst.1, p_values.len(), worst.0);
}

/// A sampler of each seed at some sample.
fn over_seeds(pattern: Pattern, planned: u32, (pixel, sample): (UVec2, u32)) -> impl Iterator<Item = Box<dyn Sampler>> {
    (0..8000).map(move |seed| {
        let mut sampler = pattern.sampler()(seed, planned);
        sampler.start_pixel(pixel, 100, sample);
        sampler
    })
}

const PIXEL: UVec2 = UVec2::new(5, 3);

#[test]
fn every_address_is_uniform_over_seeds() {
    let mut p_values = Vec::new();
    for pattern in Pattern::ALL {
        for (planned, sample) in [(16, 0), (16, 40), (0, 100), (7, 6), (61, 3000)] {
            for (vertex, purpose) in ADDRESSES {
                let name = format!("{} {planned} {sample} {vertex} {purpose:?}", pattern.name());
                let pairs = over_seeds(pattern, planned, (PIXEL, sample)).map(|mut s| s.get_2d(vertex, purpose));
                p_values.push((p_value(pairs), name.clone() + " 2d"));
                let numbers = over_seeds(pattern, planned, (PIXEL, sample)).map(|mut s| s.get_1d(vertex, purpose));
                // The digits of one number after the first four as well.
                p_values.push((p_value(numbers.map(|u| Vec2::new(u, (u * SIZE as f32).fract()))), name + " 1d"));
            }
        }
    }
    assert_all_pass(&p_values);
}

#[test]
fn numbers_of_different_addresses_are_independent() {
    let mut p_values = Vec::new();
    for pattern in Pattern::ALL {
        for (planned, sample) in [(16, 5), (0, 200), (61, 100)] {
            for (i, a) in ADDRESSES.into_iter().enumerate() {
                let b = ADDRESSES[(i + 1) % ADDRESSES.len()];
                let name = format!("{} {planned} {sample} {a:?} {b:?}", pattern.name());
                let samplers = || over_seeds(pattern, planned, (PIXEL, sample));
                let pairs = samplers().map(|mut s| Vec2::new(s.get_1d(a.0, a.1), s.get_1d(b.0, b.1)));
                p_values.push((p_value(pairs), name.clone()));
                let pairs = samplers().map(|mut s| Vec2::new(s.get_2d(a.0, a.1).x, s.get_2d(b.0, b.1).x));
                p_values.push((p_value(pairs), name.clone()));
                let pairs = samplers().map(|mut s| Vec2::new(s.get_2d(a.0, a.1).y, s.get_1d(b.0, b.1)));
                p_values.push((p_value(pairs), name));
            }
        }
    }
    assert_all_pass(&p_values);
}

#[test]
fn numbers_of_different_pixels_are_independent() {
    let mut p_values = Vec::new();
    for pattern in Pattern::ALL.into_iter().filter(|p| !relates_pixels(*p)) {
        for (planned, sample) in [(16, 5), (0, 200), (61, 100)] {
            for (vertex, purpose) in ADDRESSES.into_iter().step_by(2) {
                for other in [PIXEL + UVec2::X, PIXEL + UVec2::Y, UVec2::ZERO] {
                    let name = format!("{} {planned} {sample} {vertex} {purpose:?} {other}", pattern.name());
                    let at = |pixel| over_seeds(pattern, planned, (pixel, sample));
                    let both = || at(PIXEL).zip(at(other));
                    let pairs = both()
                        .map(|(mut s, mut t)| Vec2::new(s.get_2d(vertex, purpose).x, t.get_2d(vertex, purpose).x));
                    p_values.push((p_value(pairs), name.clone() + " 2d"));
                    let pairs =
                        both().map(|(mut s, mut t)| Vec2::new(s.get_1d(vertex, purpose), t.get_1d(vertex, purpose)));
                    p_values.push((p_value(pairs), name + " 1d"));
                }
            }
        }
    }
    assert_all_pass(&p_values);
}

/// Whether a pattern gives neighbouring pixels numbers that have to do with each other.
fn relates_pixels(pattern: Pattern) -> bool {
    matches!(pattern, Pattern::Grid | Pattern::Mitchell | Pattern::BlueNoiseDithered)
}

#[test]
fn the_order_of_calls_does_not_matter() {
    for pattern in Pattern::ALL {
        for planned in [0, 1, 16, 61] {
            let samples = 150;
            let mut in_order = pattern.sampler()(9, planned);
            let mut expected = Vec::new();
            for sample in 0..samples {
                in_order.start_pixel(PIXEL, 100, sample);
                let numbers = ADDRESSES.map(|(v, p)| (in_order.get_1d(v, p), in_order.get_2d(v, p)));
                expected.push(numbers);
            }
            let mut shuffled = pattern.sampler()(9, planned);
            for i in 0..samples {
                let sample = permute(i, samples, 1);
                shuffled.start_pixel(PIXEL + i % 3, 100, sample / 2);
                shuffled.get_2d(0, Purpose::Film);
                shuffled.start_pixel(PIXEL, 100, sample);
                for j in 0..ADDRESSES.len() {
                    let j = permute(j as u32, ADDRESSES.len() as u32, i.into()) as usize;
                    let (v, p) = ADDRESSES[j];
                    let numbers = (shuffled.get_1d(v, p), shuffled.get_2d(v, p));
                    assert_eq!(numbers, expected[sample as usize][j], "{} {planned} {sample}", pattern.name());
                    let (u, uv) = numbers;
                    let all = [u, uv.x, uv.y];
                    assert!(all.iter().all(|u| (0.0..1.0).contains(u)), "{all:?}");
                }
            }
        }
    }
}

#[test]
fn extreme_samples_have_numbers() {
    for pattern in Pattern::ALL {
        for planned in [0, 1, 3, u32::MAX] {
            for sample in [0, 1 << 16, 1 << 24, u32::MAX] {
                let mut sampler = pattern.sampler()(u64::MAX, planned);
                sampler.start_sample(u32::MAX, sample);
                for vertex in [0, 1, 5, 1000, u32::MAX] {
                    let p = sampler.get_2d(vertex, Purpose::CameraConnection);
                    let u = sampler.get_1d(vertex, Purpose::Roulette);
                    assert!(p.cmpge(Vec2::ZERO).all() && p.cmplt(Vec2::ONE).all() && (0.0..1.0).contains(&u));
                }
            }
        }
    }
}

/// Means over stretches of samples that are less than a pattern, more than one, and past the planned number.
#[test]
fn estimates_are_unbiased_at_every_number_of_samples() {
    let integrand = |sampler: &mut dyn Sampler| {
        let (a, b) = (sampler.get_2d(0, Purpose::Film).as_dvec2(), sampler.get_2d(1, Purpose::LightPoint).as_dvec2());
        let c = f64::from(sampler.get_1d(1, Purpose::Lobe));
        a.x * a.x * (1.0 + b.y) * (1.0 + a.y * c) + if b.x + b.y < 0.7 { 1.0 } else { 0.0 }
    };
    let expected = 1.0 / 3.0 * 1.5 * 1.25 + 0.245;
    let runs = 3000;
    for pattern in Pattern::ALL {
        for (planned, samples) in [(16, 0..5), (16, 16..32), (16, 16..40), (0, 0..64), (0, 20..29), (7, 3..24)] {
            let (mut sum, mut squares) = (0.0, 0.0);
            for seed in 0..runs {
                let mut sampler = pattern.sampler()(seed, planned);
                let n = f64::from(samples.end - samples.start);
                let mean = samples
                    .clone()
                    .map(|sample| {
                        sampler.start_pixel(PIXEL, 100, sample);
                        integrand(&mut *sampler)
                    })
                    .sum::<f64>()
                    / n;
                sum += mean;
                squares += mean * mean;
            }
            let n = runs as f64;
            let variance = (squares - sum * sum / n) / (n - 1.0);
            let z = (sum / n - expected) / (variance / n).sqrt();
            assert!(z.abs() < 4.5, "{} {planned} {samples:?}: z = {z}", pattern.name());
        }
    }
}

/// A product of numbers of different addresses has no structure for a sampler to use, and none for it to fall over.
#[test]
fn products_of_addresses_are_estimated_no_worse_than_independently() {
    let runs = 5000;
    for pattern in Pattern::ALL {
        for planned in [0, 64] {
            for pair in [[0, 3], [3, 4], [5, 8]] {
                let [a, b] = pair.map(|i| ADDRESSES[i]);
                let squares: f64 = (0..runs)
                    .map(|seed| {
                        let mut sampler = pattern.sampler()(seed, planned);
                        let value = |sample| {
                            sampler.start_pixel(PIXEL, 100, sample);
                            let (u, v) = (sampler.get_2d(a.0, a.1).x, sampler.get_2d(b.0, b.1).x);
                            f64::from((u - 0.5) * (v - 0.5)) * 12.0
                        };
                        ((0..64).map(value).sum::<f64>() / 64.0).powi(2)
                    })
                    .sum();
                // 64 times the variance: 1 for independent numbers; 64 / 63 for any order of 64 strata, 15 / 63 more for
                // patterns of 16, 16 and 32. The sum is nearly a chi-square of 5000 degrees.
                let relative = squares / runs as f64 * 64.0;
                assert!(relative < 1.07 + 4.5 * (2.0 / runs as f64).sqrt(), "{} {pair:?}: {relative}", pattern.name());
            }
        }
    }
}

/// Every planned pattern, and the next, has one sample in each of as many parts.
#[test]
fn single_numbers_are_stratified() {
    for pattern in Pattern::ALL.into_iter().filter(|p| *p != Pattern::Independent) {
        for (planned, first, count) in [(16, 0, 16), (16, 16, 16), (0, 0, 16), (0, 16, 16), (0, 32, 32), (64, 64, 64)] {
            for (vertex, purpose) in [(7, Purpose::Lobe), (3, Purpose::LightWalkRoulette)] {
                let mut sampler = pattern.sampler()(3, planned);
                let mut seen = vec![0; count as usize];
                for sample in first..first + count {
                    sampler.start_sample(77, sample);
                    seen[(sampler.get_1d(vertex, purpose) * count as f32) as usize] += 1;
                }
                assert!(seen.iter().all(|&n| n == 1), "{} {planned} {first}: {seen:?}", pattern.name());
            }
        }
    }
}
