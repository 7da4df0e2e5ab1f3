//! `sampling`: what each sample pattern buys, measured.

pub mod allocation;
mod chart;
pub mod convergence;
mod page;
pub mod penumbra;
pub mod pictures;
pub mod resampling;

use crate::{cli::SamplingArgs, clock, error::Error, files, interrupt, picture::encode_png, progress::Progress};
use etendue_core::{digest::mix, statistics::moments::Moments};
use etendue_sampling::pattern::Pattern;
use serde::Serialize;
use std::{
    io::Write,
    path::PathBuf,
    sync::atomic::{AtomicU32, Ordering},
};

/// All that was measured.
#[derive(Serialize)]
pub struct Results {
    /// The command.
    pub command: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Variance against number of samples.
    pub convergence: Vec<convergence::Series>,
    /// Errors of the images of penumbrae.
    pub penumbrae: Vec<penumbra::Row>,
    /// Resampled importance sampling against number of candidates.
    pub resampling: Vec<resampling::Series>,
    /// Star discrepancies.
    pub discrepancies: Vec<pictures::Discrepancy>,
    /// Spectra along their rings.
    pub spectra: Vec<pictures::Rings>,
    /// Variances of stratified estimates against their formulas.
    pub allocation: Vec<allocation::Row>,
}

/// A mean over trials, with the ends of its interval of 95 %.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Measured {
    /// The mean.
    pub mean: f64,
    /// Low end.
    pub low: f64,
    /// High end.
    pub high: f64,
    /// Trials.
    pub trials: u64,
}

impl Measured {
    /// The mean of positive numbers. Its error is taken as relative, so that the low end is positive as well; of one
    /// number the ends are not known and coincide.
    pub fn of(squares: &Moments) -> Measured {
        let relative = 1.96 * squares.standard_error() / squares.mean();
        let factor = if relative.is_finite() { relative.exp() } else { 1.0 };
        let mean = squares.mean();
        Measured { mean, low: mean / factor, high: mean * factor, trials: squares.count() }
    }
}

/// How far the study is, and how it is run.
pub struct Study {
    seed: u64,
    trials: u32,
    most: u32,
    progress: Progress,
    done: AtomicU32,
    steps: u32,
}

impl Study {
    /// A new step begins.
    ///
    /// # Errors
    /// If the user wants an end: what is half measured is not kept.
    fn step(&self, label: &str) -> Result<(), Error> {
        let done = self.done.fetch_add(1, Ordering::Relaxed);
        self.progress.show(f64::from(done) / f64::from(self.steps), label.to_owned());
        if interrupt::asked() { Err(Error::Interrupted) } else { Ok(()) }
    }

    /// The seed of a trial of a part of the study.
    fn seed(&self, part: u64, trial: u64) -> u64 {
        mix(mix(mix(self.seed) ^ part) ^ trial)
    }
}

/// What is printed.
#[derive(Serialize)]
struct Summary<'a> {
    #[serde(serialize_with = "files::path_text")]
    report: PathBuf,
    #[serde(serialize_with = "files::path_text")]
    results: PathBuf,
    seconds: f64,
    slopes: Vec<&'a convergence::Series>,
}

/// The command.
pub fn run(args: &SamplingArgs) -> Result<(), Error> {
    std::fs::create_dir_all(&args.out).map_err(|source| Error::Write { path: args.out.clone(), source })?;
    interrupt::listen()?;
    let threads = args.threads.map_or_else(clock::default_threads, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| Error::Input(format!("--threads {threads}: {e}")))?;
    let study = Study {
        seed: args.seed,
        trials: args.trials,
        most: args.most,
        progress: Progress::new("sampling"),
        done: AtomicU32::new(0),
        steps: convergence::steps(args.most)
            + penumbra::STEPS
            + resampling::STEPS
            + pictures::STEPS
            + allocation::STEPS,
    };
    let (measured, cost) = clock::timed(|| {
        pool.install(|| {
            let convergence = convergence::measure(&study)?;
            let penumbrae = penumbra::measure(&study)?;
            let resampling = resampling::measure(&study)?;
            let pictures = pictures::measure(&study)?;
            let allocation = allocation::measure(&study)?;
            Ok::<_, Error>((convergence, penumbrae, resampling, pictures, allocation))
        })
    });
    let (convergence, penumbrae, resampling, pictures, allocation) = measured?;
    drop(study);
    let results = Results {
        command: crate::study::command_line(),
        seed: args.seed,
        convergence,
        penumbrae: penumbrae.iter().flat_map(|p| p.rows.iter().cloned()).collect(),
        resampling,
        discrepancies: pictures.discrepancies.clone(),
        spectra: pictures.rings.clone(),
        allocation,
    };
    let at = |name: &str| args.out.join(name);
    let write = |name: &str, bytes: &[u8]| files::write_whole(&at(name), |w| w.write_all(bytes));
    write("results.json", files::json(&results).as_bytes())?;
    let (size, sheet) = pictures.sheet();
    write("patterns.png", &encode_png(size, &sheet))?;
    write("slopes.svg", page::standalone_slopes(&results).as_bytes())?;
    let facts = page::Facts { threads, processor: clock::processor(), seconds: cost.seconds };
    write("report.html", page::html(&results, &penumbrae, &pictures, &facts).as_bytes())?;
    if args.json {
        let slopes = results.convergence.iter().collect();
        let (report, results) = (at("report.html"), at("results.json"));
        return files::print_json(&Summary { report, results, seconds: cost.seconds, slopes });
    }
    files::print(&text(&results, &at("report.html").display().to_string()))
}

/// The slopes as text.
fn text(results: &Results, report: &str) -> String {
    let mut lines = Vec::new();
    for integrand in convergence::INTEGRANDS {
        lines.push(format!("{}: slope of variance over samples", integrand.name()));
        for series in results.convergence.iter().filter(|s| s.integrand == integrand.name()) {
            lines.push(format!("  {:<26} {}", series.pattern, series.slope_text()));
        }
    }
    lines.push(format!("{report} shows all of it"));
    lines.join("\n")
}

/// A pattern's place in the list: its colour and part of its seeds.
fn index_of(pattern: Pattern) -> u64 {
    Pattern::ALL.iter().position(|p| *p == pattern).map_or(0, |i| i as u64)
}
