//! Light tracing.

use crate::particle::{Particle, connects, pixels, see};
use etendue_core::{
    film::{Film, Splats},
    filter::Filter,
    has,
    rgb::Rgb,
    sampler::{Purpose, Sampler},
    scene::Scene,
    specialise_coarsely,
    statistics::render::{Rays, RenderStatistics},
    technique::{Bias, Chain, Part, Parts, Settings, Technique, TechniqueInfo},
    walk::{Vertex, Walk},
};
use glam::{UVec2, Vec2};
use std::{sync::Arc, time::Instant};

/// Light tracing as it is registered.
pub static LIGHT: TechniqueInfo = TechniqueInfo {
    name: "light",
    summary: "light tracing: particles from the lights, splatted where the camera sees them land",
    paper: "Arvo 1986; Dutré, Lafortune and Willems 1993",
    bias: Bias::Unbiased,
    covers: Parts::ALL,
    blind_spots: "surfaces that the camera sees through mirrors, smooth glass or the holes of masks; point, spot and directional \
                  lights seen through mirrors or glass",
    misses: |_| &[Chain::LightThroughDelta, Chain::CausticThroughDelta, Chain::SurfaceThroughDelta],
    knobs: &[],
    build: |scene, settings, _| Box::new(LightTracer::new(scene, settings)),
};

/// The light tracer.
///
/// A pass is one particle a pixel. Each surface that it reaches is connected to the camera. The lights themselves, seen
/// directly or through delta lobes alone ([`Part::Emission`]), are found from the camera, one path a pixel: no other way is
/// free of noise, and through mirrors there is no other way at all.
pub struct LightTracer {
    scene: Arc<Scene>,
    settings: Settings,
    statistics: RenderStatistics,
}

impl LightTracer {
    /// A light tracer for a scene; nothing is built.
    pub fn new(scene: Arc<Scene>, settings: Settings) -> LightTracer {
        let statistics = RenderStatistics { memory_bytes: scene.memory_bytes(), ..RenderStatistics::default() };
        LightTracer { scene, settings, statistics }
    }
}

impl Technique for LightTracer {
    fn pass(&mut self, seed: u64, pass: u32, film: &mut Film) {
        let start = Instant::now();
        let (scene, settings) = (&*self.scene, &self.settings);
        let (width, filter) = (film.resolution().x, film.filter());
        let scattered = Part::ALL.into_iter().any(|part| part != Part::Emission && settings.parts.contains(part));
        let paths = if scattered { pixels(film) } else { 0 };
        let counted = specialise_coarsely!(scene.has(), HAS => film.add_splat_pass(
            LIGHT.name,
            pass,
            paths,
            || (settings.sampler)(seed, settings.planned_passes),
            |sampler, path, splats, statistics| {
                sampler.start_sample(path, pass);
                follow::<HAS>(scene, settings, paths as f32, filter.radius(), &mut **sampler, splats, statistics);
            },
            |sampler, pixel, _, statistics| {
                if !settings.parts.contains(Part::Emission) {
                    return Rgb::BLACK;
                }
                sampler.start_sample(pixel.y * width + pixel.x, pass);
                emission::<HAS>(scene, settings, filter, pixel, &mut **sampler, &mut statistics.rays)
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

/// Follows one particle and splats each surface that it reaches.
#[inline]
fn follow<const HAS: u32>(
    scene: &Scene,
    settings: &Settings,
    particles: f32,
    margin: f32,
    sampler: &mut dyn Sampler,
    splats: &Splats,
    statistics: &mut RenderStatistics,
) {
    let Some(mut particle) = Particle::<HAS>::emit(scene, settings, sampler) else { return };
    while let Some(vertex) = particle.trace(&mut statistics.rays) {
        if connects::<HAS>(&vertex)
            && settings.parts.contains(particle.part(&vertex, 0))
            && let Some(seen) = see::<HAS>(scene, &vertex, particles, margin, sampler)
        {
            statistics.rays.shadow += 1;
            if !scene.occluded::<HAS>(&seen.ray) {
                splats.splat(statistics, seen.camera.film, seen.value);
            }
        }
        if !particle.walk.scatter(&vertex, sampler) {
            return;
        }
    }
}

/// What a pixel sees of the lights themselves, directly or by way of delta lobes.
#[inline]
fn emission<const HAS: u32>(
    scene: &Scene,
    settings: &Settings,
    filter: Filter,
    pixel: UVec2,
    sampler: &mut dyn Sampler,
    rays: &mut Rays,
) -> Rgb {
    let film = pixel.as_vec2() + 0.5 + filter.sample(sampler.get_2d(0, Purpose::Film));
    let lens = if scene.census().lens { sampler.get_2d(0, Purpose::Lens) } else { Vec2::ZERO };
    let mut walk = Walk::<HAS>::from_camera(scene, settings.limits(), film, lens);
    let mut sum = Rgb::BLACK;
    loop {
        match walk.trace(rays) {
            Vertex::Escaped(end) => {
                if HAS & has::INFINITE != 0 {
                    sum += end.beta * scene.lights().environment_radiance(end.direction);
                }
                return sum;
            }
            Vertex::Surface(vertex) => {
                if let Some(element) = scene.element(&vertex.surface) {
                    sum += vertex.beta * scene.lights().emitted::<HAS>(element, &vertex.surface, vertex.wo);
                }
                if HAS & has::LOBES == 0 || !vertex.bsdf.has_delta() {
                    return sum;
                }
                match walk.go_on(&vertex, sampler) {
                    Some(step) if step.delta => {}
                    _ => return sum,
                }
            }
        }
    }
}
