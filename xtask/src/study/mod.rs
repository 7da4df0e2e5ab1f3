//! `study`: what accuracy costs, cell by cell.

pub mod cell;
mod presets;
pub mod references;
pub mod region;
pub mod replicates;
pub mod results;

use crate::{
    cli::StudyArgs,
    clock, coverage,
    error::Error,
    exr_file::ExrFile,
    files, interrupt,
    job::{Job, Size, Wish},
    picture::Picture,
    progress::Progress,
    reference::{DEFAULT_SIZE, Reference},
    report::{self, RunFacts, advice::Advice},
    techniques::{self, TECHNIQUES},
};
use cell::{End, Finished, Plan};
use etendue_core::technique::{Chain, Parts, TechniqueInfo};
use references::{Found, References, Want};
use replicates::{Sums, sums_path};
use results::{Group, Results};
use serde::Serialize;
use std::{
    collections::HashMap,
    fs::{File, TryLockError},
    path::{Path, PathBuf},
};

/// What a study came to, as it is printed.
#[derive(Serialize)]
struct StudyReport {
    #[serde(serialize_with = "files::path_text")]
    report: PathBuf,
    #[serde(serialize_with = "files::path_text")]
    results: PathBuf,
    cells_run: usize,
    cells_kept: usize,
    interrupted: bool,
    /// Light that images lack, and techniques that are left out for it.
    gaps: Vec<String>,
    summary: Vec<report::SummaryRow>,
    advice: Vec<Advice>,
}

/// A scene with a technique and a sampler, what it is compared with, and under which key.
struct Entry {
    job: Job,
    group: Group,
    reference: usize,
}

/// Scenes as given, with commas between them; a comma before `name=value` belongs to the scene's parameters.
pub fn scene_list(pieces: &[String]) -> Vec<String> {
    let mut scenes: Vec<String> = Vec::new();
    for piece in pieces.iter().filter(|p| !p.is_empty()) {
        match scenes.last_mut() {
            Some(scene) if scene.contains(':') && piece.contains('=') && !piece.contains(':') => {
                scene.push(',');
                scene.push_str(piece);
            }
            _ => scenes.push(piece.clone()),
        }
    }
    scenes
}

/// The command.
pub fn run(args: &StudyArgs) -> Result<(), Error> {
    let (jobs, gaps) = load_jobs(args)?;
    gaps.iter().for_each(|gap| eprintln!("warning: {gap}"));
    create(&args.out)?;
    let images = args.out.join("images");
    create(&images)?;
    let _lock = lock(&args.out)?;
    let mut results = Results::open(&args.out.join("results.jsonl"))?;
    let references = References::open(args.out.join("references"))?;
    interrupt::listen()?;

    let (entries, found) = with_references(args, jobs, &references)?;
    let kept_before = results.cells().len();
    let (mut cells_run, mut cells_kept) = (0, 0);
    let total = entries.len() * args.replicates as usize;
    let progress = Progress::new("study");
    // A replicate of everything before the next of anything: an interrupted study is an even one.
    'cells: for replicate in 0..args.replicates {
        for entry in &entries {
            let begun = cells_run + cells_kept;
            if is_finished(&results, &entry.group, replicate, args.seconds) {
                cells_kept += 1;
                continue;
            }
            let plan = Plan {
                job: &entry.job,
                group: &entry.group,
                replicate,
                seconds: args.seconds,
                end: end_of(&results, &entry.group, args.seconds),
                reference: &found[entry.reference].reference,
            };
            let key = &entry.job.key;
            let label = format!("{} by {}, {}, replicate {replicate}", key.scene, key.technique, key.sampler);
            let show = |share: f64| progress.show((begun as f64 + share) / total as f64, label.clone());
            let Some(finished) = cell::run(&plan, show)? else { break 'cells };
            keep(&mut results, &images, &plan, finished)?;
            cells_run += 1;
        }
    }
    drop(progress);
    if cells_run + kept_before == 0 {
        return Err(Error::Interrupted);
    }
    fill(&mut results, &images, &references)?;
    let (command, processor) = (command_line(), clock::processor());
    let facts = RunFacts { command, processor, threads: args.image.threads(), gaps: gaps.clone() };
    let page = report::build(&results, &references, &images, &facts)?;
    let path = args.out.join("report.html");
    files::write_whole(&path, |w| std::io::Write::write_all(w, page.html.as_bytes()))?;
    let study = StudyReport {
        report: path,
        results: args.out.join("results.jsonl"),
        cells_run,
        cells_kept,
        interrupted: interrupt::asked(),
        gaps,
        summary: page.summary,
        advice: page.advice,
    };
    if args.json { files::print_json(&study) } else { files::print(&study.text()) }
}

/// Everything that can be wrong with what is asked for, before anything is written.
fn load_jobs(args: &StudyArgs) -> Result<(Vec<Job>, Vec<String>), Error> {
    let scenes = scene_list(&args.scenes);
    if scenes.is_empty() || args.samplers.is_empty() {
        return Err(Error::Input("a study needs a scene and a sampler".into()));
    }
    let mut size = args.image.size;
    if let Some(path) = &args.reference {
        if scenes.len() != 1 {
            return Err(Error::Input("--reference is of one scene: give one with --scenes".into()));
        }
        size = size.or(Some(Size::Exact(Reference::read(path)?.picture.size)));
    }
    let own = own_knobs(args)?;
    let wish = |scene: &str, technique: &str, sampler: &str| Wish {
        technique: technique.to_owned(),
        knobs: {
            let given: Vec<&str> = own.iter().filter(|(t, _)| *t == technique).map(|(_, knob)| *knob).collect();
            presets::knobs(scene, technique, &given)
        },
        sampler: sampler.to_owned(),
        parts: vec![],
        size: size.or(Some(DEFAULT_SIZE)),
        depth: args.image.depth,
        load: args.load.into(),
    };
    let (mut jobs, mut gaps) = (Vec::new(), Vec::new());
    for scene in &scenes {
        let mut studied = Vec::new();
        for &technique in &asked_for(args)? {
            let job = Job::load(scene, &wish(scene, technique.name, &args.samplers[0]))?;
            let (description, depth) = (&job.scene.description, job.key.depth);
            // An image without all that is seen in mirrors is no match for others, unless it is asked for.
            let chain = Chain::SurfaceThroughDelta;
            if args.techniques.is_empty() && coverage::misses(technique, chain, description, depth) {
                let left_out = coverage::gaps(description, depth, Parts::ALL, &[job.choice()]).pop();
                gaps.extend(left_out.map(|gap| format!("{scene}: {} is not studied; {gap}", technique.name)));
                continue;
            }
            studied.push(job.choice());
            jobs.push(job);
            for sampler in &args.samplers[1..] {
                jobs.push(Job::load(scene, &wish(scene, technique.name, sampler))?);
            }
        }
        if let Some(job) = jobs.last() {
            let left_out = coverage::gaps(&job.scene.description, job.key.depth, Parts::ALL, &studied);
            gaps.extend(left_out.into_iter().map(|gap| format!("{scene}: {gap}")));
        }
    }
    Ok((jobs, gaps))
}

/// The techniques that are asked for; all that there are where none is.
fn asked_for(args: &StudyArgs) -> Result<Vec<&'static TechniqueInfo>, Error> {
    match &args.techniques[..] {
        [] => Ok(TECHNIQUES.to_vec()),
        given => given.iter().map(|name| techniques::find(name)).collect(),
    }
}

/// Knobs that were given, with their techniques.
fn own_knobs(args: &StudyArgs) -> Result<Vec<(&str, &str)>, Error> {
    let techniques = asked_for(args)?;
    let studied = |technique: &str| techniques.iter().any(|t| t.name == technique);
    let mut knobs = Vec::new();
    for text in &args.knobs {
        match text.split_once('.') {
            Some((technique, knob)) if studied(technique) => knobs.push((technique, knob)),
            Some((technique, _)) if !technique.contains('=') => {
                return Err(Error::Input(format!("--knob {text}: the technique `{technique}` is not studied")));
            }
            _ => return Err(Error::Input(format!("--knob {text}: not `technique.name=value`"))),
        }
    }
    Ok(knobs)
}

fn create(folder: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(folder).map_err(|source| Error::Write { path: folder.into(), source })
}

/// Keeps a second study out of the folder for as long as the file is open.
fn lock(out: &Path) -> Result<File, Error> {
    let path = out.join(".lock");
    let file = File::create(&path).map_err(|source| Error::Write { path: path.clone(), source })?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            Err(Error::Content { path: out.into(), reason: "another study is writing to this folder".into() })
        }
        // A file system without locks is no reason to refuse.
        Err(TryLockError::Error(_)) | Ok(()) => Ok(file),
    }
}

/// Finds or makes every scene's reference, once for all techniques.
fn with_references(
    args: &StudyArgs,
    jobs: Vec<Job>,
    references: &References,
) -> Result<(Vec<Entry>, Vec<Found>), Error> {
    let threads = args.image.threads();
    let want = Want {
        file: args.reference.as_deref(),
        cell_seconds: args.seconds,
        seed: args.seed,
        threads,
        region: args.region,
    };
    let (mut found, mut index): (Vec<Found>, HashMap<String, usize>) = Default::default();
    let mut entries = Vec::new();
    for job in jobs {
        let reference = match index.get(&job.key.scene) {
            Some(&i) => i,
            None => {
                found.push(references.obtain(&job, want)?.ok_or(Error::Interrupted)?);
                index.insert(job.key.scene.clone(), found.len() - 1);
                found.len() - 1
            }
        };
        let key = &job.key;
        let group = Group {
            scene: key.scene.clone(),
            scene_hash: key.scene_hash.clone(),
            technique: key.technique.clone(),
            knobs: key.knobs.clone(),
            sampler: key.sampler.clone(),
            size: format!("{}x{}", key.width, key.height),
            depth: key.depth,
            seed: args.seed,
            threads,
            reference: found[reference].hash.clone(),
        };
        entries.push(Entry { job, group, reference });
    }
    Ok((entries, found))
}

/// Whether a cell is there that was given as much time as is asked for.
fn is_finished(results: &Results, group: &Group, replicate: u32, seconds: f64) -> bool {
    results.of(group).iter().any(|c| c.end().replicate == replicate && c.end().budget_seconds >= seconds)
}

/// The first replicate takes its seconds; the others make as many passes.
fn end_of(results: &Results, group: &Group, seconds: f64) -> End {
    let cells = results.of(group);
    let first = cells.iter().find(|c| c.end().budget_seconds >= seconds);
    first.map_or(End::Seconds, |c| End::Passes(c.end().passes))
}

/// Keeps what a cell came to. The sums go first: a replicate that is in them and not in the results is run again, and
/// then makes the same image.
fn keep(results: &mut Results, images: &Path, plan: &Plan, finished: Finished) -> Result<(), Error> {
    let (group, replicate) = (plan.group, plan.replicate);
    for (line, image) in finished.cell.lines.iter().zip(&finished.images) {
        let path = sums_path(images, group, line.passes);
        let mut sums = Sums::read(&path);
        sums.add(replicate, &plan.reference.measured(image));
        sums.write(&path)?;
    }
    if replicate == 0
        && let Some(pixels) = finished.images.last()
    {
        let (width, height) =
            group.size.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?))).unwrap_or_default();
        let picture = Picture { size: glam::UVec2::new(width, height), pixels: pixels.clone() };
        ExrFile::of(&picture).write(&images.join(format!("{}.exr", group.file_stem())))?;
    }
    results.append(finished.cell)
}

/// Squared bias and variance, from the sums of the replicates.
fn fill(results: &mut Results, images: &Path, references: &References) -> Result<(), Error> {
    let mut known: HashMap<(String, u32), Option<(f64, f64)>> = HashMap::new();
    for group in results.groups() {
        let (reference, _) = references.read(&group.scene_hash, group.depth, &group.reference)?;
        let mut passes: Vec<u32> = results.of(group).iter().flat_map(|c| c.lines.iter().map(|l| l.passes)).collect();
        passes.sort_unstable();
        passes.dedup();
        for n in passes {
            let sums = Sums::read(&sums_path(images, group, n));
            known.insert(
                (group.file_stem(), n),
                sums.bias2_and_variance(&reference.measured(&reference.picture.pixels)),
            );
        }
    }
    results.fill(|group, passes| Ok(known.get(&(group.file_stem(), passes)).copied().flatten()))
}

/// The command as it was typed.
pub fn command_line() -> String {
    let quote = |a: String| {
        let plain = a.chars().all(|c| c.is_ascii_alphanumeric() || "-_=.,:/+@%".contains(c));
        if plain && !a.is_empty() { a } else { format!("'{}'", a.replace('\'', r"'\''")) }
    };
    let arguments = std::env::args_os().skip(1).map(|a| quote(a.to_string_lossy().into_owned()));
    std::iter::once("cargo xtask".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

impl StudyReport {
    fn text(&self) -> String {
        let mut lines = vec![report::summary::table(&self.summary), String::new()];
        lines.push(format!("{} cells run, {} were there already", self.cells_run, self.cells_kept));
        if self.interrupted {
            lines.push("interrupted: the same command goes on from here".into());
        }
        lines.push(format!("report: {}", self.report.display()));
        lines.push(String::new());
        lines.extend(self.advice.iter().map(|a| a.text.clone()));
        lines.join("\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_within_parameters_do_not_part_scenes() {
        let list = |text: &str| scene_list(&text.split(',').map(str::to_owned).collect::<Vec<_>>());
        assert_eq!(list("cornell,sky"), ["cornell", "sky"]);
        assert_eq!(list("many-lights:n=64,seed=7,cornell"), ["many-lights:n=64,seed=7", "cornell"]);
        assert_eq!(list("ring:a=1,cornell:b=2,c=3"), ["ring:a=1", "cornell:b=2,c=3"]);
        assert_eq!(list("a.xml,"), ["a.xml"]);
    }
}
