//! Images in OpenEXR files.

use crate::error::{Flaw, LoadError, Place, read_file};
use etendue_core::{rgb::Rgb, texture::Bitmap};
use exr::prelude::{ReadChannels, ReadLayers};
use std::{io::Cursor, path::Path};

/// The largest file that is read.
pub const LARGEST_FILE: u64 = 1 << 30;

/// The most texels of an image: 8192 x 8192.
pub const MOST_TEXELS: u64 = 1 << 26;

/// The most texels a byte of a file may stand for. Deflation packs no more than 1032 bytes into one, and a texel has six; the
/// other methods come near that for blank images alone.
const TEXELS_PER_BYTE: u64 = 1032;

/// An image of radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The image; all its values are finite and not negative.
    pub bitmap: Bitmap<Rgb>,
    /// How many texels were negative, infinite or not numbers, and are black now.
    pub zeroed: usize,
}

/// Reads the file of an image.
///
/// # Errors
///
/// A file that cannot be read or is no OpenEXR image with channels R, G and B.
pub fn read(path: &Path) -> Result<Image, LoadError> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        return Err(Flaw::new(Place::Whole, "images are read from .exr files only").of(path));
    }
    read_exr(&read_file(path, LARGEST_FILE)?).map_err(|flaw| flaw.of(path))
}

/// Reads the channels R, G and B of an OpenEXR image's first layer that has them, in 16 or 32 bits.
///
/// # Errors
///
/// Anything that is wrong, an image of more than [`MOST_TEXELS`], or one that is too large to be in so small a file.
pub fn read_exr(bytes: &[u8]) -> Result<Image, Flaw> {
    let flaw = |message: String| Flaw::new(Place::Whole, message);
    let unreadable = |e: exr::error::Error| flaw(format!("not a readable OpenEXR image: {e}"));
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(unreadable)?;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        let texels = width.saturating_mul(height);
        if texels == 0 {
            return Err(flaw("the image is empty".to_owned()));
        }
        if texels > MOST_TEXELS {
            return Err(flaw(format!("the header claims {width} x {height} texels; {MOST_TEXELS} is the most")));
        }
        if texels > TEXELS_PER_BYTE * bytes.len() as u64 {
            let message = format!("the header claims {width} x {height} texels, too many for {} bytes", bytes.len());
            return Err(flaw(message));
        }
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Bitmap {
                width: size.width() as u32,
                height: size.height() as u32,
                texels: vec![Rgb::BLACK; size.area()],
            },
            |bitmap, at, (r, g, b): (f32, f32, f32)| {
                let index = at.y() * bitmap.width as usize + at.x();
                bitmap.texels[index] = Rgb::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(unreadable)?;
    let mut bitmap = image.layer_data.channel_data.pixels;
    let mut zeroed = 0;
    for texel in bitmap.texels.iter_mut().filter(|t| !t.is_valid()) {
        *texel = Rgb::BLACK;
        zeroed += 1;
    }
    Ok(Image { bitmap, zeroed })
}
