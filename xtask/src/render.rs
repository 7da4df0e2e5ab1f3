//! `render`: passes until the budget is used, an image and its film at the end.

use crate::{
    cli::RenderArgs,
    clock::human_seconds,
    error::Error,
    exr_file::{Attribute, ExrFile},
    files,
    film_file::{FilmFile, RayCounts, Run, Tally, film_path},
    interrupt,
    job::{Engine, Job},
    output::image_path,
    picture::Picture,
    progress::Progress,
};
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Passes when nothing is said.
const DEFAULT_PASSES: u32 = 16;

/// How long to go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// So many passes in all.
    Passes(u32),
    /// Until so many seconds are used; at least one pass.
    Seconds(f64),
}

impl Budget {
    /// The share of it that is used up.
    pub fn share(self, passes: u32, seconds: f64) -> f64 {
        match self {
            Budget::Passes(n) => f64::from(passes) / f64::from(n),
            Budget::Seconds(s) if passes > 0 => seconds / s,
            Budget::Seconds(_) => 0.0,
        }
    }

    /// The number of passes that are planned, 0 when unknown.
    pub fn planned(self) -> u32 {
        match self {
            Budget::Passes(n) => n,
            Budget::Seconds(_) => 0,
        }
    }
}

/// What a render came to, as it is printed.
#[derive(Debug, Serialize)]
pub struct RenderReport {
    scene: String,
    scene_hash: String,
    technique: String,
    knobs: BTreeMap<String, f64>,
    sampler: String,
    parts: Vec<String>,
    width: u32,
    height: u32,
    depth: u32,
    runs: Vec<Run>,
    passes: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    threads: Option<usize>,
    seconds: f64,
    cpu_seconds: f64,
    build_seconds: f64,
    rays: RayCounts,
    rays_total: u64,
    rays_per_second: f64,
    rejected: u64,
    interrupted: bool,
    #[serde(serialize_with = "files::path_text")]
    out: PathBuf,
    #[serde(serialize_with = "files::path_text")]
    png: PathBuf,
    #[serde(serialize_with = "files::path_text")]
    film: PathBuf,
    notes: Vec<String>,
    /// Light that the image lacks.
    gaps: Vec<String>,
}

/// The command.
pub fn run(args: &RenderArgs) -> Result<(), Error> {
    let out = image_path(args.out.as_deref(), &args.scene, "")?;
    let budget = match (args.passes, args.seconds) {
        (_, Some(seconds)) => Budget::Seconds(seconds),
        (passes, None) => Budget::Passes(passes.unwrap_or(DEFAULT_PASSES)),
    };
    if let Budget::Passes(n) = budget
        && args.first_pass.checked_add(n).is_none()
    {
        return Err(Error::Input(format!(
            "--first-pass {} --passes {n}: passes are numbered in 32 bits",
            args.first_pass
        )));
    }
    let job = Job::load(&args.scene, &args.wish())?;
    let earlier = if args.resume { earlier_film(&out, &job, args)? } else { None };
    let gaps = job.gaps();
    gaps.iter().for_each(|gap| eprintln!("warning: {gap}"));
    interrupt::listen()?;

    let threads = args.image.threads();
    let mut engine = job.build(threads, budget.planned())?;
    let before = earlier.as_ref().map(|f| (f.passes(), f.tally.total().seconds)).unwrap_or_default();
    let done = passes(&mut engine, args.seed, args.first_pass, budget, before, &args.scene);
    let film = match (earlier, done) {
        (None, 0) => return Err(Error::Interrupted),
        (Some(earlier), 0) => earlier,
        (earlier, done) => {
            let first = args.first_pass + before.0;
            let mut film = FilmFile {
                key: job.key.clone(),
                runs: vec![Run { seed: args.seed, first, end: first + done }],
                tally: Tally::new(engine.build, engine.passes, engine.statistics()),
                film: engine.film,
            };
            if let Some(earlier) = earlier {
                let path = film_path(&out);
                film.merge(&earlier).map_err(|reason| Error::Content { path, reason })?;
            }
            film
        }
    };
    let interrupted = interrupt::asked();
    let mut report = save(&film, &out)?;
    report.threads = Some(threads);
    report.interrupted = interrupted;
    report.notes = job.scene.notes.clone();
    report.gaps = gaps;
    print_report(&report, args.json)
}

/// Renders passes from where `before` (passes, seconds) ended until the budget is used or Ctrl-C comes; returns how many.
fn passes(engine: &mut Engine, seed: u64, first: u32, budget: Budget, before: (u32, f64), label: &str) -> u32 {
    let progress = Progress::new(label);
    let mut done = 0;
    // Seconds go by what is measured: an earlier part's own build was on its clock, this one's is on this one's.
    let seconds = |engine: &Engine| before.1 + engine.total().seconds;
    loop {
        let share = budget.share(before.0 + done, seconds(engine));
        progress.show(share, format!("{} passes, {}", before.0 + done, human_seconds(seconds(engine))));
        let Some(pass) = first.checked_add(before.0 + done) else { return done };
        if share >= 1.0 || pass == u32::MAX || interrupt::asked() {
            return done;
        }
        engine.pass(seed, pass);
        done += 1;
    }
}

/// The film beside the output file, if there is one and it is of this job.
fn earlier_film(out: &Path, job: &Job, args: &RenderArgs) -> Result<Option<FilmFile>, Error> {
    let path = film_path(out);
    if !path.exists() {
        return Ok(None);
    }
    let film = FilmFile::read(&path)?;
    let refuse = |reason| Err(Error::Content { path: path.clone(), reason });
    if let Some(difference) = job.key.difference(&film.key) {
        return refuse(format!("cannot be resumed, it is of something else: {difference}"));
    }
    match film.runs[..] {
        [run] if (run.seed, run.first) == (args.seed, args.first_pass) => Ok(Some(film)),
        [run] => refuse(format!(
            "cannot be resumed: its passes begin at {} with seed {}, not at {} with seed {}",
            run.first, run.seed, args.first_pass, args.seed
        )),
        _ => refuse("cannot be resumed: it was merged from runs apart".into()),
    }
}

/// Writes film, image and PNG. The film is first: nothing is lost if the others fail.
pub fn save(film: &FilmFile, out: &Path) -> Result<RenderReport, Error> {
    let (film_file, png) = (film_path(out), out.with_extension("png"));
    film.write(&film_file)?;
    let picture = Picture { size: film.key.size(), pixels: film.film.mean_image() };
    let mut exr = ExrFile::of(&picture);
    exr.attributes = provenance(film);
    exr.write(out)?;
    files::write_whole(&png, |w| std::io::Write::write_all(w, &picture.png(picture.exposure())))?;
    let (key, total) = (film.key.clone(), film.tally.total());
    Ok(RenderReport {
        scene: key.scene,
        scene_hash: key.scene_hash,
        technique: key.technique,
        knobs: key.knobs,
        sampler: key.sampler,
        parts: key.parts,
        width: key.width,
        height: key.height,
        depth: key.depth,
        runs: film.runs.clone(),
        passes: film.passes(),
        threads: None,
        seconds: total.seconds,
        cpu_seconds: total.cpu_seconds,
        build_seconds: film.tally.build.seconds,
        rays: film.tally.rays,
        rays_total: film.tally.rays.total(),
        rays_per_second: film.tally.rays.total() as f64 / film.tally.passes.seconds.max(f64::MIN_POSITIVE),
        rejected: film.tally.rejected,
        interrupted: false,
        out: out.into(),
        png,
        film: film_file,
        notes: Vec::new(),
        gaps: Vec::new(),
    })
}

/// Where an image comes from, as attributes of its file.
fn provenance(film: &FilmFile) -> BTreeMap<String, Attribute> {
    let text = |t: &str| Attribute::Text(t.to_owned());
    // A depth without a bound does not fit the format's integers; nor do all seeds.
    let depth = i32::try_from(film.key.depth).map_or_else(|_| text("unbounded"), Attribute::Whole);
    let list = |f: fn(&Run) -> String| film.runs.iter().map(f).collect::<Vec<_>>().join(",");
    let knobs: Vec<String> = film.key.knobs.iter().map(|(k, v)| format!("{k}={v}")).collect();
    let total = film.tally.total();
    [
        ("scene", text(&film.key.scene)),
        ("sceneHash", text(&film.key.scene_hash)),
        ("technique", text(&film.key.technique)),
        ("knobs", text(&knobs.join(","))),
        ("sampler", text(&film.key.sampler)),
        ("parts", text(&film.key.parts.join(","))),
        ("depth", depth),
        ("seed", text(&list(|r| r.seed.to_string()))),
        ("passRanges", text(&list(|r| format!("{}..{}", r.first, r.end)))),
        ("passes", Attribute::Whole(i32::try_from(film.passes()).unwrap_or(i32::MAX))),
        ("seconds", Attribute::Number(total.seconds)),
        ("cpuSeconds", Attribute::Number(total.cpu_seconds)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// Prints what a render came to.
pub fn print_report(report: &RenderReport, json: bool) -> Result<(), Error> {
    if json {
        return files::print_json(report);
    }
    let interrupted = if report.interrupted { ", interrupted" } else { "" };
    let (r, of) = (report, |n: u64| format!("{:.1} M", n as f64 / 1e6));
    let mut text = format!(
        "{} by {}: {} passes of {}x{}{interrupted}\n\
         {} ({:.3} s, of which building {:.3} s), {:.3} CPU seconds\n\
         {} rays (camera {}, scatter {}, shadow {}, light {}), {:.2} M rays a second, {} rejected samples\n\
         wrote {}, {} and {}",
        r.scene,
        r.technique,
        r.passes,
        r.width,
        r.height,
        human_seconds(r.seconds),
        r.seconds,
        r.build_seconds,
        r.cpu_seconds,
        of(r.rays_total),
        of(r.rays.camera),
        of(r.rays.scatter),
        of(r.rays.shadow),
        of(r.rays.light),
        r.rays_per_second / 1e6,
        r.rejected,
        r.out.display(),
        r.png.display(),
        r.film.display()
    );
    for note in &r.notes {
        text += &format!("\nnote: {note}");
    }
    files::print(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_end() {
        assert_eq!(Budget::Passes(4).share(3, 1e9), 0.75);
        assert!(Budget::Passes(4).share(4, 0.0) >= 1.0);
        assert_eq!(Budget::Seconds(1.0).share(0, 5.0), 0.0);
        assert!(Budget::Seconds(1.0).share(1, 1.0) >= 1.0);
    }
}
