//! Values that vary over a surface.

use crate::rgb::Rgb;
use glam::{Affine2, Vec2};
use std::{
    ops::{Add, Mul},
    sync::Arc,
};

/// What a texture can hold: a colour or a number.
pub trait Texel: Copy + Add<Output = Self> + Mul<f32, Output = Self> {
    /// A vertex colour as such a value; for a number its luminance.
    fn from_color(color: Rgb) -> Self;
}

impl Texel for Rgb {
    #[inline]
    fn from_color(color: Rgb) -> Rgb {
        color
    }
}

impl Texel for f32 {
    #[inline]
    fn from_color(color: Rgb) -> f32 {
        color.luminance()
    }
}

/// An image of linear values; row 0 is the top (`v = 1`).
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap<T> {
    /// Width in texels, positive.
    pub width: u32,
    /// Height in texels, positive.
    pub height: u32,
    /// `width * height` texels, row by row.
    pub texels: Vec<T>,
}

/// How a bitmap is looked up between its texels' centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The nearest texel.
    Nearest,
    /// Bilinear between four texels.
    #[default]
    Bilinear,
}

/// What lies beyond a bitmap's border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The bitmap again.
    #[default]
    Repeat,
    /// The bitmap mirrored.
    Mirror,
    /// Its outermost texel.
    Clamp,
}

/// What a texture is looked up with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturePoint {
    /// Texture coordinates.
    pub uv: Vec2,
    /// Interpolated vertex colour; white on a shape that has none.
    pub color: Rgb,
}

/// A value as a function of the texture coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture<T> {
    /// The same everywhere.
    Constant(T),
    /// Two values in squares; one period of both spans the unit square after `to_uv`.
    Checkerboard {
        /// Value where the squares' parities agree.
        even: T,
        /// Value elsewhere.
        odd: T,
        /// From the surface's texture coordinates to the pattern's.
        to_uv: Affine2,
    },
    /// An image over the unit square.
    Bitmap {
        /// The image.
        bitmap: Arc<Bitmap<T>>,
        /// Between texels.
        interpolation: Interpolation,
        /// Beyond the unit square.
        wrap: Wrap,
        /// From the surface's texture coordinates to the image's.
        to_uv: Affine2,
    },
    /// The mesh's own vertex colours.
    VertexColor,
}

impl<T> From<T> for Texture<T> {
    fn from(value: T) -> Texture<T> {
        Texture::Constant(value)
    }
}

impl<T: Texel> Texture<T> {
    /// An image as it most often is: bilinear, repeated.
    pub fn bitmap(bitmap: Arc<Bitmap<T>>) -> Texture<T> {
        Texture::Bitmap { bitmap, interpolation: Interpolation::Bilinear, wrap: Wrap::Repeat, to_uv: Affine2::IDENTITY }
    }

    /// The value at a point.
    pub fn at(&self, point: &TexturePoint) -> T {
        match self {
            Texture::Constant(value) => *value,
            Texture::Checkerboard { even, odd, to_uv } => {
                let t = to_uv.transform_point2(point.uv);
                let first_half = |x: f32| x - x.floor() < 0.5;
                if first_half(t.x) == first_half(t.y) { *even } else { *odd }
            }
            Texture::Bitmap { bitmap, interpolation, wrap, to_uv } => {
                bitmap.at(to_uv.transform_point2(point.uv), *interpolation, *wrap)
            }
            Texture::VertexColor => T::from_color(point.color),
        }
    }

    /// Whether it is the same everywhere.
    pub fn is_constant(&self) -> bool {
        matches!(self, Texture::Constant(_))
    }

    /// Every value that it holds; none of a mesh's vertex colours.
    pub fn values(&self) -> Vec<T> {
        match self {
            Texture::Constant(value) => vec![*value],
            Texture::Checkerboard { even, odd, .. } => vec![*even, *odd],
            Texture::Bitmap { bitmap, .. } => bitmap.texels.clone(),
            Texture::VertexColor => Vec::new(),
        }
    }
}

impl<T: Texel> Bitmap<T> {
    /// The value at image coordinates: texel centres lie at half-integers over the size; v grows upwards, rows grow downwards.
    pub fn at(&self, uv: Vec2, interpolation: Interpolation, wrap: Wrap) -> T {
        let (width, height) = (self.width as f32, self.height as f32);
        // Folding first keeps the precision of coordinates far from the unit square.
        let (u, v) = (fold(uv.x, wrap), fold(1.0 - uv.y, wrap));
        match interpolation {
            Interpolation::Nearest => self.texel((u * width).floor() as i64, (v * height).floor() as i64, wrap),
            Interpolation::Bilinear => {
                let (x, y) = (u * width - 0.5, v * height - 0.5);
                let (x0, y0) = (x.floor(), y.floor());
                let (fx, fy) = (x - x0, y - y0);
                let (column, row) = (x0 as i64, y0 as i64);
                let texel = |dx: i64, dy: i64| self.texel(column + dx, row + dy, wrap);
                (texel(0, 0) * (1.0 - fx) + texel(1, 0) * fx) * (1.0 - fy)
                    + (texel(0, 1) * (1.0 - fx) + texel(1, 1) * fx) * fy
            }
        }
    }

    /// A texel, one that lies up to a whole image outside included.
    fn texel(&self, column: i64, row: i64, wrap: Wrap) -> T {
        let inside = |i: i64, size: u32| {
            let size = i64::from(size);
            match wrap {
                Wrap::Repeat => i.rem_euclid(size),
                Wrap::Clamp => i.clamp(0, size - 1),
                Wrap::Mirror => {
                    let i = i.rem_euclid(2 * size);
                    i.min(2 * size - 1 - i)
                }
            }
        };
        self.texels[inside(row, self.height) as usize * self.width as usize + inside(column, self.width) as usize]
    }
}

/// A coordinate brought near the unit interval: repeating into it, mirroring into the first two units, clamping to its ends.
fn fold(x: f32, wrap: Wrap) -> f32 {
    match wrap {
        Wrap::Repeat => x - x.floor(),
        Wrap::Mirror => x - 2.0 * (0.5 * x).floor(),
        Wrap::Clamp => x.clamp(0.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Bitmap<f32> {
        Bitmap { width: 2, height: 2, texels: vec![1.0, 2.0, 3.0, 4.0] }
    }

    #[test]
    fn the_top_row_is_where_v_is_one() {
        let at = |u, v| ramp().at(Vec2::new(u, v), Interpolation::Bilinear, Wrap::Repeat);
        assert_eq!([at(0.25, 0.75), at(0.75, 0.75), at(0.25, 0.25), at(0.75, 0.25)], [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(at(0.5, 0.75), 1.5);
        assert_eq!(at(0.25, 0.5), 2.0);
    }

    #[test]
    fn borders_repeat_mirror_or_clamp() {
        let row = |u: f32, wrap| ramp().at(Vec2::new(u, 0.75), Interpolation::Nearest, wrap);
        for (wrap, expected) in [
            (Wrap::Repeat, [1.0, 2.0, 1.0, 2.0, 1.0, 2.0]),
            (Wrap::Mirror, [2.0, 1.0, 1.0, 2.0, 2.0, 1.0]),
            (Wrap::Clamp, [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]),
        ] {
            let found = [-0.75, -0.25, 0.25, 0.75, 1.25, 1.75].map(|u| row(u, wrap));
            assert_eq!(found, expected, "{wrap:?}");
        }
        let border = |u: f32, wrap| ramp().at(Vec2::new(u, 0.75), Interpolation::Bilinear, wrap);
        assert_eq!([Wrap::Repeat, Wrap::Mirror, Wrap::Clamp].map(|w| border(0.0, w)), [1.5, 1.0, 1.0]);
        assert_eq!([Wrap::Repeat, Wrap::Mirror, Wrap::Clamp].map(|w| border(1.0, w)), [1.5, 2.0, 2.0]);
    }

    #[test]
    fn a_checkerboard_has_one_period_a_unit() {
        let board = Texture::Checkerboard { even: 1.0f32, odd: 0.0, to_uv: Affine2::from_scale(Vec2::splat(2.0)) };
        let at = |u, v| board.at(&TexturePoint { uv: Vec2::new(u, v), color: Rgb::WHITE });
        assert_eq!([at(0.1, 0.1), at(0.3, 0.1), at(0.3, 0.3), at(0.6, 0.1)], [1.0, 0.0, 1.0, 1.0]);
    }
}
