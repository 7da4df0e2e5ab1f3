//! An image in memory, and how it is shown: tone-mapped, in sRGB, as PNG.

use etendue_core::rgb::Rgb;
use glam::UVec2;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

/// Linear radiance, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height.
    pub size: UVec2,
    /// `size.x * size.y` pixels.
    pub pixels: Vec<Rgb>,
}

/// Share of the pixels that may be brighter than what is shown as nearly white.
const BRIGHT_SHARE: f64 = 0.05;
/// What those pixels' limit is shown as.
const NEARLY_WHITE: f32 = 0.9;
/// Where the curve leaves the straight line.
const KNEE: f32 = 0.8;

impl Picture {
    /// The factor that brings 95 % of the pixels below a display value of 0.9; 1 for a black picture.
    pub fn exposure(&self) -> f32 {
        let mut luminance: Vec<f32> = self.pixels.iter().map(|p| p.luminance()).filter(|l| l.is_finite()).collect();
        if luminance.is_empty() {
            return 1.0;
        }
        let rank = ((luminance.len() - 1) as f64 * (1.0 - BRIGHT_SHARE)).round() as usize;
        let (_, limit, _) = luminance.select_nth_unstable_by(rank, f32::total_cmp);
        let exposure = NEARLY_WHITE / *limit;
        if exposure.is_finite() && exposure > 0.0 { exposure } else { 1.0 }
    }

    /// As a PNG file, with a given exposure.
    pub fn png(&self, exposure: f32) -> Vec<u8> {
        let bytes = self.pixels.iter().flat_map(|p| (*p * exposure).to_array().map(display)).collect::<Vec<u8>>();
        encode_png(self.size, &bytes)
    }
}

/// RGB bytes as a PNG file.
pub fn encode_png(size: UVec2, rgb: &[u8]) -> Vec<u8> {
    let mut png = Vec::new();
    let written = PngEncoder::new(&mut png).write_image(rgb, size.x, size.y, ExtendedColorType::Rgb8);
    written.expect("memory takes what is written, and there are as many bytes as the size says");
    png
}

/// A linear value as a byte of sRGB: straight up to the knee, then bending towards white, with no corner.
fn display(linear: f32) -> u8 {
    let bent = if linear <= KNEE { linear } else { 1.0 - (1.0 - KNEE) * (-(linear - KNEE) / (1.0 - KNEE)).exp() };
    // The sRGB transfer function [IEC 61966-2-1:1999, eq. 9]; what is not a number becomes black by the cast.
    let coded = if bent <= 0.003_130_8 { 12.92 * bent } else { 1.055 * bent.powf(1.0 / 2.4) - 0.055 };
    (coded * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_values() {
        let values = [(-1.0, 0), (0.0, 0), (0.214_041_14, 128), (KNEE, 231), (1e9, 255), (f32::NAN, 0)];
        for (linear, byte) in values {
            assert_eq!(display(linear), byte, "{linear}");
        }
        assert!((0..2000).map(|i| display(i as f32 * 1e-3)).is_sorted());
    }

    #[test]
    fn exposure_ignores_fireflies_and_black() {
        let mut picture = Picture { size: UVec2::new(10, 10), pixels: vec![Rgb::splat(0.25); 100] };
        picture.pixels[7] = Rgb::splat(1e6);
        picture.pixels[8] = Rgb::splat(f32::NAN);
        assert!((picture.exposure() - 3.6).abs() < 1e-4);
        assert_eq!(Picture { size: UVec2::ONE, pixels: vec![Rgb::BLACK] }.exposure(), 1.0);
    }

    #[test]
    fn png_is_read_back() {
        let picture = Picture { size: UVec2::new(2, 1), pixels: vec![Rgb::BLACK, Rgb::splat(0.214_041_14)] };
        let image = image::load_from_memory(&picture.png(1.0)).unwrap().into_rgb8();
        assert_eq!(image.as_raw(), &[0, 0, 0, 128, 128, 128]);
    }
}
