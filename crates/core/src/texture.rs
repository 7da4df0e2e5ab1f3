//! Colours that vary over a surface.

use crate::rgb::Rgb;
use glam::Vec2;
use std::sync::Arc;

/// A linear RGB image; row 0 is the top (`v = 1`).
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    /// Width in texels, positive.
    pub width: u32,
    /// Height in texels, positive.
    pub height: u32,
    /// `width * height` texels, row by row.
    pub texels: Vec<Rgb>,
}

/// A colour as a function of the texture coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb),
    /// Two colours in squares; one period of both spans `1 / scale` in each coordinate.
    Checkerboard {
        /// Colour where the squares' parities agree.
        even: Rgb,
        /// Colour elsewhere.
        odd: Rgb,
        /// Periods per unit.
        scale: Vec2,
    },
    /// An image, bilinearly interpolated, repeated.
    Bitmap(Arc<Bitmap>),
}

impl From<Rgb> for Texture {
    fn from(c: Rgb) -> Texture {
        Texture::Constant(c)
    }
}

impl Texture {
    /// The colour at texture coordinates `uv`.
    pub fn at(&self, uv: Vec2) -> Rgb {
        match self {
            Texture::Constant(c) => *c,
            Texture::Checkerboard { even, odd, scale } => {
                let t = uv * *scale;
                let first_half = |x: f32| x - x.floor() < 0.5;
                if first_half(t.x) == first_half(t.y) { *even } else { *odd }
            }
            Texture::Bitmap(bitmap) => bitmap.bilinear(uv),
        }
    }

    /// Every colour that it holds.
    pub fn colours(&self) -> Vec<Rgb> {
        match self {
            Texture::Constant(c) => vec![*c],
            Texture::Checkerboard { even, odd, .. } => vec![*even, *odd],
            Texture::Bitmap(bitmap) => bitmap.texels.clone(),
        }
    }
}

impl Bitmap {
    fn bilinear(&self, uv: Vec2) -> Rgb {
        // Texel centres lie at half-integers; v grows upwards, rows grow downwards.
        let x = (uv.x - uv.x.floor()) * self.width as f32 - 0.5;
        let y = (1.0 - (uv.y - uv.y.floor())) * self.height as f32 - 0.5;
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let texel = |dx: i64, dy: i64| {
            let column = (x0 as i64 + dx).rem_euclid(i64::from(self.width)) as usize;
            let row = (y0 as i64 + dy).rem_euclid(i64::from(self.height)) as usize;
            self.texels[row * self.width as usize + column]
        };
        (texel(0, 0) * (1.0 - fx) + texel(1, 0) * fx) * (1.0 - fy) + (texel(0, 1) * (1.0 - fx) + texel(1, 1) * fx) * fy
    }
}
