//! Photons on their way: from the lights to where they are stored.

use crate::{
    aim::{Aim, Worth},
    octahedral::Octahedral,
    photon::{Photon, PhotonHistory},
    surfaces::is_narrow,
};
use etendue_core::{
    bsdf::TransportMode,
    geometry::offset::offset_origin,
    has, parallel,
    ray::Ray,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::{Rays, RenderStatistics},
    technique::Settings,
    walk::{Limits, Vertex, Walk},
};
use glam::{Vec2, Vec3};

/// Which photons are stored, and followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Store {
    /// Those that have come over narrow surfaces and delta lobes alone, at least one: caustics. A photon ends where it would go
    /// on otherwise.
    Caustic,
    /// All that have been scattered before.
    Scattered,
    /// All.
    All,
}

/// What is traced.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Samplers and bounds; a path's last edge is left for the camera.
    pub settings: &'a Settings,
    /// Which photons are stored.
    pub store: Store,
    /// Where to emit.
    pub aim: &'a Aim,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of a set of photons of a seed: sets are independent.
    pub set: u32,
    /// Photons to emit.
    pub emitted: u32,
}

/// Photons as they were stored, in the order of emission.
#[derive(Debug, Default)]
pub struct Stored {
    /// Place and photon; powers are those of the whole scene's light.
    pub photons: Vec<(Vec3, Photon)>,
    /// What it took.
    pub statistics: RenderStatistics,
}

/// An emission that led to photons: numbers of its point and direction, and how many photons.
pub type Fruitful = (Vec2, Vec2, u32);

/// What a pilot has found.
#[derive(Debug, Default)]
pub struct Pilot {
    /// Emissions that led to photons, in order.
    pub emissions: Vec<Fruitful>,
    /// Where the photons lie: those of the first emission, then those of the second, and so on.
    pub photons: Vec<(Vec3, Photon)>,
    /// What it took.
    pub statistics: RenderStatistics,
}

impl Pilot {
    /// Emissions, each worth as many as its photons.
    pub fn by_number(&self) -> Vec<Worth> {
        self.emissions.iter().map(|e| (e.0, e.1, f64::from(e.2))).collect()
    }
}

/// Paths that share a sampler; enough that many runs keep all threads busy.
const RUN: u32 = 1024;

/// What a run of paths has stored.
#[derive(Default)]
struct Run {
    photons: Vec<(Vec3, Photon)>,
    fruitful: Vec<Fruitful>,
}

impl Job<'_> {
    /// Emits photons and follows them. The result depends on the job alone, on any number of threads.
    pub fn trace<const HAS: u32>(&self) -> Stored {
        let (runs, statistics) = self.runs::<HAS>();
        let mut photons = Vec::with_capacity(runs.iter().map(|run| run.photons.len()).sum());
        // Shares of the flux, now that it is known how many there are.
        let share = 1.0 / self.emitted as f32;
        for run in runs {
            photons.extend(run.photons.into_iter().map(|(p, mut photon)| {
                photon.power *= share;
                (p, photon)
            }));
        }
        Stored { photons, statistics }
    }

    /// Emits photons to see which emissions lead to stored ones.
    pub fn pilot<const HAS: u32>(&self) -> Pilot {
        let (runs, statistics) = self.runs::<HAS>();
        let mut pilot = Pilot { statistics, ..Pilot::default() };
        for run in runs {
            pilot.emissions.extend(run.fruitful);
            pilot.photons.extend(run.photons);
        }
        pilot
    }

    fn runs<const HAS: u32>(&self) -> (Vec<Run>, RenderStatistics) {
        let mut runs: Vec<Run> = (0..self.emitted.div_ceil(RUN)).map(|_| Run::default()).collect();
        let statistics = parallel::for_runs_of(&mut runs, 1, |index, runs| {
            let mut statistics = RenderStatistics::default();
            let mut sampler = (self.settings.sampler)(self.seed, self.emitted);
            let first = index as u32 * RUN;
            for path in first..first.saturating_add(RUN).min(self.emitted) {
                sampler.start_sample(self.set, path);
                let before = runs[0].photons.len();
                let Some(numbers) = self.follow::<HAS>(&mut *sampler, &mut runs[0].photons, &mut statistics.rays)
                else {
                    continue;
                };
                let stored = runs[0].photons.len() - before;
                if stored > 0 {
                    runs[0].fruitful.push((numbers.0, numbers.1, stored as u32));
                }
            }
            statistics
        });
        (runs, statistics)
    }

    /// Follows one photon; returns the numbers of its point and direction.
    fn follow<const HAS: u32>(
        &self,
        sampler: &mut dyn Sampler,
        photons: &mut Vec<(Vec3, Photon)>,
        rays: &mut Rays,
    ) -> Option<(Vec2, Vec2)> {
        // One edge is left for the camera.
        if self.settings.max_depth < 2 {
            return None;
        }
        let u_choice = sampler.get_1d(0, Purpose::EmissionChoice);
        let u_point = sampler.get_2d(0, Purpose::EmissionPoint);
        let u_direction = sampler.get_2d(0, Purpose::EmissionDirection);
        let u_aim = if self.aim.is_aimed() { sampler.get_1d(1, Purpose::EmissionChoice) } else { 0.0 };
        let aimed = self.aim.sample(u_aim, u_point, u_direction);
        let start = self.scene.lights().sample_emission::<HAS>(u_choice, aimed.point, aimed.direction)?;
        let weight = start.weight() * (1.0 / aimed.density);
        let flux = weight.max_element();
        if !(flux > 0.0 && flux.is_finite()) {
            return None;
        }
        let origin = offset_origin(start.p, start.p_error, start.normal, start.direction);
        // Roulette from the first surface on: a photon lives with the albedo's probability, and its power stays what it was
        // [Jensen 2001, sec. 5.2.4]. Throughputs are relative to the flux it starts with.
        let limits = Limits { max_depth: self.settings.max_depth - 1, roulette_depth: 1 };
        let ray = Ray::new(origin, start.direction);
        let mut walk =
            Walk::<HAS>::new(self.scene, TransportMode::Importance, limits, ray, weight * (1.0 / flux), start.pdf_w);
        let mut history = PhotonHistory {
            depth: 1,
            rough: false,
            delta_first: false,
            environment: start.infinite && !start.delta_direction,
        };
        // Whether it has met a surface that takes photons and been scattered there by a lobe that is no delta.
        let mut wide = false;
        while let Vertex::Surface(vertex) = walk.trace(rays) {
            history.depth = vertex.depth;
            let narrow = is_narrow::<HAS>(&vertex.bsdf);
            let stored = match self.store {
                Store::Caustic => vertex.depth >= 2 && !wide,
                Store::Scattered => vertex.depth >= 2,
                Store::All => true,
            };
            if stored && !narrow {
                let power = vertex.beta * flux;
                if power.is_valid() {
                    let ng = vertex.surface.ng;
                    let normal = Octahedral::new(if ng.dot(vertex.wo) < 0.0 { -ng } else { ng });
                    photons.push((vertex.surface.p, Photon::new(power, Octahedral::new(vertex.wo), normal, history)));
                }
            }
            if self.store == Store::Caustic && !narrow && (HAS & has::LOBES == 0 || !vertex.bsdf.has_delta()) {
                break;
            }
            let Some(step) = walk.go_on(&vertex, sampler) else { break };
            wide |= !narrow && !step.delta;
            if wide && self.store == Store::Caustic {
                break;
            }
            history.rough |= !step.delta;
            if vertex.depth == 1 {
                history.delta_first = step.delta;
            }
        }
        Some((aimed.point, aimed.direction))
    }
}
