//! The two ways in which a texture keeps an image.

use super::{Bitmap, Interpolation, Texel, Wrap, bitmap::Texels};
use crate::{digest::Digest, parallel};
use glam::Vec2;
use std::{fmt, marker::PhantomData, sync::Arc};

/// An image of which each component is a byte that stands for a value, as in most files: a quarter of a [`Bitmap`].
#[derive(Clone, PartialEq)]
pub struct CodedBitmap<T> {
    width: u32,
    height: u32,
    /// [`Texel::COMPONENTS`] for each texel.
    bytes: Vec<u8>,
    values: Box<[f32; 256]>,
    kind: PhantomData<T>,
}

/// An image as a texture keeps it.
#[derive(Clone, PartialEq)]
pub enum Raster<T> {
    /// Texel by texel.
    Values(Arc<Bitmap<T>>),
    /// By bytes that stand for values.
    Coded(Arc<CodedBitmap<T>>),
}

impl<T: Texel> CodedBitmap<T> {
    /// An image from the bytes of its texels' components, row by row from the top, and what each byte stands for.
    ///
    /// `None` if there are not [`Texel::COMPONENTS`] bytes for each of `width * height` texels.
    pub fn new(width: u32, height: u32, bytes: Vec<u8>, values: [f32; 256]) -> Option<CodedBitmap<T>> {
        let expected = (width as usize).checked_mul(height as usize)?.checked_mul(T::COMPONENTS)?;
        let coded = CodedBitmap { width, height, bytes, values: Box::new(values), kind: PhantomData };
        (coded.bytes.len() == expected).then_some(coded)
    }

    /// The bytes of the texels' components.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// What each byte stands for.
    pub fn values(&self) -> &[f32; 256] {
        &self.values
    }

    #[inline]
    fn get(&self, index: usize) -> T {
        let bytes = &self.bytes[index * T::COMPONENTS..][..T::COMPONENTS];
        T::from_components(|i| self.values[usize::from(bytes[i])])
    }
}

impl<T: Texel> fmt::Debug for CodedBitmap<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (words, rest) = self.bytes.as_chunks();
        let words = words.iter().map(|w| u32::from_le_bytes(*w)).chain(rest.iter().map(|b| u32::from(*b)));
        let bytes: Digest = words.collect();
        let values: Digest = self.values.iter().map(|v| v.to_bits()).collect();
        f.debug_struct("CodedBitmap")
            .field("width", &self.width)
            .field("height", &self.height)
            .field("bytes", &bytes)
            .field("values", &values)
            .finish()
    }
}

impl<T> From<Arc<Bitmap<T>>> for Raster<T> {
    fn from(bitmap: Arc<Bitmap<T>>) -> Raster<T> {
        Raster::Values(bitmap)
    }
}

impl<T> From<Arc<CodedBitmap<T>>> for Raster<T> {
    fn from(bitmap: Arc<CodedBitmap<T>>) -> Raster<T> {
        Raster::Coded(bitmap)
    }
}

/// What is printed is the image, whichever way it is kept.
impl<T: Texel> fmt::Debug for Raster<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Raster::Values(bitmap) => bitmap.fmt(f),
            Raster::Coded(bitmap) => bitmap.fmt(f),
        }
    }
}

impl<T: Texel> Raster<T> {
    /// Width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Raster::Values(bitmap) => [bitmap.width, bitmap.height],
            Raster::Coded(bitmap) => [bitmap.width, bitmap.height],
        }
    }

    /// Where it lies, the same for all clones.
    pub(crate) fn address(&self) -> usize {
        match self {
            Raster::Values(bitmap) => Arc::as_ptr(bitmap) as usize,
            Raster::Coded(bitmap) => Arc::as_ptr(bitmap) as usize,
        }
    }

    /// How many texels there are.
    #[allow(clippy::len_without_is_empty, reason = "none is empty in a scene")]
    pub fn len(&self) -> usize {
        match self {
            Raster::Values(bitmap) => bitmap.texels.len(),
            Raster::Coded(bitmap) => bitmap.bytes.len() / T::COMPONENTS,
        }
    }

    /// The memory that its texels take.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Raster::Values(bitmap) => size_of_val(&bitmap.texels[..]),
            Raster::Coded(bitmap) => bitmap.bytes.len() + size_of_val(&*bitmap.values),
        }
    }

    /// Its texels, row by row.
    pub fn values(&self) -> Vec<T> {
        match self {
            Raster::Values(bitmap) => bitmap.texels.clone(),
            Raster::Coded(bitmap) => (0..self.len()).map(|i| bitmap.get(i)).collect(),
        }
    }

    /// The image texel by texel.
    pub fn bitmap(&self) -> Arc<Bitmap<T>> {
        let [width, height] = self.size();
        match self {
            Raster::Values(bitmap) => bitmap.clone(),
            Raster::Coded(_) => Arc::new(Bitmap { width, height, texels: self.values() }),
        }
    }

    /// The image with each component of its texels changed.
    pub fn map(&self, f: impl Fn(f32) -> f32) -> Raster<T> {
        match self {
            Raster::Values(bitmap) => {
                let texels = bitmap.texels.iter().map(|t| t.map(&f)).collect();
                Arc::new(Bitmap { texels, ..**bitmap }).into()
            }
            Raster::Coded(bitmap) => {
                Arc::new(CodedBitmap { values: Box::new(bitmap.values.map(f)), ..(**bitmap).clone() }).into()
            }
        }
    }

    /// Whether each component of each texel is from `least` to `most`; every value that a byte could stand for counts.
    pub fn is_within(&self, least: f32, most: f32) -> bool {
        match self {
            Raster::Values(bitmap) => parallel::all(&bitmap.texels, |value| value.is_within(least, most)),
            Raster::Coded(bitmap) => bitmap.values.iter().all(|value| value.is_within(least, most)),
        }
    }

    /// The value at image coordinates, of which the unit square is the image; v grows upwards.
    pub fn at(&self, uv: Vec2, interpolation: Interpolation, wrap: Wrap) -> T {
        let [width, height] = self.size();
        match self {
            Raster::Values(bitmap) => Texels { width, height, get: |i| bitmap.texels[i] }.at(uv, interpolation, wrap),
            Raster::Coded(bitmap) => Texels { width, height, get: |i| bitmap.get(i) }.at(uv, interpolation, wrap),
        }
    }
}

impl Raster<f32> {
    /// Derivatives of the bilinear interpolation by the image coordinates of [`Raster::at`].
    pub(super) fn gradient(&self, uv: Vec2, wrap: Wrap) -> Vec2 {
        let [width, height] = self.size();
        let ([[t00, t10], [t01, t11]], f) = match self {
            Raster::Values(bitmap) => Texels { width, height, get: |i| bitmap.texels[i] }.patch(uv, wrap),
            Raster::Coded(bitmap) => Texels { width, height, get: |i| bitmap.get(i) }.patch(uv, wrap),
        };
        let across = (t10 - t00) * (1.0 - f.y) + (t11 - t01) * f.y;
        let down = (t01 - t00) * (1.0 - f.x) + (t11 - t10) * f.x;
        // Rows grow downwards, v upwards.
        Vec2::new(across * width as f32, -down * height as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgb::Rgb;

    /// An image by bytes, and the same texel by texel.
    fn pair<T: Texel>(width: u32, height: u32) -> [Raster<T>; 2] {
        let values: [f32; 256] = std::array::from_fn(|i| (i as f32 / 255.0).powi(2));
        let count = (width * height) as usize * T::COMPONENTS;
        let bytes: Vec<u8> = (0..count as u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        let texels = bytes.chunks(T::COMPONENTS).map(|b| T::from_components(|i| values[usize::from(b[i])])).collect();
        let coded = CodedBitmap::new(width, height, bytes, values).unwrap();
        [Arc::new(coded).into(), Arc::new(Bitmap { width, height, texels }).into()]
    }

    fn same_everywhere<T: Texel + PartialEq>() {
        let [coded, plain] = pair::<T>(7, 5);
        assert_eq!((coded.values(), coded.size(), coded.len()), (plain.values(), plain.size(), plain.len()));
        assert!(coded.bytes() < plain.bytes() + 1024);
        for i in 0..400 {
            let uv = Vec2::new((i % 20) as f32, (i / 20) as f32) * 0.137 - 1.1;
            for interpolation in [Interpolation::Nearest, Interpolation::Bilinear] {
                for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                    assert_eq!(coded.at(uv, interpolation, wrap), plain.at(uv, interpolation, wrap), "{uv}");
                }
            }
        }
    }

    #[test]
    fn both_ways_show_the_same() {
        same_everywhere::<Rgb>();
        same_everywhere::<f32>();
        let [coded, plain] = pair::<f32>(7, 5);
        let uv = Vec2::new(0.3, 0.6);
        assert_eq!(coded.gradient(uv, Wrap::Repeat), plain.gradient(uv, Wrap::Repeat));
    }

    #[test]
    fn bytes_that_make_no_image_are_refused() {
        let values = [0.0; 256];
        assert!(CodedBitmap::<Rgb>::new(2, 2, vec![0; 12], values).is_some());
        for (width, height, bytes) in [(2, 2, 11), (2, 2, 4), (u32::MAX, u32::MAX, 0)] {
            assert!(CodedBitmap::<Rgb>::new(width, height, vec![0; bytes], values).is_none());
        }
        assert!(CodedBitmap::<f32>::new(2, 2, vec![0; 4], values).is_some());
    }

    #[test]
    fn what_is_printed_tells_images_apart() {
        let [coded, plain] = pair::<Rgb>(3, 2);
        let Raster::Coded(bitmap) = &coded else { unreachable!() };
        let darker = coded.map(|v| 0.5 * v);
        assert_eq!(darker.values(), plain.map(|v| 0.5 * v).values());
        assert_eq!(darker.bitmap().texels, darker.values());
        let mut bytes = bitmap.bytes().to_vec();
        bytes[17] ^= 1;
        let changed = Raster::from(Arc::new(CodedBitmap::<Rgb>::new(3, 2, bytes, *bitmap.values()).unwrap()));
        let printed = [&coded, &plain, &darker, &changed].map(|r| format!("{r:?}"));
        assert!((0..4).all(|i| (0..i).all(|j| printed[i] != printed[j])), "{printed:?}");
        assert!(darker.is_within(0.0, 0.5) && !coded.is_within(0.0, 0.5));
    }
}
