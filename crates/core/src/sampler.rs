//! Random numbers, addressed by where they are used.

use glam::{UVec2, Vec2};

/// What a number is used for at a path vertex.
///
/// A number's address is (seed, pixel, sample, vertex, purpose), so that leaving a feature out shifts no other number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Purpose {
    /// Position within the pixel's filter (2D, vertex 0).
    Film = 0,
    /// Position on the lens (2D, vertex 0).
    Lens,
    /// Choice of a light for next-event estimation (1D).
    LightChoice,
    /// Point or direction on that light (2D).
    LightPoint,
    /// Choice among the lobes of a BSDF (1D).
    Lobe,
    /// Direction from a lobe (2D).
    Direction,
    /// Russian roulette (1D).
    Roulette,
    /// Choice of a light to emit from (1D, vertex 0 of a walk from a light).
    EmissionChoice,
    /// Point on the emitting light (2D).
    EmissionPoint,
    /// Direction of emission (2D).
    EmissionDirection,
    /// As [`Purpose::Lobe`], on a walk from a light.
    LightWalkLobe,
    /// As [`Purpose::Direction`], on a walk from a light.
    LightWalkDirection,
    /// As [`Purpose::Roulette`], on a walk from a light.
    LightWalkRoulette,
    /// Point on the lens when a walk from a light is connected to the camera (2D).
    CameraConnection,
    /// Which of several candidates of next-event estimation is kept (1D).
    LightCandidate,
    /// Which connections are tested for what lies between: of two walks to each other (1D, vertex 0), of one to the camera (1D).
    Connections,
}

/// A source of numbers in `[0, 1)`; 1 itself is never returned.
///
/// Two calls with the same address return the same number.
pub trait Sampler: Send {
    /// Moves to sample `sample` of pixel (or light path) `index`.
    fn start_sample(&mut self, index: u32, sample: u32);

    /// Moves to sample `sample` of a pixel of an image that is `width` pixels wide.
    ///
    /// The same as [`start_sample`](Sampler::start_sample) with the pixel's number in scanline order, except for
    /// samplers that relate neighbouring pixels' numbers.
    #[inline]
    fn start_pixel(&mut self, pixel: UVec2, width: u32, sample: u32) {
        self.start_sample(pixel.y * width + pixel.x, sample);
    }

    /// One number in `[0, 1)`.
    fn get_1d(&mut self, vertex: u32, purpose: Purpose) -> f32;

    /// Two numbers in `[0, 1)`.
    fn get_2d(&mut self, vertex: u32, purpose: Purpose) -> Vec2;
}

/// Makes a sampler from a seed and the number of samples a pixel that are planned (0: unknown).
pub type SamplerBuilder = fn(seed: u64, planned: u32) -> Box<dyn Sampler>;
