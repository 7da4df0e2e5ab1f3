//! Bidirectional path tracing.

use crate::{events::Event, particle::pixels, strategies::Paths, weights::Heuristic};
use etendue_core::{
    effects::{Census, LobeKind},
    film::Film,
    rgb::Rgb,
    scene::Scene,
    specialise_coarsely,
    statistics::render::RenderStatistics,
    technique::{Bias, Chain, Knob, Part, Parts, Settings, Technique, TechniqueInfo},
};
use std::{sync::Arc, time::Instant};

/// Bidirectional path tracing as it is registered.
pub static BIDIR: TechniqueInfo = TechniqueInfo {
    name: "bidir",
    summary: "bidirectional path tracing: all ways of joining a path from a light and one from the camera",
    paper: "Lafortune and Willems 1993; Veach and Guibas 1994, 1995",
    bias: Bias::Unbiased,
    covers: Parts::ALL,
    blind_spots: "point, spot and directional lights seen through mirrors or glass; their caustics, and their light through the \
                  holes of masks, seen so or through such holes",
    misses: |_| &[Chain::LightThroughDelta, Chain::CausticThroughDelta],
    knobs: &[
        Knob {
            name: "heuristic",
            summary: "how strategies share a path: 0 balance, 1 power, 2 maximum",
            range: (0.0, 2.0),
            default: 1.0,
            whole: true,
        },
        Knob {
            name: "particles",
            summary: "paths from lights for each from the camera, all but one for caustics alone; 0: four with mirrors or glass, else one",
            range: (0.0, 64.0),
            default: 0.0,
            whole: true,
        },
    ],
    build: |scene, settings, knobs| {
        let heuristic = Heuristic::ALL[(knobs[0].round() as usize).min(2)];
        let particles = match knobs[1].round() as u32 {
            0 if has_mirrors_or_glass(scene.census()) => CAUSTIC_PARTICLES,
            0 => 1,
            particles => particles,
        };
        Box::new(Bidirectional::new(scene, settings, heuristic, particles))
    },
};

/// Connections of a pair of paths that are tested for what lies between, about: in rooms there are a dozen, and a few of them
/// hold most of the light. With three, noise grows by some per cent and a pass takes a tenth to a quarter less.
const CONNECTIONS: f32 = 3.0;

/// Particles for each pixel where there are mirrors or glass.
const CAUSTIC_PARTICLES: u32 = 4;

/// Whether any surface is nothing but smooth; whether particles pay for coats over diffuse bodies has not been measured.
fn has_mirrors_or_glass(census: &Census) -> bool {
    let smooth = [LobeKind::Conductor, LobeKind::Dielectric, LobeKind::ThinDielectric];
    census.lobes.iter().any(|lobe| smooth.contains(&lobe.kind))
}

/// The bidirectional path tracer.
pub struct Bidirectional {
    scene: Arc<Scene>,
    settings: Settings,
    heuristic: Heuristic,
    particles: u32,
    statistics: RenderStatistics,
}

impl Bidirectional {
    /// A bidirectional path tracer for a scene; nothing is built. For each path from the camera there are `particles` from
    /// lights, at least one, all but one of them for caustics of smooth surfaces alone.
    pub fn new(scene: Arc<Scene>, settings: Settings, heuristic: Heuristic, particles: u32) -> Bidirectional {
        let statistics = RenderStatistics { memory_bytes: scene.memory_bytes(), ..RenderStatistics::default() };
        Bidirectional { scene, settings, heuristic, particles: particles.max(1), statistics }
    }
}

impl Technique for Bidirectional {
    fn pass(&mut self, seed: u64, pass: u32, film: &mut Film) {
        let start = Instant::now();
        let (scene, settings, heuristic) = (&*self.scene, &self.settings, self.heuristic);
        let (width, filter, pixels) = (film.resolution().x, film.filter(), pixels(film));
        let particles = if settings.parts.contains(Part::Caustic) { self.particles } else { 1 };
        let counted = specialise_coarsely!(scene.has(), HAS => film.add_splat_pass(
            BIDIR.name,
            pass,
            0,
            || {
                let sampler = (settings.sampler)(seed, settings.planned_passes);
                let paths = Paths::new(scene, settings, heuristic, filter, pixels);
                (sampler, paths.with_caustic_particles(particles).testing(CONNECTIONS))
            },
            |_, _, _, _| {},
            |(sampler, paths), pixel, splats, statistics| {
                let index = pixel.y * width + pixel.x;
                let mut rays = statistics.rays;
                let mut sum = Rgb::BLACK;
                let mut add = |event: Event<'_>| {
                    let Event::Contribution(c) = event else { return };
                    match c.film {
                        Some(position) => splats.splat(statistics, position, c.value * c.weight),
                        None => sum += c.value * c.weight,
                    }
                };
                for more in 1..particles {
                    // As if it belonged to another pixel.
                    sampler.start_sample(index.wrapping_add(more.wrapping_mul(pixels)), pass);
                    paths.caustic_particle::<HAS>(&mut **sampler, &mut rays, &mut add);
                }
                sampler.start_sample(index, pass);
                paths.sample::<HAS>(pixel, &mut **sampler, &mut rays, &mut add);
                statistics.rays = rays;
                sum
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
