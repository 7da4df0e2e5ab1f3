//! The reference of each scene of a study, copied to the study's folder with what is known of the scene, so that a
//! report needs nothing else.

use crate::{
    error::Error,
    files,
    job::Job,
    reference::{self, Reference, Store},
    render::Budget,
    study::region::Region,
};
use etendue_core::scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What a report says of a scene and its reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
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
    /// Where the reference comes from.
    pub source: Source,
    /// How it was made, one line.
    pub made: String,
    /// Seconds that it took, 0 if unknown.
    pub seconds: f64,
    /// Its own error as relMSE, if known.
    pub own_relmse: Option<f64>,
    /// What to know before trusting it; may be empty.
    pub note: String,
    /// Where errors are measured, if not everywhere.
    #[serde(default)]
    pub region: String,
    /// The census of the scene's effects, a reason a line.
    pub census: String,
    /// What loading the scene had to say.
    pub notes: Vec<String>,
}

/// Where a reference comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    /// The workspace's store.
    Stored,
    /// Rendered for the study.
    Made,
    /// A file that the user gave.
    Given,
}

/// How much longer than a cell a reference is rendered, and its least time, seconds.
const TIMES_CELL: f64 = 8.0;
const LEAST_SECONDS: f64 = 20.0;

/// A reference with its hash.
pub struct Found {
    /// The reference.
    pub reference: Reference,
    /// Hash of its bits.
    pub hash: String,
}

/// The folder of a study's references.
pub struct References {
    folder: PathBuf,
    store: Store,
}

/// What a study wants of its references.
#[derive(Clone, Copy, Debug)]
pub struct Want<'a> {
    /// A file that the user gave.
    pub file: Option<&'a Path>,
    /// Seconds of a cell.
    pub cell_seconds: f64,
    /// The study's seed.
    pub seed: u64,
    /// Threads.
    pub threads: usize,
    /// Where errors are measured; everywhere without it.
    pub region: Option<Region>,
}

impl References {
    /// Opens the folder, which is made if it is not there.
    pub fn open(folder: PathBuf) -> Result<References, Error> {
        std::fs::create_dir_all(&folder).map_err(|source| Error::Write { path: folder.clone(), source })?;
        Ok(References { folder, store: Store::of_workspace()? })
    }

    /// Finds or makes the reference of a job; none if Ctrl-C came first.
    pub fn obtain(&self, job: &Job, want: Want) -> Result<Option<Found>, Error> {
        if let Some(path) = want.file {
            let mut reference = Reference::read(path)?;
            if reference.picture.size != job.key.size() {
                let (r, s) = (reference.picture.size, job.key.size());
                let reason = format!("has {}x{} pixels, but the study renders {}x{}", r.x, r.y, s.x, s.y);
                return Err(Error::Content { path: path.into(), reason });
            }
            let made = format!("the file {}", path.display());
            let region = limit(job, &mut reference, want)?;
            let facts = SceneFacts { region, ..self.facts(job, Source::Given, made, 0.0, &reference, String::new())? };
            return self.keep(reference, &facts).map(Some);
        }
        if let Some((mut reference, entry)) = self.store.find(job)? {
            let region = limit(job, &mut reference, want)?;
            let commit = entry.commit.as_deref().map_or(String::new(), |c| format!(", revision {c:.12}"));
            let made = format!("stored: {}, {} passes, seed {}{commit}", entry.technique, entry.passes, entry.seed);
            let facts =
                SceneFacts { region, ..self.facts(job, Source::Stored, made, entry.seconds, &reference, entry.note)? };
            return self.keep(reference, &facts).map(Some);
        }
        let seconds = (TIMES_CELL * want.cell_seconds).max(LEAST_SECONDS);
        if let Some(found) = self.made_before(job, seconds, want.region)? {
            return Ok(Some(found));
        }
        // Made with every part of the light, whatever the study is of.
        let wish = reference::wish(Some(crate::job::Size::Exact(job.key.size())), Some(job.key.depth), job.load);
        let maker = Job::load(&job.key.scene, &wish)?.by(reference::technique(job))?;
        let made = reference::make(&maker, want.threads, want.seed, Budget::Seconds(seconds))?;
        let Some((mut reference, entry)) = made else { return Ok(None) };
        let region = limit(job, &mut reference, want)?;
        let made = format!("made for this study: {}, {} passes, seed {}", entry.technique, entry.passes, entry.seed);
        let facts =
            SceneFacts { region, ..self.facts(job, Source::Made, made, entry.seconds, &reference, entry.note)? };
        self.keep(reference, &facts).map(Some)
    }

    fn facts(
        &self,
        job: &Job,
        source: Source,
        made: String,
        seconds: f64,
        reference: &Reference,
        note: String,
    ) -> Result<SceneFacts, Error> {
        let scene = Scene::new(&job.scene.description);
        let scene = scene.map_err(|source| Error::Scene { scene: job.key.scene.clone(), source })?;
        Ok(SceneFacts {
            scene: job.key.scene.clone(),
            scene_hash: job.key.scene_hash.clone(),
            width: job.key.width,
            height: job.key.height,
            depth: job.key.depth,
            source,
            made,
            seconds,
            own_relmse: reference.own_relmse(),
            note,
            region: String::new(),
            census: scene.census().to_string(),
            notes: job.scene.notes.clone(),
        })
    }

    /// Copies a reference and its facts to the study's folder.
    fn keep(&self, reference: Reference, facts: &SceneFacts) -> Result<Found, Error> {
        let hash = reference.hash();
        let name = facts_name(&facts.scene_hash, facts.depth, &hash);
        reference.write(&self.folder.join(format!("{name}.exr")))?;
        let text = files::json(facts) + "\n";
        files::write_whole(&self.folder.join(format!("{name}.json")), |w| {
            std::io::Write::write_all(w, text.as_bytes())
        })?;
        Ok(Found { reference, hash })
    }

    /// The reference of a scene, by its hash, as it was kept.
    pub fn read(&self, scene_hash: &str, depth: u32, reference: &str) -> Result<(Reference, SceneFacts), Error> {
        let name = facts_name(scene_hash, depth, reference);
        let path = self.folder.join(format!("{name}.json"));
        let facts = read_facts(&path)?;
        Ok((Reference::read(&self.folder.join(format!("{name}.exr")))?, facts))
    }

    /// A reference that an earlier run of the study made, if it took long enough.
    fn made_before(&self, job: &Job, seconds: f64, region: Option<Region>) -> Result<Option<Found>, Error> {
        let listing = std::fs::read_dir(&self.folder);
        let listing = listing.map_err(|source| Error::Read { path: self.folder.clone(), source })?;
        let mut paths: Vec<PathBuf> = listing.filter_map(|e| e.ok()).map(|e| e.path()).collect();
        paths.retain(|p| p.extension().is_some_and(|e| e == "json"));
        paths.sort();
        for path in paths {
            let facts = read_facts(&path)?;
            let fits = facts.source == Source::Made
                && facts.scene_hash == job.key.scene_hash
                && (facts.width, facts.height, facts.depth) == (job.key.width, job.key.height, job.key.depth)
                && facts.region.starts_with(&region.map_or(String::new(), |r| r.to_string()))
                && facts.region.is_empty() == region.is_none()
                && facts.seconds >= seconds;
            if fits {
                let reference = Reference::read(&path.with_extension("exr"))?;
                let hash = reference.hash();
                return Ok(Some(Found { reference, hash }));
            }
        }
        Ok(None)
    }
}

/// Limits a reference to the region that is wanted; says which it is.
fn limit(job: &Job, reference: &mut Reference, want: Want) -> Result<String, Error> {
    let Some(region) = want.region else { return Ok(String::new()) };
    let inside = region.pixels(job, &reference.picture, want.seed, want.threads)?;
    let text = format!("{region}: {} of {} pixels", inside.iter().filter(|i| **i).count(), inside.len());
    reference.region = Some(inside);
    Ok(text)
}

fn facts_name(scene_hash: &str, depth: u32, reference: &str) -> String {
    format!("{scene_hash}-{depth}-{reference}")
}

fn read_facts(path: &Path) -> Result<SceneFacts, Error> {
    let reason = |e: serde_json::Error| Error::Content { path: path.into(), reason: format!("is not valid: {e}") };
    serde_json::from_slice(&files::read_whole(path)?).map_err(reason)
}
