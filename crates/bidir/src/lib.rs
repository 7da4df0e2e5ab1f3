//! Light tracing and bidirectional path tracing: paths that start at the lights.
//!
//! [`LIGHT`] sends particles out of the lights and splats where the camera sees them land. [`BIDIR`] walks a path from a light
//! and one from the camera for each pixel, joins them in every way, and weights all ways of making the same path against
//! each other.
//!
//! ```
//! use etendue_core::{film::Film, filter::Filter, rgb::Rgb, independent::independent, scene::*, technique::*};
//! use etendue_core::{camera::*, material::Material};
//! use glam::{DAffine3, DVec3, UVec2, dcamera::lh::view::look_at_affine3};
//! use std::sync::Arc;
//!
//! // A white floor under a sky of radiance 1, seen from above: it reflects 1/2.
//! let description = SceneDescription {
//!     camera: Some(CameraDescription {
//!         projection: Projection::Perspective { fov_x: 0.5 },
//!         to_world: look_at_affine3(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y).inverse(),
//!         resolution: UVec2::new(4, 4),
//!         crop: None,
//!     }),
//!     materials: vec![NamedMaterial {
//!         name: "white".into(),
//!         material: Material::lambert(Rgb::splat(0.5)),
//!         two_sided: true,
//!     }],
//!     objects: vec![Object {
//!         name: "floor".into(),
//!         shape: ObjectShape::Rectangle,
//!         to_world: DAffine3::from_scale(DVec3::splat(2.0)),
//!         material: 0,
//!         emission: None,
//!         absorption: None,
//!     }],
//!     environment: Some(etendue_core::lights::environment::Environment::Constant(Rgb::WHITE)),
//!     ..SceneDescription::default()
//! };
//! let scene = Arc::new(Scene::new(&description)?);
//! for info in [&etendue_bidir::LIGHT, &etendue_bidir::BIDIR] {
//!     let knobs: Vec<f64> = info.knobs.iter().map(|knob| knob.default).collect();
//!     let mut technique = (info.build)(scene.clone(), Settings::new(10, independent), &knobs);
//!     let mut film = Film::new(UVec2::new(4, 4), Filter::Box);
//!     for pass in 0..256 {
//!         technique.pass(1, pass, &mut film);
//!     }
//!     let mean = film.mean_image().iter().map(|c| c.g).sum::<f32>() / 16.0;
//!     assert!((mean - 0.5).abs() < 0.05, "{}: {mean}", info.name);
//! }
//! # Ok::<(), SceneError>(())
//! ```
//!
//! Sources: Arvo, "Backward Ray Tracing" (1986); Dutré, Lafortune and Willems, "Monte Carlo Light Tracing with Direct
//! Computation of Pixel Intensities" (1993); Lafortune and Willems, "Bi-directional Path Tracing" (1993); Veach and Guibas,
//! "Bidirectional Estimators for Light Transport" (1994) and "Optimally Combining Sampling Techniques for Monte Carlo
//! Rendering" (1995); Veach, "Robust Monte Carlo Methods for Light Transport Simulation" (1997), ch. 8 to 10; van Antwerpen,
//! "Recursive MIS Computation for Streaming BDPT on the GPU" (2011).
//!
//! Good at: caustics on what the camera sees directly, light that the camera's walks hardly find (behind doors, in lamps).
//! Bad at: wide open scenes, of which light from outside hits what is seen by chance alone, and scenes that path tracing
//! finds easy: a pass costs two to five times as much. Blind to what no path can be joined for: point, spot and directional
//! lights, and their caustics, seen through mirrors or smooth glass.
//!
//! # What is counted
//!
//! A path of `k` edges has `k + 1` vertices, the light's and the lens's included, of which strategy `(s, t)` makes `s` by
//! a walk from a light and `t = k + 1 - s` by one from the camera:
//!
//! | strategy | what it does |
//! | --- | --- |
//! | `s = 0` | the camera's walk runs into a light |
//! | `s = 1` | next-event estimation, with a light sampled afresh for each vertex |
//! | `s >= 2`, `t >= 2` | a vertex of one walk sees one of the other |
//! | `t = 1` | the lens is sampled from a vertex of the light's walk, and the film is splatted |
//!
//! There is no `t = 0`: a camera is no thing in the scene, and no particle runs into its lens. There is no `(1, 1)` either:
//! lights that are seen directly are seen by the camera's rays without noise.
//!
//! Splats of direct light count for less in the weights than their densities say, and caustics of smooth surfaces may have
//! particles of their own: see [`splats::Splats`].
//!
//! Depth, Russian roulette and the parts of the light are those of path tracing: a path belongs to the same
//! [`Part`](etendue_core::technique::Part) whoever makes it. Roulette on either walk is accounted for in what a path
//! carries, and left out of the densities in the weights, which need only sum to 1.

mod bidirectional;
mod connections;
pub mod densities;
pub mod events;
mod light;
pub mod particle;
pub mod splats;
pub mod strategies;
pub mod weights;

pub use bidirectional::{BIDIR, Bidirectional};
pub use light::{LIGHT, LightTracer};

/// The README's example, compiled and run as it stands.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
