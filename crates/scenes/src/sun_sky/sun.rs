//! The sun, seen through the atmosphere [Preetham, Shirley, Smits 1999, appendix 1].

use super::from_xyz;
use glam::DVec3;

/// Radiance of the sun outside of the atmosphere, W/(m² sr nm), at 380, 390 ... 750 nm [table 2].
const OUTSIDE: [f64; 38] = [
    16559.0, 16233.7, 21127.5, 25888.2, 25829.1, 24232.3, 26760.5, 29658.3, 30545.4, 30057.5, 30663.7, 28830.4,
    28712.1, 27825.0, 27100.6, 27233.6, 26361.3, 25503.8, 25060.2, 25311.6, 25355.9, 25134.2, 24631.5, 24173.2,
    23685.3, 23212.1, 22827.7, 22339.8, 21970.2, 21526.7, 21097.9, 20728.3, 20240.4, 19870.8, 19427.2, 19072.4,
    18628.9, 18259.2,
];

/// Attenuation by ozone, per cm, at the same wavelengths [table 2].
const OZONE: [f64; 38] = [
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.003, 0.006, 0.009, 0.014, 0.021, 0.03, 0.04, 0.048, 0.063, 0.075, 0.085,
    0.103, 0.12, 0.12, 0.115, 0.125, 0.12, 0.105, 0.09, 0.079, 0.067, 0.057, 0.048, 0.036, 0.028, 0.023, 0.018, 0.014,
    0.011, 0.010, 0.009,
];

/// Attenuation by water vapour, per cm, at the same wavelengths [table 2].
const WATER: [f64; 38] = [
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.016, 0.024, 0.0125, 1.0, 0.87, 0.061, 0.001,
];

/// Thickness of the ozone and of the water vapour, cm [appendix 1].
const OZONE_THICKNESS: f64 = 0.35;
const WATER_THICKNESS: f64 = 2.0;

/// Radiance of the sun at an angle from the zenith below 90 degrees, the same all over its disc, in linear RGB.
pub(super) fn radiance(turbidity: f64, theta: f64) -> DVec3 {
    // The air on the way, over that towards the zenith [appendix 1].
    let mass = 1.0 / (theta.cos() + 0.15 * (93.885 - theta.to_degrees()).powf(-1.253));
    // Angstrom's turbidity coefficient and wavelength exponent.
    let (beta, alpha) = (0.04608 * turbidity - 0.04586, 1.3);
    let mut sum = DVec3::ZERO;
    let mut efficiency = 0.0;
    for (i, outside) in OUTSIDE.iter().enumerate() {
        let nanometres = 380.0 + 10.0 * i as f64;
        let micrometres = 1e-3 * nanometres;
        let rayleigh = 0.008735 * micrometres.powf(-4.08) * mass;
        let aerosol = beta * micrometres.powf(-alpha) * mass;
        let ozone = OZONE[i] * OZONE_THICKNESS * mass;
        let vapour = WATER[i] * WATER_THICKNESS * mass;
        let water = 0.2385 * vapour / (1.0 + 20.07 * vapour).powf(0.45);
        // The mixed gases absorb beyond 750 nm only.
        let arriving = outside * (-(rayleigh + aerosol + ozone + water)).exp();
        let matching = color_matching(nanometres);
        sum += matching * arriving;
        efficiency += matching.y;
    }
    from_xyz(sum / efficiency)
}

/// The CIE's colour matching functions of 1931, fitted [Wyman, Sloan, Shirley 2013, eq. 4].
fn color_matching(wavelength: f64) -> DVec3 {
    let lobe = |height: f64, at: f64, left: f64, right: f64| {
        let t = (wavelength - at) / if wavelength < at { left } else { right };
        height * (-0.5 * t * t).exp()
    };
    DVec3::new(
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    )
}
