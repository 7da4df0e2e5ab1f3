//! A scene and a technique that are to make an image, and the engine that makes it.

use crate::{
    clock::{Cost, timed},
    coverage,
    error::Error,
    hash::scene_hash,
    samplers::{self, SamplerInfo},
    techniques,
};
use etendue_core::{
    camera::{CameraDescription, Crop},
    film::Film,
    scene::Scene,
    statistics::render::RenderStatistics,
    technique::{Part, Parts, Settings, Technique, TechniqueInfo},
};
use etendue_scenes::{LoadOptions, LoadedScene};
use glam::UVec2;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, str::FromStr, sync::Arc};

/// A size as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Width and height.
    Exact(UVec2),
    /// The longer side; the other follows from the scene's own camera.
    Longest(u32),
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Size, String> {
        let number =
            |t: &str| t.parse::<u32>().map_err(|_| format!("`{text}` is not WIDTHxHEIGHT or a number of pixels"));
        let (least, size) = match text.split_once('x') {
            Some((w, h)) => {
                let size = UVec2::new(number(w)?, number(h)?);
                (size, Size::Exact(size))
            }
            // The other side follows from the camera and may be as short as one pixel.
            None => (UVec2::new(number(text)?, 1), Size::Longest(number(text)?)),
        };
        if least.min_element() == 0 {
            return Err("width and height must be at least 1".into());
        }
        check_film(least).map_err(|reason| format!("`{text}`: {reason}"))?;
        Ok(size)
    }
}

/// Refuses images that are larger than any film.
fn check_film(size: UVec2) -> Result<(), String> {
    let pixels = u64::from(size.x) * u64::from(size.y);
    if size.max_element() > Film::MOST_PER_SIDE || pixels > Film::MOST_PIXELS {
        let (side, most) = (Film::MOST_PER_SIDE, Film::MOST_PIXELS);
        return Err(format!("an image has at most {side} pixels a side and {most} in all"));
    }
    Ok(())
}

impl Size {
    /// As a number of pixels, for a camera of the given resolution.
    pub fn of(self, camera: UVec2) -> UVec2 {
        match self {
            Size::Exact(size) => size,
            Size::Longest(longest) => {
                let longer = f64::from(camera.max_element().max(1));
                let side = |s: u32| ((f64::from(s) * f64::from(longest) / longer).round() as u32).max(1);
                UVec2::new(side(camera.x), side(camera.y))
            }
        }
    }

    /// Gives a camera's image this size; around a crop the film grows or shrinks with it.
    fn apply(self, camera: &mut CameraDescription) {
        let Some(crop) = &mut camera.crop else {
            camera.resolution = self.of(camera.resolution);
            return;
        };
        let size = self.of(crop.size);
        let factor = size.as_dvec2() / crop.size.as_dvec2();
        let scaled = |v: UVec2| (v.as_dvec2() * factor).round().as_uvec2();
        *crop = Crop { offset: scaled(crop.offset), size };
        camera.resolution = scaled(camera.resolution).max(crop.offset + crop.size);
    }
}

/// What an image is of: all that its pixels depend on beside the seed and the passes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImageKey {
    /// The scene as it was called on the command line; two images of one scene may differ in it.
    pub scene: String,
    /// [`scene_hash`].
    pub scene_hash: String,
    /// Technique.
    pub technique: String,
    /// Its knobs.
    pub knobs: BTreeMap<String, f64>,
    /// Sampler.
    pub sampler: String,
    /// Parts of the light.
    pub parts: Vec<String>,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Longest path.
    pub depth: u32,
}

impl ImageKey {
    /// What differs between two images, said with both values; none if they are of the same thing.
    pub fn difference(&self, other: &ImageKey) -> Option<String> {
        fn differ<T: PartialEq + std::fmt::Debug>(name: &str, a: &T, b: &T) -> Option<String> {
            (a != b).then(|| format!("{name} {a:?} and {b:?}"))
        }
        differ("scene hash", &self.scene_hash, &other.scene_hash)
            .map(|d| format!("{d} (scenes `{}` and `{}`)", self.scene, other.scene))
            .or_else(|| differ("technique", &self.technique, &other.technique))
            .or_else(|| differ("knobs", &self.knobs, &other.knobs))
            .or_else(|| differ("sampler", &self.sampler, &other.sampler))
            .or_else(|| differ("parts", &self.parts, &other.parts))
            .or_else(|| differ("size", &(self.width, self.height), &(other.width, other.height)))
            .or_else(|| differ("depth", &self.depth, &other.depth))
    }

    /// Width and height.
    pub fn size(&self) -> UVec2 {
        UVec2::new(self.width, self.height)
    }
}

/// What is asked for beside the scene; `None` takes the scene's own.
#[derive(Clone, Debug)]
pub struct Wish {
    /// Technique.
    pub technique: String,
    /// Knobs as `name=value`.
    pub knobs: Vec<String>,
    /// Sampler.
    pub sampler: String,
    /// Names of the parts of the light; empty: all.
    pub parts: Vec<String>,
    /// Size.
    pub size: Option<Size>,
    /// Longest path.
    pub depth: Option<u32>,
    /// How a scene file is loaded.
    pub load: LoadOptions,
}

/// A loaded scene with all that a render of it is told.
#[derive(Clone)]
pub struct Job {
    /// What the image is of.
    pub key: ImageKey,
    /// The scene as loaded, at the size of the key.
    pub scene: LoadedScene,
    /// How it was loaded.
    pub load: LoadOptions,
    technique: &'static TechniqueInfo,
    knobs: Vec<f64>,
    sampler: &'static SamplerInfo,
    parts: Parts,
}

impl Job {
    /// Loads a scene and checks what is wished.
    pub fn load(spec: &str, wish: &Wish) -> Result<Job, Error> {
        let technique = techniques::find(&wish.technique)?;
        let knobs = techniques::knobs(technique, &wish.knobs)?;
        let sampler = samplers::find(&wish.sampler)?;
        let parts = parse_parts(&wish.parts)?;
        if wish.depth == Some(0) {
            return Err(Error::Input("--depth 0: a path has at least length 1, which is emission alone".into()));
        }
        let mut scene = etendue_scenes::load_with(spec, wish.load)?;
        if let (Some(size), Some(camera)) = (wish.size, &mut scene.description.camera) {
            size.apply(camera);
        }
        let size = scene.description.camera.as_ref().map_or(UVec2::ZERO, CameraDescription::film_size);
        check_film(size)
            .map_err(|reason| Error::Input(format!("{spec} at {}x{}: {reason}; --size takes less", size.x, size.y)))?;
        let key = ImageKey {
            scene: spec.to_owned(),
            scene_hash: scene_hash(&scene),
            technique: technique.name.to_owned(),
            knobs: techniques::named_knobs(technique, &knobs),
            sampler: sampler.name.to_owned(),
            parts: Part::ALL.into_iter().filter(|p| parts.contains(*p)).map(|p| p.name().to_owned()).collect(),
            width: size.x,
            height: size.y,
            depth: wish.depth.unwrap_or(scene.max_depth),
        };
        Ok(Job { key, scene, load: wish.load, technique, knobs, sampler, parts })
    }

    /// The same image by another technique, with its knobs at their defaults.
    pub fn by(mut self, technique: &str) -> Result<Job, Error> {
        self.technique = techniques::find(technique)?;
        self.knobs = techniques::knobs(self.technique, &[])?;
        self.key.technique = self.technique.name.to_owned();
        self.key.knobs = techniques::named_knobs(self.technique, &self.knobs);
        Ok(self)
    }

    /// Light that the image will lack because the technique cannot render it, said in sentences.
    pub fn gaps(&self) -> Vec<String> {
        coverage::gaps(&self.scene.description, self.key.depth, self.parts, &[self.choice()])
    }

    /// The technique with the values of its knobs.
    pub fn choice(&self) -> coverage::Choice {
        (self.technique, self.knobs.clone())
    }

    /// Builds the scene and the technique on a pool of threads. Only what building takes is on the clock.
    pub fn build(&self, threads: usize, planned_passes: u32) -> Result<Engine, Error> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|e| Error::Input(format!("--threads {threads}: {e}")))?;
        let settings = Settings {
            max_depth: self.key.depth,
            roulette_depth: self.scene.roulette_depth,
            parts: self.parts,
            sampler: self.sampler.build,
            planned_passes: if self.sampler.plans { planned_passes } else { 0 },
        };
        let (built, build) = timed(|| {
            pool.install(|| {
                let scene = Arc::new(Scene::new(&self.scene.description)?);
                Ok::<_, etendue_core::scene::SceneError>((
                    scene.clone(),
                    (self.technique.build)(scene, settings, &self.knobs),
                ))
            })
        });
        let (scene, technique) = built.map_err(|source| Error::Scene { scene: self.key.scene.clone(), source })?;
        let film = Film::new(self.key.size(), self.scene.filter);
        Ok(Engine { pool, technique, scene, film, build, passes: Cost::default() })
    }
}

/// The set of the named parts; all without a name.
fn parse_parts(names: &[String]) -> Result<Parts, Error> {
    if names.is_empty() {
        return Ok(Parts::ALL);
    }
    names.iter().try_fold(Parts::NONE, |parts, name| {
        let part = Part::ALL.into_iter().find(|p| p.name() == name).ok_or_else(|| {
            let known = Part::ALL.map(Part::name).join(", ");
            Error::Input(format!("--parts {name}: there is no such part of the light; there is: {known}"))
        })?;
        Ok(parts.with(part))
    })
}

/// A technique at work, with its film and its clock.
pub struct Engine {
    pool: rayon::ThreadPool,
    technique: Box<dyn Technique>,
    /// The scene.
    pub scene: Arc<Scene>,
    /// The passes so far.
    pub film: Film,
    /// What building the scene and the technique cost.
    pub build: Cost,
    /// What the passes cost so far.
    pub passes: Cost,
}

impl Engine {
    /// Adds a pass to the film, on the clock.
    pub fn pass(&mut self, seed: u64, pass: u32) {
        let ((), cost) = timed(|| self.pool.install(|| self.technique.pass(seed, pass, &mut self.film)));
        self.passes += cost;
    }

    /// Building and passes.
    pub fn total(&self) -> Cost {
        let mut total = self.build;
        total += self.passes;
        total
    }

    /// What the technique counted.
    pub fn statistics(&self) -> &RenderStatistics {
        self.technique.statistics()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!("64x32".parse(), Ok(Size::Exact(UVec2::new(64, 32))));
        assert_eq!("64".parse(), Ok(Size::Longest(64)));
        assert_eq!(Size::Longest(128).of(UVec2::new(768, 512)), UVec2::new(128, 85));
        assert_eq!(Size::Longest(4).of(UVec2::new(1, 100)), UVec2::new(1, 4));
        assert_eq!("65536x4096".parse(), Ok(Size::Exact(UVec2::new(65_536, 4096))));
        assert_eq!("65536".parse(), Ok(Size::Longest(65_536)));
        for large in ["65537", "65537x1", "1x65537", "65536x4097", "16385x16384"] {
            let error = large.parse::<Size>().unwrap_err();
            assert!(error.contains("65536 pixels a side") && error.contains("268435456"), "{error}");
        }
        // The longer side alone does not tell that the image is too large.
        let error =
            Job::load("cornell", &crate::reference::wish(Some(Size::Longest(65_536)), None, Default::default()));
        assert!(error.err().unwrap().to_string().contains("--size takes less"));
        for bad in ["0x0", "0", "64x", "x", "", "-1x4", "1e3", "4294967296", "99999x99999", "64x64x64"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }

    #[test]
    fn a_crop_keeps_its_place_at_another_size() {
        let mut camera = etendue_scenes::load("cornell").unwrap().description.camera.unwrap();
        camera.resolution = UVec2::new(100, 80);
        camera.crop = Some(Crop { offset: UVec2::new(10, 20), size: UVec2::new(40, 30) });
        assert_eq!(camera.film_size(), UVec2::new(40, 30));
        Size::Longest(20).apply(&mut camera);
        assert_eq!(camera.crop, Some(Crop { offset: UVec2::new(5, 10), size: UVec2::new(20, 15) }));
        assert_eq!((camera.resolution, camera.film_size()), (UVec2::new(50, 40), UVec2::new(20, 15)));
        // Rounding never puts the crop outside of the film.
        camera.resolution = UVec2::new(7, 7);
        camera.crop = Some(Crop { offset: UVec2::new(5, 5), size: UVec2::new(2, 2) });
        for n in 1..20 {
            let mut camera = camera.clone();
            Size::Longest(n).apply(&mut camera);
            let crop = camera.crop.unwrap();
            assert!(crop.size == UVec2::splat(n) && (crop.offset + crop.size).cmple(camera.resolution).all(), "{n}");
        }
    }

    #[test]
    fn keys_say_what_differs() {
        let wish = Wish {
            technique: "path".into(),
            knobs: vec![],
            sampler: "independent".into(),
            parts: vec![],
            size: Some(Size::Longest(8)),
            depth: None,
            load: LoadOptions::default(),
        };
        let key = Job::load("cornell", &wish).unwrap().key;
        let renamed = ImageKey { scene: "./cornell".into(), ..key.clone() };
        assert_eq!(key.difference(&renamed), None);
        let deeper = ImageKey { depth: key.depth + 1, ..key.clone() };
        assert!(key.difference(&deeper).unwrap().starts_with("depth"));
        let direct = Job::load("cornell", &Wish { parts: vec!["direct".into()], ..wish }).unwrap().key;
        assert!(key.difference(&direct).unwrap().starts_with("parts"));
    }

    #[test]
    fn an_invalid_scene_is_refused_by_name() {
        let wish = crate::reference::wish(Some(Size::Longest(8)), None, LoadOptions::default());
        let mut job = Job::load("cornell", &wish).unwrap();
        job.scene.description.objects[0].material = usize::MAX;
        let object = job.scene.description.objects[0].name.clone();
        let error = job.build(1, 0).err().unwrap();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().starts_with("cornell: ") && error.to_string().contains(&object), "{error}");
    }
}
