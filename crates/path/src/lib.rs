//! Unidirectional path tracing with next-event estimation: the baseline that every other technique is held against.
//!
//! At each vertex a light is sampled and the BSDF is sampled, and the two are joined by multiple importance sampling
//! with the power heuristic. With the knob `light_candidates` each vertex looks at several samples of the lights and sends
//! a shadow ray to the most promising.
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
//! (1997), ch. 9 and 10; for `light_candidates` Talbot, Cline and Egbert, "Importance Resampling for Global Illumination"
//! (2005).
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
    has,
    scene::Scene,
    specialise,
    statistics::render::RenderStatistics,
    technique::{Bias, Chain, Knob, Parts, Settings, Technique, TechniqueInfo},
};
use std::{sync::Arc, time::Instant};

/// Path tracing as it is registered.
pub static INFO: TechniqueInfo = TechniqueInfo {
    name: "path",
    summary: "unidirectional path tracing with next-event estimation and multiple importance sampling",
    paper: "Kajiya 1986; Veach 1997, ch. 9-10",
    bias: Bias::Unbiased,
    covers: Parts::ALL,
    blind_spots: "light of point, spot and directional lights that comes by way of mirrors, glass or the holes of masks",
    misses: |_| &[Chain::LightThroughDelta, Chain::Caustic, Chain::CausticThroughDelta],
    knobs: &[LIGHT_CANDIDATES],
    build: |scene, settings, knobs| {
        let candidates = knobs.first().map_or(1, |k| k.round() as u32);
        Box::new(PathTracer::with_light_candidates(scene, settings, candidates))
    },
};

/// Features that the loop with several candidates is compiled for; a variant for each scene's own, as there is with one
/// candidate, would double the time it takes to compile this crate.
const PLAIN: u32 = has::CURVED | has::INFINITE;
/// Those and lobes.
const GLOSSY: u32 = PLAIN | has::LOBES;

const LIGHT_CANDIDATES: Knob = Knob {
    name: "light_candidates",
    summary: "samples of the lights a vertex looks at before it sends its shadow ray",
    range: (1.0, 64.0),
    default: 1.0,
    whole: true,
};

/// The path tracer.
pub struct PathTracer {
    scene: Arc<Scene>,
    settings: Settings,
    light_candidates: u32,
    statistics: RenderStatistics,
}

impl PathTracer {
    /// A path tracer for a scene; nothing is built.
    pub fn new(scene: Arc<Scene>, settings: Settings) -> PathTracer {
        PathTracer::with_light_candidates(scene, settings, 1)
    }

    /// A path tracer that at each vertex looks at so many samples of the lights, at least 1, and sends a shadow ray to one:
    /// resampled importance sampling [Talbot et al. 2005].
    pub fn with_light_candidates(scene: Arc<Scene>, settings: Settings, light_candidates: u32) -> PathTracer {
        let statistics = RenderStatistics { memory_bytes: scene.memory_bytes(), ..RenderStatistics::default() };
        PathTracer { scene, settings, light_candidates, statistics }
    }
}

impl PathTracer {
    #[inline]
    fn add_pass<const HAS: u32, const RESAMPLED: bool>(
        &self,
        seed: u64,
        pass: u32,
        film: &mut Film,
    ) -> RenderStatistics {
        let (scene, settings, candidates) = (&*self.scene, &self.settings, self.light_candidates);
        let width = film.resolution().x;
        let filter = film.filter();
        film.add_pass(
            INFO.name,
            pass,
            || (settings.sampler)(seed, settings.planned_passes),
            |sampler, pixel, statistics| {
                sampler.start_pixel(pixel, width, pass);
                let rays = &mut statistics.rays;
                radiance::pixel_sample::<HAS, RESAMPLED>(
                    scene,
                    settings,
                    candidates,
                    filter,
                    pixel,
                    &mut **sampler,
                    rays,
                )
            },
        )
    }
}

impl Technique for PathTracer {
    fn pass(&mut self, seed: u64, pass: u32, film: &mut Film) {
        let start = Instant::now();
        let has = self.scene.has();
        let counted = if self.light_candidates <= 1 {
            specialise!(has, HAS => self.add_pass::<HAS, false>(seed, pass, film))
        } else if has & !PLAIN == 0 {
            self.add_pass::<PLAIN, true>(seed, pass, film)
        } else if has & !GLOSSY == 0 {
            self.add_pass::<GLOSSY, true>(seed, pass, film)
        } else {
            self.add_pass::<{ has::ALL }, true>(seed, pass, film)
        };
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
