//! Photon mapping.

use crate::{
    aim::Aim,
    clear::is_clear,
    eye::{Eye, Indirect, Source},
    kd_tree::Neighbours,
    kernel::Kernel,
    map::{Gathering, IrradianceMap, PhotonMap},
    surfaces::{has_caustics, takes_photons},
    trace::{Job, Store},
};
use etendue_core::{
    film::Film,
    scene::Scene,
    specialise_coarsely,
    statistics::render::RenderStatistics,
    technique::{Bias, Chain, Knob, Part, Parts, Settings, Technique, TechniqueInfo},
};
use std::{sync::Arc, time::Instant};

/// Photon mapping as it is registered.
pub static PHOTON: TechniqueInfo = TechniqueInfo {
    name: "photon",
    summary: "photon mapping: caustics from a photon map, indirect light by final gathering over another",
    paper: "Jensen 1996, 2001; Christensen 1999",
    bias: Bias::Bounded,
    covers: Parts::ALL,
    blind_spots: "point, spot and directional lights seen through mirrors or glass",
    misses: |knobs| match Options::from_knobs(knobs).caustic_photons {
        0 => &[Chain::LightThroughDelta, Chain::Caustic, Chain::CausticThroughDelta],
        _ => &[Chain::LightThroughDelta],
    },
    knobs: &[
        Knob {
            name: "caustic_photons",
            summary: "photons in the caustic map, about; 0: caustics are left to paths",
            range: (0.0, 1e8),
            default: 50_000.0,
            whole: true,
        },
        Knob {
            name: "global_photons",
            summary: "photons in the global map, about",
            range: (0.0, 1e8),
            default: 20_000.0,
            whole: true,
        },
        Knob { name: "nearest", summary: "photons in an estimate", range: (2.0, 1e5), default: 50.0, whole: true },
        Knob {
            name: "caustic_radius",
            summary: "greatest radius of an estimate from the caustic map, over that of the scene",
            range: (1e-6, 10.0),
            default: 0.03,
            whole: false,
        },
        Knob {
            name: "global_radius",
            summary: "greatest radius of an estimate from the global map, over that of the scene",
            range: (1e-6, 10.0),
            default: 0.1,
            whole: false,
        },
        Knob {
            name: "indirect",
            summary: "indirect light: 0 by paths, 1 by final gathering, 2 the global map shown as it is",
            range: (0.0, 2.0),
            default: 1.0,
            whole: true,
        },
        Knob {
            name: "irradiance",
            summary: "photons for each place that irradiance is computed ahead at; 0: it is not",
            range: (0.0, 1e4),
            default: 4.0,
            whole: true,
        },
        Knob {
            name: "kernel",
            summary: "how photons count by distance: 0 alike, 1 a cone, 2 a Gaussian",
            range: (0.0, 2.0),
            default: 1.0,
            whole: true,
        },
        Knob {
            name: "renew",
            summary: "maps are made anew after so many samples for each photon asked for; 0: one serves all",
            range: (0.0, 1e6),
            default: 4.0,
            whole: false,
        },
    ],
    build: |scene, settings, knobs| Box::new(PhotonMapper::new(scene, settings, Options::from_knobs(knobs))),
};

/// Where indirect light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndirectLight {
    /// Paths go on to the end: maps are for caustics alone.
    Paths,
    /// Final gathering: one more edge of a path, and what the global map says at its end.
    Gather,
    /// The global map where the camera sees it, direct light included.
    Show,
}

/// Settings of photon mapping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Photons in the caustic map, about; 0: no map, and caustics are left to paths.
    pub caustic_photons: u32,
    /// Photons in the global map, about.
    pub global_photons: u32,
    /// Photons in an estimate, at least 2.
    pub nearest: usize,
    /// Greatest radius of an estimate from the caustic map, over that of the scene.
    pub caustic_radius: f32,
    /// The same for the global map.
    pub global_radius: f32,
    /// Where indirect light comes from.
    pub indirect: IndirectLight,
    /// Photons of the global map for each place that irradiance is computed ahead at; 0: it is not.
    pub irradiance_every: usize,
    /// How photons count by distance.
    pub kernel: Kernel,
    /// Maps are made anew after so many samples for each photon asked for; 0: one serves all.
    pub renew: f64,
}

impl Default for Options {
    fn default() -> Options {
        let defaults: Vec<f64> = PHOTON.knobs.iter().map(|k| k.default).collect();
        Options::from_knobs(&defaults)
    }
}

impl Options {
    /// From values of the knobs of [`PHOTON`], in order.
    pub fn from_knobs(knobs: &[f64]) -> Options {
        Options {
            caustic_photons: knobs[0].round() as u32,
            global_photons: knobs[1].round() as u32,
            nearest: knobs[2].round() as usize,
            caustic_radius: knobs[3] as f32,
            global_radius: knobs[4] as f32,
            indirect: match knobs[5].round() as u32 {
                0 => IndirectLight::Paths,
                1 => IndirectLight::Gather,
                _ => IndirectLight::Show,
            },
            irradiance_every: knobs[6].round() as usize,
            kernel: Kernel::ALL[knobs[7].round() as usize],
            renew: knobs[8],
        }
    }
}

/// Sets of photons of a seed ([`Job::set`]): numbers that no pixel has. Maps that are made anew have the sets below the first
/// [`SETS`].
const CAUSTIC_PILOT: u32 = u32::MAX;
const GLOBAL_PILOT: u32 = u32::MAX - 1;
const CAUSTIC: u32 = u32::MAX - 2;
const GLOBAL: u32 = u32::MAX - 3;
const PLACES: u32 = u32::MAX - 4;
/// Sets that are traced for the maps of a number.
const SETS: u32 = 3;

/// Emissions of a pilot.
const PILOT: u32 = 1 << 14;
/// Most emissions for a photon that is wanted: where hardly any arrive, hardly any are traced.
const MOST_EMISSIONS: f64 = 16.0;

/// Half the diagonal of what is visible, metres; 0 where nothing is.
pub(crate) fn scene_radius(scene: &Scene) -> f32 {
    scene.geometry().bounds().map_or(0.0, |(low, high)| 0.5 * low.distance(high))
}

/// How the photons of a map are emitted.
struct Emission {
    aim: Aim,
    emitted: u32,
}

/// How the photons of a seed are emitted, map by map; none where there is no map.
struct Emissions {
    seed: u64,
    caustics: Option<Emission>,
    global: Option<Emission>,
}

/// Maps of a seed, of which the first have the number 0.
struct Maps {
    seed: u64,
    number: u32,
    caustics: Option<PhotonMap>,
    global: Option<PhotonMap>,
    irradiance: Option<IrradianceMap>,
}

impl Maps {
    fn memory_bytes(&self) -> u64 {
        let maps = [&self.caustics, &self.global].into_iter().flatten();
        maps.map(PhotonMap::memory_bytes).sum::<u64>() + self.irradiance.as_ref().map_or(0, |i| i.tree.memory_bytes())
    }
}

/// The photon mapper.
///
/// Maps are made by the first pass that asks for them: they depend on the seed and on the number of the pass alone.
pub struct PhotonMapper {
    scene: Arc<Scene>,
    settings: Settings,
    options: Options,
    emissions: Option<Emissions>,
    maps: Option<Maps>,
    statistics: RenderStatistics,
}

impl PhotonMapper {
    /// A photon mapper for a scene; maps are made when they are needed.
    pub fn new(scene: Arc<Scene>, settings: Settings, options: Options) -> PhotonMapper {
        let statistics = RenderStatistics { memory_bytes: scene.memory_bytes(), ..RenderStatistics::default() };
        PhotonMapper { scene, settings, options, emissions: None, maps: None, statistics }
    }

    /// The photons of the caustic map of the last seed, if there is a map.
    pub fn caustic_map(&self) -> Option<&PhotonMap> {
        self.maps.as_ref()?.caustics.as_ref()
    }

    /// The photons of the global map of the last seed, if there is a map.
    pub fn global_map(&self) -> Option<&PhotonMap> {
        self.maps.as_ref()?.global.as_ref()
    }

    /// The number of the maps that a pass takes, of so many samples.
    fn number(&self, pass: u32, samples: f64) -> u32 {
        let photons = f64::from(self.options.caustic_photons) + f64::from(self.options.global_photons);
        let passes = (self.options.renew * photons / samples).ceil();
        if passes >= 1.0 { (f64::from(pass) / passes) as u32 } else { 0 }
    }

    /// Makes the maps of a number of a seed, if they are not there yet.
    pub fn prepare(&mut self, seed: u64, number: u32) {
        if self.maps.as_ref().is_some_and(|maps| (maps.seed, maps.number) == (seed, number)) {
            return;
        }
        let start = Instant::now();
        let emissions = match self.emissions.take() {
            Some(emissions) if emissions.seed == seed => emissions,
            _ => self.plan(seed),
        };
        let caustics =
            emissions.caustics.as_ref().map(|e| self.map(seed, Store::Caustic, e, CAUSTIC.wrapping_sub(SETS * number)));
        let global =
            emissions.global.as_ref().map(|e| self.map(seed, Store::All, e, GLOBAL.wrapping_sub(SETS * number)));
        let every = self.options.irradiance_every;
        let ahead = every > 0 && self.options.indirect == IndirectLight::Gather;
        let places = emissions.global.as_ref().filter(|_| ahead).map(|e| {
            let fewer = Emission { aim: e.aim.clone(), emitted: e.emitted.div_ceil(every as u32) };
            self.map(seed, Store::All, &fewer, PLACES.wrapping_sub(SETS * number))
        });
        self.emissions = Some(emissions);
        self.statistics.add_time("photons", start.elapsed());
        let start = Instant::now();
        let irradiance = global.as_ref().zip(places).map(|(map, places)| {
            let (scene, gathering) = (&*self.scene, self.gathering(self.options.global_radius));
            specialise_coarsely!(scene.has(), HAS => {
                map.irradiance(places, every, &gathering, |p, n, radius| is_clear::<HAS>(scene, p, n, radius))
            })
        });
        if irradiance.is_some() {
            self.statistics.add_time("irradiance", start.elapsed());
        }
        let maps = Maps { seed, number, caustics, global, irradiance };
        self.statistics.memory_bytes = self.scene.memory_bytes() + maps.memory_bytes();
        self.maps = Some(maps);
    }

    /// Which maps are called for, and how many photons have to be emitted for each.
    fn plan(&mut self, seed: u64) -> Emissions {
        let wanted = |part| self.settings.parts.contains(part);
        let indirect = wanted(Part::Indirect) || wanted(Part::Caustic);
        // A light, a surface in between, one that takes photons, and the camera.
        let far_enough = self.settings.max_depth >= 3;
        let options = self.options;
        let caustics = has_caustics(self.scene.census())
            && options.indirect != IndirectLight::Show
            && options.caustic_photons > 0
            && indirect
            && far_enough;
        let global = options.global_photons > 0
            && takes_photons(self.scene.census())
            && match options.indirect {
                IndirectLight::Paths => false,
                IndirectLight::Gather => indirect && far_enough,
                IndirectLight::Show => indirect || wanted(Part::Direct) || wanted(Part::Environment),
            };
        let caustics = caustics.then(|| self.pilot(seed, Store::Caustic, options.caustic_photons, CAUSTIC_PILOT));
        let global = global.then(|| self.pilot(seed, Store::All, options.global_photons, GLOBAL_PILOT));
        Emissions { seed, caustics, global }
    }

    /// The settings that photons of a map are traced with.
    fn photon_settings(&self, store: Store) -> Settings {
        // Photons for final gathering are a path's further edge away from the camera.
        let max_depth = match (store, self.options.indirect) {
            (Store::All, IndirectLight::Gather) => self.settings.max_depth - 1,
            _ => self.settings.max_depth,
        };
        Settings { max_depth, ..self.settings }
    }

    /// A pilot for a map of about so many photons: it tells how many have to be emitted, and for caustics where to.
    fn pilot(&mut self, seed: u64, store: Store, photons: u32, set: u32) -> Emission {
        let (scene, settings) = (&*self.scene, &self.photon_settings(store));
        let pilot = Job { scene, settings, store, aim: &Aim::default(), seed, set, emitted: PILOT.min(photons) };
        let found = specialise_coarsely!(scene.has(), HAS => pilot.pilot::<HAS>());
        self.statistics.merge(&found.statistics);
        let fruitful = found.by_number();
        let aim = if store == Store::Caustic { Aim::at(&fruitful) } else { Aim::default() };
        // What an aimed emission yields, seen from the pilot's.
        let stored: f64 = fruitful.iter().map(|f| f.2 * f64::from(aim.density(f.0, f.1))).sum();
        let emitted = match f64::from(photons) * f64::from(pilot.emitted) / stored {
            n if stored > 0.0 => n.min(MOST_EMISSIONS * f64::from(photons)),
            _ => f64::from(pilot.emitted),
        };
        Emission { aim, emitted: emitted.clamp(1.0, f64::from(u32::MAX)) as u32 }
    }

    fn map(&mut self, seed: u64, store: Store, emission: &Emission, set: u32) -> PhotonMap {
        let (scene, settings) = (&*self.scene, &self.photon_settings(store));
        let Emission { aim, emitted } = emission;
        let job = Job { scene, settings, store, aim, seed, set, emitted: *emitted };
        let traced = specialise_coarsely!(scene.has(), HAS => job.trace::<HAS>());
        self.statistics.merge(&traced.statistics);
        PhotonMap::new(traced.photons)
    }

    fn gathering(&self, radius: f32) -> Gathering {
        Gathering {
            nearest: self.options.nearest,
            radius: radius * scene_radius(&self.scene),
            kernel: self.options.kernel,
            parts: self.settings.parts,
            max_depth: self.settings.max_depth,
        }
    }
}

impl Technique for PhotonMapper {
    fn pass(&mut self, seed: u64, pass: u32, film: &mut Film) {
        let (width, height) = (film.resolution().x, film.resolution().y);
        self.prepare(seed, self.number(pass, f64::from(width) * f64::from(height)));
        let start = Instant::now();
        let source = |map, radius| Some(Source { map, gathering: self.gathering(radius) });
        let caustics = self.caustic_map().and_then(|map| source(map, self.options.caustic_radius));
        let global = self.global_map().and_then(|map| source(map, self.options.global_radius));
        let irradiance = self.maps.as_ref().and_then(|maps| maps.irradiance.as_ref());
        let eye = Eye {
            scene: &self.scene,
            settings: &self.settings,
            filter: film.filter(),
            caustics,
            indirect: match self.options.indirect {
                IndirectLight::Paths => Indirect::Paths,
                IndirectLight::Gather => Indirect::Gather { global, irradiance },
                IndirectLight::Show => Indirect::Show { global },
            },
        };
        let settings = &self.settings;
        let counted = specialise_coarsely!(self.scene.has(), HAS => film.add_pass(
            PHOTON.name,
            pass,
            || ((settings.sampler)(seed, settings.planned_passes), Neighbours::default()),
            |(sampler, found), pixel, statistics| {
                sampler.start_pixel(pixel, width, pass);
                eye.pixel_sample::<HAS>(pixel, &mut **sampler, found, &mut statistics.rays)
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
        (self.emissions, self.maps) = (None, None);
    }
}
