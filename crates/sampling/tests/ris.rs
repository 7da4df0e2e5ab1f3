//! Resampled importance sampling: its identity with Monte Carlo, its distribution and its weights.

use etendue_core::{
    independent::Independent,
    sampler::{Purpose, Sampler},
    statistics::{chi_square, moments::Moments},
};
use etendue_sampling::ris::{Candidate, Resampled, Resampling, Source, resample};
use proptest::prelude::*;

struct Random(Independent, u32);

impl Random {
    fn new(seed: u64) -> Random {
        Random(Independent::new(seed), 0)
    }

    fn next(&mut self) -> f32 {
        self.1 += 1;
        self.0.get_1d(self.1, Purpose::LightChoice)
    }
}

/// A source over eight equal bins of `[0, 1)` and a target that is in every bin an integer multiple of its density.
const SHARES: [f64; 8] = [0.05, 0.2, 0.1, 0.25, 0.05, 0.15, 0.1, 0.1];
const MULTIPLES: [usize; 8] = [3, 1, 0, 2, 12, 1, 5, 0];

fn bin(x: f64) -> usize {
    (x * 8.0) as usize
}

fn source(random: &mut Random) -> f64 {
    let (mut u, mut bin) = (f64::from(random.next()), 0);
    while u >= SHARES[bin] && bin < 7 {
        u -= SHARES[bin];
        bin += 1;
    }
    (bin as f64 + (u / SHARES[bin]).min(1.0 - f64::EPSILON)) / 8.0
}

fn pdf(x: f64) -> f64 {
    8.0 * SHARES[bin(x)]
}

fn target(x: f64) -> f64 {
    MULTIPLES[bin(x)] as f64 * pdf(x)
}

fn kept(random: &mut Random, count: u64) -> Option<Resampled<f64>> {
    let mut resampling = Resampling::default();
    for _ in 0..count {
        let x = source(random);
        resampling.update(Candidate::identical(x, pdf(x), count), target(x), random.next());
    }
    assert_eq!((resampling.count(), resampling.rejected()), (count, 0));
    resampling.finish()
}

/// The probability of every bin, and last of no sample: with `S` the sum of `count - 1` multiples, a bin of share `s` and
/// multiple `k` has probability `count s E[k / (k + S)]`. `S` is on a lattice, so that its distribution is a power of
/// convolution.
fn exact(count: u64) -> [f64; 9] {
    let mut sums = vec![1.0];
    for _ in 1..count {
        let mut next = vec![0.0; sums.len() + MULTIPLES.iter().max().unwrap()];
        for (sum, probability) in sums.iter().enumerate() {
            for (share, k) in SHARES.iter().zip(MULTIPLES) {
                next[sum + k] += share * probability;
            }
        }
        sums = next;
    }
    let mut result = [0.0; 9];
    for (bin, (&share, &k)) in SHARES.iter().zip(&MULTIPLES).enumerate().filter(|(_, (_, k))| **k > 0) {
        let mean: f64 = sums.iter().enumerate().map(|(sum, p)| p * k as f64 / (k + sum) as f64).sum();
        result[bin] = count as f64 * share * mean;
    }
    let nothing: f64 = SHARES.iter().zip(MULTIPLES).filter(|(_, k)| *k == 0).map(|(share, _)| share).sum();
    result[8] = nothing.powi(count as i32);
    assert!((result.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    result
}

/// What `exact` tends to.
fn limit() -> [f64; 9] {
    let sum: f64 = SHARES.iter().zip(MULTIPLES).map(|(share, k)| share * k as f64).sum();
    std::array::from_fn(|bin| if bin < 8 { SHARES[bin] * MULTIPLES[bin] as f64 / sum } else { 0.0 })
}

/// p-value of runs against probabilities; runs without a sample are left out where they have probability 0.
fn p_value(count: u64, runs: u32, probabilities: &[f64; 9]) -> f64 {
    let mut random = Random::new(count);
    let mut counts = [0; 9];
    for _ in 0..runs {
        counts[kept(&mut random, count).map_or(8, |k| bin(k.sample))] += 1;
    }
    if probabilities[8] == 0.0 {
        counts[8] = 0;
    }
    let total: u64 = counts.iter().sum();
    chi_square::test(&counts, &probabilities.map(|p| p * total as f64), 5.0).p_value
}

#[test]
fn the_sample_has_the_density_that_so_many_candidates_give() {
    for count in [1, 4, 16, 64] {
        let p = p_value(count, 200_000, &exact(count));
        assert!(p > chi_square::sidak(1e-4, 4), "{count} candidates: {p}");
    }
}

#[test]
fn the_density_tends_to_the_target() {
    let distance = |count| exact(count).iter().zip(limit()).map(|(a, b)| (a - b).abs()).sum::<f64>() / 2.0;
    let distances = [1, 4, 16, 64].map(distance);
    // As 1 / M in the end.
    assert!(distances.windows(2).all(|d| d[1] < 0.5 * d[0]), "{distances:?}");
    assert!((distances[2] / distances[3] / 4.0 - 1.0).abs() < 0.2, "{distances:?}");
    for (count, accepted) in [(1, false), (4, false), (16, false), (1024, true)] {
        let p = p_value(count, 20_000, &limit());
        assert_eq!(p > 1e-4, accepted, "{count} candidates: {p}");
    }
}

/// The mean of `W` over each of ten bins, which is the bin's measure where the target is positive.
fn assert_contributions(name: &str, measures: [f64; 10], mut run: impl FnMut(&mut Random) -> Option<Resampled<f64>>) {
    let mut random = Random::new(11);
    let mut moments = [Moments::default(); 10];
    for _ in 0..100_000 {
        let kept = run(&mut random);
        for (bin, moments) in moments.iter_mut().enumerate() {
            let inside = kept.filter(|k| (k.sample * 10.0) as usize == bin);
            moments.push(inside.map_or(0.0, |k| k.contribution));
        }
    }
    for (bin, (m, measure)) in moments.iter().zip(measures).enumerate() {
        let z = (m.mean() - measure) / m.standard_error();
        let exact = m.mean() == 0.0 && measure == 0.0;
        assert!(exact || z.abs() < 4.0, "{name}, bin {bin}: {} against {measure}, z = {z}", m.mean());
    }
}

fn hill(x: f64) -> f64 {
    if (0.4..0.5).contains(&x) { 0.0 } else { 0.1 + x * (1.0 - x) * x }
}

const HILL: [f64; 10] = [0.1, 0.1, 0.1, 0.1, 0.0, 0.1, 0.1, 0.1, 0.1, 0.1];

#[test]
fn contribution_weights_stand_for_one_over_the_density() {
    for count in [1, 2, 7, 32] {
        assert_contributions(&format!("{count} candidates"), HILL, |random| {
            // Density 1/2 + (1 - x): one half of it uniform, the other falling to 0.
            let candidates = (0..count).map(|_| {
                let u = f64::from(random.next());
                let x = if u < 0.5 { u * 2.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() };
                Candidate::identical(x.min(1.0 - f64::EPSILON), 0.5 + (1.0 - x), count)
            });
            let candidates: Vec<_> = candidates.collect();
            resample(candidates, |x| hill(*x), || random.next())
        });
    }
}

#[test]
fn so_they_do_where_their_number_is_known_in_the_end() {
    assert_contributions("counted", HILL, |random| {
        let mut resampling = Resampling::default();
        for _ in 0..5 {
            resampling.update(Candidate::identical(f64::from(random.next()), 1.0, 1), hill(0.0), random.next());
        }
        let count = resampling.count() as f64;
        let mut kept = resampling.finish()?;
        kept.contribution /= count;
        (hill(kept.sample) > 0.0).then_some(kept)
    });
}

/// Sources on `[0, 0.6)`, on `[0.3, 1)` rising from a density of 0, and of a zero count.
#[test]
fn so_they_do_with_sources_of_different_supports() {
    let densities =
        |x: f64| [if x < 0.6 { 1.0 / 0.6 } else { 0.0 }, if x >= 0.3 { (x - 0.3) * 2.0 / 0.49 } else { 0.0 }, 1.0];
    for counts in [[1, 1, 0], [3, 2, 0], [1, 16, 0]] {
        assert_contributions(&format!("{counts:?}"), HILL, |random| {
            let mut candidates = Vec::new();
            for (technique, count) in counts.into_iter().enumerate() {
                for _ in 0..count {
                    let u = f64::from(random.next());
                    let x = [0.6 * u, 0.3 + 0.7 * u.sqrt(), u][technique];
                    let sources: [Source; 3] =
                        std::array::from_fn(|k| Source { count: counts[k], pdf: densities(x)[k] });
                    candidates.push(Candidate::balanced(x, &sources));
                }
            }
            resample(candidates, |x| hill(*x), || random.next())
        });
    }
    // Where no source can be, nothing is: a half of [0, 1) alone.
    let half = [0.1, 0.1, 0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_contributions("half", half, |random| {
        let x = 0.5 * f64::from(random.next());
        resample([Candidate::identical(x, 2.0, 1)], |x| hill(*x), || random.next())
    });
}

/// Candidates may depend on each other: here they are one shifted grid.
#[test]
fn so_they_do_with_candidates_that_depend_on_each_other() {
    assert_contributions("grid", HILL, |random| {
        let shift = f64::from(random.next());
        let grid = (0..8).map(|k| Candidate::identical((shift + f64::from(k)) / 8.0, 1.0, 8));
        resample(grid, |x| hill(*x), || random.next())
    });
}

/// What was resampled towards one target is resampled towards another.
#[test]
fn so_they_do_in_a_chain() {
    assert_contributions("chain", HILL, |random| {
        let first = |target: &dyn Fn(f64) -> f64, random: &mut Random| {
            let candidates: Vec<_> = (0..4).map(|_| Candidate::identical(f64::from(random.next()), 1.0, 4)).collect();
            resample(candidates, |x| target(*x), || random.next())
        };
        let kept = [first(&|x| 0.1 + x, random), first(&|x| 1.1 - x * x, random)];
        let chained = kept.into_iter().flatten().map(|k| Candidate { sample: k.sample, weight: 0.5 * k.contribution });
        resample(chained, |x| hill(*x), || random.next())
    });
}

#[test]
fn a_target_that_is_mostly_zero_counts_its_zeros() {
    let spike = |x: &f64| if *x < 0.02 { 1.0 } else { 0.0 };
    let mut random = Random::new(3);
    let mut estimate = Moments::default();
    let mut empty = 0;
    for _ in 0..200_000 {
        let candidates: Vec<_> = (0..4).map(|_| Candidate::identical(f64::from(random.next()), 1.0, 4)).collect();
        let kept = resample(candidates, spike, || random.next());
        empty += u32::from(kept.is_none());
        estimate.push(kept.map_or(0.0, |k| k.sample * k.contribution));
    }
    let z = (estimate.mean() - 0.0002) / estimate.standard_error();
    assert!(z.abs() < 4.0, "{z}");
    assert!(empty > 180_000, "{empty}");
    assert!(resample([Candidate::identical(0.5, 1.0, 1)], |_| 0.0, || 0.0).is_none());
}

#[test]
fn no_candidate_and_one_candidate() {
    assert_eq!(Resampling::<f64>::default().finish(), None);
    // The weight of one candidate is one over its density, whatever the target.
    for target in [1e-300, 0.3, 1e300] {
        let one = resample([Candidate::identical("x", 0.25, 1)], |_| target, || 0.999).unwrap();
        assert_eq!((one.sample, one.target), ("x", target));
        assert!((one.contribution / 4.0 - 1.0).abs() <= f64::EPSILON);
    }
}

#[test]
fn what_is_no_weight_is_refused_and_counted() {
    let mut resampling = Resampling::default();
    let bad = [f64::NAN, f64::INFINITY, -1.0];
    for value in bad {
        assert!(!resampling.update(Candidate { sample: (), weight: 1.0 }, value, 0.0));
        assert!(!resampling.update(Candidate { sample: (), weight: value }, 1.0, 0.0));
        assert!(!resampling.update(Candidate { sample: (), weight: value }, 0.0, 0.0));
    }
    // No source can make it.
    assert!(!resampling.update(Candidate::balanced((), &[Source { count: 3, pdf: 0.0 }]), 1.0, 0.0));
    assert!(!resampling.update(Candidate::balanced((), &[]), 1.0, 0.0));
    assert_eq!((resampling.count(), resampling.rejected()), (11, 11));
    assert!(resampling.update(Candidate::identical((), 0.5, 12), 3.0, 0.9));
    assert_eq!(resampling.finish(), Some(Resampled { sample: (), target: 3.0, contribution: 1.0 / 6.0 }));
}

proptest! {
    /// With the integrand as the target, one sample gives the Monte Carlo estimate of all candidates.
    #[test]
    fn with_the_integrand_as_target_it_is_monte_carlo(
        candidates in prop::collection::vec((1e-9..1e3_f64, 1e-3..1e3_f64), 1..100), u in 0.0..1.0_f32,
    ) {
        let count = candidates.len() as u64;
        let mean = candidates.iter().map(|(f, p)| f / p).sum::<f64>() / count as f64;
        let stream = candidates.iter().map(|&(f, p)| Candidate::identical(f, p, count));
        let kept = resample(stream, |f| *f, || u).unwrap();
        prop_assert!((kept.target * kept.contribution / mean - 1.0).abs() <= 1e-13);
    }

    /// The same for several sources: the multi-sample estimate by the balance heuristic.
    #[test]
    fn and_so_with_several_sources(
        candidates in prop::collection::vec((1e-9..1e3_f64, 0.0..10.0_f64, 1e-3..1e3_f64), 1..60), u in 0.0..1.0_f32,
    ) {
        let (first, second) = (candidates.len() as u64 / 3, candidates.len() as u64 - candidates.len() as u64 / 3);
        let mut estimate = 0.0;
        let mut stream = Vec::new();
        for (i, &(f, a, b)) in candidates.iter().enumerate() {
            // Those of the first source are where its density is positive.
            let a = if (i as u64) < first { a.max(1e-3) } else { a };
            let own = if (i as u64) < first { a } else { b };
            let weight = own / (first as f64 * a + second as f64 * b);
            estimate += weight * f / own;
            stream.push(Candidate::balanced(f, &[Source { count: first, pdf: a }, Source { count: second, pdf: b }]));
        }
        let kept = resample(stream, |f| *f, || u).unwrap();
        prop_assert!((kept.target * kept.contribution / estimate - 1.0).abs() <= 1e-13);
    }
}
