//! White furnaces: what must come out is known exactly, or by quadrature.

use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Lobe, Roughness, TransportMode},
    filter::Filter,
    has,
    material::Material,
    rgb::Rgb,
    scene::*,
    statistics::moments::Moments,
    technique::TechniqueInfo,
};
use etendue_tests::{Run, aiming, bias_allowance, limit, small::*};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::PI;
use xtask::techniques::TECHNIQUES;

/// Every technique's image mean is `expected` within its standard error.
fn shines(name: &str, scene: &SceneDescription, depth: u32, expected: f64) {
    shines_by(TECHNIQUES.iter().copied(), name, scene, depth, expected);
}

/// The image mean of some techniques.
fn shines_by<'a>(
    techniques: impl Iterator<Item = &'a TechniqueInfo>,
    name: &str,
    scene: &SceneDescription,
    depth: u32,
    expected: f64,
) {
    for technique in techniques {
        let run = Run::of(scene, Filter::Box, depth);
        let mut means = Moments::default();
        for seed in 0..16 {
            let image = run.film(technique, seed, 0..64).mean_image();
            means.push(image.iter().map(|c: &Rgb| f64::from(c.g)).sum::<f64>() / image.len() as f64);
        }
        // Where there is no noise, single precision leaves a few roundings.
        let error = means.standard_error().hypot(3e-6 * expected);
        let z = (means.mean() - expected) / error;
        println!("{name}, {}: {:.6} against {expected:.6}, {z:.2} standard errors", technique.name, means.mean());
        let allowed = limit(means.count()) + bias_allowance(technique) * expected / error;
        assert!(z.abs() < allowed, "{name}, {}: {} against {expected}", technique.name, means.mean());
    }
}

/// A ball of a material under a constant sky of radiance 1, filling the view.
fn ball(made_of: Material) -> SceneDescription {
    let scene = SceneDescription {
        name: "ball".into(),
        camera: Some(orthographic(DVec3::Z * 3.0, DVec3::ZERO, DVec3::Y, 1.2, 8)),
        materials: vec![material("ball", made_of)],
        objects: vec![sphere("ball", DVec3::ZERO, 1.0, 0)],
        ..SceneDescription::default()
    };
    under_sky(scene, 1.0)
}

#[test]
fn a_closed_lambert_furnace_is_a_geometric_series() {
    for (reflectance, emission, depth) in [(0.5f32, 0.5f32, 20u32), (0.8, 0.2, 12), (0.0, 1.0, 5), (1.0, 0.125, 8)] {
        let shape = ObjectShape::Sphere { center: DVec3::ZERO, radius: 1.0, inverted: true };
        let scene = SceneDescription {
            name: "furnace".into(),
            camera: Some(pinhole(DVec3::new(0.1, 0.2, -0.3), DVec3::new(0.4, 0.5, 0.6), 1.2, 8)),
            materials: vec![grey(reflectance)],
            objects: vec![emitting(object("walls", shape, glam::DAffine3::IDENTITY, 0), emission)],
            ..SceneDescription::default()
        };
        let expected: f64 = (0..depth).map(|k| f64::from(emission) * f64::from(reflectance).powi(k as i32)).sum();
        shines(&format!("lambert {reflectance}"), &scene, depth, expected);
    }
}

#[test]
fn a_white_mirror_and_clear_glass_vanish_in_a_furnace() {
    let mirror = Material::conductor(ConductorFresnel::Constant(Rgb::WHITE), None);
    shines("mirror", &ball(mirror), 8, 1.0);
    // Light may go round inside the glass many times; what the depth bound cuts is far below the noise.
    for eta in [1.5, 1.0 / 1.5, 1.0, 2.4] {
        shines(&format!("glass {eta}"), &ball(Material::dielectric(eta, None)), 200, 1.0);
    }
}

/// Directional albedo of a lobe: the integral of `f |cos wi|` over all directions, in a grid that is fine where the lobe is.
///
/// The half-vector's slopes are the grid's coordinates: with `m` the microfacet normal, the mirrored direction covers the
/// solid angle `4 |wo.m| dm`, and `dm = cos³(m) dslope` [Walter et al. 2007, eq. 14; Heitz 2014, eq. 2].
fn conductor_albedo(lobe: Lobe, wo: Vec3, alpha: Vec2) -> f64 {
    let bsdf = etendue_core::bsdf::Bsdf { first: lobe, second: None, two_sided: false };
    // Slopes reach as far as the distribution's tail: radius alpha tan(t), t up to nearly a right angle.
    let (radial, angular) = (2000, 720);
    let mut sum = 0.0;
    for i in 0..radial {
        let t = (f64::from(i) + 0.5) / f64::from(radial) * PI / 2.0;
        let r = t.tan();
        let dr = PI / 2.0 / f64::from(radial) / t.cos().powi(2);
        for j in 0..angular {
            let phi = (f64::from(j) + 0.5) / f64::from(angular) * 2.0 * PI;
            let slope = (f64::from(alpha.x) * r * phi.cos(), f64::from(alpha.y) * r * phi.sin());
            let m = DVec3::new(-slope.0, -slope.1, 1.0).normalize();
            let wo = wo.as_dvec3();
            let wi = m * (2.0 * wo.dot(m)) - wo;
            if wo.dot(m) <= 0.0 || wi.z <= 0.0 {
                continue;
            }
            let slope_area = f64::from(alpha.x * alpha.y) * r * dr * (2.0 * PI / f64::from(angular));
            let solid_angle = 4.0 * wo.dot(m) * m.z.powi(3) * slope_area;
            let f = bsdf.eval_pdf::<{ has::ALL }>(wo.as_vec3(), wi.as_vec3(), TransportMode::Radiance).0;
            sum += f64::from(f.g) * wi.z * solid_angle;
        }
    }
    sum
}

#[test]
fn rough_metal_shows_its_directional_albedo() {
    let fresnel = ConductorFresnel::Constant(Rgb::WHITE);
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for alpha in [Vec2::splat(0.05), Vec2::splat(0.3), Vec2::splat(1.0), Vec2::new(0.1, 0.5)] {
            for angle in [0.2f64, 1.0, 1.4] {
                let roughness = Roughness { distribution, alpha };
                let wo = Vec3::new(angle.sin() as f32, 0.0, angle.cos() as f32);
                let expected = conductor_albedo(Lobe::RoughConductor { fresnel, roughness }, wo, alpha);
                // A plane seen in parallel at one angle: nothing of it sees the rest of it. Texture coordinates make its
                // tangent, and the camera stands on the tangent's side.
                let scene = SceneDescription {
                    name: "plane".into(),
                    camera: Some(orthographic(wo.as_dvec3() * 3.0, DVec3::ZERO, DVec3::Y, 0.1, 4)),
                    materials: vec![material("metal", Material::conductor(fresnel, Some(roughness)))],
                    objects: vec![rectangle("plane", DVec3::ZERO, DVec3::Z, (20.0, 20.0), 0)],
                    ..SceneDescription::default()
                };
                let name = format!("{distribution:?} {alpha} at {angle}: single scattering keeps {expected:.4}");
                shines_by(aiming(), &name, &under_sky(scene, 1.0), 2, expected);
            }
        }
    }
}
