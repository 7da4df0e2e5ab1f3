//! Assignment of lens, light and time to the samples of neighbouring pixels.

use crate::{
    layout::Layout,
    permutation::{permute_by, scaled},
    stratified::{GOLDEN, jitter},
    torus::{Place, distance_squared},
};
use std::sync::OnceLock;

/// What a sample of a pixel has beside its place there: lens, light and time, times `2^32`. Time is on a circle, so its
/// second coordinate is 0.
pub(crate) type Parameters = [Place; 3];

/// The most samples of a pixel.
pub(crate) const MOST: u32 = 64;

/// Strata that are tried for each parameter of a sample.
const CANDIDATES: u32 = 12;

/// Spread of the Gaussian by which samples are near each other in the image, in distances between samples, and the
/// distance to which it is followed.
const NEAR: f32 = 1.2;
const REACH: f32 = 3.5;

/// Spread of that by which values are near each other, for lens, light and time: about ten samples are near in the image.
const ALIKE: [f32; 3] = [0.2, 0.2, 0.08];

/// Parameters of the samples of a square tile of pixels, which repeats.
///
/// Each pixel has one sample in each of `count` strata of its area, and one in each of `count` strata of the lens, of the
/// light and of the time. Which goes with which is free, and chosen so that samples near each other in the image are far
/// from each other on the lens, on the light and in time: the noise that a distribution ray tracer's parameters cause then
/// is of high frequency in the image, as that of its film positions is [Mitchell 1991, sec. 4].
///
/// That paper asks that the pattern's spectrum have little power at low frequencies of the image, whatever the frequency
/// along the parameters, and takes best candidates for it. Here samples get their values one after the other: of some
/// strata that are left to the pixel, each takes the one that is crowded least by the samples around.
#[derive(Clone, Debug)]
pub(crate) struct Tile {
    /// Pixels on a side.
    size: u32,
    /// Samples of a pixel.
    count: u32,
    /// By pixel, row by row, then by stratum of the pixel in the order of [`Layout`].
    samples: Vec<Parameters>,
}

impl Tile {
    /// The tile for `count` samples a pixel, from 1 to [`MOST`]; made when it is first asked for.
    pub(crate) fn of(count: u32) -> &'static Tile {
        static TILES: [OnceLock<Tile>; MOST as usize] = [const { OnceLock::new() }; MOST as usize];
        TILES[count as usize - 1].get_or_init(|| Tile::new(count))
    }

    fn new(count: u32) -> Tile {
        let size: u32 = if count < 4 { 32 } else { 16 };
        let pixels = size * size;
        let tile = Tile { size, count, samples: vec![Parameters::default(); (pixels * count) as usize] };
        let mut maker = Maker { tile, layout: Layout::new(count), assigned: vec![0; pixels as usize], drawn: 0 };
        (0..pixels).for_each(|step| maker.assign(permute_by(step, pixels, GOLDEN)));
        maker.tile
    }

    /// Parameters of sample `stratum` of a pixel.
    #[inline]
    pub(crate) fn parameters(&self, x: u32, y: u32, stratum: u32) -> Parameters {
        self.samples[(((y % self.size) * self.size + x % self.size) * self.count + stratum) as usize]
    }
}

/// A tile that is being made.
struct Maker {
    tile: Tile,
    layout: Layout,
    /// How many samples of each pixel have their parameters.
    assigned: Vec<u32>,
    drawn: u32,
}

impl Maker {
    /// Gives a pixel's samples their parameters.
    fn assign(&mut self, pixel: u32) {
        let count = self.tile.count;
        let mut left = [(); 3].map(|()| Vec::from_iter(0..count));
        for stratum in 0..count {
            let around = self.around(pixel, stratum);
            let mut parameters = Parameters::default();
            for (i, left) in left.iter_mut().enumerate() {
                let crowd = |value: Place| -> f32 {
                    let near = around.iter().map(|(other, weight)| weight * alike(value, other[i], ALIKE[i]));
                    near.sum()
                };
                let (mut best, mut least) = ((0, Place::default()), f32::INFINITY);
                for _ in 0..CANDIDATES {
                    let place = scaled(self.draw()[0], left.len() as u32) as usize;
                    let value = self.value(i, left[place]);
                    let crowded = crowd(value);
                    if crowded < least {
                        (best, least) = ((place, value), crowded);
                    }
                }
                left.swap_remove(best.0);
                parameters[i] = best.1;
            }
            self.tile.samples[(pixel * count + stratum) as usize] = parameters;
            self.assigned[pixel as usize] += 1;
        }
    }

    fn draw(&mut self) -> [u32; 2] {
        self.drawn += 1;
        jitter(0, self.drawn)
    }

    /// A random value in a stratum of a parameter.
    fn value(&mut self, parameter: usize, stratum: u32) -> Place {
        let random = self.draw();
        // Multiples of 2^-24.
        let bits = |u: f32| ((u * (1 << 24) as f32) as u32) << 8;
        match parameter {
            2 => [bits(self.layout.place_1d(stratum, random[0])), 0],
            _ => self.layout.place(stratum, random).to_array().map(bits),
        }
    }

    /// The samples near one in the image that have their parameters, and how near they are.
    fn around(&self, pixel: u32, stratum: u32) -> Vec<(Parameters, f32)> {
        let (size, count) = (self.tile.size, self.tile.count);
        let spacing = (count as f32).sqrt().recip();
        let middle = |stratum| self.layout.place(stratum, [1 << 31; 2]);
        let (x, y, from) = (pixel % size, pixel / size, middle(stratum));
        let pixels = (REACH * spacing + 1.0) as u32;
        let mut around = Vec::new();
        for (i, j) in (0..=2 * pixels).flat_map(|i| (0..=2 * pixels).map(move |j| (i, j))) {
            let [column, row] = [x + i, y + j].map(|c| (c + size - pixels) % size);
            let other = (row * size + column) as usize;
            let between = glam::Vec2::new(i as f32, j as f32) - pixels as f32 - from;
            for other_stratum in 0..self.assigned[other] {
                let distance = (between + middle(other_stratum)).length() / spacing;
                if distance < REACH {
                    let weight = (-0.5 * (distance / NEAR).powi(2)).exp();
                    around.push((self.tile.samples[other * count as usize + other_stratum as usize], weight));
                }
            }
        }
        around
    }
}

/// A Gaussian of the distance around the torus.
fn alike(a: Place, b: Place, spread: f32) -> f32 {
    let squared = distance_squared(a, b) as f32 / 2.0_f32.powi(64);
    (-0.5 * squared / (spread * spread)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pixel_has_every_stratum_of_every_parameter() {
        for count in [1, 2, 7, 16, 61, MOST] {
            let tile = Tile::of(count);
            let layout = Layout::new(count);
            let numbers = |place: Place| place.map(|c| (c >> 8) as f32 / (1 << 24) as f32);
            for (x, y) in [(0, 0), (3, 5), (15, 15)] {
                for parameter in 0..3 {
                    let mut seen = vec![false; count as usize];
                    for stratum in 0..count {
                        let value = numbers(tile.parameters(x, y, stratum)[parameter]);
                        let inside = |&s: &u32| {
                            let ends = [0, u32::MAX];
                            if parameter == 2 {
                                let [low, high] = ends.map(|end| layout.place_1d(s, end));
                                return (low..=high).contains(&value[0]);
                            }
                            let [low, high] = ends.map(|end| layout.place(s, [end; 2]));
                            (low.x..=high.x).contains(&value[0]) && (low.y..=high.y).contains(&value[1])
                        };
                        seen[(0..count).find(inside).unwrap() as usize] = true;
                    }
                    assert!(seen.into_iter().all(|s| s), "{count}: parameter {parameter}");
                }
            }
        }
    }

    /// The mean over an area of the image, of a function of a parameter that averages to nothing: its square is the
    /// spectrum's power at low frequencies of the image, over that of parameters that are stratified in each pixel alone.
    #[test]
    fn values_of_neighbouring_pixels_make_up_for_each_other() {
        for (count, most) in [(1, 0.35), (4, 0.65), (16, 0.9)] {
            let tile = Tile::of(count);
            for parameter in 0..3 {
                let wave = |x, y, stratum| {
                    let angle = |c: u32| f64::from(c) / 2.0_f64.powi(32) * std::f64::consts::TAU;
                    let value: Place = tile.parameters(x, y, stratum)[parameter];
                    angle(value[0]).sin_cos()
                };
                let (mut alone, mut together) = (0.0, 0.0);
                let add = |sum: (f64, f64), term: (f64, f64)| (sum.0 + term.0, sum.1 + term.1);
                let square = |sum: (f64, f64)| sum.0 * sum.0 + sum.1 * sum.1;
                for (x, y) in (0..tile.size).flat_map(|x| (0..tile.size).map(move |y| (x, y))) {
                    let pixel = |x, y| (0..count).map(|s| wave(x, y, s)).fold((0.0, 0.0), add);
                    alone += square(pixel(x, y));
                    together += square((0..16).map(|i| pixel(x + i % 4, y + i / 4)).fold((0.0, 0.0), add)) / 16.0;
                }
                let share = together / alone;
                assert!(share < most, "{count} {parameter}: {share}");
            }
        }
    }
}
