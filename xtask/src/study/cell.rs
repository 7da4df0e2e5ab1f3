//! A cell: passes of one technique on one scene with one seed, measured at doubling counts.

use crate::{
    clock::{peak_memory, reset_peak_memory},
    error::Error,
    hash::derive_seed,
    interrupt,
    job::{Engine, Job},
    reference::Reference,
    study::results::{Cell, Group, Line},
};
use etendue_core::{rgb::Rgb, statistics::image_error::ImageError};

/// When a cell ends.
#[derive(Clone, Copy, Debug)]
pub enum End {
    /// When its seconds are used: the first replicate of a group.
    Seconds,
    /// After as many passes as the first replicate made: all replicates of a group have the same checkpoints.
    Passes(u32),
}

/// What a cell is and how long it may take.
pub struct Plan<'a> {
    /// The scene and the technique.
    pub job: &'a Job,
    /// What the cell is of.
    pub group: &'a Group,
    /// Which replicate.
    pub replicate: u32,
    /// Seconds of a cell.
    pub seconds: f64,
    /// When it ends.
    pub end: End,
    /// What it is compared with.
    pub reference: &'a Reference,
}

/// A cell that is finished, and its image at each checkpoint.
pub struct Finished {
    /// The measurements.
    pub cell: Cell,
    /// The images, in the order of the cell's lines.
    pub images: Vec<Vec<Rgb>>,
}

/// Below this ratio of passes, the last checkpoint stands for the one before it as well.
const CLOSE: f64 = 1.25;

/// Runs a cell; none if Ctrl-C came before its end.
pub fn run(plan: &Plan, mut progress: impl FnMut(f64)) -> Result<Option<Finished>, Error> {
    reset_peak_memory();
    let seed = derive_seed(plan.group.seed, u64::from(plan.replicate));
    // No number of passes is planned, even where it is known: a sampler that plans for it would do its best at the end
    // alone, but there is a checkpoint at every power of two, and the replicates must be alike.
    let mut engine = plan.job.build(plan.group.threads, 0)?;
    let mut checkpoints = Vec::new();
    for pass in 0..u32::MAX {
        if interrupt::asked() {
            return Ok(None);
        }
        engine.pass(seed, pass);
        let passes = pass + 1;
        let share = match plan.end {
            End::Seconds => engine.total().seconds / plan.seconds,
            End::Passes(n) => f64::from(passes) / f64::from(n),
        };
        let last = share >= 1.0 || passes == u32::MAX;
        if last || passes.is_power_of_two() {
            // Off the clock: only building and passes are timed.
            checkpoints.push(measure(plan, &engine, passes, last));
        }
        progress(share);
        if last {
            break;
        }
    }
    if let [.., (before, _), (end, _)] = &checkpoints[..]
        && f64::from(end.passes) < CLOSE * f64::from(before.passes)
    {
        checkpoints.remove(checkpoints.len() - 2);
    }
    let (lines, images) = checkpoints.into_iter().unzip();
    Ok(Some(Finished { cell: Cell { lines }, images }))
}

fn measure(plan: &Plan, engine: &Engine, passes: u32, last: bool) -> (Line, Vec<Rgb>) {
    let image = engine.film.mean_image();
    let reference = plan.reference;
    let error = ImageError::new(&reference.measured(&image), &reference.measured(&reference.picture.pixels));
    let (total, statistics) = (engine.total(), engine.statistics());
    let line = Line {
        group: plan.group.clone(),
        replicate: plan.replicate,
        passes,
        build_seconds: engine.build.seconds,
        seconds: total.seconds,
        cpu_seconds: total.cpu_seconds,
        rays: statistics.rays.total(),
        mse: error.mse,
        relmse: error.relmse,
        relmse_trimmed: error.relmse_trimmed,
        trimmed_share: error.trimmed_share,
        trimmed_energy_share: error.trimmed_energy_share,
        smape: error.smape,
        mean_error: error.mean_error,
        mean_error_relative: error.mean_error_relative,
        bias2: None,
        variance: None,
        rejected: statistics.rejected,
        peak_bytes: peak_memory(),
        budget_seconds: plan.seconds,
        last,
    };
    (line, image)
}
