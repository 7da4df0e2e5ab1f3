//! Images, decoded from PNG or JPEG.

use super::flaw;
use crate::{
    error::Flaw,
    image_file::{MOST_TEXELS, from_srgb},
};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::io::Cursor;

/// The most texels a byte of a file may stand for: a PNG has eight in a byte, of which deflation packs no more than 1032 into
/// one, and a JPEG of one colour needs no more bytes.
const TEXELS_PER_BYTE: u64 = 8 * 1032;

/// A decoded image.
pub(super) struct Decoded {
    pub(super) width: u32,
    pub(super) height: u32,
    texels: Texels,
}

enum Texels {
    Eight(Vec<u8>),
    Sixteen(Vec<u16>),
}

impl Decoded {
    /// Decodes an image by what its first bytes say of its format; its size is looked at before memory is taken.
    pub(super) fn of(bytes: &[u8]) -> Result<Decoded, String> {
        let format = match image::guess_format(bytes) {
            Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
            _ => return Err("it is neither a PNG nor a JPEG".to_owned()),
        };
        let unreadable = |e: image::ImageError| format!("not a readable image: {e}");
        let decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder().map_err(unreadable)?;
        let (width, height) = decoder.dimensions();
        let texels = u64::from(width) * u64::from(height);
        if texels == 0 {
            return Err("the image is empty".to_owned());
        }
        if texels > MOST_TEXELS {
            return Err(format!("the header claims {width} x {height} texels; {MOST_TEXELS} is the most"));
        }
        if texels > TEXELS_PER_BYTE * bytes.len() as u64 {
            return Err(format!("the header claims {width} x {height} texels, too many for {} bytes", bytes.len()));
        }
        let image = DynamicImage::from_decoder(decoder).map_err(unreadable)?;
        let texels = match image.color().bytes_per_pixel() / image.color().channel_count() {
            1 => Texels::Eight(image.into_rgba8().into_raw()),
            _ => Texels::Sixteen(image.into_rgba16().into_raw()),
        };
        Ok(Decoded { width, height, texels })
    }

    /// Each texel with its components from 0 to 1.
    pub(super) fn texels(&self) -> Box<dyn Iterator<Item = [f32; 4]> + '_> {
        fn scaled<T: Copy + Into<f32>>(texel: &[T; 4], most: f32) -> [f32; 4] {
            texel.map(|c| c.into() / most)
        }
        match &self.texels {
            Texels::Eight(all) => Box::new(all.as_chunks().0.iter().map(|t| scaled(t, 255.0))),
            Texels::Sixteen(all) => Box::new(all.as_chunks().0.iter().map(|t| scaled(t, 65535.0))),
        }
    }

    /// The colour of each texel, taken from sRGB to linear light.
    pub(super) fn colours(&self) -> Box<dyn Iterator<Item = [f32; 3]> + '_> {
        match &self.texels {
            Texels::Eight(all) => {
                let table: [f32; 256] = std::array::from_fn(|i| from_srgb(i as f32 / 255.0));
                Box::new(all.as_chunks().0.iter().map(move |[r, g, b, _]| [r, g, b].map(|c| table[usize::from(*c)])))
            }
            Texels::Sixteen(_) => Box::new(self.texels().map(|[r, g, b, _]| [r, g, b].map(from_srgb))),
        }
    }
}

/// A message about an image of the file's list.
pub(super) fn flaw_of(index: usize, message: &str) -> Flaw {
    flaw(format!("images[{index}]: {message}"))
}
