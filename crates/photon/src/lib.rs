//! Photon maps: light that leaves the lights as photons, stored where it lands, and asked for where the camera looks.
//!
//! [`PHOTON`] is photon mapping in passes: a map of caustics, and a global map behind final gathering. [`SPPM`] is its
//! progressive form, whose bias goes away with time. [`kd_tree::KdTree`] serves in anybody's renderer and needs no scene.
//!
//! ```
//! use etendue_core::{film::Film, filter::Filter, independent::independent, rgb::Rgb, scene::*, technique::*};
//! use etendue_core::{camera::*, material::Material};
//! use glam::{DAffine3, DVec3, UVec2, dcamera::lh::view::look_at_affine3};
//! use std::sync::Arc;
//!
//! // A lamp over a floor, and a mirror wall that throws its light onto the floor once more.
//! let named = |name: &str, material| NamedMaterial { name: name.into(), material, two_sided: true };
//! let object = |name: &str, to_world, material| Object {
//!     name: name.into(), shape: ObjectShape::Rectangle, to_world, material, emission: None, absorption: None,
//! };
//! let mirror = etendue_core::bsdf::ConductorFresnel::Constant(Rgb::WHITE);
//! let description = SceneDescription {
//!     camera: Some(CameraDescription {
//!         projection: Projection::Orthographic { width: 0.2 },
//!         to_world: look_at_affine3(DVec3::Z * 0.5, DVec3::ZERO, DVec3::Y).inverse(),
//!         resolution: UVec2::new(4, 4),
//!         crop: None,
//!     }),
//!     materials: vec![
//!         named("grey", Material::lambert(Rgb::splat(0.5))),
//!         named("mirror", Material::conductor(mirror, None)),
//!     ],
//!     objects: vec![
//!         object("floor", DAffine3::from_scale(DVec3::splat(3.0)), 0),
//!         object("wall", DAffine3::from_translation(DVec3::X) * DAffine3::from_rotation_y(-1.5707963267948966), 1),
//!     ],
//!     lights: vec![LightDescription {
//!         name: "lamp".into(),
//!         kind: DeltaLight::Point { position: DVec3::Z, intensity: Rgb::WHITE },
//!     }],
//!     ..SceneDescription::default()
//! };
//! let scene = Arc::new(Scene::new(&description)?);
//! // Light from the lamp's image behind the wall: 2 m away and 1 m high, reflected by 0.5 / pi.
//! let expected = 0.5 / std::f32::consts::PI * 5.0f32.powf(-1.5);
//! for info in [&etendue_photon::PHOTON, &etendue_photon::SPPM] {
//!     // So few pixels have few photons of their own: the progressive form gets more for each.
//!     let value = |knob: &Knob| if knob.name == "photons" { 64.0 } else { knob.default };
//!     let knobs: Vec<f64> = info.knobs.iter().map(value).collect();
//!     let settings = Settings { parts: Parts::NONE.with(Part::Caustic), ..Settings::new(8, independent) };
//!     let mut technique = (info.build)(scene.clone(), settings, &knobs);
//!     let mut film = Film::new(UVec2::new(4, 4), Filter::Box);
//!     for pass in 0..200 {
//!         technique.pass(1, pass, &mut film);
//!     }
//!     let mean = film.mean_image().iter().map(|c| c.g).sum::<f32>() / 16.0;
//!     assert!((mean / expected - 1.0).abs() < 0.1, "{}: {mean} {expected}", info.name);
//! }
//! # Ok::<(), SceneError>(())
//! ```
//!
//! Sources: Jensen, "Global Illumination using Photon Maps" (1996) and "Realistic Image Synthesis Using Photon Mapping" (2001);
//! Christensen, "Faster Photon Map Global Illumination" (1999); Hachisuka and Jensen, "Stochastic Progressive Photon Mapping"
//! (2009); Knaus and Zwicker, "Progressive Photon Mapping: A Probabilistic Approach" (2011).
//!
//! Good at: caustics, seen directly, in mirrors and through glass alike, and of point and directional lights too; indirect
//! light of many bounces. Bad at: sharp edges of caustics with few photons (they are as wide as the disk that photons are
//! gathered in), large open scenes, light that most photons never reach. Blind to: point, spot and directional lights
//! themselves, seen through mirrors or glass.
//!
//! # Who counts which path
//!
//! Seen from the camera, a path is scattered by delta lobes and narrow glossy surfaces ([`surfaces::is_narrow`]) until it meets
//! a surface that takes photons, x. Direct light there is sampled as in path tracing; light that comes to x by way of narrow
//! scattering alone is the caustic map's; what comes from another surface y that takes photons is the global map's at y. Each
//! path is counted by one of them.

pub mod aim;
pub mod clear;
mod eye;
pub mod kd_tree;
pub mod kernel;
pub mod map;
mod mapping;
pub mod octahedral;
pub mod photon;
mod progressive;
pub mod surfaces;
pub mod trace;
mod view;

pub use mapping::{IndirectLight, Options, PHOTON, PhotonMapper};
pub use progressive::{ProgressiveMapper, ProgressiveOptions, SPPM, shrinkage};

/// The README's example, compiled and run as it stands.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
