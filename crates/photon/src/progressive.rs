//! Stochastic progressive photon mapping.

use crate::{
    aim::Aim,
    eye::{Eye, Footprint, Indirect, Source},
    kd_tree::Neighbours,
    kernel::Kernel,
    map::{Gathering, PhotonMap},
    mapping::scene_radius,
    surfaces::takes_photons,
    trace::{Job, Store},
    view::View,
};
use etendue_core::{
    film::Film,
    scene::Scene,
    specialise_coarsely,
    statistics::render::RenderStatistics,
    technique::{Bias, Chain, Knob, Part, Parts, Settings, Technique, TechniqueInfo},
};
use glam::UVec2;
use std::{sync::Arc, time::Instant};

/// Stochastic progressive photon mapping as it is registered.
pub static SPPM: TechniqueInfo = TechniqueInfo {
    name: "sppm",
    summary: "stochastic progressive photon mapping: new photons every pass, gathered within shrinking radii",
    paper: "Hachisuka and Jensen 2009; Knaus and Zwicker 2011",
    bias: Bias::Consistent,
    covers: Parts::ALL,
    blind_spots: "point, spot and directional lights seen through mirrors or glass",
    misses: |_| &[Chain::LightThroughDelta],
    knobs: &[
        Knob {
            name: "photons",
            summary: "photons emitted in a pass, over the number of pixels",
            range: (1e-3, 1e3),
            default: 1.0,
            whole: false,
        },
        Knob {
            name: "nearest",
            summary: "photons of the pilot, which has four times those of a pass, in the first radius",
            range: (2.0, 1e5),
            default: 20.0,
            whole: true,
        },
        Knob {
            name: "radius",
            summary: "greatest first radius, over that of the scene",
            range: (1e-6, 10.0),
            default: 0.1,
            whole: false,
        },
        Knob {
            name: "pixels",
            summary: "greatest first radius in pixels, as large as they are where it is",
            range: (0.1, 1e6),
            default: 16.0,
            whole: false,
        },
        Knob {
            name: "alpha",
            summary: "how slowly radii shrink: 0 as fast as the error allows, 1 not at all",
            range: (0.0, 1.0),
            default: 0.5,
            whole: false,
        },
    ],
    build: |scene, settings, knobs| {
        let options = ProgressiveOptions {
            photons: knobs[0],
            nearest: knobs[1].round() as usize,
            radius: knobs[2] as f32,
            pixels: knobs[3] as f32,
            alpha: knobs[4],
        };
        Box::new(ProgressiveMapper::new(scene, settings, options))
    },
};

/// Settings of progressive photon mapping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgressiveOptions {
    /// Photons emitted in a pass, over the number of pixels.
    pub photons: f64,
    /// Photons of the pilot in the first radius, at least 2.
    pub nearest: usize,
    /// Greatest first radius, over that of the scene.
    pub radius: f32,
    /// Greatest first radius in pixels, as large as they are where it is.
    pub pixels: f32,
    /// How slowly radii shrink, in `[0, 1]`.
    pub alpha: f64,
}

/// The set of photons of a seed ([`Job::set`]) that first radii are taken from; others are numbered by passes.
const PILOT: u32 = u32::MAX;
/// The set that emission is aimed by, and that of paths from the camera that say where to.
const AIMING: u32 = u32::MAX - 1;
const VIEW: u32 = u32::MAX - 2;
/// Photons of the pilot over those of a pass.
const PILOT_SHARE: u32 = 4;
/// Fewest photons a pass, for the smallest images.
const FEWEST: f64 = 256.0;

/// Progressive photon mapping, of which every pass stands for itself.
///
/// A pass sends photons of its own and gathers them within radii that depend on its number alone: the squared radius of pass
/// `i + 1` is that of pass `i` times `(i + alpha) / (i + 1)` [Knaus and Zwicker 2011, eq. 15]. The variance of a pass grows as its
/// bias falls, so that the mean of all passes loses both. First radii are those in which a pilot of the seed finds its `nearest`
/// photons: they are small where light is, as in the original, and need no memory for pixels. No radius is larger than some pixels:
/// where hardly any photon comes, disks would reach past what they lie on, and lose light by that.
pub struct ProgressiveMapper {
    scene: Arc<Scene>,
    settings: Settings,
    options: ProgressiveOptions,
    pilot: Option<Pilot>,
    statistics: RenderStatistics,
}

/// The pilot of a seed for passes of so many photons.
struct Pilot {
    seed: u64,
    photons: u32,
    aim: Aim,
    map: PhotonMap,
}

/// The radius of a pass over the first pass's.
pub fn shrinkage(pass: u32, alpha: f64) -> f64 {
    // [Knaus and Zwicker 2011, eq. 15]
    (1..=pass).map(|i| (f64::from(i) + alpha) / (f64::from(i) + 1.0)).product::<f64>().sqrt()
}

impl ProgressiveMapper {
    /// A photon mapper for a scene; the pilot is traced when it is needed.
    pub fn new(scene: Arc<Scene>, settings: Settings, options: ProgressiveOptions) -> ProgressiveMapper {
        let statistics = RenderStatistics { memory_bytes: scene.memory_bytes(), ..RenderStatistics::default() };
        ProgressiveMapper { scene, settings, options, pilot: None, statistics }
    }

    /// The pilot of a seed: where the camera looks, then where photons have to start that come there, then first radii.
    fn pilot(&mut self, seed: u64, photons: u32, resolution: UVec2) -> Pilot {
        if photons == 0 {
            return Pilot { seed, photons, aim: Aim::default(), map: PhotonMap::new(Vec::new()) };
        }
        let (scene, settings) = (&*self.scene, &self.settings);
        let job =
            Job { scene, settings, store: Store::Scattered, aim: &Aim::default(), seed, set: AIMING, emitted: photons };
        let (view, found) = specialise_coarsely!(scene.has(), HAS => {
            (View::new::<HAS>(scene, settings, resolution, seed, VIEW), job.pilot::<HAS>())
        });
        self.statistics.merge(&view.1);
        self.statistics.merge(&found.statistics);
        let aim = Aim::at(&view.0.worth(&found));
        let map = self.trace(seed, PILOT, &aim, photons * PILOT_SHARE);
        Pilot { seed, photons, aim, map }
    }

    fn trace(&mut self, seed: u64, set: u32, aim: &Aim, emitted: u32) -> PhotonMap {
        let (scene, settings) = (&*self.scene, &self.settings);
        let job = Job { scene, settings, store: Store::Scattered, aim, seed, set, emitted };
        let traced = specialise_coarsely!(scene.has(), HAS => job.trace::<HAS>());
        self.statistics.merge(&traced.statistics);
        PhotonMap::new(traced.photons)
    }
}

impl Technique for ProgressiveMapper {
    fn pass(&mut self, seed: u64, pass: u32, film: &mut Film) {
        let start = Instant::now();
        let size = film.resolution();
        let pixels = f64::from(size.x) * f64::from(size.y);
        let wanted = |part| self.settings.parts.contains(part);
        let scattered = (wanted(Part::Indirect) || wanted(Part::Caustic))
            && self.settings.max_depth >= 3
            && takes_photons(self.scene.census());
        let photons = if scattered {
            (self.options.photons * pixels).clamp(FEWEST, f64::from(u32::MAX / PILOT_SHARE)) as u32
        } else {
            0
        };
        let pilot = match self.pilot.take() {
            Some(pilot) if (pilot.seed, pilot.photons) == (seed, photons) => pilot,
            _ => self.pilot(seed, photons, size),
        };
        let map = self.trace(seed, pass, &pilot.aim, photons);
        self.statistics.memory_bytes = self.scene.memory_bytes() + pilot.map.memory_bytes() + map.memory_bytes();
        self.statistics.add_time("photons", start.elapsed());

        let start = Instant::now();
        let gathering = Gathering {
            nearest: self.options.nearest,
            radius: self.options.radius * scene_radius(&self.scene),
            kernel: Kernel::Disk,
            parts: self.settings.parts,
            max_depth: self.settings.max_depth,
        };
        let eye = Eye {
            scene: &self.scene,
            settings: &self.settings,
            filter: film.filter(),
            caustics: None,
            indirect: Indirect::Progressive {
                photons: Source { map: &map, gathering },
                pilot: Source { map: &pilot.map, gathering },
                shrink: shrinkage(pass, self.options.alpha) as f32,
                pixels: self.options.pixels,
                footprint: Footprint::of(&self.scene, size),
            },
        };
        let settings = &self.settings;
        let counted = specialise_coarsely!(self.scene.has(), HAS => film.add_pass(
            SPPM.name,
            pass,
            || ((settings.sampler)(seed, settings.planned_passes), Neighbours::default()),
            |(sampler, found), pixel, statistics| {
                sampler.start_pixel(pixel, size.x, pass);
                eye.pixel_sample::<HAS>(pixel, &mut **sampler, found, &mut statistics.rays)
            },
        ));
        self.pilot = Some(pilot);
        self.statistics.merge(&counted);
        self.statistics.add_time("passes", start.elapsed());
    }

    fn statistics(&self) -> &RenderStatistics {
        &self.statistics
    }

    fn next_frame(&mut self, scene: Arc<Scene>) {
        self.statistics.memory_bytes = scene.memory_bytes();
        self.scene = scene;
        self.pilot = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_shrink_as_published() {
        // Gamma functions of the closed form, by the recurrence itself for a few passes.
        assert_eq!(shrinkage(0, 0.5), 1.0);
        assert!((shrinkage(1, 0.5).powi(2) - 1.5 / 2.0).abs() < 1e-12);
        assert!((shrinkage(2, 0.5).powi(2) - 1.5 / 2.0 * 2.5 / 3.0).abs() < 1e-12);
        assert_eq!(shrinkage(1000, 1.0), 1.0);
        // Radii squared fall as the (1 - alpha)-th power of the number of passes.
        for alpha in [0.3, 2.0 / 3.0] {
            let slope = (shrinkage(200_000, alpha) / shrinkage(100_000, alpha)).powi(2).log2();
            assert!((slope - (alpha - 1.0)).abs() < 1e-4, "{slope}");
        }
    }
}
