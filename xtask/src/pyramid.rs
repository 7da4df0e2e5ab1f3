//! `pyramid`: what each strategy of bidirectional path tracing contributes, with and without its weight.

use crate::{
    cli::PyramidArgs,
    clock::{human_seconds, timed},
    error::Error,
    exr_file::{Attribute, ExrFile},
    files, interrupt,
    job::{Job, Wish},
    output::image_path,
    picture::{Picture, encode_png},
    progress::Progress,
};
use etendue_bidir::{
    events::{Contribution, Event},
    strategies::Paths,
    weights::Heuristic,
};
use etendue_core::{
    filter::Filter, has, rgb::Rgb, sampler::SamplerBuilder, scene::Scene, statistics::render::Rays, technique::Settings,
};
use glam::{UVec2, Vec2};
use image::{RgbImage, imageops};
use rayon::prelude::*;
use serde::Serialize;
use std::{ops::Range, path::PathBuf};

/// Rows of pixels whose contributions are held at a time.
const ROWS: u32 = 32;
/// The most numbers that all images together may have: 4 GiB.
const MOST_VALUES: u64 = 1 << 29;
/// Pixels between two images of the sheet, and between its two pyramids in place of that.
const GAP: u32 = 4;
const GREAT_GAP: u32 = 24;
/// Longer side of an image on the sheet.
const CELL: u32 = 128;
/// Colour between images.
const PAPER: image::Rgb<u8> = image::Rgb([255; 3]);

/// The images of all strategies that make paths of up to so many edges, of a pyramid in which row `k` holds those of
/// `s + t = k` vertices, `s` of them made from a light and `t >= 1` from the camera.
pub struct Pyramid {
    size: UVec2,
    filter: Filter,
    depth: u32,
    passes: u32,
    rejected: u64,
    /// Sums over passes, unweighted and weighted, in the order of [`strategies`].
    sums: Vec<[Vec<[f64; 3]>; 2]>,
}

/// A strategy: vertices made from a light and from the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strategy {
    /// Vertices made from a light.
    pub s: u32,
    /// Vertices made from the camera.
    pub t: u32,
}

/// The strategies for paths of up to `depth` edges, row by row, `s` from 0 up. That a light is connected to the lens itself
/// (`s = t = 1`) is none: what is seen of lights directly is found from the camera alone.
pub fn strategies(depth: u32) -> impl Iterator<Item = Strategy> {
    (2..=depth + 1).flat_map(|k| (0..k).map(move |s| Strategy { s, t: k - s })).filter(|v| (v.s, v.t) != (1, 1))
}

/// The place of a strategy in that order.
fn place(s: u32, t: u32) -> usize {
    // Row k begins behind one strategy of row 2 and j of each row j from 3 to k - 1.
    let k = s + t;
    let before = if k == 2 { 0 } else { (k - 1) * k / 2 - 2 };
    (before + s) as usize
}

/// What one strategy has added to a pixel.
struct Deposit {
    place: u32,
    pixel: u32,
    value: Rgb,
    weight: f32,
}

impl Pyramid {
    /// An empty one.
    pub fn new(size: UVec2, filter: Filter, depth: u32) -> Pyramid {
        let image = || vec![[0.0; 3]; (size.x * size.y) as usize];
        let sums = strategies(depth).map(|_| [image(), image()]).collect();
        Pyramid { size, filter, depth, passes: 0, rejected: 0, sums }
    }

    /// Adds a pass: a pair of paths for each pixel, those of [`etendue_bidir::BIDIR`] with the same seed and
    /// no particles besides. The same sums come
    /// of it on any number of threads.
    pub fn pass(&mut self, scene: &Scene, settings: &Settings, heuristic: Heuristic, seed: u64) {
        for first in (0..self.size.y).step_by(ROWS as usize) {
            let rows: Vec<(Vec<Deposit>, u64)> = (first..self.size.y.min(first + ROWS))
                .into_par_iter()
                .map(|y| self.row(scene, settings, heuristic, seed, y))
                .collect();
            for (deposits, rejected) in rows {
                self.rejected += rejected;
                for d in deposits {
                    let [unweighted, weighted] = &mut self.sums[d.place as usize];
                    let (unweighted, weighted) = (&mut unweighted[d.pixel as usize], &mut weighted[d.pixel as usize]);
                    for (c, value) in d.value.to_array().into_iter().enumerate() {
                        unweighted[c] += f64::from(value);
                        weighted[c] += f64::from(value) * f64::from(d.weight);
                    }
                }
            }
        }
        self.passes += 1;
    }

    /// The contributions of a row's paths, and how many are not finite or negative.
    fn row(&self, scene: &Scene, settings: &Settings, heuristic: Heuristic, seed: u64, y: u32) -> (Vec<Deposit>, u64) {
        let mut sampler = (settings.sampler)(seed, settings.planned_passes);
        let mut paths = Paths::new(scene, settings, heuristic, self.filter, self.size.x * self.size.y);
        let (mut deposits, mut rejected) = (Vec::new(), 0);
        for x in 0..self.size.x {
            let index = y * self.size.x + x;
            sampler.start_sample(index, self.passes);
            paths.sample::<{ has::ALL }>(UVec2::new(x, y), &mut *sampler, &mut Rays::default(), &mut |event| {
                let Event::Contribution(c) = event else { return };
                if !(c.value.is_valid() && c.film.is_none_or(Vec2::is_finite)) {
                    rejected += 1;
                    return;
                }
                self.deposit(&c, index, &mut deposits);
            });
        }
        (deposits, rejected)
    }

    /// Puts a contribution on the pixels that it belongs to.
    fn deposit(&self, c: &Contribution<'_>, index: u32, deposits: &mut Vec<Deposit>) {
        let place = place(c.s, c.t) as u32;
        let Some(film) = c.film else {
            return deposits.push(Deposit { place, pixel: index, value: c.value, weight: c.weight });
        };
        for y in reached(film.y, self.filter.radius(), self.size.y) {
            for x in reached(film.x, self.filter.radius(), self.size.x) {
                // A position on a box's edge belongs to one pixel alone, whatever rounding makes of the offset.
                let share = match self.filter {
                    Filter::Box => f32::from(film.floor() == Vec2::new(x as f32, y as f32)),
                    filter => filter.evaluate(film - Vec2::new(x as f32 + 0.5, y as f32 + 0.5)),
                };
                if share > 0.0 {
                    let pixel = y * self.size.x + x;
                    deposits.push(Deposit { place, pixel, value: c.value * share, weight: c.weight });
                }
            }
        }
    }

    fn picture(&self, sums: &[[f64; 3]]) -> Picture {
        let scale = 1.0 / f64::from(self.passes.max(1));
        let pixels = sums.iter().map(|p| Rgb::from(p.map(|v| (v * scale) as f32))).collect();
        Picture { size: self.size, pixels }
    }

    /// A strategy's image without and with its weight.
    pub fn images(&self, strategy: Strategy) -> [Picture; 2] {
        let [unweighted, weighted] = &self.sums[place(strategy.s, strategy.t)];
        [self.picture(unweighted), self.picture(weighted)]
    }

    /// The sum of the weighted images of some strategies: all together are the image.
    pub fn sum(&self, strategies: impl Iterator<Item = Strategy>) -> Picture {
        let mut sum = vec![[0.0; 3]; (self.size.x * self.size.y) as usize];
        for v in strategies {
            for (sum, p) in sum.iter_mut().zip(&self.sums[place(v.s, v.t)][1]) {
                (0..3).for_each(|c| sum[c] += p[c]);
            }
        }
        self.picture(&sum)
    }

    /// All images in one file: the image itself, and for each strategy the layers `s2t3.unweighted` and `s2t3.weighted`.
    fn exr(&self) -> ExrFile {
        let mut file = ExrFile::of(&self.sum(strategies(self.depth)));
        for v in strategies(self.depth) {
            for (name, picture) in ["unweighted", "weighted"].into_iter().zip(self.images(v)) {
                let prefix = format!("s{}t{}.{name}.", v.s, v.t);
                file.add_layer(&prefix, picture.pixels.iter().map(|p| p.to_array()));
            }
        }
        file
    }

    /// Two pyramids, without weights above and with them below; a row has the exposure of what its weighted images add up to.
    fn sheet(&self) -> RgbImage {
        let longer = self.size.max_element();
        let side = |n: u32| ((n * CELL + longer / 2) / longer).max(1);
        let cell = UVec2::new(side(self.size.x), side(self.size.y));
        let span = |n: u32, cell: u32| n * (cell + GAP) - GAP;
        let height = span(self.depth, cell.y);
        let width = span(self.depth + 1, cell.x);
        let mut sheet = RgbImage::from_pixel(width, 2 * height + GREAT_GAP, PAPER);
        for row in 0..self.depth {
            let of_row: Vec<Strategy> = strategies(self.depth).filter(|v| v.s + v.t == row + 2).collect();
            let exposure = self.sum(of_row.iter().copied()).exposure();
            let left = (width - span(of_row.len() as u32, cell.x)) / 2;
            for (column, v) in (0..).zip(of_row) {
                for (half, picture) in (0..).zip(self.images(v)) {
                    let png = picture.png(exposure);
                    let shown = image::load_from_memory(&png).expect("a picture that was just encoded").into_rgb8();
                    let shown = imageops::resize(&shown, cell.x, cell.y, imageops::FilterType::Triangle);
                    let x = left + column * (cell.x + GAP);
                    let y = row * (cell.y + GAP) + half * (height + GREAT_GAP);
                    imageops::replace(&mut sheet, &shown, x.into(), y.into());
                }
            }
        }
        sheet
    }
}

/// The pixels of a row of `size` whose filter may reach a position.
fn reached(position: f32, radius: f32, size: u32) -> Range<u32> {
    // The conversion saturates at 0.
    let first = (position - 0.5 - radius).floor() as u32;
    let end = (position + 0.5 + radius).ceil() as u32;
    first.min(size)..end.min(size)
}

/// A strategy as it is printed: the means are over pixels and channels.
#[derive(Serialize)]
struct StrategyReport {
    s: u32,
    t: u32,
    edges: u32,
    unweighted_mean: f64,
    weighted_mean: f64,
}

/// What a pyramid came to, as it is printed.
#[derive(Serialize)]
struct PyramidReport {
    scene: String,
    scene_hash: String,
    heuristic: &'static str,
    width: u32,
    height: u32,
    depth: u32,
    seed: u64,
    passes: u32,
    seconds: f64,
    rejected: u64,
    interrupted: bool,
    mean: f64,
    strategies: Vec<StrategyReport>,
    #[serde(serialize_with = "files::path_text")]
    out: PathBuf,
    #[serde(serialize_with = "files::path_text")]
    png: PathBuf,
}

/// The command.
pub fn run(args: &PyramidArgs) -> Result<(), Error> {
    let out = image_path(args.out.as_deref(), &args.scene, "-pyramid")?;
    let wish = Wish {
        technique: etendue_bidir::BIDIR.name.into(),
        knobs: Vec::new(),
        sampler: "independent".into(),
        parts: Vec::new(),
        size: args.size,
        depth: Some(args.depth),
        load: args.load.into(),
    };
    let job = Job::load(&args.scene, &wish)?;
    job.gaps().iter().for_each(|gap| eprintln!("warning: {gap}"));
    let size = job.key.size();
    let values = u64::from(size.x) * u64::from(size.y) * 6 * strategies(args.depth).count() as u64;
    if values > MOST_VALUES {
        let reason = format!("{size} pixels for each of {} strategies", strategies(args.depth).count());
        return Err(Error::Input(format!("{reason} take more memory than 4 GiB; --size and --depth take less")));
    }
    let scene = Scene::new(&job.scene.description);
    let scene = scene.map_err(|source| Error::Scene { scene: args.scene.clone(), source })?;
    let sampler: SamplerBuilder = etendue_core::independent::independent;
    let settings = Settings {
        roulette_depth: job.scene.roulette_depth,
        planned_passes: args.passes,
        ..Settings::new(args.depth, sampler)
    };
    interrupt::listen()?;
    let threads = args.threads.map_or_else(crate::clock::default_threads, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| Error::Input(format!("--threads {threads}: {e}")))?;

    let mut pyramid = Pyramid::new(size, job.scene.filter, args.depth);
    let progress = Progress::new(&args.scene);
    let mut seconds = 0.0;
    while pyramid.passes < args.passes && !interrupt::asked() {
        let ((), cost) = timed(|| pool.install(|| pyramid.pass(&scene, &settings, args.heuristic, args.seed)));
        seconds += cost.seconds;
        let share = f64::from(pyramid.passes) / f64::from(args.passes);
        progress.show(share, format!("{} passes, {}", pyramid.passes, human_seconds(seconds)));
    }
    drop(progress);
    if pyramid.passes == 0 {
        return Err(Error::Interrupted);
    }
    let report = save(&pyramid, args, &job, out, seconds)?;
    if args.json { files::print_json(&report) } else { files::print(&report.text()) }
}

/// Writes the file of all images and the sheet.
fn save(pyramid: &Pyramid, args: &PyramidArgs, job: &Job, out: PathBuf, seconds: f64) -> Result<PyramidReport, Error> {
    let mean = |p: &Picture| {
        let sum: f64 = p.pixels.iter().flat_map(|p| p.to_array()).map(f64::from).sum();
        sum / (3 * p.pixels.len()) as f64
    };
    let mut exr = pyramid.exr();
    exr.attributes = [
        ("scene", Attribute::Text(job.key.scene.clone())),
        ("sceneHash", Attribute::Text(job.key.scene_hash.clone())),
        ("heuristic", Attribute::Text(args.heuristic.name().into())),
        ("seed", Attribute::Text(args.seed.to_string())),
        ("passes", Attribute::Whole(i32::try_from(pyramid.passes).unwrap_or(i32::MAX))),
        ("depth", Attribute::Whole(pyramid.depth as i32)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    exr.write(&out)?;
    let png = out.with_extension("png");
    let sheet = pyramid.sheet();
    let bytes = encode_png(UVec2::from(sheet.dimensions()), sheet.as_raw());
    files::write_whole(&png, |w| std::io::Write::write_all(w, &bytes))?;
    let strategy = |v: Strategy| {
        let [unweighted, weighted] = pyramid.images(v);
        StrategyReport {
            s: v.s,
            t: v.t,
            edges: v.s + v.t - 1,
            unweighted_mean: mean(&unweighted),
            weighted_mean: mean(&weighted),
        }
    };
    Ok(PyramidReport {
        scene: job.key.scene.clone(),
        scene_hash: job.key.scene_hash.clone(),
        heuristic: args.heuristic.name(),
        width: pyramid.size.x,
        height: pyramid.size.y,
        depth: pyramid.depth,
        seed: args.seed,
        passes: pyramid.passes,
        seconds,
        rejected: pyramid.rejected,
        interrupted: interrupt::asked(),
        mean: mean(&pyramid.sum(strategies(pyramid.depth))),
        strategies: strategies(pyramid.depth).map(strategy).collect(),
        out,
        png,
    })
}

impl PyramidReport {
    fn text(&self) -> String {
        let interrupted = if self.interrupted { ", interrupted" } else { "" };
        let mut text = format!(
            "{}: {} passes of {}x{} in {}{interrupted}, {} rejected contributions\n\
             edges   s   t   unweighted mean   weighted mean",
            self.scene,
            self.passes,
            self.width,
            self.height,
            human_seconds(self.seconds),
            self.rejected
        );
        for v in &self.strategies {
            let (unweighted, weighted) = (v.unweighted_mean, v.weighted_mean);
            text += &format!("\n{:5} {:3} {:3} {unweighted:17.6} {weighted:15.6}", v.edges, v.s, v.t);
        }
        text + &format!("\nwrote {} and {}", self.out.display(), self.png.display())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strategies_have_places_in_their_order() {
        assert_eq!(strategies(1).collect::<Vec<_>>(), [Strategy { s: 0, t: 2 }]);
        for depth in 1..12 {
            for (i, v) in strategies(depth).enumerate() {
                assert_eq!(place(v.s, v.t), i, "{v:?}");
                assert!(v.t >= 1 && v.s + v.t <= depth + 1);
            }
        }
    }

    #[test]
    fn pixels_that_a_filter_reaches() {
        assert_eq!(reached(0.2, 0.5, 4), 0..2);
        assert_eq!(reached(2.5, 0.5, 4), 1..4);
        assert_eq!(reached(-0.3, 1.0, 4), 0..2);
        assert_eq!(reached(4.4, 1.0, 4), 2..4);
        assert!(reached(9.0, 1.0, 4).is_empty() && reached(-9.0, 1.0, 4).is_empty());
    }
}
