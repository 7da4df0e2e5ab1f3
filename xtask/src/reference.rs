//! `reference`: ground truth with its own noise stated, and how it is stored.

use crate::{
    cli::ReferenceArgs,
    clock::human_seconds,
    coverage,
    error::Error,
    exr_file::{ExrFile, picture_of},
    files,
    hash::{Fnv, derive_seed},
    interrupt,
    job::{ImageKey, Job, Size, Wish},
    picture::Picture,
    progress::Progress,
    render::Budget,
};
use etendue_core::{effects::Census, rgb::Rgb, technique::Chain};
use etendue_scenes::LoadOptions;
use serde::{Deserialize, Serialize};
use std::{
    borrow::Cow,
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::Command,
};

/// The longer side of a stored reference, and of a study's images, unless told otherwise.
pub const DEFAULT_SIZE: Size = Size::Longest(128);
/// Prefix of the channels that hold the variance of the mean.
const VARIANCE: &str = "variance.";
/// Channel that is 1 in the pixels that errors are measured in.
const REGION: &str = "region";
/// Which of the seeds drawn from a seed is the references': one past the replicates', whose numbers have 32 bits.
const SEED_INDEX: u64 = 1 << 32;
/// Seconds a scene when nothing is said.
const DEFAULT_SECONDS: f64 = 60.0;
/// Fewest passes from which a variance is told.
const FEWEST_PASSES: u32 = 2;

/// How a reference was made and how far it can be trusted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceEntry {
    /// The scene as it was called.
    pub scene: String,
    /// Hash of the scene.
    pub scene_hash: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Longest path.
    pub depth: u32,
    /// What made it.
    pub technique: String,
    /// Passes, each one sample a pixel.
    pub passes: u32,
    /// Seed of the passes.
    pub seed: u64,
    /// Seconds that it took.
    pub seconds: f64,
    /// The revision of this program that made it.
    pub commit: Option<String>,
    /// Its own error: what its noise adds to any relMSE, estimated from the scatter of its passes.
    pub relmse: Option<f64>,
    /// What to know before trusting it; may be empty.
    pub note: String,
}

/// A reference in memory.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The image.
    pub picture: Picture,
    /// Variance of each pixel's mean, if known.
    pub variance: Option<Vec<Rgb>>,
    /// Which pixels errors are measured in; all without it.
    pub region: Option<Vec<bool>>,
}

impl Reference {
    /// Reads an image and, if it has it, its variance.
    pub fn read(path: &Path) -> Result<Reference, Error> {
        let file = ExrFile::read(path)?;
        let picture = picture_of(&file, path)?;
        if let Some(i) = picture.pixels.iter().position(|p| !p.to_array().iter().all(|v| v.is_finite())) {
            let (x, y) = (i as u32 % picture.size.x, i as u32 / picture.size.x);
            let reason = format!("is no reference: pixel ({x}, {y}) is not finite");
            return Err(Error::Content { path: path.into(), reason });
        }
        let region = file.channels.get(REGION).map(|values| values.iter().map(|v| *v > 0.0).collect());
        Ok(Reference { picture, variance: file.layer(VARIANCE), region })
    }

    /// Writes image and variance.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let mut file = ExrFile::of(&self.picture);
        if let Some(variance) = &self.variance {
            file.add_layer(VARIANCE, variance.iter().map(|v| v.to_array()));
        }
        if let Some(region) = &self.region {
            file.channels.insert(REGION.into(), region.iter().map(|inside| f32::from(*inside)).collect());
        }
        file.write(path)
    }

    /// The pixels of an image of the same size that errors are measured in.
    pub fn measured<'a>(&self, pixels: &'a [Rgb]) -> Cow<'a, [Rgb]> {
        match &self.region {
            None => Cow::Borrowed(pixels),
            Some(region) => pixels.iter().zip(region).filter(|(_, inside)| **inside).map(|(p, _)| *p).collect(),
        }
    }

    /// The relMSE that the reference's own noise causes: the mean of variance / (reference² + 0.01).
    pub fn own_relmse(&self) -> Option<f64> {
        let (variance, pixels) = (self.measured(self.variance.as_ref()?), self.measured(&self.picture.pixels));
        let relative = |(v, r): (f32, f32)| f64::from(v) / (f64::from(r).powi(2) + 0.01);
        let pixel = |(v, p): (&Rgb, &Rgb)| v.to_array().into_iter().zip(p.to_array()).map(relative).sum::<f64>();
        let sum: f64 = variance.iter().zip(&*pixels).map(pixel).sum();
        let mean = sum / (3 * variance.len()) as f64;
        mean.is_finite().then_some(mean)
    }

    /// A hash of the image's bits and the region.
    pub fn hash(&self) -> String {
        let mut hash = Fnv::default();
        hash.add(&self.picture.size.x.to_le_bytes());
        self.picture.pixels.iter().flat_map(|p| p.to_array()).for_each(|v| hash.add(&v.to_le_bytes()));
        self.region.iter().flatten().for_each(|inside| hash.add(&[u8::from(*inside)]));
        hash.hex()
    }
}

/// What to know of a reference, by what made it and the scene's census.
fn caution(technique: &str, has_caustics: bool) -> &'static str {
    match (has_caustics, technique) {
        (false, _) => "",
        (true, "bidir") => {
            "caustics of small lights that are seen through glass or in mirrors are found by chance alone, and the stated \
             error is too small where they have not been found yet"
        }
        (true, "sppm") => {
            "caustics are blurred, the less the more passes there were; the stated error is that of noise alone"
        }
        (true, _) => {
            "things in this scene can cast caustics; path tracing finds those of small lights by chance alone and does not \
             converge there, and the stated error is too small where it has not found them yet"
        }
    }
}

/// That, and light that is missing.
fn note(job: &Job, census: &Census) -> String {
    let caution = caution(&job.key.technique, census.has_caustics());
    let sentences: Vec<String> =
        (!caution.is_empty()).then(|| caution.to_owned()).into_iter().chain(job.gaps()).collect();
    sentences.join("; ")
}

/// Renders a reference; none if Ctrl-C came first.
pub fn make(
    job: &Job,
    threads: usize,
    seed: u64,
    budget: Budget,
) -> Result<Option<(Reference, ReferenceEntry)>, Error> {
    if let Some(radiance) = job.scene.exact.and_then(|furnace| furnace.radiance(job.key.depth)) {
        return Ok(Some(exact(job, radiance)));
    }
    let seed = derive_seed(seed, SEED_INDEX);
    let mut engine = job.build(threads, budget.planned())?;
    let progress = Progress::new(&format!("reference of {}", job.key.scene));
    let mut passes = 0;
    while budget.share(passes, engine.total().seconds) < 1.0 || passes < FEWEST_PASSES {
        if interrupt::asked() {
            return Ok(None);
        }
        engine.pass(seed, passes);
        passes += 1;
        let seconds = engine.total().seconds;
        progress.show(budget.share(passes, seconds), format!("{passes} passes, {}", human_seconds(seconds)));
    }
    let variance = engine.film.variance_image().into_iter().map(|v| Rgb::from(v.map(|v| v as f32)));
    let picture = Picture { size: job.key.size(), pixels: engine.film.mean_image() };
    let reference = Reference { picture, variance: Some(variance.collect()), region: None };
    let entry = ReferenceEntry {
        technique: job.key.technique.clone(),
        passes,
        seed,
        seconds: engine.total().seconds,
        relmse: reference.own_relmse(),
        note: note(job, engine.scene.census()),
        ..known(job)
    };
    Ok(Some((reference, entry)))
}

/// The entry of an image that is known without rendering.
fn known(job: &Job) -> ReferenceEntry {
    ReferenceEntry {
        scene: job.key.scene.clone(),
        scene_hash: job.key.scene_hash.clone(),
        width: job.key.width,
        height: job.key.height,
        depth: job.key.depth,
        technique: "analytic".into(),
        passes: 0,
        seed: 0,
        seconds: 0.0,
        commit: commit(),
        relmse: Some(0.0),
        note: "the radiance is known: a geometric series".into(),
    }
}

/// The reference of a scene whose every pixel is known.
fn exact(job: &Job, radiance: f64) -> (Reference, ReferenceEntry) {
    let size = job.key.size();
    let pixels = vec![Rgb::splat(radiance as f32); size.x as usize * size.y as usize];
    let variance = Some(vec![Rgb::BLACK; pixels.len()]);
    let reference = Reference { picture: Picture { size, pixels }, variance, region: None };
    (reference, known(job))
}

/// The technique that a scene's reference is made with where none is asked for: one that converges there.
pub fn technique(job: &Job) -> &'static str {
    let spec = &job.key.scene;
    match spec.split(':').next().unwrap_or(spec) {
        "ring" | "glass-caustic" | "hidden-lights" | "glass-ball" | "glossy-caustic" | "studio" => "bidir",
        // Light under water that is seen through its surface; blurred, and less with time.
        "pool" => "sppm",
        // What a reference lacks would count as an error of those who render it.
        _ if coverage::misses(&etendue_path::INFO, Chain::Caustic, &job.scene.description, job.key.depth) => "bidir",
        _ => "path",
    }
}

/// The default sampler of references: independent numbers, as its error is told from the scatter of
/// its passes.
pub fn wish(size: Option<Size>, depth: Option<u32>, load: LoadOptions) -> Wish {
    Wish { technique: "path".into(), knobs: vec![], sampler: "independent".into(), parts: vec![], size, depth, load }
}

/// The stored references: what there is, by the name of the scene.
pub struct Store {
    folder: PathBuf,
    entries: BTreeMap<String, ReferenceEntry>,
}

impl Store {
    /// Opens a folder's list, which may be missing.
    pub fn open(folder: &Path) -> Result<Store, Error> {
        let path = folder.join("reference.json");
        let entries = if path.exists() {
            let bytes = files::read_whole(&path)?;
            let reason =
                |e: serde_json::Error| Error::Content { path: path.clone(), reason: format!("is not valid: {e}") };
            serde_json::from_slice(&bytes).map_err(reason)?
        } else {
            BTreeMap::new()
        };
        Ok(Store { folder: folder.into(), entries })
    }

    /// The workspace's own store.
    pub fn of_workspace() -> Result<Store, Error> {
        Store::open(&files::workspace_root().join("reference"))
    }

    /// The reference of a job's scene at its size and depth, if it is there.
    pub fn find(&self, job: &Job) -> Result<Option<(Reference, ReferenceEntry)>, Error> {
        let key = &job.key;
        let fits = |e: &&ReferenceEntry| {
            e.scene_hash == key.scene_hash && (e.width, e.height, e.depth) == (key.width, key.height, key.depth)
        };
        let Some((name, entry)) = self.entries.iter().find(|(_, e)| fits(e)) else { return Ok(None) };
        let path = self.folder.join(format!("{name}.exr"));
        let reference = Reference::read(&path)?;
        if reference.picture.size != key.size() {
            return Err(Error::Content { path, reason: "has not the size that reference.json says".into() });
        }
        Ok(Some((reference, entry.clone())))
    }

    /// The name under which a scene's reference is stored: its own, or with its hash if that is another scene's.
    fn name(&self, key: &ImageKey) -> String {
        let plain = files::plain_name(&key.scene);
        // In lower case, as some file systems do not tell letters by their case.
        let taken = |(name, entry): (&String, &ReferenceEntry)| {
            name.to_lowercase() == plain.to_lowercase()
                && entry.scene != key.scene
                && entry.scene_hash != key.scene_hash
        };
        if self.entries.iter().any(taken) { format!("{plain}-{}", key.scene_hash) } else { plain }
    }

    /// Stores a reference: the image first, so that the list names no image that is not there.
    pub fn put(&mut self, name: &str, reference: &Reference, entry: ReferenceEntry) -> Result<(), Error> {
        reference.write(&self.folder.join(format!("{name}.exr")))?;
        self.entries.insert(name.to_owned(), entry);
        let list = files::json(&self.entries) + "\n";
        files::write_whole(&self.folder.join("reference.json"), |w| std::io::Write::write_all(w, list.as_bytes()))
    }
}

/// The command.
pub fn run(args: &ReferenceArgs) -> Result<(), Error> {
    let folder = args.out.clone().unwrap_or_else(|| files::workspace_root().join("reference"));
    std::fs::create_dir_all(&folder).map_err(|source| Error::Write { path: folder.clone(), source })?;
    let mut store = Store::open(&folder)?;
    let scenes = match &args.scenes[..] {
        [] => etendue_scenes::builtins().iter().map(|b| b.name.to_owned()).collect(),
        given => crate::study::scene_list(given),
    };
    let budget = match args.passes {
        Some(n) => Budget::Passes(n),
        None => Budget::Seconds(args.seconds.unwrap_or(DEFAULT_SECONDS)),
    };
    let wish = wish(Some(args.image.size.unwrap_or(DEFAULT_SIZE)), args.image.depth, args.load.into());
    let load = |scene: &String| match &args.technique {
        Some(technique) => Job::load(scene, &Wish { technique: technique.clone(), ..wish.clone() }),
        None => {
            let job = Job::load(scene, &wish)?;
            let technique = technique(&job);
            job.by(technique)
        }
    };
    let jobs = scenes.iter().map(load).collect::<Result<Vec<_>, _>>()?;
    interrupt::listen()?;
    let mut made = BTreeMap::new();
    for job in &jobs {
        let Some((reference, entry)) = make(job, args.image.threads(), args.seed, budget)? else { break };
        let name = store.name(&job.key);
        if !args.json {
            let own = entry.relmse.map_or_else(|| "unknown".into(), |e| format!("{e:.2e}"));
            let (passes, seconds) = (entry.passes, human_seconds(entry.seconds));
            files::print(&format!("{name}: {passes} passes in {seconds}, own relMSE {own}"))?;
        }
        store.put(&name, &reference, entry.clone())?;
        made.insert(name, entry);
    }
    if made.is_empty() {
        return Err(Error::Interrupted);
    }
    if args.json { files::print_json(&made) } else { Ok(()) }
}

/// The revision of the workspace, with a mark if something in it was changed since; none without git.
fn commit() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).current_dir(files::workspace_root()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let head = git(&["rev-parse", "HEAD"])?;
    let changed = git(&["status", "--porcelain", "--untracked-files=no"])?;
    Some(if changed.is_empty() { head } else { format!("{head} with changes") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn own_error_is_relative_variance() {
        let picture = Picture { size: UVec2::new(2, 1), pixels: vec![Rgb::BLACK, Rgb::WHITE] };
        let variance = vec![Rgb::splat(0.01), Rgb::splat(1.01)];
        let mut reference = Reference { picture, variance: Some(variance), region: None };
        assert!((reference.own_relmse().unwrap() - 1.0).abs() < 1e-6);
        let whole = reference.hash();
        reference.variance.as_mut().unwrap()[0] = Rgb::splat(0.03);
        reference.region = Some(vec![true, false]);
        assert!((reference.own_relmse().unwrap() - 3.0).abs() < 1e-6);
        assert_ne!(reference.hash(), whole);
        let path = tempfile::tempdir().unwrap();
        let path = path.path().join("r.exr");
        reference.write(&path).unwrap();
        assert_eq!(Reference::read(&path).unwrap().region, reference.region);
    }

    #[test]
    fn stored_references_are_found_by_hash_size_and_depth() {
        let folder = tempfile::tempdir().unwrap();
        let job = Job::load("cornell", &wish(Some(Size::Longest(4)), Some(3), LoadOptions::default())).unwrap();
        let (reference, entry) = make(&job, 1, 0, Budget::Passes(3)).unwrap().unwrap();
        assert_eq!(entry.passes, 3);
        Store::open(folder.path()).unwrap().put("cornell", &reference, entry.clone()).unwrap();
        let store = Store::open(folder.path()).unwrap();
        let (found, listed) = store.find(&job).unwrap().unwrap();
        assert_eq!(listed, entry);
        assert_eq!((found.hash(), found.variance), (reference.hash(), reference.variance));
        for (size, depth) in [(5, 3), (4, 4)] {
            let other =
                Job::load("cornell", &wish(Some(Size::Longest(size)), Some(depth), LoadOptions::default())).unwrap();
            assert!(store.find(&other).unwrap().is_none());
        }
    }
}
