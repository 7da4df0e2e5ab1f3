//! Puts pictures side by side on one sheet, in rows of a given number, each scaled to a given side. `docs/pictures.sh` makes
//! the README's picture with it:
//!
//! ```text
//! cargo run --release -p xtask --example contact_sheet -- OUT.png COLUMNS SIDE PICTURE.png..
//! ```

use image::{DynamicImage, RgbImage, imageops};
use std::error::Error;

/// Pixels between two pictures.
const GAP: u32 = 4;
/// Colour between pictures.
const PAPER: image::Rgb<u8> = image::Rgb([255; 3]);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, columns, side, pictures @ ..] = &arguments[..] else {
        return Err("usage: contact_sheet OUT.png COLUMNS SIDE PICTURE.png..".into());
    };
    let (columns, side) = (columns.parse::<u32>()?.max(1), side.parse::<u32>()?);
    let rows = (pictures.len() as u32).div_ceil(columns);
    let span = |n: u32| (n * (side + GAP)).saturating_sub(GAP);
    let mut sheet = RgbImage::from_pixel(span(columns), span(rows), PAPER);
    for (i, path) in (0..).zip(pictures) {
        let picture = image::open(path).map_err(|e| format!("{path}: {e}"))?;
        let scaled = picture.resize_to_fill(side, side, imageops::FilterType::Triangle).into_rgb8();
        let at = |n: u32| i64::from(n * (side + GAP));
        imageops::replace(&mut sheet, &scaled, at(i % columns), at(i / columns));
    }
    DynamicImage::from(sheet).save(out)?;
    Ok(())
}
