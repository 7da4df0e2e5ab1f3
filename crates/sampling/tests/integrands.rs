//! The integrals that integrands claim, against sums over their values.

use etendue_core::{
    independent::Independent,
    sampler::{Purpose, Sampler},
    statistics::moments::Moments,
};
use etendue_sampling::integrands::{Integrand, LightShape};
use glam::DVec2;

/// Points and weights of Gauss's rule of five points on `[0, 1]` [Abramowitz and Stegun 1964, table 25.4].
const GAUSS: [(f64, f64); 5] = [
    (0.046910077030668, 0.1184634425280945),
    (0.2307653449471585, 0.2393143352496832),
    (0.5, 0.2844444444444444),
    (0.7692346550528415, 0.2393143352496832),
    (0.953089922969332, 0.1184634425280945),
];

/// The rule in every dimension.
fn gauss(integrand: Integrand, x: &mut Vec<f64>) -> f64 {
    if x.len() == integrand.dimensions() {
        return integrand.evaluate(x);
    }
    let mut sum = 0.0;
    for (point, weight) in GAUSS {
        x.push(point);
        sum += weight * gauss(integrand, x);
        x.pop();
    }
    sum
}

/// The midpoint rule on a square.
fn midpoints(side: u32, f: impl Fn(DVec2) -> f64) -> f64 {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let row = |y: u32| (0..side).map(|x| f(DVec2::new(at(x), at(y)))).sum::<f64>();
    (0..side).map(row).sum::<f64>() / f64::from(side).powi(2)
}

/// The irradiance next to the penumbra.
fn open(shape: LightShape) -> f64 {
    shape.irradiance(DVec2::new(0.1, 0.25))
}

#[test]
fn smooth_products() {
    use Integrand::*;
    for integrand in [Smooth1, Smooth2, Product4, Product6, Product8] {
        let found = gauss(integrand, &mut Vec::new());
        assert!((found / integrand.exact() - 1.0).abs() < 1e-10, "{integrand:?}: {found}");
    }
}

#[test]
fn integrands_of_two_dimensions() {
    use Integrand::*;
    // The midpoint rule errs by its spacing squared where all is smooth, and by its power of 3/2 or so on an edge.
    for (integrand, tolerance) in [
        (Gaussian, 1e-7),
        (Edge, 1e-5),
        (Corner, 1e-5),
        (Disk, 1e-5),
        (Light(LightShape::Square), 1e-5),
        (Light(LightShape::Round), 1e-5),
    ] {
        let found = midpoints(2048, |p| integrand.evaluate(&p.to_array()));
        let error = (found / integrand.exact() - 1.0).abs();
        assert!(error < tolerance, "{integrand:?}: {found} against {}", integrand.exact());
    }
    let line = Light(LightShape::Linear);
    let n = 1_000_000;
    let found = (0..n).map(|i| line.evaluate(&[(f64::from(i) + 0.5) / f64::from(n)])).sum::<f64>() / f64::from(n);
    assert!((found / line.exact() - 1.0).abs() < 1e-6, "{found} against {}", line.exact());
}

#[test]
fn the_irradiance_of_lights_in_umbra_penumbra_and_open() {
    for shape in LightShape::ALL {
        assert_eq!(shape.irradiance(DVec2::new(0.0, -0.5)), 0.0);
        let mut before = 0.0;
        for step in 0..20 {
            let point = DVec2::new(0.1, -0.25 + 0.025 * f64::from(step));
            let exact = shape.irradiance(point);
            let found = midpoints(512, |u| shape.sample(point, u));
            assert!((found - exact).abs() < 2e-3 * open(shape), "{shape:?} at {point}: {found} {exact}");
            assert!(exact >= before || point.y > 0.0, "{shape:?} at {point}");
            before = exact;
        }
        // Open, it is nearly the light's measure.
        let measure = [0.3, 0.09, 0.0908][shape as usize];
        assert!(open(shape) < measure && open(shape) > 0.8 * measure, "{shape:?}: {}", open(shape));
    }
}

/// A pixel is the mean of its quarters' quarters: the quadrature has converged.
#[test]
fn the_light_on_pixels_is_exact() {
    let corner = DVec2::new(0.02, -0.05);
    let side = 0.0625;
    for shape in LightShape::ALL {
        for corner in [corner, DVec2::new(0.1, -0.26), DVec2::new(-0.2, 0.2), DVec2::new(0.03, 0.12)] {
            let whole = shape.pixel_irradiance(corner, side);
            let parts: f64 = (0..16)
                .map(|i| {
                    shape.pixel_irradiance(
                        corner + 0.25 * side * DVec2::new(f64::from(i % 4), f64::from(i / 4)),
                        0.25 * side,
                    )
                })
                .sum();
            // Where the edge touches a round light, what is seen of it grows as a power of 3/2, which no polynomial does.
            let tolerance = if shape == LightShape::Round { 1e-8 } else { 1e-13 } * open(shape);
            assert!((parts / 16.0 - whole).abs() < tolerance, "{shape:?} at {corner}: {parts} {whole}");
            let sampled = midpoints(32, |u| shape.irradiance(corner + side * u));
            assert!((sampled - whole).abs() < 1e-4 * open(shape), "{shape:?} at {corner}: {sampled} {whole}");
        }
    }
}

#[test]
fn the_light_on_a_pixel_by_monte_carlo() {
    for shape in LightShape::ALL {
        let integrand = Integrand::PixelAndLight(shape);
        let mut sampler = Independent::new(6);
        let estimate: Moments = (0..1_000_000)
            .map(|i| {
                sampler.start_sample(i, 0);
                let (pixel, light) = (sampler.get_2d(0, Purpose::Film), sampler.get_2d(0, Purpose::LightPoint));
                integrand.evaluate(&[pixel.x, pixel.y, light.x, light.y].map(f64::from))
            })
            .collect();
        let z = (estimate.mean() - integrand.exact()) / estimate.standard_error();
        assert!(z.abs() < 4.0, "{shape:?}: {} against {}", estimate.mean(), integrand.exact());
        // Neither dark nor open: it varies by more than the cosines do.
        assert!(estimate.variance().sqrt() > 0.3 * estimate.mean(), "{shape:?}");
    }
}

#[test]
fn names_are_unique_and_coordinates_beyond_are_ignored() {
    for (i, integrand) in Integrand::ALL.into_iter().enumerate() {
        assert!(Integrand::ALL[..i].iter().all(|other| other.name() != integrand.name()));
        let x = [0.3, 0.4, 0.45, 0.6, 0.2, 0.1, 0.8, 0.7, 0.5, 0.9];
        assert_eq!(integrand.evaluate(&x), integrand.evaluate(&x[..integrand.dimensions()]));
        assert!(integrand.exact() > 0.0 && integrand.exact().is_finite());
    }
}
