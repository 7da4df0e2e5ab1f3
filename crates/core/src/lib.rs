//! Geometry, materials, lights, cameras, film, sampling and statistics: what the rendering techniques share.

pub mod bsdf;
pub mod camera;
pub mod effects;
pub mod distribution;
pub mod film;
pub mod filter;
pub mod frame;
pub mod fixed;
pub mod geometry;
pub mod has;
pub mod lights;
pub mod material;
pub mod parallel;
pub mod ray;
pub mod rgb;
pub mod sampler;
pub mod scene;
pub mod statistics;
pub mod technique;
pub mod texture;
pub mod walk;
pub mod warp;
