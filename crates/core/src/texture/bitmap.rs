//! Images and how they are looked up.

use super::Texel;
use crate::digest::Digest;
use glam::Vec2;
use std::fmt;

/// An image of linear values; row 0 is the top (`v = 1`).
///
/// Its `Debug` form has a digest of the texels, as there are millions of them.
#[derive(Clone, PartialEq)]
pub struct Bitmap<T> {
    /// Width in texels, positive.
    pub width: u32,
    /// Height in texels, positive.
    pub height: u32,
    /// `width * height` texels, row by row.
    pub texels: Vec<T>,
}

impl<T: Texel> fmt::Debug for Bitmap<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut digest = Digest::default();
        self.texels.iter().for_each(|t| t.digest(&mut digest));
        f.debug_struct("Bitmap")
            .field("width", &self.width)
            .field("height", &self.height)
            .field("texels", &digest)
            .finish()
    }
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

/// The texels of an image by their index, row by row, however they are kept.
pub(super) struct Texels<F> {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) get: F,
}

impl<T: Texel, F: Fn(usize) -> T> Texels<F> {
    /// The value at image coordinates: texel centres lie at half-integers over the size; v grows upwards, rows grow downwards.
    pub(super) fn at(&self, uv: Vec2, interpolation: Interpolation, wrap: Wrap) -> T {
        match interpolation {
            Interpolation::Nearest => {
                let (x, y) = self.place(uv, wrap);
                self.texel(x.floor() as i64, y.floor() as i64, wrap)
            }
            Interpolation::Bilinear => {
                let ([[t00, t10], [t01, t11]], f) = self.patch(uv, wrap);
                (t00 * (1.0 - f.x) + t10 * f.x) * (1.0 - f.y) + (t01 * (1.0 - f.x) + t11 * f.x) * f.y
            }
        }
    }

    /// Image coordinates in texels from the top left corner.
    fn place(&self, uv: Vec2, wrap: Wrap) -> (f32, f32) {
        // Folding first keeps the precision of coordinates far from the unit square.
        (fold(uv.x, wrap) * self.width as f32, fold(1.0 - uv.y, wrap) * self.height as f32)
    }

    /// The four texels, by row, around a point, and where it lies between them.
    pub(super) fn patch(&self, uv: Vec2, wrap: Wrap) -> ([[T; 2]; 2], Vec2) {
        let (x, y) = self.place(uv, wrap);
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (column, row) = (x0 as i64, y0 as i64);
        let texel = |dx: i64, dy: i64| self.texel(column + dx, row + dy, wrap);
        ([[texel(0, 0), texel(1, 0)], [texel(0, 1), texel(1, 1)]], Vec2::new(x - x0, y - y0))
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
        (self.get)(inside(row, self.height) as usize * self.width as usize + inside(column, self.width) as usize)
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

    #[test]
    fn any_coordinates_find_texels_of_the_image() {
        let (tiny, least) = (f32::MIN_POSITIVE, f32::from_bits(1));
        let places = [0.0, least, tiny, 1e-9, 0.3, 1.0_f32.next_down(), 1.0, 2.0_f32.next_down(), 2.0, 1e9, f32::MAX];
        let places: Vec<f32> = places.iter().flat_map(|&x| [x, -x]).chain([f32::NAN, f32::INFINITY]).collect();
        for (width, height) in [(1, 1), (2, 1), (1, 3), (7, 5), (4096, 2)] {
            let get = |i: usize| {
                assert!(i < (width * height) as usize, "{i} of {width} x {height}");
                1.0_f32
            };
            let texels = Texels { width, height, get };
            for (&u, &v) in places.iter().flat_map(|u| places.iter().map(move |v| (u, v))) {
                for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                    assert_eq!(texels.at(Vec2::new(u, v), Interpolation::Nearest, wrap), 1.0);
                    let between = texels.at(Vec2::new(u, v), Interpolation::Bilinear, wrap);
                    assert!((between - 1.0).abs() < 1e-6 || !(u.is_finite() && v.is_finite()), "{u} {v} {between}");
                }
            }
        }
    }
}
