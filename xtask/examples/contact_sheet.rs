//! Puts pictures side by side on one sheet, in rows of a given number, each scaled to a given side, with a line of text
//! under each that has one. `docs/pictures.sh` makes the pictures of the READMEs with it:
//!
//! ```text
//! cargo run --release -p xtask --example contact_sheet -- OUT.png COLUMNS SIDE PICTURE.png[=TEXT]..
//! ```

use embedded_graphics::{
    Drawable, Pixel,
    draw_target::DrawTarget,
    geometry::{OriginDimensions, Point, Size},
    mono_font::{MonoTextStyle, ascii::FONT_9X15},
    pixelcolor::{Gray8, GrayColor},
    text::{Alignment, Text},
};
use image::{DynamicImage, Rgb, RgbImage, imageops};
use std::{convert::Infallible, error::Error};

/// Pixels between two pictures.
const GAP: u32 = 4;
/// Height of a line of text.
const LINE: u32 = 20;
/// Colour between pictures.
const PAPER: Rgb<u8> = Rgb([255; 3]);

/// The sheet as something that text can be drawn on.
struct Sheet(RgbImage);

impl OriginDimensions for Sheet {
    fn size(&self) -> Size {
        Size::new(self.0.width(), self.0.height())
    }
}

impl DrawTarget for Sheet {
    type Color = Gray8;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Gray8>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(at, color) in pixels {
            if let Some(pixel) = self.0.get_pixel_mut_checked(at.x as u32, at.y as u32) {
                *pixel = Rgb([color.luma(); 3]);
            }
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, columns, side, pictures @ ..] = &arguments[..] else {
        return Err("usage: contact_sheet OUT.png COLUMNS SIDE PICTURE.png[=TEXT]..".into());
    };
    let (columns, side) = (columns.parse::<u32>()?.max(1), side.parse::<u32>()?);
    let captioned = pictures.iter().any(|picture| picture.contains('='));
    let row = side + GAP + if captioned { LINE } else { 0 };
    let rows = (pictures.len() as u32).div_ceil(columns);
    let size = (columns * (side + GAP) - GAP, rows * row - GAP);
    let mut sheet = Sheet(RgbImage::from_pixel(size.0, size.1, PAPER));
    for (i, picture) in (0..).zip(pictures) {
        let (path, text) = picture.split_once('=').unwrap_or((picture, ""));
        let scaled = image::open(path)
            .map_err(|e| format!("{path}: {e}"))?
            .resize_to_fill(side, side, imageops::FilterType::Triangle)
            .into_rgb8();
        let (x, y) = (i % columns * (side + GAP), i / columns * row);
        imageops::replace(&mut sheet.0, &scaled, i64::from(x), i64::from(y));
        let style = MonoTextStyle::new(&FONT_9X15, Gray8::BLACK);
        let middle = Point::new((x + side / 2) as i32, (y + side + LINE - 6) as i32);
        let Ok(_) = Text::with_alignment(text, middle, style, Alignment::Center).draw(&mut sheet);
    }
    DynamicImage::from(sheet.0).save(out)?;
    Ok(())
}
