//! What a rendering technique is to whoever drives it.

use crate::{film::Film, sampler::SamplerBuilder, scene::Scene, statistics::render::RenderStatistics, walk::Limits};
use std::sync::Arc;

/// How a technique's error behaves: it chooses the test that the technique faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// The expected image of a pass is the true one.
    Unbiased,
    /// The expected image tends to the true one as passes go on.
    Consistent,
    /// The expected image differs from the true one by a bounded amount that falls with a knob.
    Bounded,
}

/// Parts of the light that reaches the film; every contribution belongs to exactly one. A vertex is rough where it scatters by
/// a lobe that is no delta.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Part {
    /// A light or the environment seen directly or by way of delta lobes alone: no rough vertex in between.
    Emission = 0,
    /// One rough vertex, lit straight from an area, point, spot or directional light.
    Direct,
    /// One rough vertex, lit straight from the environment.
    Environment,
    /// A rough vertex lit from a light or the environment by way of at least one delta lobe.
    Caustic,
    /// Everything else: two rough vertices or more, the last of them lit straight from the light.
    Indirect,
}

impl Part {
    /// All parts in order.
    pub const ALL: [Part; 5] = [Part::Emission, Part::Direct, Part::Environment, Part::Caustic, Part::Indirect];

    /// Its name in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Part::Emission => "emission",
            Part::Direct => "direct",
            Part::Environment => "environment",
            Part::Caustic => "caustic",
            Part::Indirect => "indirect",
        }
    }
}

/// A set of [`Part`]s.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts(u8);

impl Parts {
    /// Every part.
    pub const ALL: Parts = Parts(31);
    /// No part.
    pub const NONE: Parts = Parts(0);

    /// This set and one part more.
    #[must_use]
    pub const fn with(self, part: Part) -> Parts {
        Parts(self.0 | 1 << part as u8)
    }

    /// Whether it holds a part.
    #[inline]
    pub const fn contains(self, part: Part) -> bool {
        self.0 >> part as u8 & 1 != 0
    }
}

/// Light that not every technique can render: chains of vertices in which delta lobes, or a light without an extent, leave
/// no direction and no point to choose.
///
/// Mirrors, glass and the holes of masks are delta lobes; point, spot and directional lights and projectors have no extent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chain {
    /// A light without an extent, seen in mirrors or through glass: the camera, delta lobes, the light.
    LightThroughDelta,
    /// A rough surface lit by a light without an extent by way of delta lobes.
    Caustic,
    /// That, seen by way of delta lobes in its turn.
    CausticThroughDelta,
    /// Rough surfaces, whatever lights them, seen by way of delta lobes.
    SurfaceThroughDelta,
}

impl Chain {
    /// Every chain.
    pub const ALL: [Chain; 4] =
        [Chain::LightThroughDelta, Chain::Caustic, Chain::CausticThroughDelta, Chain::SurfaceThroughDelta];

    /// Edges of the shortest path of the chain.
    pub const fn edges(self) -> u32 {
        match self {
            Chain::LightThroughDelta => 2,
            Chain::Caustic | Chain::SurfaceThroughDelta => 3,
            Chain::CausticThroughDelta => 4,
        }
    }

    /// Returns `true` if its light can belong to one of `parts`.
    pub const fn meets(self, parts: Parts) -> bool {
        match self {
            Chain::LightThroughDelta => parts.contains(Part::Emission),
            Chain::Caustic | Chain::CausticThroughDelta => parts.contains(Part::Caustic),
            Chain::SurfaceThroughDelta => parts.0 & !Parts::NONE.with(Part::Emission).0 != 0,
        }
    }
}

/// What every technique is told.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Longest path, counted as in Mitsuba: 1 is emission alone, 2 adds direct light. At least 1.
    pub max_depth: u32,
    /// Depth from which Russian roulette may end a path.
    pub roulette_depth: u32,
    /// Parts of the light to render.
    pub parts: Parts,
    /// Random numbers.
    pub sampler: SamplerBuilder,
    /// Passes that are planned, 0 when unknown.
    pub planned_passes: u32,
}

impl Settings {
    /// Every part of the light, roulette from depth 5, an unknown number of passes.
    pub fn new(max_depth: u32, sampler: SamplerBuilder) -> Settings {
        Settings { max_depth, roulette_depth: 5, parts: Parts::ALL, sampler, planned_passes: 0 }
    }

    /// Where a walk ends.
    #[inline]
    pub fn limits(&self) -> Limits {
        Limits { max_depth: self.max_depth, roulette_depth: self.roulette_depth }
    }
}

/// A numeric setting of one technique, as data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, one line.
    pub summary: &'static str,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Value when it is not given.
    pub default: f64,
    /// `true` for a knob that takes whole numbers alone.
    pub whole: bool,
}

/// Builds a technique for a scene, with a value for each of its knobs.
pub type TechniqueBuilder = fn(scene: Arc<Scene>, settings: Settings, knobs: &[f64]) -> Box<dyn Technique>;

/// A technique as it is registered.
pub struct TechniqueInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// What it is, one line.
    pub summary: &'static str,
    /// Where it was published.
    pub paper: &'static str,
    /// How its error behaves.
    pub bias: Bias,
    /// The parts of the light that it converges on.
    pub covers: Parts,
    /// What it does not cover, one line; empty: it covers everything.
    pub blind_spots: &'static str,
    /// The same for programs: chains that it never makes with certain values of its knobs.
    pub misses: fn(knobs: &[f64]) -> &'static [Chain],
    /// Its own settings.
    pub knobs: &'static [Knob],
    /// Builds it for a scene; `knobs` holds one value for each entry of `knobs`, in order and in range.
    pub build: TechniqueBuilder,
}

/// A technique at work on a scene.
pub trait Technique: Send {
    /// Adds one estimate of the whole image to the film. The same (seed, pass) adds the same bits on any number of
    /// threads.
    fn pass(&mut self, seed: u64, pass: u32, film: &mut Film);

    /// What it has counted so far.
    fn statistics(&self) -> &RenderStatistics;

    /// Goes on with the next frame's scene, of which what is unchanged may be reused.
    fn next_frame(&mut self, scene: Arc<Scene>);
}
