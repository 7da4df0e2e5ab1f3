//! The list of patterns.

use crate::{blue_noise, halton, sampler, sobol, stratified};
use etendue_core::{
    digest::mix,
    independent::{self, unit},
    sampler::{Purpose, SamplerBuilder},
};
use glam::{UVec2, Vec2};

/// A way to put points into the unit square, and to give a path its numbers.
///
/// ```
/// use etendue_sampling::pattern::Pattern;
/// for pattern in Pattern::ALL {
///     assert_eq!(pattern.points(61, 7).len(), 61, "{}", pattern.name());
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pattern {
    /// Independent uniform points: [`independent()`].
    Independent,
    /// Middles of equal strata: [`stratified::grid`].
    Grid,
    /// A random point in each stratum: [`stratified::jittered`].
    Jittered,
    /// The same random offset in each stratum: [`stratified::uniform_jitter`].
    UniformJitter,
    /// Jittered in squares, columns and rows: [`stratified::multi_jittered`].
    MultiJittered,
    /// The same, arranged alike everywhere: [`stratified::correlated_multi_jittered`].
    CorrelatedMultiJittered,
    /// Bases 2 and 3, scrambled: [`halton::halton`].
    Halton,
    /// Base 2, Owen-scrambled: [`sobol::sobol`].
    Sobol,
    /// None near another: [`blue_noise::poisson_disk`].
    PoissonDisk,
    /// Each the farthest of several from all before: [`blue_noise::best_candidate`].
    BestCandidate,
    /// Stratified, and assigned across pixels: [`sampler::mitchell`]. As points, those of one pixel on a light.
    Mitchell,
    /// Sobol points, shifted for each pixel by a blue-noise mask: [`sampler::blue_noise_dithered`]. As points, those of
    /// one pixel.
    BlueNoiseDithered,
}

impl Pattern {
    /// Every pattern.
    pub const ALL: [Pattern; 12] = [
        Pattern::Independent,
        Pattern::Grid,
        Pattern::Jittered,
        Pattern::UniformJitter,
        Pattern::MultiJittered,
        Pattern::CorrelatedMultiJittered,
        Pattern::Halton,
        Pattern::Sobol,
        Pattern::PoissonDisk,
        Pattern::BestCandidate,
        Pattern::Mitchell,
        Pattern::BlueNoiseDithered,
    ];

    /// Its name: lower case, with hyphens.
    pub const fn name(self) -> &'static str {
        match self {
            Pattern::Independent => "independent",
            Pattern::Grid => "grid",
            Pattern::Jittered => "jittered",
            Pattern::UniformJitter => "uniform-jitter",
            Pattern::MultiJittered => "multi-jittered",
            Pattern::CorrelatedMultiJittered => "correlated-multi-jittered",
            Pattern::Halton => "halton",
            Pattern::Sobol => "sobol",
            Pattern::PoissonDisk => "poisson-disk",
            Pattern::BestCandidate => "best-candidate",
            Pattern::Mitchell => "mitchell",
            Pattern::BlueNoiseDithered => "blue-noise-dithered",
        }
    }

    /// `count` points in `[0, 1)^2`. The same seed gives the same bits; the grid takes no notice of it.
    pub fn points(self, count: u32, seed: u64) -> Vec<Vec2> {
        match self {
            Pattern::Independent => independent(count, seed),
            Pattern::Grid => stratified::grid(count),
            Pattern::Jittered => stratified::jittered(count, seed),
            Pattern::UniformJitter => stratified::uniform_jitter(count, seed),
            Pattern::MultiJittered => stratified::multi_jittered(count, seed),
            Pattern::CorrelatedMultiJittered => stratified::correlated_multi_jittered(count, seed),
            Pattern::Halton => halton::halton(count, seed),
            Pattern::Sobol => sobol::sobol(count, seed),
            Pattern::PoissonDisk => blue_noise::poisson_disk(count, seed).points,
            Pattern::BestCandidate => blue_noise::best_candidate(count, seed),
            Pattern::Mitchell | Pattern::BlueNoiseDithered => self.points_of_a_pixel(count, seed),
        }
    }

    /// What makes the sampler of this pattern.
    pub const fn sampler(self) -> SamplerBuilder {
        match self {
            Pattern::Independent => independent::independent,
            Pattern::Grid => sampler::grid,
            Pattern::Jittered => sampler::jittered,
            Pattern::UniformJitter => sampler::uniform_jitter,
            Pattern::MultiJittered => sampler::multi_jittered,
            Pattern::CorrelatedMultiJittered => sampler::correlated_multi_jittered,
            Pattern::Halton => sampler::halton,
            Pattern::Sobol => sampler::sobol,
            Pattern::PoissonDisk => sampler::poisson_disk,
            Pattern::BestCandidate => sampler::best_candidate,
            Pattern::Mitchell => sampler::mitchell,
            Pattern::BlueNoiseDithered => sampler::blue_noise_dithered,
        }
    }

    /// What a sampler gives a pixel, whose place depends on the seed, as points on the first light.
    fn points_of_a_pixel(self, count: u32, seed: u64) -> Vec<Vec2> {
        let mut sampler = self.sampler()(seed, count);
        let pixel = UVec2::from(stratified::jitter(mix(seed), 0)) >> 20;
        let point = |sample| {
            sampler.start_pixel(pixel, 1 << 12, sample);
            sampler.get_2d(1, Purpose::LightPoint)
        };
        (0..count).map(point).collect()
    }
}

/// `count` independent points.
pub fn independent(count: u32, seed: u64) -> Vec<Vec2> {
    let key = mix(seed ^ 0x2f63_9b04_8c5e_d717);
    let word = |i: u32| stratified::jitter(key, i);
    (0..count).map(|i| Vec2::from(word(i).map(unit))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNTS: [u32; 16] = [0, 1, 2, 3, 4, 5, 7, 8, 13, 16, 61, 64, 97, 127, 256, 1009];

    #[test]
    fn every_pattern_has_as_many_points_as_asked_for_in_the_square() {
        for pattern in Pattern::ALL {
            for count in COUNTS {
                for seed in [0, 1, u64::MAX] {
                    let points = pattern.points(count, seed);
                    assert_eq!(points.len(), count as usize, "{}", pattern.name());
                    let inside = |p: &Vec2| p.cmpge(Vec2::ZERO).all() && p.cmplt(Vec2::ONE).all();
                    assert!(points.iter().all(inside), "{} of {count}", pattern.name());
                    assert_eq!(points, pattern.points(count, seed), "{} of {count}", pattern.name());
                }
            }
        }
    }

    #[test]
    fn seeds_and_patterns_differ() {
        for pattern in Pattern::ALL {
            let points = pattern.points(64, 1);
            let same = pattern == Pattern::Grid;
            assert_eq!(points == pattern.points(64, 2), same, "{}", pattern.name());
            for other in Pattern::ALL {
                assert_eq!(points == other.points(64, 1), pattern == other, "{} {}", pattern.name(), other.name());
            }
        }
    }

    #[test]
    fn names_are_plain_and_differ() {
        let names: std::collections::BTreeSet<&str> = Pattern::ALL.into_iter().map(Pattern::name).collect();
        assert_eq!(names.len(), Pattern::ALL.len());
        assert!(names.iter().all(|n| n.chars().all(|c| c.is_ascii_lowercase() || c == '-')));
    }
}
