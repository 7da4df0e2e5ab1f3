//! Values of the coated and the principled lobes against another renderer's.

use crate::{direction, figures::*};
use etendue_core::{
    bsdf::{Bsdf, Distribution, Lobe, Plastic, Principled, PrincipledThin, RoughPlastic, TransportMode},
    has,
    rgb::Rgb,
    warp::ONE_MINUS_EPSILON,
};
use glam::Vec2;

const DIFFUSE: Rgb = Rgb::new(0.8, 0.5, 0.1);
const SPECULAR: Rgb = Rgb::new(1.0, 0.9, 0.7);

/// What Mitsuba takes where nothing is said.
pub(crate) const PRINCIPLED: Principled = Principled {
    base_color: DIFFUSE,
    roughness: 0.5,
    anisotropic: 0.0,
    metallic: 0.0,
    spec_trans: 0.0,
    eta: 1.5,
    spec_tint: 0.0,
    sheen: 0.0,
    sheen_tint: 0.0,
    flatness: 0.0,
    clearcoat: 0.0,
    clearcoat_gloss: 0.0,
};

/// As [`PRINCIPLED`], for a thin sheet.
pub(crate) const THIN: PrincipledThin = PrincipledThin {
    base_color: DIFFUSE,
    roughness: 0.5,
    anisotropic: 0.0,
    spec_trans: 0.0,
    eta: 1.5,
    spec_tint: 0.0,
    sheen: 0.0,
    sheen_tint: 0.0,
    flatness: 0.0,
    diff_trans: 0.0,
};

/// Everything at once, with transmission.
pub(crate) fn principled_all() -> Principled {
    Principled {
        base_color: Rgb::new(0.9, 0.7, 0.4),
        roughness: 0.7,
        anisotropic: 0.3,
        metallic: 0.2,
        spec_trans: 0.6,
        eta: 1.33,
        spec_tint: 0.5,
        sheen: 0.3,
        sheen_tint: 0.2,
        flatness: 0.5,
        clearcoat: 0.5,
        clearcoat_gloss: 0.9,
    }
}

/// Whatever only reflects.
pub(crate) fn principled_coated() -> Principled {
    Principled {
        base_color: Rgb::new(0.1, 0.3, 0.7),
        roughness: 0.6,
        metallic: 0.3,
        clearcoat: 1.0,
        clearcoat_gloss: 0.2,
        sheen: 0.8,
        sheen_tint: 0.6,
        spec_tint: 0.7,
        flatness: 0.4,
        eta: 1.4,
        ..PRINCIPLED
    }
}

/// A thin sheet with everything at once.
pub(crate) fn thin_all() -> PrincipledThin {
    PrincipledThin {
        base_color: Rgb::new(0.9, 0.7, 0.4),
        roughness: 0.6,
        spec_trans: 0.6,
        spec_tint: 0.4,
        anisotropic: 0.4,
        sheen: 0.3,
        flatness: 0.3,
        eta: 1.3,
        diff_trans: 0.8,
        ..THIN
    }
}

#[track_caller]
fn check(lobe: Lobe, pairs: &[[f64; 4]; 10], expected: &[[f32; 3]; 10], tolerance: f32) {
    let bsdf = Bsdf::single(lobe, false);
    for (&[theta_o, phi_o, theta_i, phi_i], expected) in pairs.iter().zip(expected) {
        let (wo, wi) = (direction(theta_o, phi_o), direction(theta_i, phi_i));
        let value = bsdf.eval(wo, wi, TransportMode::Radiance) * wi.z.abs();
        for c in 0..3 {
            let off = (value[c] - expected[c]).abs();
            assert!(off <= tolerance * expected[c], "{theta_o} {phi_o}, {theta_i} {phi_i}: {value:?} {expected:?}");
        }
    }
}

#[test]
fn plastic_agrees() {
    check(Lobe::Plastic(Plastic::new(1.49, DIFFUSE, SPECULAR, false)), &FRONT, &PLASTIC_LINEAR, 1e-5);
    check(Lobe::Plastic(Plastic::new(1.9, DIFFUSE, SPECULAR, true)), &FRONT, &PLASTIC_NONLINEAR, 1e-5);
}

#[test]
fn rough_plastic_agrees() {
    let plastic = |eta, distribution, alpha, nonlinear| {
        Lobe::RoughPlastic(RoughPlastic::new(eta, (distribution, alpha), DIFFUSE, SPECULAR, nonlinear))
    };
    let (ggx, beckmann) = (Distribution::Ggx, Distribution::Beckmann);
    check(plastic(1.49, beckmann, 0.15, true), &FRONT, &ROUGH_PLASTIC_BECKMANN_NONLINEAR, 2e-4);
    check(plastic(1.7, beckmann, 0.5, false), &FRONT, &ROUGH_PLASTIC_BECKMANN_LINEAR, 2e-4);
    // Mitsuba's own quadrature for its tables has 32 by 32 points, over kinks that its sampling of GGX normals has.
    check(plastic(1.49, ggx, 0.2, false), &FRONT, &ROUGH_PLASTIC_GGX_LINEAR, 1e-3);
    check(plastic(1.7, ggx, 0.45, true), &FRONT, &ROUGH_PLASTIC_GGX_NONLINEAR, 1e-3);
}

#[test]
fn principled_agrees() {
    let metal = Principled { roughness: 0.45, metallic: 1.0, anisotropic: 0.7, ..PRINCIPLED };
    let base_color = Rgb::new(0.9, 0.7, 0.4);
    let glass = Principled { base_color, spec_trans: 1.0, ..PRINCIPLED };
    let bubble = Principled {
        base_color,
        roughness: 0.6,
        spec_trans: 0.7,
        spec_tint: 0.4,
        metallic: 0.1,
        clearcoat: 0.5,
        clearcoat_gloss: 0.4,
        eta: 0.7,
        ..PRINCIPLED
    };
    check(Lobe::Principled(PRINCIPLED), &FRONT, &PRINCIPLED_DEFAULT, 1e-4);
    check(Lobe::Principled(metal), &FRONT, &PRINCIPLED_METAL, 1e-4);
    check(Lobe::Principled(principled_coated()), &FRONT, &PRINCIPLED_COATED, 1e-4);
    check(Lobe::Principled(glass), &BOTH, &PRINCIPLED_GLASS, 1e-4);
    check(Lobe::Principled(principled_all()), &BOTH, &PRINCIPLED_ALL, 1e-4);
    check(Lobe::Principled(bubble), &BOTH, &PRINCIPLED_BUBBLE, 1e-4);
}

#[test]
fn thin_principled_agrees() {
    let leaf = PrincipledThin {
        base_color: Rgb::new(0.2, 0.6, 0.1),
        roughness: 0.7,
        diff_trans: 1.2,
        sheen: 0.5,
        sheen_tint: 0.7,
        flatness: 0.6,
        ..THIN
    };
    let glass = PrincipledThin {
        base_color: Rgb::new(0.9, 0.7, 0.4),
        spec_trans: 1.0,
        spec_tint: 0.4,
        anisotropic: 0.4,
        ..THIN
    };
    check(Lobe::PrincipledThin(leaf), &SHEET, &THIN_LEAF, 1e-4);
    check(Lobe::PrincipledThin(glass), &SHEET, &THIN_GLASS, 1e-4);
    check(Lobe::PrincipledThin(thin_all()), &SHEET, &THIN_ALL, 1e-4);
}

#[test]
fn thin_dielectric_agrees() {
    let transmittance = Rgb::new(0.8, 0.6, 0.9);
    let bsdf = Bsdf::single(Lobe::ThinDielectric { eta: 1.5, reflectance: SPECULAR, transmittance }, false);
    for (theta, reflected, transmitted) in THIN_DIELECTRIC {
        let wo = direction(theta, 30.0);
        for (u, expected) in [(0.0, reflected), (ONE_MINUS_EPSILON, transmitted)] {
            let s = bsdf.sample::<{ has::ALL }>(wo, u, Vec2::splat(0.5), TransportMode::Radiance).unwrap();
            let energy = s.weight * s.pdf_w;
            assert!((0..3).all(|c| (energy[c] - expected[c]).abs() < 1e-6), "{theta} {u}: {energy:?} {expected:?}");
            let reflection = glam::Vec3::new(-wo.x, -wo.y, wo.z);
            assert_eq!(s.wi, if u == 0.0 { reflection } else { -wo });
        }
    }
}
