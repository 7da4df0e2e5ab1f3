//! Geometry, materials, lights, cameras, film, sampling and statistics: what the rendering techniques share.

pub mod bsdf;
pub mod camera;
pub mod digest;
pub mod direct_light;
pub mod distribution;
pub mod effects;
pub mod film;
pub mod filter;
pub mod fixed;
pub mod frame;
pub mod geometry;
pub mod has;
pub mod independent;
pub mod lights;
pub mod material;
pub mod mis;
pub mod parallel;
pub mod ray;
mod relief;
pub mod reservoir;
pub mod rgb;
pub mod sampler;
pub mod scene;
pub mod statistics;
pub mod technique;
pub mod texture;
pub mod walk;
pub mod warp;

/// The README's example, compiled and run as it stands.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
