//! The list of samplers: a new one is one line here.

use crate::error::Error;
use etendue_core::sampler::SamplerBuilder;
use etendue_sampling::pattern::Pattern;

/// A sampler as it is listed.
pub struct SamplerInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// Makes it.
    pub build: SamplerBuilder,
}

/// Every sampler that the command line knows.
pub static SAMPLERS: &[SamplerInfo] = &[
    SamplerInfo::of(Pattern::Independent),
    SamplerInfo::of(Pattern::Grid),
    SamplerInfo::of(Pattern::Jittered),
    SamplerInfo::of(Pattern::UniformJitter),
    SamplerInfo::of(Pattern::MultiJittered),
    SamplerInfo::of(Pattern::CorrelatedMultiJittered),
    SamplerInfo::of(Pattern::Halton),
    SamplerInfo::of(Pattern::Sobol),
    SamplerInfo::of(Pattern::PoissonDisk),
    SamplerInfo::of(Pattern::BestCandidate),
    SamplerInfo::of(Pattern::Mitchell),
    SamplerInfo::of(Pattern::BlueNoiseDithered),
];

impl SamplerInfo {
    const fn of(pattern: Pattern) -> SamplerInfo {
        SamplerInfo { name: pattern.name(), build: pattern.sampler() }
    }
}

/// The sampler of a name.
pub fn find(name: &str) -> Result<&'static SamplerInfo, Error> {
    SAMPLERS.iter().find(|s| s.name == name).ok_or_else(|| {
        let known: Vec<&str> = SAMPLERS.iter().map(|s| s.name).collect();
        Error::Input(format!("there is no sampler `{name}`; there is: {}", known.join(", ")))
    })
}
