//! Images in files: OpenEXR, Radiance HDR, PNG, JPEG, BMP and TGA.
//!
//! Whatever a header claims, an image is refused before memory is taken if it has more than [`MOST_TEXELS`] or more than so
//! small a file could hold.

mod exr;

pub use exr::read_exr;

use crate::error::{Flaw, LoadError, Place, read_file};
use etendue_core::{
    rgb::Rgb,
    texture::{Bitmap, CodedBitmap, Raster},
};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::{io::Cursor, path::Path, sync::Arc};

/// The largest file that is read.
pub const LARGEST_FILE: u64 = 1 << 30;

/// The most texels of an image: 8192 x 8192.
pub const MOST_TEXELS: u64 = 1 << 26;

/// The most texels a byte of a file may stand for. Deflation packs no more than 1032 bytes into one, JPEG has a bit for a block of
/// 64 texels at the least, and the other methods come near that for blank images alone.
const TEXELS_PER_BYTE: u64 = 1032;

/// An image of radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The image; all its values are finite and not negative.
    pub bitmap: Bitmap<Rgb>,
    /// How many texels were negative, infinite or not numbers, and are black now.
    pub zeroed: usize,
}

impl Image {
    fn of(mut bitmap: Bitmap<Rgb>) -> Image {
        let mut zeroed = 0;
        for texel in bitmap.texels.iter_mut().filter(|t| !t.is_valid()) {
            *texel = Rgb::BLACK;
            zeroed += 1;
        }
        Image { bitmap, zeroed }
    }
}

/// What the whole numbers of a file stand for; numbers with a point are linear in any case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coding {
    /// sRGB [IEC 61966-2-1].
    Srgb,
    /// The values themselves, the largest as 1.
    Linear,
    /// The values, the largest as 1, to this power.
    Gamma(f32),
}

/// Reads an image of radiance; whole numbers in it are sRGB.
///
/// # Errors
///
/// A file that cannot be read or is no image of a supported kind.
pub fn read(path: &Path) -> Result<Image, LoadError> {
    let image = decode(&read_file(path, LARGEST_FILE)?, path, Coding::Srgb).map_err(|flaw| flaw.of(path))?;
    Ok(Image::of(Arc::unwrap_or_clone(image.bitmap())))
}

/// Decodes an image by what its first bytes, or if they do not say it the end of its name, say of its format. Transparency is
/// left out, and grey is given to each component.
///
/// # Errors
///
/// Anything that is wrong, an image of more than [`MOST_TEXELS`], or one that is too large to be in so small a file.
pub fn decode(bytes: &[u8], name: &Path, coding: Coding) -> Result<Raster<Rgb>, Flaw> {
    // Some programs begin Radiance files with the name of their texels.
    if let Some(rest) = bytes.strip_prefix(b"#?RGBE") {
        let renamed = [b"#?RADIANCE", rest].concat();
        return whole_numbers(&renamed, ImageFormat::Hdr, coding);
    }
    match format(bytes, name) {
        Some(ImageFormat::OpenExr) => Ok(Arc::new(exr::decode(bytes)?).into()),
        Some(format) if format.reading_enabled() => whole_numbers(bytes, format, coding),
        _ => Err(whole("images are read from .exr, .hdr, .png, .jpg, .bmp and .tga files")),
    }
}

/// The format, by the first bytes, or if they do not say it by the end of the name.
fn format(bytes: &[u8], name: &Path) -> Option<ImageFormat> {
    image::guess_format(bytes).or_else(|_| ImageFormat::from_path(name)).ok()
}

fn whole(message: impl Into<String>) -> Flaw {
    Flaw::new(Place::Whole, message)
}

/// Refuses what is too large.
fn check_size(width: u64, height: u64, bytes: usize) -> Result<(), Flaw> {
    let texels = width.saturating_mul(height);
    if texels == 0 {
        return Err(whole("the image is empty"));
    }
    if texels > MOST_TEXELS {
        return Err(whole(format!("the header claims {width} x {height} texels; {MOST_TEXELS} is the most")));
    }
    if texels > TEXELS_PER_BYTE * bytes as u64 {
        return Err(whole(format!("the header claims {width} x {height} texels, too many for {bytes} bytes")));
    }
    Ok(())
}

fn whole_numbers(bytes: &[u8], format: ImageFormat, coding: Coding) -> Result<Raster<Rgb>, Flaw> {
    let unreadable = |e: image::ImageError| whole(format!("not a readable image: {e}"));
    let reader = ImageReader::with_format(Cursor::new(bytes), format);
    let decoder = reader.into_decoder().map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    check_size(u64::from(width), u64::from(height), bytes.len())?;
    let image = DynamicImage::from_decoder(decoder).map_err(unreadable)?;
    if image.color().bytes_per_pixel() == image.color().channel_count() {
        let coded = CodedBitmap::new(width, height, image.into_rgb8().into_raw(), coding.eight_bits());
        return coded.map(|c| Arc::new(c).into()).ok_or_else(|| whole("the image has not the size that it claims"));
    }
    let sixteen = |v: u16| coding.linear(f32::from(v) / f32::from(u16::MAX));
    let texels = match &image {
        DynamicImage::ImageLuma16(i) => i.pixels().map(|p| Rgb::splat(sixteen(p[0]))).collect(),
        DynamicImage::ImageLumaA16(i) => i.pixels().map(|p| Rgb::splat(sixteen(p[0]))).collect(),
        DynamicImage::ImageRgb16(i) => i.pixels().map(|p| Rgb::from(p.0.map(sixteen))).collect(),
        DynamicImage::ImageRgba16(i) => i.pixels().map(|p| Rgb::from([0, 1, 2].map(|c| sixteen(p[c])))).collect(),
        DynamicImage::ImageRgb32F(i) => i.pixels().map(|p| Rgb::from(p.0)).collect(),
        other => return Err(whole(format!("images of the kind {:?} are not read", other.color()))),
    };
    Ok(Arc::new(Bitmap { width, height, texels }).into())
}

/// A component of sRGB, from 0 to 1, as linear light [IEC 61966-2-1].
pub(crate) fn from_srgb(v: f32) -> f32 {
    let v = f64::from(v);
    (if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }) as f32
}

impl Coding {
    fn linear(self, v: f32) -> f32 {
        match self {
            Coding::Srgb => from_srgb(v),
            Coding::Linear => v,
            Coding::Gamma(gamma) => v.powf(gamma),
        }
    }

    /// What each number of eight bits stands for.
    fn eight_bits(self) -> [f32; 256] {
        std::array::from_fn(|i| self.linear(i as f32 / 255.0))
    }
}
