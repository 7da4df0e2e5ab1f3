//! Lobes of several parts: coats over bodies, the principled materials, masks.

use crate::{
    Uniform,
    agreement::{PRINCIPLED, THIN, principled_all, principled_coated, thin_all},
    chart::{Case, Chart},
    direction,
    statistics::{CELLS, check},
};
use etendue_core::{
    bsdf::{
        Bsdf, BsdfSample, Distribution, Lobe, Plastic, Principled, PrincipledThin, RoughPlastic, Roughness,
        TransportMode,
    },
    has,
    material::{Material, Relief},
    rgb::Rgb,
    texture::TexturePoint,
    warp::ONE_MINUS_EPSILON,
};
use glam::{DVec2, Vec2, Vec3};

const GREY: Rgb = Rgb::splat(0.5);
const MODE: TransportMode = TransportMode::Radiance;

pub(crate) fn plastic(eta: f32, diffuse: Rgb, nonlinear: bool) -> Lobe {
    Lobe::Plastic(Plastic::new(eta, diffuse, Rgb::WHITE, nonlinear))
}

pub(crate) fn rough_plastic(distribution: Distribution, alpha: f32, eta: f32, diffuse: Rgb) -> Lobe {
    Lobe::RoughPlastic(RoughPlastic::new(eta, (distribution, alpha), diffuse, Rgb::WHITE, true))
}

/// What microfacet roughness a principled material has.
fn alphas(roughness: f32, anisotropic: f32) -> DVec2 {
    let (squared, aspect) = (f64::from(roughness).powi(2), (1.0 - 0.9 * f64::from(anisotropic)).sqrt());
    DVec2::new(squared / aspect, squared * aspect).max(DVec2::splat(1e-3))
}

fn plastics() -> Vec<(String, Lobe, Vec<Chart>)> {
    let mut lobes = Vec::new();
    for eta in [1.0, 1.5, 0.7] {
        lobes.push((format!("plastic {eta}"), plastic(eta, GREY, false), vec![Chart::Sphere]));
    }
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        // A narrow lobe and a diffuse body do not fit the same chart.
        for (alpha, eta, diffuse) in
            [(1e-4, 1.5, Rgb::BLACK), (0.01, 1.5, Rgb::BLACK), (0.1, 1.5, GREY), (0.3, 1.5, GREY), (1.0, 0.7, GREY)]
        {
            lobes.push((
                format!("rough plastic {distribution:?} {alpha} {eta}"),
                rough_plastic(distribution, alpha, eta, diffuse),
                vec![Chart::Reflect(DVec2::splat(f64::from(alpha)))],
            ));
        }
    }
    lobes
}

fn principled() -> Vec<(String, Lobe, Vec<Chart>)> {
    let metal = Principled { metallic: 1.0, ..PRINCIPLED };
    let glass = Principled { spec_trans: 1.0, ..PRINCIPLED };
    let opaque = [
        ("default", PRINCIPLED),
        ("coated", principled_coated()),
        ("stretched metal", Principled { anisotropic: 0.9, ..metal }),
        ("polished metal", Principled { roughness: 0.0, ..metal }),
        // The coat is as narrow as the base.
        ("polished, coated metal", Principled { roughness: 0.0, clearcoat: 1.0, clearcoat_gloss: 1.0, ..metal }),
        ("coated metal", Principled { roughness: 0.1f32.sqrt(), clearcoat: 1.0, ..metal }),
        ("black cloth", Principled { base_color: Rgb::BLACK, sheen: 1.0, roughness: 1.0, ..PRINCIPLED }),
        ("flat", Principled { flatness: 1.0, roughness: 1.0, ..PRINCIPLED }),
    ];
    let clear = [
        ("everything", Principled { clearcoat_gloss: 0.0, ..principled_all() }),
        ("glass", glass),
        ("polished glass", Principled { roughness: 0.0, ..glass }),
        ("sheer glass", Principled { sheen: 1.0, eta: 1.2, ..glass }),
        ("bubble", Principled { eta: 1.0 / 1.5, ..glass }),
        ("air", Principled { eta: 1.0, roughness: 0.8, ..glass }),
    ];
    let mut lobes = Vec::new();
    for (name, p) in opaque {
        let charts = vec![Chart::Reflect(alphas(p.roughness, p.anisotropic))];
        lobes.push((name.to_string(), Lobe::Principled(p), charts));
    }
    for (name, p) in clear {
        for inside in [false, true] {
            let alpha = alphas(p.roughness, p.anisotropic);
            let eta = f64::from(if p.eta == 1.0 { 1.001f32 } else { p.eta });
            let charts = vec![Chart::Reflect(alpha), Chart::Refract(alpha, if inside { 1.0 / eta } else { eta })];
            lobes.push((format!("{name}{}", if inside { " inside" } else { "" }), Lobe::Principled(p), charts));
        }
    }
    lobes
}

fn sheets() -> Vec<(String, Lobe, Vec<Chart>)> {
    let glass = PrincipledThin { spec_trans: 1.0, ..THIN };
    let sheets = [
        ("paper", PrincipledThin { diff_trans: 1.0, sheen: 1.0, ..THIN }),
        ("gel", PrincipledThin { diff_trans: 2.0, ..THIN }),
        ("everything", thin_all()),
        ("pane", glass),
        ("polished pane", PrincipledThin { roughness: 0.0, ..glass }),
        ("rough, stretched pane", PrincipledThin { roughness: 1.0, anisotropic: 0.9, ..glass }),
        ("dense pane", PrincipledThin { eta: 2.2, ..glass }),
    ];
    let charts = |p: &PrincipledThin| {
        let through = (0.65 * p.eta - 0.35) * p.roughness;
        vec![Chart::Reflect(alphas(p.roughness, p.anisotropic)), Chart::Through(alphas(through, p.anisotropic))]
    };
    sheets.map(|(name, p)| (format!("thin {name}"), Lobe::PrincipledThin(p), charts(&p))).into()
}

/// Each lobe seen from the normal to a tenth of a degree above the horizon; those with transmission from both sides.
fn cases(lobes: Vec<(String, Lobe, Vec<Chart>)>) -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, lobe, charts) in lobes {
        for theta in [0.0, 60.0, 89.9] {
            let wo = direction(theta, if theta > 89.0 { 0.0 } else { 25.0 });
            let wo = if name.contains("inside") { Vec3::new(wo.x, wo.y, -wo.z) } else { wo };
            cases.push(Case {
                name: format!("{name} theta {theta}"),
                bsdf: Bsdf::single(lobe, false),
                wo,
                charts: charts.clone(),
            });
        }
    }
    cases
}

/// Every compound lobe, and masks of some.
pub(crate) fn compound_cases() -> Vec<Case> {
    let mut cases = cases([plastics(), principled(), sheets()].concat());
    cases.extend(masked());
    cases
}

fn masked() -> Vec<Case> {
    let mask = |lobe, opacity| Bsdf { first: Lobe::Null, second: Some((lobe, opacity)), two_sided: true };
    let lambert = Lobe::Lambert { reflectance: GREY };
    [
        ("lambert", mask(lambert, 0.3)),
        ("plastic", mask(plastic(1.5, GREY, true), 0.7)),
        ("principled", mask(Lobe::Principled(Principled { roughness: 1.0, ..PRINCIPLED }), 0.5)),
        ("leaf", mask(Lobe::PrincipledThin(PrincipledThin { diff_trans: 1.0, ..THIN }), 0.9)),
    ]
    .into_iter()
    .flat_map(|(name, bsdf)| {
        [20.0, 80.0, 110.0].map(|theta| Case {
            name: format!("masked {name} theta {theta}"),
            bsdf,
            wo: direction(theta, 25.0),
            charts: vec![Chart::Sphere],
        })
    })
    .collect()
}

#[test]
fn plastics_scatter_as_their_density_says() {
    check(&cases(plastics()), 6000);
}

#[test]
fn principled_materials_scatter_as_their_density_says() {
    check(&cases(principled()), 7000);
}

#[test]
fn thin_principled_materials_scatter_as_their_density_says() {
    check(&cases(sheets()), 8000);
}

#[test]
fn masked_materials_scatter_as_their_density_says() {
    check(&masked(), 9000);
}

fn sample(bsdf: &Bsdf, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
    bsdf.sample::<{ has::ALL }>(wo, u_lobe, u, MODE)
}

/// Directional albedo, the smooth part by its probability.
fn albedo(lobe: Lobe, theta: f64, chart: Chart) -> f64 {
    let (bsdf, wo) = (Bsdf::single(lobe, false), direction(theta, 25.0));
    let case = Case { name: String::new(), bsdf, wo, charts: vec![chart] };
    let delta = sample(&bsdf, wo, 0.0, Vec2::splat(0.5)).filter(|s| s.delta);
    let smooth = delta.map_or(0.0, |s| f64::from(s.weight.r * s.pdf_w));
    case.integrate(CELLS).iter().map(|c| c.albedo).sum::<f64>() + smooth
}

#[test]
fn coats_over_white_bodies_gain_nothing() {
    for theta in [0.0, 60.0, 89.0] {
        for eta in [1.0, 1.3, 1.5, 2.0, 3.0] {
            // The fits of the diffuse reflectance are off by so much.
            let albedo = albedo(plastic(eta, Rgb::WHITE, true), theta, Chart::Sphere);
            assert!((0.999..1.0012).contains(&albedo), "{eta} {theta}: {albedo}");
        }
        for distribution in [Distribution::Ggx, Distribution::Beckmann] {
            for (alpha, eta) in [(0.05, 1.5), (0.2, 1.5), (0.5, 1.5), (1.0, 1.5), (0.3, 2.0)] {
                let chart = Chart::Reflect(DVec2::splat(f64::from(alpha)));
                let albedo = albedo(rough_plastic(distribution, alpha, eta, Rgb::WHITE), theta, chart);
                assert!(albedo < 1.0, "{distribution:?} {alpha} {eta} {theta}: {albedo}");
            }
        }
    }
}

/// The model gains energy; the documentation of the module quotes how much.
#[test]
fn a_white_principled_body_gains_what_the_documentation_says() {
    let table = include_str!("../../src/bsdf/principled.rs");
    for roughness in [0.2f32, 0.5, 1.0] {
        let mut row = format!("//! | {roughness} |");
        for theta in [0.0, 45.0, 60.0, 80.0, 89.0] {
            let lobe = Lobe::Principled(Principled { base_color: Rgb::WHITE, roughness, ..PRINCIPLED });
            let albedo = albedo(lobe, theta, Chart::Reflect(alphas(roughness, 0.0)));
            row += &format!(" {albedo:.2} |");
        }
        assert!(table.contains(&row), "not in the documentation: {row}");
    }
}

#[test]
fn a_thin_sheet_keeps_all_energy_and_looks_the_same_from_both_sides() {
    for eta in [0.5, 1.0, 1.5, 3.0] {
        let bsdf =
            Bsdf::single(Lobe::ThinDielectric { eta, reflectance: Rgb::WHITE, transmittance: Rgb::WHITE }, false);
        assert!(bsdf.is_delta() && bsdf.has_delta());
        for theta in 0..90 {
            let wo = direction(f64::from(theta), 40.0);
            let [above, below] =
                [wo, -wo].map(|wo| [0.0, ONE_MINUS_EPSILON].map(|u| sample(&bsdf, wo, u, Vec2::ZERO).unwrap()));
            assert!(above.iter().chain(&below).all(|s| s.delta && s.eta == 1.0 && s.weight == Rgb::WHITE));
            assert_eq!(above.map(|s| s.pdf_w), below.map(|s| s.pdf_w));
            assert_eq!(above.map(|s| s.wi), below.map(|s| -s.wi));
            // Either both ways are possible, or one has all.
            let total = if above[0].wi == above[1].wi { above[0].pdf_w } else { above[0].pdf_w + above[1].pdf_w };
            assert!((total - 1.0).abs() < 1e-6, "{eta} {theta}: {above:?}");
        }
    }
}

#[test]
fn tints_are_factors_and_white_ones_change_nothing() {
    let (reflectance, transmittance) = (Rgb::new(0.2, 0.5, 1.0), Rgb::new(0.9, 0.0, 0.3));
    let roughness = Roughness { distribution: Distribution::Ggx, alpha: Vec2::splat(0.3) };
    let mut uniform = Uniform::new(10);
    for (clear, tinted) in [
        (Lobe::dielectric(1.5), Lobe::Dielectric { eta: 1.5, reflectance, transmittance }),
        (Lobe::dielectric(1.0), Lobe::Dielectric { eta: 1.0, reflectance, transmittance }),
        (
            Lobe::rough_dielectric(1.5, roughness),
            Lobe::RoughDielectric { eta: 1.5, roughness, reflectance, transmittance },
        ),
    ] {
        let [clear, tinted] = [clear, tinted].map(|lobe| Bsdf::single(lobe, false));
        for i in 0..1000 {
            let wo = direction(f64::from(i % 180), f64::from(i));
            let (u_lobe, u) = (uniform.one(), uniform.two());
            let (Some(c), Some(t)) = (sample(&clear, wo, u_lobe, u), sample(&tinted, wo, u_lobe, u)) else { continue };
            let tint = if c.wi.z * wo.z > 0.0 { reflectance } else { transmittance };
            assert_eq!((t.wi, t.pdf_w, t.delta), (c.wi, c.pdf_w, c.delta));
            let (value, expected) = (tinted.eval(wo, c.wi, MODE), tint * clear.eval(wo, c.wi, MODE));
            for channel in 0..3 {
                assert!((t.weight[channel] - tint[channel] * c.weight[channel]).abs() <= 1e-6 * c.weight[channel]);
                assert_eq!(value[channel], expected[channel]);
            }
        }
    }
}

#[test]
fn smooth_plastic_is_a_mirror_and_a_body() {
    let bsdf = Bsdf::single(plastic(1.5, GREY, false), false);
    assert!(bsdf.has_delta() && !bsdf.is_delta());
    for theta in [0.0, 45.0, 80.0, 89.9] {
        let wo = direction(theta, 25.0);
        let reflectance = etendue_core::bsdf::fresnel::dielectric(wo.z, 1.5);
        let s = sample(&bsdf, wo, 0.0, Vec2::splat(0.3)).unwrap();
        assert!(s.delta && s.wi == Vec3::new(-wo.x, -wo.y, wo.z));
        assert!((s.weight.r * s.pdf_w - reflectance).abs() < 1e-6, "{theta}");
        // Connections do not see the mirror.
        assert!(bsdf.eval(wo, s.wi, MODE).r < 0.5);
        let body = sample(&bsdf, wo, ONE_MINUS_EPSILON, Vec2::splat(0.3)).unwrap();
        assert!(!body.delta);
    }
    let black = Bsdf::single(plastic(1.5, Rgb::BLACK, false), false);
    assert!(black.has_delta() && black.is_delta());
    let dull = Lobe::Plastic(Plastic::new(1.5, GREY, Rgb::BLACK, false));
    assert!(!dull.has_delta() && !dull.is_delta());
}

#[test]
fn masks_let_light_straight_through() {
    let point = TexturePoint { uv: Vec2::ZERO, color: Rgb::WHITE };
    let mask = |opacity: f32| {
        let material = Box::new(Material::lambert(GREY));
        Material::Mask { opacity: opacity.into(), material }.bsdf(&point, true)
    };
    let wo = direction(120.0, 25.0);
    let bsdf = mask(0.25);
    assert!(bsdf.has_delta() && !bsdf.is_delta());
    for (u, through) in [(0.0, false), (0.2499, false), (0.25, true), (ONE_MINUS_EPSILON, true)] {
        let s = sample(&bsdf, wo, u, Vec2::splat(0.3)).unwrap();
        assert_eq!(s.delta, through);
        if through {
            assert_eq!(s, BsdfSample { wi: -wo, weight: Rgb::WHITE, pdf_w: 0.75, delta: true, eta: 1.0 });
        } else {
            assert!((s.weight.r - 0.5).abs() < 1e-6 && s.wi.z < 0.0);
        }
    }
    assert_eq!(mask(1.0), Bsdf::lambert(GREY, true));
    assert_eq!(mask(0.0), Bsdf::single(Lobe::Null, true));
    assert!(mask(0.0).is_delta());
    // The same in a relief.
    let relief = Material::Relief {
        relief: Relief::Bump { height: 0.0.into(), scale: 1.0 },
        material: Box::new(Material::Mask { opacity: 0.25.into(), material: Box::new(Material::lambert(GREY)) }),
    };
    assert_eq!(relief.bsdf(&point, true), bsdf);
}
