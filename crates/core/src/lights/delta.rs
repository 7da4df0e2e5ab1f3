//! Lights without an extent, ready to render.

use super::{picture::Picture, polar::Band};
use crate::{frame::Frame, rgb::Rgb, scene::DeltaLight, texture::Texture};
use glam::{Vec2, Vec3};
use std::f64::consts::PI;

/// A light without an extent in the rendered world.
#[derive(Clone, Debug)]
pub(super) enum Delta {
    Point {
        position: Vec3,
        intensity: Rgb,
    },
    Spot {
        position: Vec3,
        intensity: Rgb,
        cone: SpotCone,
    },
    /// A spot light with a picture, or a projector.
    Picture(Box<Picture>),
    /// `direction` is where the light travels to.
    Directional {
        direction: Vec3,
        irradiance: Rgb,
    },
}

/// The angular shape of a spot light.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpotCone {
    /// Unit axis.
    pub axis: Vec3,
    /// Half-angle of full intensity.
    beam: f32,
    /// Half-angle beyond which there is none.
    cutoff: f32,
    /// Integral of the falloff over the sphere, steradians.
    integral: f32,
}

impl From<&DeltaLight> for Delta {
    fn from(light: &DeltaLight) -> Delta {
        match light.clone() {
            DeltaLight::Point { position, intensity } => Delta::Point { position: position.as_vec3(), intensity },
            DeltaLight::Spot { position, direction, intensity, beam, cutoff, image } => {
                let cone = SpotCone::new(direction.normalize().as_vec3(), beam, cutoff);
                let plain = |intensity| Delta::Spot { position: position.as_vec3(), intensity, cone };
                match image {
                    None => plain(intensity),
                    Some((Texture::Constant(factor), _)) => plain(intensity * factor),
                    Some(image) => Delta::Picture(Box::new(Picture::spot(position, (cone, cutoff), intensity, image))),
                }
            }
            DeltaLight::Projector { to_world, fov_x, aspect, irradiance } => {
                Delta::Picture(Box::new(Picture::projector(&to_world, fov_x, aspect, irradiance)))
            }
            DeltaLight::Directional { direction, irradiance } => {
                Delta::Directional { direction: direction.normalize().as_vec3(), irradiance }
            }
        }
    }
}

impl Delta {
    /// Position in the world; `None` for a light at infinity.
    #[inline]
    pub fn position(&self) -> Option<Vec3> {
        match self {
            Delta::Point { position, .. } | Delta::Spot { position, .. } => Some(*position),
            Delta::Picture(picture) => Some(picture.position),
            Delta::Directional { .. } => None,
        }
    }

    /// Flux in watts, by luminance; a directional light's through a disk of the radius of the world.
    pub fn flux(&self, world_radius: f32) -> f64 {
        match self {
            Delta::Point { intensity, .. } => 4.0 * PI * f64::from(intensity.luminance()),
            Delta::Spot { intensity, cone, .. } => f64::from(cone.integral) * f64::from(intensity.luminance()),
            Delta::Picture(picture) => picture.flux,
            Delta::Directional { irradiance, .. } => {
                PI * f64::from(world_radius).powi(2) * f64::from(irradiance.luminance())
            }
        }
    }
}

impl SpotCone {
    fn new(axis: Vec3, beam: f64, cutoff: f64) -> SpotCone {
        let (beam, cutoff) = (beam.min(cutoff), cutoff.min(PI));
        let (inner, outer) = shares(beam, cutoff);
        SpotCone { axis, beam: beam as f32, cutoff: cutoff as f32, integral: (inner + outer) as f32 }
    }

    /// The part of the axial intensity that goes into a unit direction.
    #[inline]
    pub fn falloff(&self, direction: Vec3) -> f32 {
        // By the arc tangent: the arc cosine loses small angles.
        let theta = direction.cross(self.axis).length().atan2(direction.dot(self.axis));
        if theta <= self.beam {
            1.0
        } else if theta < self.cutoff {
            (self.cutoff - theta) / (self.cutoff - self.beam)
        } else {
            0.0
        }
    }

    /// Samples a direction with density proportional to the falloff.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let (beam, cutoff) = (f64::from(self.beam), f64::from(self.cutoff));
        let (inner, outer) = shares(beam, cutoff);
        let x = f64::from(u.x) * (inner + outer);
        let theta = if x < inner {
            // 1 - cos(theta) is uniform; by the half-angle, which keeps small angles.
            2.0 * ((0.5 * beam).sin() * (x / inner).sqrt()).asin()
        } else {
            let band = Band::new(beam, cutoff - beam);
            beam + band.width * band.sample(1.0, 0.0, ((x - inner) / outer).min(1.0))
        };
        let (sin, cos) = (theta as f32).sin_cos();
        let (sin_phi, cos_phi) = (2.0 * std::f32::consts::PI * u.y).sin_cos();
        Frame::from_normal(self.axis).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos))
    }

    /// Density of [`SpotCone::sample`] per steradian.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        if self.integral > 0.0 { self.falloff(direction) / self.integral } else { 0.0 }
    }
}

/// Integrals of the falloff within `beam`, and from there to `cutoff`, in steradians.
fn shares(beam: f64, cutoff: f64) -> (f64, f64) {
    let (falling, _) = Band::new(beam, cutoff - beam).weights();
    (4.0 * PI * (0.5 * beam).sin().powi(2), 2.0 * PI * (cutoff - beam) * falling)
}
