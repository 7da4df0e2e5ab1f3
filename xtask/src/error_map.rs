//! Error maps: where an image differs from its reference, in false colours.

use crate::picture::{Picture, encode_png};
use etendue_core::rgb::Rgb;

/// The squared relative errors that the two ends of the colours stand for.
pub const RANGE: (f64, f64) = (1e-5, 10.0);

/// Colours of the map at equal steps, from no error to the greatest: black, violet, red, orange, white, each brighter
/// than the one before, so that the map reads in grey too.
const COLOURS: [[f64; 3]; 6] = [
    [4.0, 5.0, 20.0],
    [62.0, 18.0, 98.0],
    [148.0, 38.0, 103.0],
    [222.0, 81.0, 58.0],
    [251.0, 164.0, 11.0],
    [252.0, 253.0, 200.0],
];

/// The colour of a position in [0, 1].
pub fn colour(t: f64) -> [u8; 3] {
    let x = t.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let i = (x as usize).min(COLOURS.len() - 2);
    let f = x - i as f64;
    std::array::from_fn(|c| (COLOURS[i][c] * (1.0 - f) + COLOURS[i + 1][c] * f).round() as u8)
}

/// A pixel's squared error relative to the reference, as in relMSE: the mean of (a - b)² / (b² + 0.01) over channels.
fn relative_square(a: Rgb, b: Rgb) -> f64 {
    let channel = |c: usize| {
        let (a, b) = (f64::from(a[c]), f64::from(b[c]));
        (a - b) * (a - b) / (b * b + 0.01)
    };
    (channel(0) + channel(1) + channel(2)) / 3.0
}

/// The map as a PNG; logarithmic over [`RANGE`]. What is no number has the greatest error.
pub fn error_map_png(image: &Picture, reference: &Picture) -> Vec<u8> {
    let (low, high) = (RANGE.0.log10(), RANGE.1.log10());
    let position = |e: f64| if e.is_nan() { 1.0 } else { (e.log10() - low) / (high - low) };
    let pairs = image.pixels.iter().zip(&reference.pixels);
    let bytes: Vec<u8> = pairs.flat_map(|(a, b)| colour(position(relative_square(*a, *b)))).collect();
    encode_png(image.size, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn colours_brighten_with_the_error() {
        let luminance = |c: [u8; 3]| 0.2126 * f64::from(c[0]) + 0.7152 * f64::from(c[1]) + 0.0722 * f64::from(c[2]);
        assert!((0..=100).map(|i| luminance(colour(f64::from(i) / 100.0))).is_sorted());
    }

    #[test]
    fn maps_show_where_the_error_is() {
        let reference = Picture { size: UVec2::new(4, 1), pixels: vec![Rgb::WHITE; 4] };
        let mut image = reference.clone();
        image.pixels[1] = Rgb::splat(1.1);
        image.pixels[2] = Rgb::splat(1e9);
        image.pixels[3] = Rgb::splat(f32::NAN);
        let map = image::load_from_memory(&error_map_png(&image, &reference)).unwrap().into_rgb8();
        let pixel = |x| map.get_pixel(x, 0).0;
        assert_eq!(pixel(0), colour(0.0));
        // log10(0.01 / 1.01) is 2.996 above the low end of six decades.
        assert_eq!(pixel(1), colour(2.9957 / 6.0));
        assert_eq!((pixel(2), pixel(3)), (colour(1.0), colour(1.0)));
    }
}
