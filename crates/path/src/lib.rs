//! Unidirectional path tracing with next-event estimation: the baseline that every other technique is held against.
//!
//! At each vertex a light is sampled and the BSDF is sampled, and the two are joined by multiple importance sampling
//! with the power heuristic.
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
//!         to_world: DAffine3::from_scale(DVec3::splat(9.0)),
//!         material: 0,
//!         emission: None,
//!         absorption: None,
//!     }],
//!     environment: Some(etendue_core::lights::environment::Environment::Constant(Rgb::WHITE)),
//!     ..SceneDescription::default()
//! };
//! let scene = Arc::new(Scene::new(&description)?);
//! let mut technique = (etendue_path::INFO.build)(scene, Settings::new(10, independent), &[]);
//! let mut film = Film::new(UVec2::new(4, 4), Filter::Box);
//! for pass in 0..16 {
//!     technique.pass(1, pass, &mut film);
//! }
//! assert!((film.mean(UVec2::ZERO).g - 0.5).abs() < 0.2);
//! # Ok::<(), SceneError>(())
//! ```
//!
//! Source: Kajiya, "The Rendering Equation" (1986); Veach, "Robust Monte Carlo Methods for Light Transport Simulation"
//! (1997), ch. 9 and 10.
//!
//! Good at: direct light and diffuse interreflection, large lights, environments. Bad at: caustics of small lights
//! (found only by chance, as fireflies), light that comes through a small opening. Blind to: point, spot and
//! directional lights seen through delta lobes.

mod radiance;

/// The README's example, compiled and run as it stands.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

use etendue_core::{
    film::Film,
    scene::Scene,
    specialise,
    statistics::render::RenderStatistics,
    technique::{Bias, Parts, Settings, Technique, TechniqueInfo},
};
use std::{sync::Arc, time::Instant};

/// Path tracing as it is registered.
pub static INFO: TechniqueInfo = TechniqueInfo {
    name: "path",
    summary: "unidirectional path tracing with next-event estimation and multiple importance sampling",
    paper: "Kajiya 1986; Veach 1997, ch. 9-10",
    bias: Bias::Unbiased,
    covers: Parts::ALL,
    blind_spots: "point, spot and directional lights seen through mirrors or glass",
    knobs: &[],
    build: |scene, settings, _| Box::new(PathTracer::new(scene, settings)),
};

/// The path tracer.
pub struct PathTracer {
    scene: Arc<Scene>,
    settings: Settings,
    statistics: RenderStatistics,
}

impl PathTracer {
    /// A path tracer for a scene; nothing is built.
    pub fn new(scene: Arc<Scene>, settings: Settings) -> PathTracer {
        let statistics = RenderStatistics { memory_bytes: scene.memory_bytes(), ..RenderStatistics::default() };
        PathTracer { scene, settings, statistics }
    }
}

impl Technique for PathTracer {
    fn pass(&mut self, seed: u64, pass: u32, film: &mut Film) {
        let start = Instant::now();
        let (scene, settings) = (&*self.scene, &self.settings);
        let width = film.resolution().x;
        let filter = film.filter();
        let counted = specialise!(scene.has(), HAS => film.add_pass(
            INFO.name,
            pass,
            || (settings.sampler)(seed, settings.planned_passes),
            |sampler, pixel, statistics| {
                sampler.start_pixel(pixel, width, pass);
                radiance::pixel_sample::<HAS>(scene, settings, filter, pixel, &mut **sampler, &mut statistics.rays)
            },
        ));
        self.statistics.merge(&counted);
        self.statistics.add_time("passes", start.elapsed());
    }

    fn statistics(&self) -> &RenderStatistics {
        &self.statistics
    }

    fn next_frame(&mut self, scene: Arc<Scene>) {
        self.statistics.memory_bytes = scene.memory_bytes();
        self.scene = scene;
    }
}
