//! The command line's grammar.

use crate::{
    job::{Size, Wish},
    samplers,
    study::region::Region,
};
use clap::{Args, Parser, Subcommand};
use etendue_bidir::weights::Heuristic;
use etendue_scenes::LoadOptions;
use std::path::PathBuf;

/// What accuracy costs in time: renders, references, convergence studies and their reports.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, max_term_width = 110)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a convergence study and write its report.
    Study(StudyArgs),
    /// Render a scene to an OpenEXR file and a PNG beside it.
    Render(RenderArgs),
    /// Show what each strategy of bidirectional path tracing contributes.
    Pyramid(PyramidArgs),
    /// Add films that were rendered apart, exactly.
    Merge(MergeArgs),
    /// Compare an image with a reference.
    Compare(CompareArgs),
    /// Make the stored references.
    Reference(ReferenceArgs),
    /// Measure what sample patterns buy: variance, spectra, images, resampling.
    Sampling(SamplingArgs),
    /// Describe a scene: what is in it, what it costs to load and to hold, which effects it has.
    Scene(SceneArgs),
    /// List the built-in scenes and their parameters.
    #[command(after_help = "Examples:\n  cargo xtask scenes\n  cargo xtask scenes --json")]
    Scenes(ListArgs),
    /// List the techniques and their knobs.
    #[command(after_help = "Examples:\n  cargo xtask techniques\n  cargo xtask techniques --json")]
    Techniques(ListArgs),
    /// Run what must pass before a change is taken: formatting, lints, documentation, tests.
    Check(CheckArgs),
}

/// What every command that loads scenes can be told about the image.
#[derive(Clone, Debug, Args)]
pub struct ImageArgs {
    /// Size in pixels; one number is the longer side, in the scene's own shape
    #[arg(long, value_name = "WxH|N")]
    pub size: Option<Size>,
    /// Longest path, as Mitsuba counts: 1 is emission alone, 2 adds direct light [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub depth: Option<u32>,
    /// Threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

impl ImageArgs {
    /// The number of threads.
    pub fn threads(&self) -> usize {
        self.threads.map_or_else(crate::clock::default_threads, usize::from)
    }
}

/// How scene files are loaded.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct LoadArgs {
    /// Leave out what is wrong or not supported in a scene file, or let something plain stand in for it, and list it
    #[arg(long)]
    pub lenient: bool,
    /// Read files outside of the scene's folder where the scene names them
    #[arg(long)]
    pub allow_outside: bool,
}

impl From<LoadArgs> for LoadOptions {
    fn from(args: LoadArgs) -> LoadOptions {
        LoadOptions { lenient: args.lenient, outside_folder: args.allow_outside }
    }
}

/// Arguments of `scene`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  cargo xtask scene scene.xml
  cargo xtask scene many-lights:n=4096 --json
  cargo xtask scene old.xml --lenient        (and what was left out)")]
pub struct SceneArgs {
    /// A built-in scene with its parameters (`many-lights:n=4096`), or a file
    pub scene: String,
    /// How it is loaded.
    #[command(flatten)]
    pub load: LoadArgs,
    /// Threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `render`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  cargo xtask render cornell --passes 64 --out cornell.exr
  cargo xtask render many-lights:n=4096 --seconds 10 --size 256x256
  cargo xtask render scene.xml --passes 4096 --out scene.exr            (Ctrl-C: what is finished is saved)
  cargo xtask render scene.xml --passes 4096 --out scene.exr --resume   (goes on from there)
  cargo xtask render cornell --first-pass 32 --passes 32 --out second-half.exr

Beside the OpenEXR file stand a tone-mapped PNG and the film, which `--resume` and `merge` read.")]
pub struct RenderArgs {
    /// A built-in scene with its parameters (`many-lights:n=4096`), or a file
    pub scene: String,
    /// Technique
    #[arg(long, default_value = "path", value_name = "NAME")]
    pub technique: String,
    #[command(flatten)]
    /// The image.
    pub image: ImageArgs,
    /// How the scene is loaded.
    #[command(flatten)]
    pub load: LoadArgs,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Passes in all; each adds one sample a pixel [default: 16]
    #[arg(long, value_name = "N", conflicts_with = "seconds", value_parser = clap::value_parser!(u32).range(1..))]
    pub passes: Option<u32>,
    /// Passes until so many seconds are used, building included, at least one pass
    #[arg(long, value_name = "S", value_parser = positive_seconds)]
    pub seconds: Option<f64>,
    /// First pass, to render an image in parts that `merge` adds
    #[arg(long, default_value_t = 0, value_name = "K")]
    pub first_pass: u32,
    /// Parts of the light: emission, direct, environment, caustic, indirect [default: all]
    #[arg(long, value_delimiter = ',', value_name = "PART,..")]
    pub parts: Vec<String>,
    /// A setting of the technique (`cargo xtask techniques` lists them)
    #[arg(long = "knob", value_name = "NAME=VALUE")]
    pub knobs: Vec<String>,
    /// Random numbers: sobol, independent, halton, .. (`cargo xtask sampling` measures them)
    #[arg(long, default_value = samplers::DEFAULT, value_name = "NAME")]
    pub sampler: String,
    /// The OpenEXR file to write [default: the scene's name, in the current folder]
    #[arg(long, value_name = "FILE.exr")]
    pub out: Option<PathBuf>,
    /// Go on from the film beside the output file; the budget counts what is in it
    #[arg(long)]
    pub resume: bool,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

impl RenderArgs {
    /// What is wished of the image.
    pub fn wish(&self) -> Wish {
        Wish {
            technique: self.technique.clone(),
            knobs: self.knobs.clone(),
            sampler: self.sampler.clone(),
            parts: self.parts.clone(),
            size: self.image.size,
            depth: self.image.depth,
            load: self.load.into(),
        }
    }
}

/// Arguments of `pyramid`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  cargo xtask pyramid hidden-lights
  cargo xtask pyramid glass-caustic --depth 5 --passes 256 --out caustic.exr
  cargo xtask pyramid scene.xml --size 256 --heuristic balance --seed 1

A strategy makes s vertices of a path from a light and t from the camera. The OpenEXR file holds the image and, for each
strategy, the layers sXtY.unweighted (unbiased alone wherever it can make every path) and sXtY.weighted (its share; all
add up to the image). Beside it stands a PNG with two pyramids, without weights above and with them below: a row for each
number of edges, s from 0 on the left; a row has the exposure of what its weighted images add up to.")]
pub struct PyramidArgs {
    /// A built-in scene with its parameters (`many-lights:n=4096`), or a file
    pub scene: String,
    /// Size in pixels; one number is the longer side, in the scene's own shape
    #[arg(long, value_name = "WxH|N")]
    pub size: Option<Size>,
    /// Longest path, as Mitsuba counts, and number of rows
    #[arg(long, default_value_t = 6, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=32))]
    pub depth: u32,
    /// How the scene is loaded.
    #[command(flatten)]
    pub load: LoadArgs,
    /// How strategies share a path: balance, power or maximum
    #[arg(long, default_value = "power", value_name = "NAME", value_parser = heuristic)]
    pub heuristic: Heuristic,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Passes, each a pair of paths a pixel
    #[arg(long, default_value_t = 64, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub passes: u32,
    /// Threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// The OpenEXR file to write [default: SCENE-pyramid.exr, in the current folder]
    #[arg(long, value_name = "FILE.exr")]
    pub out: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `merge`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  cargo xtask render cornell --first-pass 0 --passes 4 --out a.exr
  cargo xtask render cornell --first-pass 4 --passes 4 --out b.exr
  cargo xtask merge whole.exr a.film b.film      (the bits of eight passes in one go)

Films of other seeds can be added as well and average as independent renders do; parts of one seed share a pattern, so that
with the default sampler their error falls faster.")]
pub struct MergeArgs {
    /// The OpenEXR file to write; its PNG and film are written beside it
    pub out: PathBuf,
    /// Films of one scene at one size with one technique; no pass of a seed twice
    #[arg(required = true)]
    pub films: Vec<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  cargo xtask compare render.exr reference/cornell.exr
  cargo xtask compare render.exr reference.exr --json
  cargo xtask compare render.exr reference.exr --mask caustic.png --out error-map.png

relMSE is the mean of (a - b)^2 / (b^2 + 0.01) over pixels and channels; trimmed, the worst 0.1 % of the pixels are left
out, and the trimmed share is the part of the error that they hold. A channel with a value that is not finite is named,
the figures are then null, and the exit code is 1.")]
pub struct CompareArgs {
    /// The image
    pub image: PathBuf,
    /// The reference
    pub reference: PathBuf,
    /// Look only where this image of the same size (PNG or OpenEXR) is not black
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// Write a map of the error, relative to the reference, in false colours
    #[arg(long, value_name = "FILE.png")]
    pub out: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `study`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  cargo xtask study                                             (which technique for which scene, within three minutes)
  cargo xtask study --scenes cornell,sky --seconds 30 --replicates 8 --out study
  cargo xtask study --scenes scene.xml --reference truth.exr
  cargo xtask study --scenes ring --techniques path,bidir --region caustic:0.2
  cargo xtask study --scenes pool --techniques photon,sppm --knob photon.nearest=100
  open study/report.html

Results are kept in OUT as they come. Interrupted and started again with the same arguments, a study goes on where it
was; cells that differ in scene, technique, knobs, sampler, size, depth, seed, threads or reference are never mixed.")]
pub struct StudyArgs {
    /// Scenes, built-in or files
    #[arg(long, value_delimiter = ',', value_name = "SCENE,..", default_values_t = QUICK_SCENES.map(String::from))]
    pub scenes: Vec<String>,
    /// Techniques [default: all, but for those that leave out what a scene shows in mirrors or through glass]
    #[arg(long, value_delimiter = ',', value_name = "NAME,..")]
    pub techniques: Vec<String>,
    /// Turn a knob of a technique, as `cargo xtask techniques` lists them; again for more. Some scenes have knobs of their own,
    /// which the report tells
    #[arg(long = "knob", value_name = "TECHNIQUE.NAME=VALUE")]
    pub knobs: Vec<String>,
    /// Random numbers; every technique runs with each of them
    #[arg(long, alias = "sampler", value_delimiter = ',', value_name = "NAME,..", default_value = samplers::DEFAULT)]
    pub samplers: Vec<String>,
    /// Time of each cell (a scene with a technique, a sampler and a seed), building included
    #[arg(long, default_value_t = 2.0, value_name = "S", value_parser = positive_seconds)]
    pub seconds: f64,
    /// Cells with different seeds; the bands in the report are over them
    #[arg(long, default_value_t = 4, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub replicates: u32,
    /// The image.
    #[command(flatten)]
    pub image: ImageArgs,
    /// How the scenes are loaded.
    #[command(flatten)]
    pub load: LoadArgs,
    /// Seed from which those of the replicates are drawn
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Folder of the results and the report; it is made if it is not there
    #[arg(long, default_value = "study", value_name = "DIR")]
    pub out: PathBuf,
    /// The reference of the one scene that is studied; sets the size unless --size does
    #[arg(long, value_name = "FILE.exr")]
    pub reference: Option<PathBuf>,
    /// Measure errors only in pixels of which this part of the light is more than this share (emission, direct, environment,
    /// caustic, indirect); where it is, 64 passes of bidirectional path tracing tell
    #[arg(long, value_name = "PART:SHARE")]
    pub region: Option<Region>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// The scenes of a quick study: diffuse light, glossy highlights, a caustic, lamps that are turned away. Each wants another
/// technique.
pub const QUICK_SCENES: [&str; 4] = ["cornell", "veach-mis", "ring", "hidden-lights"];

/// Arguments of `reference`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  cargo xtask reference                                    (every built-in scene, a minute each)
  cargo xtask reference --scenes ring,glass-caustic --seconds 600
  cargo xtask reference --scenes cornell --passes 4096 --size 256

Writes SCENE.exr with the mean (R, G, B) and the variance of the mean (variance.R, ..), and an entry in reference.json.")]
pub struct ReferenceArgs {
    /// Technique: one that finds all that the scene's light does [default: one that does, for each built-in scene; else path]
    #[arg(long, value_name = "NAME")]
    pub technique: Option<String>,
    /// Scenes [default: every built-in one]
    #[arg(long, value_delimiter = ',', value_name = "SCENE,..")]
    pub scenes: Vec<String>,
    /// Time of each scene [default: 60]
    #[arg(long, value_name = "S", conflicts_with = "passes", value_parser = positive_seconds)]
    pub seconds: Option<f64>,
    /// Passes of each scene
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    pub passes: Option<u32>,
    /// The image.
    #[command(flatten)]
    pub image: ImageArgs,
    /// How the scenes are loaded.
    #[command(flatten)]
    pub load: LoadArgs,
    /// Seed; a study's own seeds never meet it
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Folder [default: `reference` in the workspace]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `sampling`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  cargo xtask sampling                              (within two minutes)
  cargo xtask sampling --trials 10000 --seed 1 --out study/sampling-1
  cargo xtask sampling --trials 32 --most 256       (a quick look)
  open study/sampling/report.html

Writes report.html, which needs nothing else, results.json with all figures, and the pictures patterns.png and slopes.svg.")]
pub struct SamplingArgs {
    /// Folder of the results; it is made if it is not there
    #[arg(long, default_value = "study/sampling", value_name = "DIR")]
    pub out: PathBuf,
    /// Trials that a variance is measured over; fewer where a trial has many samples
    #[arg(long, default_value_t = 1024, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub trials: u32,
    /// The most samples of a trial, which go up in powers of four
    #[arg(long, default_value_t = 65_536, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=1 << 24))]
    pub most: u32,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print the slopes as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of the lists.
#[derive(Debug, Args)]
pub struct ListArgs {
    /// Print as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  cargo xtask check\n  cargo xtask check --list")]
pub struct CheckArgs {
    /// Print the commands and run none
    #[arg(long)]
    pub list: bool,
}

fn positive_seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(s) if s > 0.0 && s.is_finite() => Ok(s),
        _ => Err("not a positive number of seconds".into()),
    }
}

fn heuristic(text: &str) -> Result<Heuristic, String> {
    Heuristic::ALL.into_iter().find(|h| h.name() == text).ok_or_else(|| "not one of balance, power, maximum".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_grammar_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_command_has_examples() {
        for command in Cli::command().get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.contains(&format!("cargo xtask {}", command.get_name())), "{}", command.get_name());
        }
    }
}
