//! What a technique counts while it renders.

use std::time::Duration;

/// Rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rays {
    /// From the camera.
    pub camera: u64,
    /// Continuing a path at a surface.
    pub scatter: u64,
    /// Testing visibility between two points.
    pub shadow: u64,
    /// From a light.
    pub light: u64,
}

impl Rays {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.camera + self.scatter + self.shadow + self.light
    }
}

/// A sample that was not finite or was negative, and so was left out of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RejectedSample {
    /// Pass.
    pub pass: u32,
    /// Row of the pixel.
    pub y: u32,
    /// Column of the pixel.
    pub x: u32,
    /// Technique that made it.
    pub technique: &'static str,
}

/// Counts of a render; merging is associative and commutative, so they do not depend on the number of threads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderStatistics {
    /// Rays by kind.
    pub rays: Rays,
    /// Number of rejected samples.
    pub rejected: u64,
    /// The first of the rejected samples (at most [`RenderStatistics::REJECTED_KEPT`]) in order of pass, row, column.
    pub rejected_samples: Vec<RejectedSample>,
    /// Bytes held by the technique's own structures and the scene's hierarchy.
    pub memory_bytes: u64,
    /// Time by phase (such as "build", "pass"), in order of first appearance; zero-time phases are not listed.
    pub phases: Vec<(&'static str, Duration)>,
}

impl RenderStatistics {
    /// How many rejected samples are kept with their place.
    pub const REJECTED_KEPT: usize = 16;

    /// Counts a rejected sample.
    pub fn reject(&mut self, sample: RejectedSample) {
        self.rejected += 1;
        self.rejected_samples.push(sample);
        self.trim();
    }

    /// Adds time to a phase.
    pub fn add_time(&mut self, phase: &'static str, time: Duration) {
        match self.phases.iter_mut().find(|(name, _)| *name == phase) {
            Some((_, total)) => *total += time,
            None => self.phases.push((phase, time)),
        }
    }

    /// Adds what another part of the render counted.
    pub fn merge(&mut self, other: &RenderStatistics) {
        self.rays.camera += other.rays.camera;
        self.rays.scatter += other.rays.scatter;
        self.rays.shadow += other.rays.shadow;
        self.rays.light += other.rays.light;
        self.rejected += other.rejected;
        self.rejected_samples.extend_from_slice(&other.rejected_samples);
        self.trim();
        self.memory_bytes += other.memory_bytes;
        for (phase, time) in &other.phases {
            self.add_time(phase, *time);
        }
    }

    fn trim(&mut self) {
        self.rejected_samples.sort_unstable();
        self.rejected_samples.truncate(Self::REJECTED_KEPT);
    }
}
