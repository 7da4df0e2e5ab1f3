//! Values that vary over a surface.

mod bitmap;
mod raster;

pub use bitmap::{Bitmap, Interpolation, Wrap};
pub use raster::{CodedBitmap, Raster};

use crate::{digest::Digest, rgb::Rgb};
use glam::{Affine2, Vec2};
use std::{
    fmt,
    ops::{Add, Mul},
};

/// What a texture can hold: a colour or a number.
pub trait Texel: Copy + fmt::Debug + Send + Sync + Add<Output = Self> + Mul<f32, Output = Self> {
    /// How many numbers it is made of.
    const COMPONENTS: usize;
    /// From these numbers.
    fn from_components(components: impl Fn(usize) -> f32) -> Self;
    /// Each of these numbers changed.
    fn map(self, f: impl Fn(f32) -> f32) -> Self;
    /// A vertex colour as such a value; for a number its luminance.
    fn from_color(color: Rgb) -> Self;
    /// Whether each component is from `least` to `most`; what is no number is not.
    fn is_within(self, least: f32, most: f32) -> bool;
    /// Adds its bits to a digest.
    fn digest(self, digest: &mut Digest);
}

impl Texel for Rgb {
    const COMPONENTS: usize = 3;

    #[inline]
    fn from_components(components: impl Fn(usize) -> f32) -> Rgb {
        Rgb::new(components(0), components(1), components(2))
    }

    #[inline]
    fn map(self, f: impl Fn(f32) -> f32) -> Rgb {
        Rgb::new(f(self.r), f(self.g), f(self.b))
    }

    #[inline]
    fn from_color(color: Rgb) -> Rgb {
        color
    }

    #[inline]
    fn is_within(self, least: f32, most: f32) -> bool {
        // Without branches, so that many are checked at once.
        self.r.is_within(least, most) & self.g.is_within(least, most) & self.b.is_within(least, most)
    }

    fn digest(self, digest: &mut Digest) {
        self.to_array().into_iter().for_each(|v| digest.add(v.to_bits()));
    }
}

impl Texel for f32 {
    const COMPONENTS: usize = 1;

    #[inline]
    fn from_components(components: impl Fn(usize) -> f32) -> f32 {
        components(0)
    }

    #[inline]
    fn map(self, f: impl Fn(f32) -> f32) -> f32 {
        f(self)
    }

    #[inline]
    fn from_color(color: Rgb) -> f32 {
        color.luminance()
    }

    #[inline]
    fn is_within(self, least: f32, most: f32) -> bool {
        (self >= least) & (self <= most)
    }

    fn digest(self, digest: &mut Digest) {
        digest.add(self.to_bits());
    }
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
pub enum Texture<T: Texel> {
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
        bitmap: Raster<T>,
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

impl<T: Texel> From<T> for Texture<T> {
    fn from(value: T) -> Texture<T> {
        Texture::Constant(value)
    }
}

impl<T: Texel> Texture<T> {
    /// An image as it most often is: bilinear, repeated.
    pub fn bitmap(bitmap: impl Into<Raster<T>>) -> Texture<T> {
        let bitmap = bitmap.into();
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
            Texture::Bitmap { bitmap, .. } => bitmap.values(),
            Texture::VertexColor => Vec::new(),
        }
    }
}

impl Texture<f32> {
    /// Derivatives of the value by the surface's texture coordinates.
    ///
    /// Of a bilinear image those of the bilinear patch, which jump at texel centres. Zero where the value is piecewise
    /// constant; vertex colours, whose derivative is not known at a point, count as that.
    pub fn gradient(&self, point: &TexturePoint) -> Vec2 {
        match self {
            Texture::Bitmap { bitmap, interpolation: Interpolation::Bilinear, wrap, to_uv } => {
                let by_image = bitmap.gradient(to_uv.transform_point2(point.uv), *wrap);
                // The chain rule: the gradient goes by the transpose.
                to_uv.matrix2.transpose() * by_image
            }
            _ => Vec2::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn ramp() -> Raster<f32> {
        Arc::new(Bitmap { width: 2, height: 2, texels: vec![1.0, 2.0, 3.0, 4.0] }).into()
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
    fn gradients_are_the_slope_of_the_image() {
        let mut texels = Vec::new();
        for i in 0..20u32 {
            texels.push((i.wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 24) as f32);
        }
        let bitmap = Raster::from(Arc::new(Bitmap { width: 5, height: 4, texels }));
        let to_uv = Affine2::from_scale_angle_translation(Vec2::new(1.5, 0.7), 0.4, Vec2::new(0.2, -0.3));
        let step = 1e-3;
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let texture =
                Texture::Bitmap { bitmap: bitmap.clone(), interpolation: Interpolation::Bilinear, wrap, to_uv };
            let point = |uv| TexturePoint { uv, color: Rgb::WHITE };
            let mut checked = 0;
            for i in 0..400 {
                let uv = Vec2::new((i % 20) as f32, (i / 20) as f32) * 0.137 - 1.1;
                let slope = |along: Vec2| {
                    (texture.at(&point(uv + along * step)) - texture.at(&point(uv - along * step))) / (2.0 * step)
                };
                let ahead = |along: Vec2| (texture.at(&point(uv + along * step)) - texture.at(&point(uv))) / step;
                let expected = Vec2::new(slope(Vec2::X), slope(Vec2::Y));
                // A patch has a slope of its own: points near a seam between two are left out.
                if (ahead(Vec2::X) - expected.x).abs() + (ahead(Vec2::Y) - expected.y).abs() < 2e-2 {
                    let found = texture.gradient(&point(uv));
                    assert!((found - expected).length() < 2e-2, "{wrap:?} {uv}: {found} instead of {expected}");
                    checked += 1;
                }
            }
            assert!(checked > 300, "{checked}");
        }
    }

    #[test]
    fn what_is_constant_by_pieces_has_no_slope() {
        let bitmap = ramp();
        let nearest = Texture::Bitmap {
            bitmap,
            interpolation: Interpolation::Nearest,
            wrap: Wrap::Repeat,
            to_uv: Affine2::IDENTITY,
        };
        let point = TexturePoint { uv: Vec2::new(0.3, 0.4), color: Rgb::WHITE };
        assert_eq!(nearest.gradient(&point), Vec2::ZERO);
        assert_eq!(Texture::Constant(2.0).gradient(&point), Vec2::ZERO);
    }

    #[test]
    fn a_checkerboard_has_one_period_a_unit() {
        let board = Texture::Checkerboard { even: 1.0f32, odd: 0.0, to_uv: Affine2::from_scale(Vec2::splat(2.0)) };
        let at = |u, v| board.at(&TexturePoint { uv: Vec2::new(u, v), color: Rgb::WHITE });
        assert_eq!([at(0.1, 0.1), at(0.3, 0.1), at(0.3, 0.3), at(0.6, 0.1)], [1.0, 0.0, 1.0, 1.0]);
    }
}
