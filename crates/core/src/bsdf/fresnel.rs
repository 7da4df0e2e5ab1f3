//! Reflectance of smooth boundaries for unpolarised light.

use super::ConductorFresnel;
use crate::rgb::Rgb;

/// Reflectance of a dielectric boundary in `[0, 1]`. `cos` is the cosine to the normal on the side of the known
/// direction, `eta` the index of refraction on the other side over that on its own. Total internal reflection gives 1;
/// `eta` of exactly 1 gives 0 at every angle.
#[inline]
pub fn dielectric(cos: f32, eta: f32) -> f32 {
    if eta == 1.0 {
        return 0.0;
    }
    let cos = cos.abs();
    let transmitted2 = scaled_transmitted_cos2(cos, eta);
    if transmitted2 <= 0.0 {
        return 1.0;
    }
    // The Fresnel formulas [Born and Wolf 1999, sec. 1.5.2, eq. 21], both cosines times eta.
    let transmitted = transmitted2.sqrt();
    let perpendicular = (cos - transmitted) / (cos + transmitted);
    let parallel = (eta * eta * cos - transmitted) / (eta * eta * cos + transmitted);
    (0.5 * (perpendicular * perpendicular + parallel * parallel)).min(1.0)
}

/// `(eta cos_t)²` by Snell's law; zero or less for total internal reflection. `eta² - 1` is a product, so that an `eta`
/// near 1 keeps its digits.
#[inline]
pub(super) fn scaled_transmitted_cos2(cos: f32, eta: f32) -> f32 {
    (eta - 1.0) * (eta + 1.0) + cos * cos
}

/// Reflectance in `[0, 1]` of a dielectric boundary for light that arrives evenly from the whole hemisphere: the mean of
/// [`dielectric`] weighted with the cosine. A fit, within 0.003 for `eta` from 0.5 to 2, and the one that other
/// renderers' coats are made of, so that coats agree with theirs.
pub fn diffuse(eta: f32) -> f32 {
    let inverse = 1.0 / eta;
    if eta >= 1.0 {
        // [d'Eon and Irving 2011]
        [-1.368_81, 4.985_54, -7.809_89, 6.753_35, -3.479_3, 0.919_317].iter().fold(0.0, |sum, c| sum * inverse + c)
    } else if inverse <= LARGEST_FITTED {
        // [Egan and Hilgeman 1973]
        0.0636 * inverse + 0.6681 + eta * (0.7099 - 1.4399 * eta)
    } else {
        // The fit would exceed 1. As much light enters as leaves, over solid angles eta² apart.
        1.0 - (1.0 - diffuse(inverse)) * eta * eta
    }
}

/// The index of refraction up to which [`diffuse`] takes the fit of Egan and Hilgeman from inside; it is 0.006 too high there.
const LARGEST_FITTED: f32 = 2.5;

/// Reflectance in `[0, 1]` of a conductor of index of refraction `eta + i k`, both relative to the outside.
#[inline]
pub fn conductor(cos: f32, eta: f32, k: f32) -> f32 {
    // [Born and Wolf 1999, sec. 14.2], with `a² + b²` the modulus of (eta + ik)² - sin².
    let cos = cos.abs().min(1.0);
    let cos2 = cos * cos;
    let sin2 = (1.0 - cos) * (1.0 + cos);
    // eta² - k² - sin², the terms that cancel for eta near 1 together.
    let real = (eta - 1.0) * (eta + 1.0) + cos2 - k * k;
    let imaginary = 2.0 * eta * k;
    let modulus = (real * real + imaginary * imaginary).sqrt();
    // (modulus + real) / 2, for negative `real` without the cancellation.
    let a2 = if real >= 0.0 { 0.5 * (modulus + real) } else { 0.5 * imaginary * (imaginary / (modulus - real)) };
    let two_a_cos = 2.0 * a2.sqrt() * cos;
    let perpendicular = ratio(modulus + cos2 - two_a_cos, modulus + cos2 + two_a_cos);
    let parallel = perpendicular
        * ratio(cos2 * modulus + sin2 * sin2 - two_a_cos * sin2, cos2 * modulus + sin2 * sin2 + two_a_cos * sin2);
    (0.5 * (perpendicular + parallel)).clamp(0.0, 1.0)
}

/// A quotient whose limit is 1 where both sides vanish: grazing incidence.
#[inline]
fn ratio(a: f32, b: f32) -> f32 {
    if b > 0.0 { a / b } else { 1.0 }
}

impl ConductorFresnel {
    /// With every reflectance multiplied by a colour.
    #[inline]
    pub fn tinted(self, color: Rgb) -> ConductorFresnel {
        match self {
            ConductorFresnel::Constant(reflectance) => ConductorFresnel::Constant(reflectance * color),
            ConductorFresnel::Complex { eta, k, tint } => ConductorFresnel::Complex { eta, k, tint: tint * color },
        }
    }

    /// The reflectance at the cosine `cos` to the normal.
    #[inline]
    pub fn reflectance(&self, cos: f32) -> Rgb {
        match *self {
            ConductorFresnel::Constant(reflectance) => reflectance,
            ConductorFresnel::Complex { eta, k, tint } => {
                tint * Rgb::new(conductor(cos, eta.r, k.r), conductor(cos, eta.g, k.g), conductor(cos, eta.b, k.b))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dielectric_matches_known_values() {
        // Normal incidence: ((eta - 1) / (eta + 1))².
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-7);
        assert!((dielectric(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-7);
        // Brewster's angle: the parallel part vanishes, the perpendicular part is ((eta² - 1) / (eta² + 1))².
        let eta = 1.5f32;
        let brewster = (1.0 / (1.0 + eta * eta)).sqrt();
        let perpendicular = ((eta * eta - 1.0) / (eta * eta + 1.0)).powi(2);
        assert!((dielectric(brewster, eta) - 0.5 * perpendicular).abs() < 1e-6);
        // Grazing, and beyond the critical angle.
        assert_eq!(dielectric(0.0, 1.5), 1.0);
        let critical = (1.0 - 1.0 / (eta * eta)).sqrt();
        assert_eq!(dielectric(critical - 1e-4, 1.0 / eta), 1.0);
        assert!(dielectric(critical + 1e-4, 1.0 / eta) < 1.0);
    }

    #[test]
    fn dielectric_is_the_same_along_the_refracted_path() {
        // From the inside, grazing angles lie within rounding of the critical angle.
        for i in 100..1000 {
            let cos = i as f32 / 1000.0;
            for eta in [1.01f32, 1.33, 1.5, 2.4] {
                let transmitted = scaled_transmitted_cos2(cos, eta).sqrt() / eta;
                assert!((dielectric(cos, eta) - dielectric(transmitted, 1.0 / eta)).abs() < 1e-5, "{cos} {eta}");
            }
        }
    }

    #[test]
    fn diffuse_reflectance_is_the_mean_over_the_hemisphere() {
        for (eta, outside, inside) in [
            (1.0f32, 3e-4, 3e-3),
            (1.1, 3e-4, 1e-3),
            (1.33, 3e-4, 1e-3),
            (1.5, 3e-4, 1e-3),
            (2.0, 3e-4, 1e-3),
            (2.5, 3e-4, 6e-3),
            (2.6, 3e-4, 3e-4),
            (10.0, 1e-2, 3e-4),
        ] {
            for (eta, tolerance) in [(eta, outside), (1.0 / eta, inside)] {
                let n = 20_000;
                let mean = |i| {
                    let cos = (f64::from(i) + 0.5) / f64::from(n);
                    2.0 * cos * f64::from(dielectric(cos as f32, eta)) / f64::from(n)
                };
                let mean: f64 = (0..n).map(mean).sum();
                assert!((f64::from(diffuse(eta)) - mean).abs() < tolerance, "{eta}: {} {mean}", diffuse(eta));
            }
        }
    }

    #[test]
    fn equal_indices_reflect_nothing() {
        for cos in [0.0, f32::MIN_POSITIVE / 8.0, 1e-20, 1e-3, 0.5, 1.0] {
            assert_eq!(dielectric(cos, 1.0), 0.0);
        }
    }

    #[test]
    fn conductor_without_extinction_is_a_dielectric() {
        for i in 0..=1000 {
            let cos = i as f32 / 1000.0;
            for eta in [1.2f32, 1.5, 3.0] {
                assert!((conductor(cos, eta, 0.0) - dielectric(cos, eta)).abs() < 1e-5, "{cos} {eta}");
            }
        }
    }

    #[test]
    fn conductor_matches_the_complex_formula() {
        // The Fresnel formulas with complex numbers in f64, by hand: (re, im) pairs.
        type C = (f64, f64);
        let mul = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let norm2 = |a: C| a.0 * a.0 + a.1 * a.1;
        for (eta, k) in [(0.2, 3.9), (0.001, 2.0), (1.5, 1.9), (3.0, 0.01), (1.0, 0.0), (5.0, 40.0)] {
            for i in 1..=1000 {
                let cos = i as f64 / 1000.0;
                let n2 = mul((eta, k), (eta, k));
                let root2 = (n2.0 - (1.0 - cos * cos), n2.1);
                let modulus = norm2(root2).sqrt();
                let root = (((modulus + root2.0) / 2.0).max(0.0).sqrt(), ((modulus - root2.0) / 2.0).max(0.0).sqrt());
                let s = norm2((cos - root.0, -root.1)) / norm2((cos + root.0, root.1));
                let (nc, sum) = ((n2.0 * cos, n2.1 * cos), root);
                let p = norm2((nc.0 - sum.0, nc.1 - sum.1)) / norm2((nc.0 + sum.0, nc.1 + sum.1));
                let got = f64::from(conductor(cos as f32, eta as f32, k as f32));
                assert!((got - 0.5 * (s + p)).abs() < 3e-6, "{eta} {k} {cos}: {got} against {}", 0.5 * (s + p));
            }
        }
    }
}
