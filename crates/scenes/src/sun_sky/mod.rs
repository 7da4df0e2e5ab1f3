//! Daylight: a clear or hazy sky with the sun, as an image of light from infinity.
//!
//! ```
//! use etendue_scenes::sun_sky::{SunSky, bake};
//! use glam::DVec3;
//!
//! let noon = SunSky { sun_direction: DVec3::new(0.2, 1.0, 0.1), ..SunSky::default() };
//! let image = bake(&noon);
//! assert_eq!((image.width, image.height), (2048, 1024));
//! // Half of the sphere lies below the horizon and is black.
//! assert!(image.texels[image.texels.len() / 2..].iter().all(|t| t.is_black()));
//! ```
//!
//! The model is that of [Preetham, Shirley, Smits 1999, "A Practical Analytic Model for Daylight"]: the luminance and the
//! chromaticity of the sky after [Perez et al. 1993], fitted to simulations, and the sun's spectrum outside of the
//! atmosphere, attenuated on its way through it. The ground's albedo, which later models ask for, is not a parameter of it.
//!
//! # Space
//!
//! The image is one of [`Environment::LatLong`] with [`Rows::Centred`]: +y is up. The sky depends on the directions of the
//! zenith and of the sun alone, so for a scene in which another axis is up, any rotation to there will do, with the sun's
//! direction turned back by it. [`sun_direction`] has -z in the north and +x in the east.
//!
//! # Units
//!
//! Radiance is in W/(m² sr nm), as a spectrum that is the same at every wavelength would have it, brought to linear RGB by
//! the CIE's XYZ: RGB of luminance 1 stands for 683 · 106.9 cd/m². Mitsuba 3 has the same units, but its `sunsky` follows
//! another model [Hošek and Wilkie 2012, 2013]. Luminances of the irradiance here over those in Mitsuba 3.9.1 with a black
//! ground, the sky's on the ground and the sun's on a plane that faces it:
//!
//! | turbidity | elevation of the sun | sky | sun |
//! | --- | --- | --- | --- |
//! | 2 | 20° | 2.12 | 0.88 |
//! | 2 | 45° | 2.01 | 1.01 |
//! | 2 | 80° | 1.80 | 1.05 |
//! | 3 | 20° | 1.64 | 0.70 |
//! | 3 | 45° | 1.96 | 0.90 |
//! | 3 | 80° | 2.23 | 0.96 |
//! | 6 | 20° | 1.43 | 0.37 |
//! | 6 | 45° | 1.92 | 0.66 |
//! | 6 | 80° | 2.58 | 0.77 |
//!
//! No constant lies between the two: the zenith's luminance rises faster with the sun here. [Zotti, Wilkie, Purgathofer 2007,
//! "A Critical Review of the Preetham Skylight Model"] hold this model's sky against measured ones. [`SunSky::sky_scale`] is
//! there for whom the other sky's brightness matters.
//!
//! [`Environment::LatLong`]: etendue_core::lights::environment::Environment::LatLong
//! [`Rows::Centred`]: etendue_core::lights::environment::Rows::Centred

mod place;
mod sky;
mod sun;

pub use place::{Moment, sun_direction};

use etendue_core::{rgb::Rgb, texture::Bitmap};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A sky with the sun in it.
#[derive(Clone, Debug, PartialEq)]
pub struct SunSky {
    /// Haze: all that is in the air over what clean air would have; 2 is a clear day, 6 a hazy one. What lies outside of
    /// [`TURBIDITIES`] counts as the nearest that lies inside.
    pub turbidity: f64,
    /// Towards the sun, of any length but zero; +y is up. A sun below the horizon leaves all black.
    pub sun_direction: DVec3,
    /// Factor on the sun's radiance.
    pub sun_scale: f64,
    /// Factor on the sky's radiance.
    pub sky_scale: f64,
    /// Angle across the sun, radians, in (0, pi). A sun of another size than the real one has the same irradiance.
    pub sun_aperture: f64,
    /// Width of the image in texels, even, at least 8; the image is half as high.
    pub width: u32,
}

/// The turbidities for which the sky's luminance is positive everywhere and the fits are of use.
pub const TURBIDITIES: (f64, f64) = (1.7, 10.0);

/// Angle across the sun as it is seen, radians.
pub const SUN_APERTURE: f64 = 0.5358 * (PI / 180.0);

impl Default for SunSky {
    /// A clear day with the sun at 45 degrees in the south (+z).
    fn default() -> SunSky {
        SunSky {
            turbidity: 3.0,
            sun_direction: DVec3::new(0.0, 1.0, 1.0),
            sun_scale: 1.0,
            sky_scale: 1.0,
            sun_aperture: SUN_APERTURE,
            width: 2048,
        }
    }
}

/// The image of a sky with the sun, for [`Rows::Centred`] and a scale of 1.
///
/// The sun is drawn by the share of each texel that it covers, and scaled so that the interpolated image holds exactly its
/// power, however few texels it has.
///
/// [`Rows::Centred`]: etendue_core::lights::environment::Rows::Centred
pub fn bake(params: &SunSky) -> Bitmap<Rgb> {
    let height = params.width.max(8) / 2;
    let grid = Grid { width: 2 * height as usize, height: height as usize };
    let mut texels = vec![Rgb::BLACK; grid.width * grid.height];
    let sun = params.sun_direction.normalize_or_zero();
    if sun.y > 0.0 {
        let turbidity = params.turbidity.clamp(TURBIDITIES.0, TURBIDITIES.1);
        let sky = sky::Sky::new(turbidity, sun.y.acos());
        for row in 0..grid.height / 2 {
            for column in 0..grid.width {
                let direction = grid.direction(column as f64 + 0.5, row as f64 + 0.5);
                let radiance = sky.radiance(direction.y, angle(direction, sun)) * params.sky_scale;
                texels[row * grid.width + column] = rgb(radiance);
            }
        }
        let irradiance = sun::radiance(turbidity, sun.y.acos()) * solid_angle(SUN_APERTURE) * params.sun_scale;
        for (index, share) in grid.disc(sun, 0.5 * params.sun_aperture) {
            texels[index] += rgb(irradiance * share);
        }
    }
    Bitmap { width: grid.width as u32, height, texels }
}

/// As single precision, without what lies outside of the gamut.
fn rgb(value: DVec3) -> Rgb {
    let [r, g, b] = value.max(DVec3::ZERO).as_vec3().to_array();
    Rgb::new(r, g, b)
}

/// From CIE XYZ to linear RGB [ITU-R BT.709-6, with the white D65].
fn from_xyz(xyz: DVec3) -> DVec3 {
    DVec3::new(
        DVec3::new(3.240_454_2, -1.537_138_5, -0.498_531_4).dot(xyz),
        DVec3::new(-0.969_266_0, 1.876_010_8, 0.041_556_0).dot(xyz),
        DVec3::new(0.055_643_4, -0.204_025_9, 1.057_225_2).dot(xyz),
    )
}

/// Between two unit vectors; precise for small angles, too.
fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Of a cone with an angle across.
fn solid_angle(aperture: f64) -> f64 {
    // 2 pi (1 - cos(a / 2)) without its cancellation.
    4.0 * PI * (0.25 * aperture).sin().powi(2)
}

/// Where the texels lie.
struct Grid {
    width: usize,
    height: usize,
}

impl Grid {
    /// The direction at coordinates in texels.
    fn direction(&self, x: f64, y: f64) -> DVec3 {
        let (phi, theta) = (x * TAU / self.width as f64, y * PI / self.height as f64);
        // u = atan2(d.x, -d.z) / 2 pi, v = acos(d.y) / pi.
        DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos())
    }

    /// How much of the sphere's solid angle a texel of a row stands for under bilinear interpolation: the integral of its
    /// tent.
    fn weight(&self, row: usize) -> f64 {
        let h = PI / self.height as f64;
        let theta = (row as f64 + 0.5) * h;
        // The integrals of (1 - t / h) cos t and of (1 - t / h) sin t from 0 to h.
        let (even, odd) = ((1.0 - h.cos()) / h, 1.0 - h.sin() / h);
        let half = theta.sin() * even;
        let column = TAU / self.width as f64;
        if row == 0 || row == self.height - 1 {
            // Towards the pole the value stays.
            let polar = theta.min(PI - theta);
            column * (half + polar.cos() * odd + (1.0 - polar.cos()))
        } else {
            column * 2.0 * half
        }
    }

    /// What a disc of the irradiance 1 adds to the texels that it covers.
    fn disc(&self, center: DVec3, radius: f64) -> Vec<(usize, f64)> {
        /// Points along each side of a texel at which it is looked for the disc.
        const POINTS: usize = 16;
        let theta = center.y.clamp(-1.0, 1.0).acos();
        let row = |theta: f64| (theta / PI * self.height as f64).clamp(0.0, self.height as f64 - 1.0) as usize;
        // Squared chords tell angles apart that cosines do not.
        let chord = (2.0 * (0.5 * radius.min(FRAC_PI_2)).sin()).powi(2);
        let mut covered = Vec::new();
        for row in row(theta - radius)..=row(theta + radius) {
            for column in 0..self.width {
                let place = |i: usize, at: usize| at as f64 + (i as f64 + 0.5) / POINTS as f64;
                let hits = (0..POINTS * POINTS)
                    .map(|i| self.direction(place(i % POINTS, column), place(i / POINTS, row)))
                    .filter(|d| d.distance_squared(center) < chord)
                    .count();
                if hits > 0 {
                    covered.push((row * self.width + column, hits as f64));
                }
            }
        }
        if covered.is_empty() {
            // Smaller than the space between the points.
            let phi = center.x.atan2(-center.z).rem_euclid(TAU);
            let column = ((phi / TAU * self.width as f64) as usize).min(self.width - 1);
            covered.push((row(theta) * self.width + column, 1.0));
        }
        let total: f64 = covered.iter().map(|(index, share)| share * self.weight(index / self.width)).sum();
        covered.iter_mut().for_each(|(_, share)| *share /= total);
        covered
    }
}
