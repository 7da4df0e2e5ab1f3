//! Bidirectional path tracing.

use crate::{
    particle::particles,
    strategies::{Event, Paths},
    weights::Heuristic,
};
use etendue_core::{
    film::Film,
    rgb::Rgb,
    scene::Scene,
    specialise_coarsely,
    statistics::render::RenderStatistics,
    technique::{Bias, Knob, Parts, Settings, Technique, TechniqueInfo},
};
use std::{sync::Arc, time::Instant};

/// Bidirectional path tracing as it is registered.
pub static BIDIR: TechniqueInfo = TechniqueInfo {
    name: "bidir",
    summary: "bidirectional path tracing: all ways of joining a path from a light and one from the camera",
    paper: "Lafortune and Willems 1993; Veach and Guibas 1994, 1995",
    bias: Bias::Unbiased,
    covers: Parts::ALL,
    blind_spots: "point, spot and directional lights, and caustics that they make, seen through mirrors or glass",
    knobs: &[Knob {
        name: "heuristic",
        summary: "how strategies share a path: 0 balance, 1 power, 2 maximum",
        range: (0.0, 2.0),
        default: 1.0,
    }],
    build: |scene, settings, knobs| {
        let heuristic = Heuristic::ALL[(knobs[0].round() as usize).min(2)];
        Box::new(Bidirectional::new(scene, settings, heuristic))
    },
};

/// Connections of a pair of paths that are tested for what lies between, about: in rooms there are a dozen, and a few of them
/// hold most of the light. With three, noise grows by some per cent and a pass takes a tenth to a quarter less.
const CONNECTIONS: f32 = 3.0;

/// The bidirectional path tracer.
pub struct Bidirectional {
    scene: Arc<Scene>,
    settings: Settings,
    heuristic: Heuristic,
    statistics: RenderStatistics,
}

impl Bidirectional {
    /// A bidirectional path tracer for a scene; nothing is built.
    pub fn new(scene: Arc<Scene>, settings: Settings, heuristic: Heuristic) -> Bidirectional {
        let statistics = RenderStatistics { memory_bytes: scene.memory_bytes(), ..RenderStatistics::default() };
        Bidirectional { scene, settings, heuristic, statistics }
    }
}

impl Technique for Bidirectional {
    fn pass(&mut self, seed: u64, pass: u32, film: &mut Film) {
        let start = Instant::now();
        let (scene, settings, heuristic) = (&*self.scene, &self.settings, self.heuristic);
        let (width, filter, pixels) = (film.resolution().x, film.filter(), particles(film));
        let counted = specialise_coarsely!(scene.has(), HAS => film.add_splat_pass(
            BIDIR.name,
            pass,
            0,
            || {
                let sampler = (settings.sampler)(seed, settings.planned_passes);
                (sampler, Paths::new(scene, settings, heuristic, filter, pixels).testing(CONNECTIONS))
            },
            |_, _, _, _| {},
            |(sampler, paths), pixel, splats, statistics| {
                sampler.start_sample(pixel.y * width + pixel.x, pass);
                let mut rays = statistics.rays;
                let mut sum = Rgb::BLACK;
                paths.sample::<HAS>(pixel, &mut **sampler, &mut rays, &mut |event| {
                    let Event::Contribution(c) = event else { return };
                    match c.film {
                        Some(position) => splats.splat(statistics, position, c.value * c.weight),
                        None => sum += c.value * c.weight,
                    }
                });
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
