//! `compare`: the error of an image against a reference.

use crate::{
    cli::CompareArgs, error::Error, error_map::error_map_png, exr_file::read_picture, files, picture::Picture,
};
use etendue_core::{rgb::Rgb, statistics::image_error::ImageError};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What is compared and what came of it; the figures are there if every value is finite.
#[derive(Debug, Serialize)]
struct Comparison {
    #[serde(serialize_with = "files::path_text")]
    image: PathBuf,
    #[serde(serialize_with = "files::path_text")]
    reference: PathBuf,
    width: u32,
    height: u32,
    pixels: usize,
    mse: Option<f64>,
    relmse: Option<f64>,
    relmse_trimmed: Option<f64>,
    trimmed_share: Option<f64>,
    smape: Option<f64>,
    mean_error: Option<f64>,
    mean_error_relative: Option<f64>,
    not_finite: Vec<NotFinite>,
}

/// A channel with values that are no numbers.
#[derive(Debug, Serialize)]
struct NotFinite {
    #[serde(serialize_with = "files::path_text")]
    file: PathBuf,
    channel: &'static str,
    nan: usize,
    infinite: usize,
    first_x: u32,
    first_y: u32,
}

/// The command.
pub fn run(args: &CompareArgs) -> Result<(), Error> {
    if let Some(out) = &args.out {
        files::check_output(out)?;
    }
    let (image, reference) = (read_picture(&args.image)?, read_picture(&args.reference)?);
    same_size(&image, &args.image, &reference, &args.reference)?;
    let mask = args.mask.as_ref().map(|path| read_mask(path, &reference, &args.reference)).transpose()?;
    let inside = |i: usize| mask.as_ref().is_none_or(|m| m[i]);
    let masked =
        |p: &Picture| -> Vec<Rgb> { (0..p.pixels.len()).filter(|i| inside(*i)).map(|i| p.pixels[i]).collect() };
    let (a, b) = (masked(&image), masked(&reference));
    if a.is_empty() {
        return Err(Error::Input("the mask is black everywhere: no pixel is left to compare".into()));
    }
    let not_finite: Vec<NotFinite> = [(&image, &args.image), (&reference, &args.reference)]
        .into_iter()
        .flat_map(|(picture, path)| channels_not_finite(picture, path, inside))
        .collect();
    let error = not_finite.is_empty().then(|| ImageError::new(&a, &b));
    let comparison = Comparison {
        image: args.image.clone(),
        reference: args.reference.clone(),
        width: image.size.x,
        height: image.size.y,
        pixels: a.len(),
        mse: error.as_ref().map(|e| e.mse),
        relmse: error.as_ref().map(|e| e.relmse),
        relmse_trimmed: error.as_ref().map(|e| e.relmse_trimmed),
        trimmed_share: error.as_ref().map(|e| e.trimmed_share),
        smape: error.as_ref().map(|e| e.smape),
        mean_error: error.as_ref().map(|e| e.mean_error),
        mean_error_relative: error.as_ref().map(|e| e.mean_error_relative),
        not_finite,
    };
    if let Some(out) = &args.out {
        files::write_whole(out, |w| std::io::Write::write_all(w, &error_map_png(&image, &reference)))?;
    }
    if args.json {
        files::print_json(&comparison)?;
    } else {
        files::print(&comparison.text())?;
    }
    match comparison.not_finite.first() {
        Some(n) => Err(Error::Failed(n.text())),
        None => Ok(()),
    }
}

impl Comparison {
    fn text(&self) -> String {
        let figures = [
            ("mse", self.mse),
            ("relmse", self.relmse),
            ("relmse_trimmed", self.relmse_trimmed),
            ("trimmed_share", self.trimmed_share),
            ("smape", self.smape),
            ("mean_error", self.mean_error),
            ("mean_error_relative", self.mean_error_relative),
        ];
        let figure = |(name, value): (&str, Option<f64>)| match value {
            Some(v) => format!("{name:<20} {v:.6e}"),
            None => format!("{name:<20} none"),
        };
        let lines = figures.into_iter().map(figure).chain(self.not_finite.iter().map(NotFinite::text));
        let head = format!("{} pixels of {}x{}", self.pixels, self.width, self.height);
        std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n")
    }
}

impl NotFinite {
    fn text(&self) -> String {
        format!(
            "{}: channel {} holds {} NaN and {} infinite values, the first at x {}, y {}",
            self.file.display(),
            self.channel,
            self.nan,
            self.infinite,
            self.first_x,
            self.first_y
        )
    }
}

/// The channels of a picture that hold values that are no numbers, where it is looked at.
fn channels_not_finite(picture: &Picture, path: &Path, inside: impl Fn(usize) -> bool) -> Vec<NotFinite> {
    let channel = |(c, name): (usize, &'static str)| {
        let bad = |i: &usize| inside(*i) && !picture.pixels[*i][c].is_finite();
        let places: Vec<usize> = (0..picture.pixels.len()).filter(bad).collect();
        let first = *places.first()? as u32;
        let nan = places.iter().filter(|i| picture.pixels[**i][c].is_nan()).count();
        Some(NotFinite {
            file: path.into(),
            channel: name,
            nan,
            infinite: places.len() - nan,
            first_x: first % picture.size.x,
            first_y: first / picture.size.x,
        })
    };
    ["R", "G", "B"].into_iter().enumerate().filter_map(channel).collect()
}

/// Refuses pictures of different sizes.
pub fn same_size(a: &Picture, a_path: &Path, b: &Picture, b_path: &Path) -> Result<(), Error> {
    if a.size == b.size {
        return Ok(());
    }
    let reason =
        format!("has {}x{} pixels, but {} has {}x{}", a.size.x, a.size.y, b_path.display(), b.size.x, b.size.y);
    Err(Error::Content { path: a_path.into(), reason })
}

/// Where a mask is not black.
fn read_mask(path: &Path, reference: &Picture, reference_path: &Path) -> Result<Vec<bool>, Error> {
    let mask = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        read_picture(path)?
    } else {
        let bytes = files::read_whole(path)?;
        let image = image::load_from_memory(&bytes);
        let image =
            image.map_err(|e| Error::Content { path: path.into(), reason: format!("as a mask: {e}") })?.into_rgb8();
        let pixels = image.pixels().map(|p| Rgb::from(p.0.map(f32::from))).collect();
        Picture { size: image.dimensions().into(), pixels }
    };
    same_size(&mask, path, reference, reference_path)?;
    Ok(mask.pixels.iter().map(|p| p.max_element() > 0.0).collect())
}
