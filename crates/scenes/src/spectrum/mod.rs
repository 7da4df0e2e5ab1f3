//! From spectra to linear RGB, as the RGB variants of Mitsuba 3 do it.

mod cie;
mod metals;

pub(crate) use metals::{conductor, names as conductor_names};

use etendue_core::rgb::Rgb;

/// The most points of a spectrum.
const MOST_POINTS: usize = 1 << 16;

/// A spectrum by points between which it is linear and outside of which it is black: wavelengths in nm, increasing, with values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spectrum(Vec<(f64, f64)>);

/// Rows of the matrix from CIE XYZ to linear RGB with the primaries of [ITU-R BT.709] and the white of D65.
const FROM_XYZ: [[f64; 3]; 3] =
    [[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]];

/// Integral of the observer's y, nm.
const INTEGRAL_Y: f64 = 106.856895;
/// What D65 is divided by, so that light of it has the Y of light of the same value everywhere.
const D65_SCALE: f64 = 98.99741751876255;
/// The number of places at which spectra are looked up.
const STEPS: usize = 1000;

fn rgb(xyz: [f64; 3]) -> [f64; 3] {
    FROM_XYZ.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// Light of the same power at each wavelength, which is a little redder than the white of D65.
pub(crate) fn uniform_emission(value: f64) -> Rgb {
    Rgb::from(rgb([value; 3]).map(|c| c as f32))
}

impl Spectrum {
    /// The spectrum through the points.
    ///
    /// # Errors
    /// Fewer than two points, too many, wavelengths that do not increase, or a negative value.
    pub(crate) fn new(points: Vec<(f64, f64)>) -> Result<Spectrum, String> {
        if points.len() < 2 || points.len() > MOST_POINTS {
            return Err(format!("a spectrum has from 2 to {MOST_POINTS} points, not {}", points.len()));
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            return Err(format!("the wavelength {} does not lie above {}", pair[1].0, pair[0].0));
        }
        match points.iter().find(|(_, value)| *value < 0.0) {
            Some((wavelength, value)) => Err(format!("a spectrum is not negative ({value} at {wavelength} nm)")),
            None => Ok(Spectrum(points)),
        }
    }

    /// The largest value.
    pub(crate) fn most(&self) -> f64 {
        self.0.iter().fold(0.0, |most, (_, value)| most.max(*value))
    }

    /// As light.
    pub(crate) fn emission(&self) -> Rgb {
        Rgb::from(self.integrate(|_| 1.0).map(|c| c.max(0.0) as f32))
    }

    /// As what reflects the light of D65; at most 1.
    pub(crate) fn reflectance(&self) -> Rgb {
        Rgb::from(self.under_d65().map(|c| c.clamp(0.0, 1.0) as f32))
    }

    /// As an index of refraction or the like: as what reflects, without a bound.
    pub(crate) fn index(&self) -> Rgb {
        Rgb::from(self.under_d65().map(|c| c.max(0.0) as f32))
    }

    fn under_d65(&self) -> [f64; 3] {
        self.integrate(|wavelength| {
            let (i, t) = place(wavelength);
            (cie::D65[i] * (1.0 - t) + cie::D65[i + 1] * t) / D65_SCALE
        })
    }

    fn integrate(&self, light: impl Fn(f64) -> f64) -> [f64; 3] {
        let last = cie::FIRST + cie::STEP * (cie::COUNT - 1) as f64;
        let mut xyz = [0.0; 3];
        let mut above = 1;
        for step in 0..STEPS {
            let wavelength = cie::FIRST + (last - cie::FIRST) * (step as f64 / (STEPS - 1) as f64);
            if wavelength < self.0[0].0 {
                continue;
            }
            while above < self.0.len() && self.0[above].0 < wavelength {
                above += 1;
            }
            let Some(&(right, high)) = self.0.get(above) else { break };
            let (left, low) = self.0[above - 1];
            let value = low + (high - low) * (wavelength - left) / (right - left);
            let (i, t) = place(wavelength);
            let weight = value * light(wavelength) * (last - cie::FIRST) / ((STEPS - 1) as f64 * INTEGRAL_Y);
            for (c, sum) in xyz.iter_mut().enumerate() {
                *sum += weight * (cie::OBSERVER[i][c] * (1.0 - t) + cie::OBSERVER[i + 1][c] * t);
            }
        }
        rgb(xyz)
    }
}

/// The entry of the tables below a wavelength, and how far towards the next it lies.
fn place(wavelength: f64) -> (usize, f64) {
    let x = (wavelength - cie::FIRST) / cie::STEP;
    let i = (x as usize).min(cie::COUNT - 2);
    (i, x - i as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Rgb, b: [f64; 3]) {
        for (x, y) in a.to_array().into_iter().zip(b) {
            assert!((f64::from(x) - y).abs() <= 1e-5 * y.abs().max(0.1), "{a:?} {b:?}");
        }
    }

    /// Figures: Mitsuba 3.9.1, scalar_rgb, `traverse` of a `diffuse`, a `point` and a `conductor`.
    #[test]
    fn spectra_become_what_mitsuba_makes_of_them() {
        let spectrum = |points: &[(f64, f64)]| Spectrum::new(points.to_vec()).unwrap();
        let flat = spectrum(&[(400.0, 0.78), (500.0, 0.78), (600.0, 0.78), (700.0, 0.78)]);
        near(flat.reflectance(), [0.776367, 0.77981, 0.776029]);
        let varied = spectrum(&[(400.0, 0.1), (500.0, 0.9), (600.0, 0.2), (700.0, 0.4)]);
        near(varied.reflectance(), [0.0499287, 0.64263, 0.531135]);
        let lamp = spectrum(&[(400.0, 0.0), (500.0, 8.0), (600.0, 15.6), (700.0, 18.4)]);
        near(lamp.emission(), [20.7108, 10.8546, 2.77115]);
        near(spectrum(&[(400.0, 1.0), (700.0, 1.0)]).emission(), [1.19969, 0.94952, 0.903443]);
        near(uniform_emission(3.0), [3.61438, 2.84487, 2.72675]);
        near(spectrum(&[(400.0, 1.5), (700.0, 1.2)]).index(), [1.25177, 1.3567, 1.45155]);
        near(spectrum(&[(400.0, 3.0), (700.0, 5.0)]).index(), [4.59432, 3.95218, 3.25681]);
    }

    #[test]
    fn a_spectrum_beyond_the_visible_is_black() {
        for points in [[(100.0, 1.0), (200.0, 1.0)], [(900.0, 1.0), (1000.0, 1.0)]] {
            assert_eq!(Spectrum::new(points.to_vec()).unwrap().emission(), Rgb::BLACK);
        }
    }

    #[test]
    fn wrong_points_are_refused() {
        let message = |points: &[(f64, f64)]| Spectrum::new(points.to_vec()).unwrap_err();
        assert_eq!(message(&[(400.0, 1.0)]), "a spectrum has from 2 to 65536 points, not 1");
        assert_eq!(message(&[(400.0, 1.0), (400.0, 2.0)]), "the wavelength 400 does not lie above 400");
        assert_eq!(message(&[(400.0, 1.0), (500.0, -2.0)]), "a spectrum is not negative (-2 at 500 nm)");
    }

    #[test]
    fn conductors_have_names() {
        assert_eq!(conductor("Cu").unwrap().1, Rgb::new(3.91326, 2.45305, 2.14209));
        assert!(conductor("cu").is_none());
        assert!(conductor_names().all(|name| conductor(name).is_some()));
    }
}
