//! Scattering at surfaces.

use crate::rgb::Rgb;
use glam::{Vec2, Vec3};

/// What a path carries: it decides the scaling at a refracting boundary [Veach 1997, sec. 5.2].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// The path started at the camera; radiance flows against it.
    Radiance,
    /// The path started at a light; importance flows against it.
    Importance,
}

/// Microfacet distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Trowbridge-Reitz [Walter et al. 2007].
    Ggx,
    /// Beckmann [Walter et al. 2007].
    Beckmann,
}

/// Roughness of a microfacet surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Shape of the distribution.
    pub distribution: Distribution,
    /// Roughness along the tangent and the bitangent, each in `[1e-4, 1]`.
    pub alpha: Vec2,
}

/// Reflectance of a conductor at its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConductorFresnel {
    /// The same at every angle: an ideal mirror is `Constant(Rgb::WHITE)`.
    Constant(Rgb),
    /// Complex index of refraction `eta + i k` relative to the outside, times a tint.
    Complex {
        /// Real part.
        eta: Rgb,
        /// Imaginary part (extinction), positive.
        k: Rgb,
        /// Factor on the reflectance.
        tint: Rgb,
    },
}

/// One way of scattering, by value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// Constant diffuse reflection.
    Lambert {
        /// Albedo.
        reflectance: Rgb,
    },
    /// Smooth conductor: a mirror.
    Conductor {
        /// Reflectance.
        fresnel: ConductorFresnel,
    },
    /// Rough conductor (Torrance-Sparrow with separable Smith masking).
    RoughConductor {
        /// Reflectance at the microfacets.
        fresnel: ConductorFresnel,
        /// Microfacet distribution.
        roughness: Roughness,
    },
    /// Smooth dielectric boundary: reflects and refracts.
    Dielectric {
        /// Index of refraction inside over outside; outside is where the normal points.
        eta: f32,
    },
    /// Rough dielectric boundary [Walter et al. 2007].
    RoughDielectric {
        /// Index of refraction inside over outside.
        eta: f32,
        /// Microfacet distribution.
        roughness: Roughness,
    },
}

/// How a surface scatters at a point: one lobe, or two mixed. Directions are in the local shading frame: `z` is the
/// shading normal, `wo` points to where the path came from, `wi` to where it goes, both away from the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bsdf {
    /// The first lobe.
    pub first: Lobe,
    /// The second lobe and its share in `[0, 1]`; the first has the rest.
    pub second: Option<(Lobe, f32)>,
    /// Whether the back side scatters as the front side does (opaque lobes only; a dielectric has both sides anyway).
    pub two_sided: bool,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The direction, unit length, local.
    pub wi: Vec3,
    /// `f(wo, wi) |cos wi| / pdf`.
    pub weight: Rgb,
    /// Density per steradian of all lobes together; for a delta lobe the probability of choosing it.
    pub pdf_w: f32,
    /// Whether the direction comes from a delta lobe.
    pub delta: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: 1 for a reflection.
    pub eta: f32,
}
