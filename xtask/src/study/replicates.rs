//! Sums of the images of a group's replicates at a checkpoint: what squared bias and variance are told from.
//!
//! The image of a replicate at a checkpoint is determined by the group's key, so a replicate that is run again adds
//! nothing and is left out.

use crate::{error::Error, files, study::results::Group};
use etendue_core::rgb::Rgb;
use std::{
    io::Write,
    path::{Path, PathBuf},
};

/// How a file begins.
const MAGIC: &[u8; 16] = b"etendue sums 1\r\n";

/// Sums over replicates, in `f64`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sums {
    replicates: Vec<u32>,
    /// The sum of the squares of all values of all replicates.
    squares: f64,
    /// The sum over replicates of each value.
    values: Vec<f64>,
}

/// The file of a group's sums at a checkpoint.
pub fn sums_path(images: &Path, group: &Group, passes: u32) -> PathBuf {
    images.join(format!("{}-{passes}.sums", group.file_stem()))
}

impl Sums {
    /// Reads a file; a missing or damaged one holds nothing.
    pub fn read(path: &Path) -> Sums {
        std::fs::read(path).ok().and_then(|bytes| Sums::decode(&bytes)).unwrap_or_default()
    }

    fn decode(bytes: &[u8]) -> Option<Sums> {
        let (count, rest) = bytes.strip_prefix(MAGIC)?.split_first_chunk::<4>()?;
        let (replicates, rest) = rest.split_at_checked(4 * u32::from_le_bytes(*count) as usize)?;
        let (squares, values) = rest.split_first_chunk::<8>()?;
        let number = |b: &[u8]| Some(f64::from_le_bytes(*b.first_chunk()?));
        Some(Sums {
            replicates: replicates
                .chunks(4)
                .map(|b| Some(u32::from_le_bytes(*b.first_chunk()?)))
                .collect::<Option<_>>()?,
            squares: f64::from_le_bytes(*squares),
            values: values.chunks(8).map(number).collect::<Option<_>>()?,
        })
    }

    /// Writes the file, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        files::write_whole(path, |w| {
            w.write_all(MAGIC)?;
            w.write_all(&(self.replicates.len() as u32).to_le_bytes())?;
            self.replicates.iter().try_for_each(|r| w.write_all(&r.to_le_bytes()))?;
            w.write_all(&self.squares.to_le_bytes())?;
            self.values.iter().try_for_each(|v| w.write_all(&v.to_le_bytes()))
        })
    }

    /// Adds a replicate's image unless it is in already.
    pub fn add(&mut self, replicate: u32, image: &[Rgb]) {
        if self.replicates.contains(&replicate) {
            return;
        }
        if self.values.len() != 3 * image.len() {
            *self = Sums { values: vec![0.0; 3 * image.len()], ..Sums::default() };
        }
        self.replicates.push(replicate);
        for (sum, v) in self.values.iter_mut().zip(image.iter().flat_map(|p| p.to_array())) {
            *sum += f64::from(v);
            self.squares += f64::from(v).powi(2);
        }
    }

    /// Squared bias and variance of one replicate, means over pixels and channels; none with fewer than two replicates
    /// or another size. Their sum is the mean over replicates of the mean squared error.
    ///
    /// The squared bias is an unbiased estimate, so that it scatters about 0 where there is none; the reference's own
    /// noise is in it.
    pub fn bias2_and_variance(&self, reference: &[Rgb]) -> Option<(f64, f64)> {
        let n = self.replicates.len() as f64;
        if self.replicates.len() < 2 || self.values.len() != 3 * reference.len() {
            return None;
        }
        let values = self.values.len() as f64;
        let square_of_sums: f64 = self.values.iter().map(|s| s * s).sum();
        let variance = ((self.squares - square_of_sums / n) / (n - 1.0)).max(0.0) / values;
        let apart = |(s, r): (&f64, f32)| (s / n - f64::from(r)).powi(2);
        let square: f64 = self.values.iter().zip(reference.iter().flat_map(|p| p.to_array())).map(apart).sum();
        Some((square / values - variance / n, variance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::statistics::image_error::{ImageError, bias_and_variance};

    #[test]
    fn sums_tell_what_the_replicates_tell() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sums");
        let value = |i: usize| ((i as f32 * 0.7331).sin() + 1.0) * 2.0;
        let image = |r: usize| -> Vec<Rgb> {
            (0..64).map(|i| Rgb::splat(value(i + 64 * r)) * Rgb::new(1.0, 0.5, 2.0)).collect()
        };
        let (images, reference): (Vec<Vec<Rgb>>, _) = ((0..5).map(image).collect(), image(9));
        for (i, image) in images.iter().enumerate() {
            let mut sums = Sums::read(&path);
            sums.add(i as u32, image);
            sums.add(i as u32, image);
            sums.write(&path).unwrap();
        }
        let (bias2, variance) = Sums::read(&path).bias2_and_variance(&reference).unwrap();
        let slices: Vec<&[Rgb]> = images.iter().map(Vec::as_slice).collect();
        let expected = bias_and_variance(&slices, &reference).unwrap();
        assert!((bias2 - expected.bias2).abs() < 1e-12 && (variance - expected.variance).abs() < 1e-12);
        let mse = images.iter().map(|i| ImageError::new(i, &reference).mse).sum::<f64>() / 5.0;
        assert!((bias2 + variance - mse).abs() < 1e-12);
    }

    #[test]
    fn a_damaged_file_holds_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sums");
        let mut sums = Sums::default();
        sums.add(3, &[Rgb::WHITE; 4]);
        sums.write(&path).unwrap();
        assert_eq!(Sums::read(&path), sums);
        let bytes = std::fs::read(&path).unwrap();
        for cut in [0, 10, 18, 22, 29, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            assert_eq!(Sums::read(&path), Sums::default(), "cut at {cut}");
        }
    }
}
