//! How far an image is from its reference.

use super::moments::Moments;
use crate::rgb::Rgb;

/// Added to squares of the reference in relMSE, and to the denominator of SMAPE, so that a dark pixel's noise does not
/// count without bound.
pub const EPSILON: f64 = 0.01;

/// Share of the pixels, the worst ones, that the trimmed relMSE leaves out.
pub const TRIMMED: f64 = 0.001;

/// Errors of an image, each over all pixels and channels; those of a region are got by passing its pixels alone.
///
/// A NaN in either image makes every figure NaN, and an image without pixels too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageError {
    /// Mean of `(x - r)^2`.
    pub mse: f64,
    /// Mean of `(x - r)^2 / (r^2 + 0.01)`.
    pub relmse: f64,
    /// The same without the worst 0.1 % of the pixels (their number is rounded), by the mean over a pixel's channels. It
    /// misleads by itself: where light is concentrated, what it leaves out may be the light.
    pub relmse_trimmed: f64,
    /// Share of `relmse` that the pixels left out hold, in `[0, 1]`.
    pub trimmed_share: f64,
    /// Share of the image's energy, the sum of all channels, that the pixels left out hold.
    pub trimmed_energy_share: f64,
    /// Mean of `|x - r| / (|x| + |r| + 0.01)`, in `[0, 1)`.
    pub smape: f64,
    /// Mean of the image less mean of the reference.
    pub mean_error: f64,
    /// The same over the mean of the reference; infinite if that alone is black, 0 if both are.
    pub mean_error_relative: f64,
}

impl ImageError {
    /// Compares an image with its reference.
    ///
    /// # Panics
    /// If their numbers of pixels differ.
    pub fn new(image: &[Rgb], reference: &[Rgb]) -> ImageError {
        assert_eq!(image.len(), reference.len(), "an image and its reference differ in size");
        let (mut mse, mut smape, mut mean_error, mut mean) = (0.0, 0.0, 0.0, 0.0);
        // Relative squared error and energy of each pixel.
        let mut pixels: Vec<(f64, f64)> = Vec::with_capacity(image.len());
        for (x, r) in image.iter().zip(reference) {
            let mut pixel = (0.0, 0.0);
            for (x, r) in x.to_array().into_iter().zip(r.to_array()) {
                let (x, r) = (f64::from(x), f64::from(r));
                let square = (x - r) * (x - r);
                mse += square;
                smape += (x - r).abs() / (x.abs() + r.abs() + EPSILON);
                mean_error += x - r;
                mean += r;
                pixel.0 += square / (r * r + EPSILON);
                pixel.1 += x;
            }
            pixels.push(pixel);
        }
        let values = 3.0 * image.len() as f64;

        let worst = (TRIMMED * image.len() as f64).round() as usize;
        let kept = image.len() - worst;
        if worst > 0 {
            pixels.select_nth_unstable_by(kept, |a, b| a.0.total_cmp(&b.0));
        }
        let sum = |pixels: &[(f64, f64)]| pixels.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
        let (best, trimmed) = (sum(&pixels[..kept]), sum(&pixels[kept..]));
        let total = (best.0 + trimmed.0, best.1 + trimmed.1);
        let share = |part: f64, total: f64| if total == 0.0 { 0.0 } else { part / total };
        let trimmed_mean = best.0 / (3.0 * kept as f64);
        ImageError {
            mse: mse / values,
            relmse: total.0 / values,
            // A pixel that is not a number would be among the worst, and unseen.
            relmse_trimmed: if total.0.is_nan() { f64::NAN } else { trimmed_mean },
            trimmed_share: share(trimmed.0, total.0),
            trimmed_energy_share: share(trimmed.1, total.1),
            smape: smape / values,
            mean_error: mean_error / values,
            mean_error_relative: if mean_error == 0.0 { 0.0 } else { mean_error / mean },
        }
    }
}

/// The two parts of a technique's squared error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasVariance {
    /// Mean over pixels and channels of the squared difference between expected image and reference: an unbiased estimate,
    /// so it scatters about 0, to negative values too, when there is no bias. The reference's own variance is in it.
    pub bias2: f64,
    /// Mean over pixels and channels of the variance of one replicate.
    pub variance: f64,
}

/// Estimates squared bias and variance from independent replicates; `None` with fewer than two.
///
/// # Panics
/// If the numbers of pixels differ.
pub fn bias_and_variance(replicates: &[&[Rgb]], reference: &[Rgb]) -> Option<BiasVariance> {
    if replicates.len() < 2 {
        return None;
    }
    assert!(replicates.iter().all(|r| r.len() == reference.len()), "a replicate and its reference differ in size");
    let (mut square, mut variance) = (0.0, 0.0);
    for (i, r) in reference.iter().enumerate() {
        for (c, r) in r.to_array().into_iter().enumerate() {
            let moments: Moments = replicates.iter().map(|image| f64::from(image[i].to_array()[c])).collect();
            square += (moments.mean() - f64::from(r)).powi(2);
            variance += moments.variance();
        }
    }
    let values = 3.0 * reference.len() as f64;
    let variance = variance / values;
    // The mean of n replicates has itself a variance, n times less than theirs.
    Some(BiasVariance { bias2: square / values - variance / replicates.len() as f64, variance })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        independent::Independent,
        sampler::{Purpose, Sampler},
    };

    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-7 * expected.abs(), "{value} is not {expected}");
    }

    #[test]
    fn known_values() {
        let error = ImageError::new(
            &[Rgb::new(1.5, 0.0, 2.0), Rgb::new(0.0, 0.5, 1.0)],
            &[Rgb::new(1.0, 0.0, 3.0), Rgb::new(0.0, 0.0, 1.0)],
        );
        close(error.mse, 1.5 / 6.0);
        let relative = 0.25 / 1.01 + 1.0 / 9.01 + 0.25 / 0.01;
        close(error.relmse, relative / 6.0);
        close(error.relmse_trimmed, relative / 6.0);
        assert_eq!((error.trimmed_share, error.trimmed_energy_share), (0.0, 0.0));
        close(error.smape, (0.5 / 2.51 + 1.0 / 5.01 + 0.5 / 0.51) / 6.0);
        assert_eq!((error.mean_error, error.mean_error_relative), (0.0, 0.0));
        let error = ImageError::new(&[Rgb::splat(1.5)], &[Rgb::splat(2.0)]);
        assert_eq!((error.mean_error, error.mean_error_relative), (-0.5, -0.25));
    }

    #[test]
    fn the_worst_pixels_are_left_out_and_said() {
        // 1500 pixels: 2 are left out (1.5 is rounded).
        let reference = vec![Rgb::WHITE; 1500];
        let mut image = vec![Rgb::splat(1.125); 1500];
        (image[7], image[900], image[1400]) = (Rgb::splat(11.0), Rgb::new(21.0, 1.0, 1.0), Rgb::splat(3.0));
        let error = ImageError::new(&image, &reference);
        let (ordinary, third) = (3.0 * 0.015625 / 1.01 * 1497.0, 12.0 / 1.01);
        let trimmed = (300.0 + 400.0) / 1.01;
        close(error.relmse_trimmed, (ordinary + third) / (3.0 * 1498.0));
        close(error.trimmed_share, trimmed / (ordinary + third + trimmed));
        close(error.trimmed_energy_share, 56.0 / (56.0 + 9.0 + 3.375 * 1497.0));
        close(error.relmse, (ordinary + third + trimmed) / 4500.0);
    }

    #[test]
    fn a_pixel_that_is_not_a_number_is_not_hidden() {
        let mut image = vec![Rgb::WHITE; 5000];
        image[3].g = f32::NAN;
        let e = ImageError::new(&image, &vec![Rgb::WHITE; 5000]);
        for figure in [
            e.mse,
            e.relmse,
            e.relmse_trimmed,
            e.trimmed_share,
            e.trimmed_energy_share,
            e.smape,
            e.mean_error,
            e.mean_error_relative,
        ] {
            assert!(figure.is_nan(), "{e:?}");
        }
        assert!(ImageError::new(&[], &[]).relmse.is_nan());
    }

    #[test]
    fn black_against_black_has_no_error() {
        let e = ImageError::new(&[Rgb::BLACK; 4], &[Rgb::BLACK; 4]);
        assert_eq!((e.mse, e.relmse, e.relmse_trimmed, e.smape), (0.0, 0.0, 0.0, 0.0));
        assert_eq!((e.trimmed_share, e.trimmed_energy_share, e.mean_error_relative), (0.0, 0.0, 0.0));
        assert_eq!(ImageError::new(&[Rgb::WHITE], &[Rgb::BLACK]).mean_error_relative, f64::INFINITY);
    }

    #[test]
    fn bias_and_variance_come_apart() {
        const PIXELS: u32 = 20_000;
        let replicate = |index: u32| -> Vec<Rgb> {
            let mut sampler = Independent::new(6);
            let mut value = |i: u32, vertex: u32| {
                sampler.start_sample(i, index);
                sampler.get_1d(vertex, Purpose::Lobe)
            };
            (0..PIXELS).map(|i| Rgb::new(value(i, 0), value(i, 1), value(i, 2))).collect()
        };
        let images: Vec<Vec<Rgb>> = (0..5).map(replicate).collect();
        let images: Vec<&[Rgb]> = images.iter().map(Vec::as_slice).collect();
        for bias in [0.0, 0.1] {
            let parts = bias_and_variance(&images, &vec![Rgb::splat(0.5 + bias); PIXELS as usize]).unwrap();
            // Of a uniform number: variance 1/12, fourth central moment 1/80.
            let values = 3.0 * f64::from(PIXELS);
            let of_variance = ((1.0 / 80.0 - 2.0 / 4.0 / 144.0) / 5.0 / values).sqrt();
            assert!((parts.variance - 1.0 / 12.0).abs() < 4.0 * of_variance, "{parts:?}");
            // bias2 is the mean of products of deviations of different replicates, plus twice the bias times the mean's.
            let of_square = 2.0 / (5.0 * 4.0 * 144.0);
            let of_bias2 = ((of_square + 4.0 * f64::from(bias * bias) / 60.0) / values).sqrt();
            assert!((parts.bias2 - f64::from(bias * bias)).abs() < 4.0 * of_bias2, "{parts:?}");
        }
        assert_eq!(bias_and_variance(&images[..1], images[0]), None);
    }
}
