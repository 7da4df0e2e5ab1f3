//! Helpers shared by the cross-crate tests.

pub mod small;

/// The README's example, compiled and run as it stands.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

use etendue_core::{
    film::Film,
    filter::Filter,
    independent::independent,
    rgb::Rgb,
    scene::{Scene, SceneDescription},
    statistics::special::student_t_quantile,
    technique::{Bias, Settings, TechniqueInfo},
};
use etendue_scenes::LoadedScene;
use glam::UVec2;
use std::{ops::Range, path::PathBuf, sync::Arc};

/// The folder of scenes and references from elsewhere; `None`, with a printed reason, where it is absent.
pub fn shared(what: &str) -> Option<PathBuf> {
    let root = std::env::var_os("ETENDUE_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    let path = root.join(what);
    if path.exists() {
        Some(path)
    } else {
        println!("skipped: {} is not there (set ETENDUE_SHARED)", path.display());
        None
    }
}

/// Two-sided limit, in standard errors that come from `replicates` replicates, with the significance that four standard
/// errors have when they are known exactly.
pub fn limit(replicates: u64) -> f64 {
    student_t_quantile(1.0 - 3.167e-5, (replicates - 1) as f64)
}

/// How far the expected image of a technique may be from the true one, relative to it: nothing where there is no bias, else
/// what photon maps blur over edges and around curves.
pub fn bias_allowance(technique: &TechniqueInfo) -> f64 {
    match technique.bias {
        Bias::Unbiased => 0.0,
        Bias::Consistent | Bias::Bounded => 0.03,
    }
}

/// The techniques that find a spot or a lobe however small: all but light tracing, whose particles land there by chance alone.
pub fn aiming() -> impl Iterator<Item = &'static TechniqueInfo> {
    xtask::techniques::TECHNIQUES.iter().copied().filter(|t| t.name != etendue_bidir::LIGHT.name)
}

/// A scene at work with a technique.
pub struct Run {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Pixels.
    pub resolution: UVec2,
    /// Pixel filter.
    pub filter: Filter,
    /// Settings.
    pub settings: Settings,
}

impl Run {
    /// A loaded scene at its own size and depth.
    ///
    /// # Panics
    /// When the scene is refused or has no camera.
    pub fn new(loaded: &LoadedScene) -> Run {
        let mut run = Run::of(&loaded.description, loaded.filter, loaded.max_depth);
        run.settings.roulette_depth = loaded.roulette_depth;
        run
    }

    /// A described scene at its camera's size.
    ///
    /// # Panics
    /// When the scene is refused.
    pub fn of(description: &SceneDescription, filter: Filter, max_depth: u32) -> Run {
        let scene = Scene::new(description).unwrap_or_else(|e| panic!("{}: {e}", description.name));
        Run {
            resolution: description.camera.as_ref().expect("a scene has a camera").film_size(),
            scene: Arc::new(scene),
            filter,
            settings: Settings::new(max_depth, independent),
        }
    }

    /// A built-in scene of `size` x `size` pixels.
    ///
    /// # Panics
    /// When the name is unknown.
    pub fn builtin(spec: &str, size: u32) -> Run {
        let mut loaded = etendue_scenes::load(spec).expect("a built-in scene");
        loaded.description.camera.as_mut().expect("a scene has a camera").resolution = UVec2::splat(size);
        Run::new(&loaded)
    }

    /// Renders some passes. A sample that the film rejects fails the test.
    ///
    /// # Panics
    /// When a sample is rejected.
    pub fn film(&self, technique: &TechniqueInfo, seed: u64, passes: Range<u32>) -> Film {
        let defaults: Vec<f64> = technique.knobs.iter().map(|k| k.default).collect();
        let mut running = (technique.build)(self.scene.clone(), self.settings, &defaults);
        let mut film = Film::new(self.resolution, self.filter);
        for pass in passes {
            running.pass(seed, pass, &mut film);
        }
        let statistics = running.statistics();
        assert_eq!(statistics.rejected, 0, "rejected samples: {:?}", statistics.rejected_samples);
        film
    }

    /// Independent estimates of the image: one a seed.
    pub fn replicates(&self, technique: &TechniqueInfo, seeds: Range<u64>, passes: u32) -> Vec<Vec<Rgb>> {
        seeds.map(|seed| self.film(technique, seed, 0..passes).mean_image()).collect()
    }
}
