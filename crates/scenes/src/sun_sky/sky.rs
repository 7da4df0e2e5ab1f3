//! The sky without the sun [Preetham, Shirley, Smits 1999, sec. 3.1 and appendix 2].

use super::from_xyz;
use glam::DVec3;
use std::f64::consts::PI;

/// Luminance, cd/m², of the spectrum that is 1 W/(m² sr nm) at every wavelength: 683 lm/W times the integral of the CIE's
/// luminous efficiency over the wavelengths in nm.
const LUMINANCE_OF_ONE: f64 = 683.0 * 106.857;

/// The coefficients A to E of the sky's distribution, each linear in the turbidity: of the luminance and of the chromaticities
/// x and y [appendix 2].
const LUMINANCE: [(f64, f64); 5] =
    [(0.1787, -1.4630), (-0.3554, 0.4275), (-0.0227, 5.3251), (0.1206, -2.5771), (-0.0670, 0.3703)];
const X: [(f64, f64); 5] =
    [(-0.0193, -0.2592), (-0.0665, 0.0008), (-0.0004, 0.2125), (-0.0641, -0.8989), (-0.0033, 0.0452)];
const Y: [(f64, f64); 5] =
    [(-0.0167, -0.2608), (-0.0950, 0.0092), (-0.0079, 0.2102), (-0.0441, -1.6537), (-0.0109, 0.0529)];

/// The zenith's chromaticities: rows for the turbidity squared, the turbidity and 1, columns for the third to the zeroth power
/// of the sun's angle [appendix 2].
const ZENITH_X: [[f64; 4]; 3] =
    [[0.00166, -0.00375, 0.00209, 0.0], [-0.02903, 0.06377, -0.03202, 0.00394], [0.11693, -0.21196, 0.06052, 0.25886]];
const ZENITH_Y: [[f64; 4]; 3] =
    [[0.00275, -0.00610, 0.00317, 0.0], [-0.04214, 0.08970, -0.04153, 0.00516], [0.15346, -0.26756, 0.06670, 0.26688]];

/// A sky, by its luminance and chromaticity.
pub(super) struct Sky {
    luminance: Distribution,
    x: Distribution,
    y: Distribution,
}

/// One quantity over the sky.
struct Distribution {
    coefficients: [f64; 5],
    /// What the coefficients' function is to be multiplied by.
    factor: f64,
}

impl Distribution {
    fn new(coefficients: [(f64, f64); 5], turbidity: f64, zenith: f64, sun_theta: f64) -> Distribution {
        let coefficients = coefficients.map(|(slope, constant)| slope * turbidity + constant);
        // [eq. 4]: the function at the zenith itself, where cos theta = 1 and gamma = theta_s.
        Distribution { coefficients, factor: zenith / perez(coefficients, 1.0, sun_theta) }
    }

    fn at(&self, cos_theta: f64, gamma: f64) -> f64 {
        self.factor * perez(self.coefficients, cos_theta, gamma)
    }
}

/// The distribution of [Perez et al. 1993], as in [eq. 3].
fn perez([a, b, c, d, e]: [f64; 5], cos_theta: f64, gamma: f64) -> f64 {
    (1.0 + a * (b / cos_theta).exp()) * (1.0 + c * (d * gamma).exp() + e * gamma.cos().powi(2))
}

impl Sky {
    /// The sky of a turbidity with the sun at an angle from the zenith below 90 degrees.
    pub(super) fn new(turbidity: f64, sun_theta: f64) -> Sky {
        let t = turbidity;
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * sun_theta);
        // kcd/m² [appendix 2].
        let luminance = (4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192;
        let zenith = |rows: [[f64; 4]; 3]| {
            let [square, linear, constant] =
                rows.map(|row| row.iter().fold(0.0, |sum, coefficient| sum * sun_theta + coefficient));
            (square * t + linear) * t + constant
        };
        Sky {
            luminance: Distribution::new(LUMINANCE, t, 1e3 * luminance / LUMINANCE_OF_ONE, sun_theta),
            x: Distribution::new(X, t, zenith(ZENITH_X), sun_theta),
            y: Distribution::new(Y, t, zenith(ZENITH_Y), sun_theta),
        }
    }

    /// Radiance above the horizon, where `cos_theta` is positive, at the angle `gamma` from the sun; linear RGB, of which a
    /// component outside of the gamut is negative.
    pub(super) fn radiance(&self, cos_theta: f64, gamma: f64) -> DVec3 {
        let [luminance, x, y] = [&self.luminance, &self.x, &self.y].map(|d| d.at(cos_theta, gamma));
        from_xyz(DVec3::new(x, y, 1.0 - x - y) * (luminance / y))
    }
}
