//! What holds for every direction, not only on average.

use crate::{
    METAL, Uniform,
    agreement::{principled_all, principled_coated, thin_all},
    chart::Case,
    compound::{compound_cases, plastic, rough_plastic},
    conductor, dielectric, direction, rough_cases, wide_cases,
};
use etendue_core::{
    bsdf::{
        Bsdf, BsdfSample, ConductorFresnel, Distribution, Lobe, Plastic, Principled, PrincipledThin, RoughPlastic,
        TransportMode,
    },
    has,
    rgb::Rgb,
    warp::ONE_MINUS_EPSILON,
};
use glam::{Vec2, Vec3};
use proptest::{prelude::*, test_runner::RngSeed};

const MODES: [TransportMode; 2] = [TransportMode::Radiance, TransportMode::Importance];

fn sample(bsdf: &Bsdf, wo: Vec3, u_lobe: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
    bsdf.sample::<{ has::ALL }>(wo, u_lobe, u, mode)
}

fn all_cases() -> impl Iterator<Item = Case> {
    rough_cases().into_iter().chain(wide_cases()).chain(compound_cases())
}

fn assert_sound(bsdf: &Bsdf, wo: Vec3, s: &BsdfSample) {
    assert!((s.wi.length() - 1.0).abs() < 1e-5, "{bsdf:?} {wo:?} {s:?}");
    assert!(s.weight.is_valid() && s.pdf_w > 0.0 && s.pdf_w.is_finite() && s.eta > 0.0, "{bsdf:?} {wo:?} {s:?}");
    assert!(s.wi.z != 0.0, "{bsdf:?} {wo:?} {s:?}");
}

#[test]
fn samples_carry_value_times_cosine_over_density() {
    let mut uniform = Uniform::new(1);
    for case in all_cases() {
        for _ in 0..200 {
            let (u_lobe, u) = (uniform.one(), uniform.two());
            let [radiance, importance] = MODES.map(|mode| sample(&case.bsdf, case.wo, u_lobe, u, mode));
            assert_eq!(radiance.is_some(), importance.is_some());
            let (Some(radiance), Some(importance)) = (radiance, importance) else { continue };
            // Radiance is scaled by 1 / eta² where it is refracted, importance never.
            let unscaled = radiance.weight * (radiance.eta * radiance.eta);
            assert!((unscaled.r - importance.weight.r).abs() <= 1e-5 * unscaled.r, "{}", case.name);
            for (s, mode) in [(radiance, MODES[0]), (importance, MODES[1])] {
                assert_sound(&case.bsdf, case.wo, &s);
                if s.delta {
                    continue;
                }
                let f = case.bsdf.eval(case.wo, s.wi, mode);
                assert_eq!(s.pdf_w, case.bsdf.pdf_w(case.wo, s.wi), "{}", case.name);
                let weight = f * (s.wi.z.abs() / s.pdf_w);
                for c in 0..3 {
                    assert!((weight[c] - s.weight[c]).abs() <= 1e-5 * weight[c], "{}: {s:?} {weight:?}", case.name);
                }
            }
        }
    }
}

#[test]
fn swapping_directions_swaps_modes_and_scales_by_the_index_squared() {
    let mut bsdfs = Vec::new();
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for (x, y) in [(0.01, 0.01), (0.1, 0.4), (1.0, 1.0)] {
            bsdfs.extend([conductor(distribution, x, y, METAL), dielectric(distribution, x, y, 1.5)]);
        }
        bsdfs.push(Bsdf::single(rough_plastic(distribution, 0.3, 1.5, Rgb::splat(0.5)), false));
    }
    let thin = PrincipledThin { roughness: 1.0, ..thin_all() };
    for lobe in [
        plastic(1.5, Rgb::splat(0.5), true),
        Lobe::Principled(principled_coated()),
        Lobe::Principled(principled_all()),
        Lobe::Principled(Principled { eta: 0.7, ..principled_all() }),
        Lobe::PrincipledThin(thin_all()),
        Lobe::PrincipledThin(thin),
    ] {
        bsdfs.push(Bsdf::single(lobe, false));
        bsdfs.push(Bsdf { first: Lobe::Null, second: Some((lobe, 0.4)), two_sided: true });
    }
    let mut uniform = Uniform::new(2);
    for bsdf in bsdfs {
        let mut compared = 0;
        for i in 0..2000 {
            let wo = direction(f64::from(i % 85), f64::from(i));
            let wo = if i % 2 == 0 { wo } else { -wo };
            let Some(s) = sample(&bsdf, wo, uniform.one(), uniform.two(), MODES[0]) else { continue };
            if s.delta || s.wi.z.abs() < 0.01 {
                continue;
            }
            let forth = bsdf.eval(wo, s.wi, TransportMode::Radiance).r;
            let back = bsdf.eval(s.wi, wo, TransportMode::Radiance).r * (1.0 / (s.eta * s.eta));
            let adjoint = bsdf.eval(s.wi, wo, TransportMode::Importance).r;
            // In the far tail of a narrow lobe the rounding of a direction shows.
            assert!((forth - back).abs() <= 2e-3 * forth, "{bsdf:?} {wo} {s:?}: {forth} {back}");
            assert!((forth - adjoint).abs() <= 2e-3 * forth, "{bsdf:?} {wo} {s:?}: {forth} {adjoint}");
            compared += 1;
        }
        assert!(compared > 300, "{bsdf:?}: {compared}");
    }
}

#[test]
fn the_borders_of_the_unit_square_stay_in_the_support() {
    let ends = [0.0, f32::MIN_POSITIVE, f32::EPSILON / 2.0, 0.5, ONE_MINUS_EPSILON];
    for case in all_cases() {
        for u_lobe in ends {
            for u in ends.iter().flat_map(|&x| ends.iter().map(move |&y| Vec2::new(x, y))) {
                for s in MODES.iter().filter_map(|&mode| sample(&case.bsdf, case.wo, u_lobe, u, mode)) {
                    assert_sound(&case.bsdf, case.wo, &s);
                }
            }
        }
    }
    // Lambert never fails.
    let bsdf = Bsdf::lambert(Rgb::WHITE, false);
    for u in ends.iter().flat_map(|&x| ends.iter().map(move |&y| Vec2::new(x, y))) {
        assert!(sample(&bsdf, direction(89.9, 10.0), 0.0, u, MODES[0]).is_some_and(|s| s.wi.z > 0.0 && s.pdf_w > 0.0));
    }
}

#[test]
fn lambert_alone_needs_no_lobes() {
    let mut uniform = Uniform::new(3);
    for two_sided in [false, true] {
        let bsdf = Bsdf::lambert(Rgb::new(0.0, 0.4, 1.0), two_sided);
        for _ in 0..1000 {
            let [wo, wi] = [uniform.two(), uniform.two()].map(etendue_core::warp::sample_sphere);
            let (u_lobe, u) = (uniform.one(), uniform.two());
            let few = bsdf.eval_pdf::<{ has::INFINITE }>(wo, wi, MODES[0]);
            assert_eq!(few, bsdf.eval_pdf::<{ has::ALL }>(wo, wi, MODES[0]));
            let few = bsdf.sample::<{ has::INFINITE }>(wo, u_lobe, u, MODES[0]);
            assert_eq!(few, sample(&bsdf, wo, u_lobe, u, MODES[0]));
            // An albedo of 0 or 1 is exact.
            assert!(few.is_none_or(|s| s.weight == Rgb::new(0.0, 0.4, 1.0)));
            assert_eq!(few.is_some(), wo.z > 0.0 || two_sided);
        }
    }
}

#[test]
fn the_back_of_an_opaque_surface_is_black_or_as_the_front() {
    let mut uniform = Uniform::new(4);
    let mirror = Lobe::Conductor { fresnel: METAL };
    let rough = conductor(Distribution::Beckmann, 0.2, 0.3, METAL).first;
    let mixed = Bsdf { first: rough, second: Some((mirror, 0.5)), two_sided: false };
    let coats = [
        plastic(1.5, Rgb::splat(0.5), true),
        rough_plastic(Distribution::Ggx, 0.3, 1.5, Rgb::splat(0.5)),
        Lobe::Principled(principled_coated()),
        // No light passes a metal.
        Lobe::Principled(Principled { metallic: 1.0, ..principled_all() }),
    ];
    let coats = coats.map(|lobe| Bsdf::single(lobe, false));
    for front in [Bsdf::single(mirror, false), Bsdf::single(rough, false), mixed].into_iter().chain(coats) {
        let both = Bsdf { two_sided: true, ..front };
        for i in 0..500 {
            let wo = direction(f64::from(i % 90), f64::from(i));
            let back = Vec3::new(wo.x, wo.y, -wo.z);
            let (u_lobe, u) = (uniform.one(), uniform.two());
            assert_eq!(sample(&front, back, u_lobe, u, MODES[0]), None);
            let above = sample(&front, wo, u_lobe, u, MODES[0]);
            let below = sample(&both, back, u_lobe, u, MODES[0]);
            let mirrored = above.map(|s| BsdfSample { wi: Vec3::new(s.wi.x, s.wi.y, -s.wi.z), ..s });
            assert_eq!(below, mirrored);
            if let Some(s) = below {
                assert_eq!(front.eval_pdf::<{ has::ALL }>(back, s.wi, MODES[0]), (Rgb::BLACK, 0.0));
                assert_eq!(both.eval_pdf::<{ has::ALL }>(wo, s.wi, MODES[0]), (Rgb::BLACK, 0.0));
            }
        }
    }
}

#[test]
fn a_smooth_dielectric_keeps_all_energy_and_obeys_snell() {
    for eta in [0.5f32, 0.75, 1.00001, 1.33, 1.5, 2.5] {
        let bsdf = Bsdf::single(Lobe::dielectric(eta), false);
        assert!(bsdf.is_delta());
        for i in 0..1800 {
            let theta = f64::from(i) / 10.0 + 0.05;
            let wo = direction(theta, 40.0);
            let relative = if wo.z > 0.0 { eta } else { 1.0 / eta };
            let ends = [0.0, ONE_MINUS_EPSILON].map(|u| sample(&bsdf, wo, u, Vec2::ZERO, MODES[0]).unwrap());
            let (reflected, other) = (ends[0], ends[1]);
            assert_sound(&bsdf, wo, &reflected);
            assert_sound(&bsdf, wo, &other);
            assert!(reflected.delta && other.delta);
            assert_eq!((reflected.wi, reflected.weight.r), (Vec3::new(-wo.x, -wo.y, wo.z), 1.0));
            if other.wi == reflected.wi {
                let sin = wo.truncate().length();
                assert!(other.pdf_w == 1.0 && sin > relative * 0.999_99, "{eta} {theta}");
                continue;
            }
            let energy = reflected.pdf_w + other.pdf_w * other.weight.r * other.eta * other.eta;
            assert!((energy - 1.0).abs() < 1e-6, "{eta} {theta}: {energy}");
            assert!(other.eta == relative && other.wi.z * wo.z < 0.0);
            assert!((other.wi.truncate() * other.eta + wo.truncate()).length() < 1e-6, "{eta} {theta}");
        }
    }
}

#[test]
fn equal_indices_let_light_pass_unchanged() {
    for (wo, alpha) in [(direction(0.0, 0.0), 1.0), (direction(89.999, 3.0), 1e-4), (direction(120.0, 3.0), 0.3)] {
        let rough = dielectric(Distribution::Ggx, alpha, alpha, 1.0);
        for bsdf in [rough, Bsdf::single(Lobe::dielectric(1.0), false)] {
            assert!(bsdf.is_delta() && bsdf.has_delta());
            for (u, mode) in [(0.0, MODES[0]), (ONE_MINUS_EPSILON, MODES[1])] {
                let s = sample(&bsdf, wo, u, Vec2::splat(0.3), mode).unwrap();
                assert_eq!(s, BsdfSample { wi: -wo, weight: Rgb::WHITE, pdf_w: 1.0, delta: true, eta: 1.0 });
            }
            assert_eq!(bsdf.eval_pdf::<{ has::ALL }>(wo, -wo, MODES[0]), (Rgb::BLACK, 0.0));
        }
    }
}

#[test]
fn a_mixture_with_a_mirror_chooses_it_with_its_share() {
    let mirror = Lobe::Conductor { fresnel: ConductorFresnel::Constant(Rgb::splat(0.5)) };
    let lambert = Lobe::Lambert { reflectance: Rgb::WHITE };
    let wo = direction(30.0, 0.0);
    for (share, u_lobe, delta) in
        [(0.25, 0.2499, true), (0.25, 0.25, false), (1.0, ONE_MINUS_EPSILON, true), (0.0, 0.0, false)]
    {
        let bsdf = Bsdf { first: lambert, second: Some((mirror, share)), two_sided: false };
        assert!(bsdf.has_delta() && !bsdf.is_delta());
        let s = sample(&bsdf, wo, u_lobe, Vec2::new(0.2, 0.6), MODES[0]).unwrap();
        assert_eq!(s.delta, delta);
        if delta {
            assert_eq!((s.pdf_w, s.weight), (share, Rgb::splat(0.5)));
        } else {
            // The mixture's value and density both hold the share of the diffuse lobe.
            assert!((s.weight.r - 1.0).abs() < 1e-6);
            assert!((s.pdf_w - (1.0 - share) * s.wi.z / std::f32::consts::PI).abs() < 1e-6);
        }
    }
}

/// Cosines from 1 down to subnormal numbers.
fn any_direction() -> impl Strategy<Value = Vec3> {
    (-40.0..0.0f32, 0.0..std::f32::consts::TAU, any::<bool>(), any::<bool>()).prop_map(|(exponent, phi, up, even)| {
        let cos = if even { -exponent / 40.0 } else { 10f32.powf(exponent) };
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), if up { cos } else { -cos })
    })
}

fn any_lobe() -> impl Strategy<Value = Lobe> {
    let roughness = (any::<bool>(), -4.0..0.0f32, -4.0..0.0f32).prop_map(|(ggx, x, y)| {
        let distribution = if ggx { Distribution::Ggx } else { Distribution::Beckmann };
        etendue_core::bsdf::Roughness { distribution, alpha: Vec2::new(10f32.powf(x), 10f32.powf(y)) }
    });
    let near_one = (-8.0..-1.0f32, any::<bool>())
        .prop_map(|(e, above)| if above { 1.0 + 10f32.powf(e) } else { 1.0 - 10f32.powf(e) });
    let eta = prop_oneof![Just(1.0f32), 0.2..5.0f32, near_one];
    let fresnel = (0.0..5.0f32, 1e-3..50.0f32).prop_map(|(eta, k)| ConductorFresnel::Complex {
        eta: Rgb::splat(eta),
        k: Rgb::splat(k),
        tint: Rgb::WHITE,
    });
    // Tables are made once for each of a few coats.
    let coats = [(1e-4, 1.5), (0.01, 1.1), (0.3, 1.5), (1.0, 0.6), (0.2, 1.0), (0.5, 4.0)];
    let coat = (any::<bool>(), proptest::sample::select(coats.to_vec()))
        .prop_map(|(ggx, (alpha, eta))| (if ggx { Distribution::Ggx } else { Distribution::Beckmann }, alpha, eta));
    let colours = (any_colour(), any_colour(), any::<bool>());
    (0..11, fresnel, roughness, eta, coat, colours, any_principled()).prop_map(
        |(kind, fresnel, roughness, eta, (distribution, alpha, coat_eta), (diffuse, specular, nonlinear), p)| match kind
        {
            0 => Lobe::Lambert { reflectance: Rgb::WHITE },
            1 => Lobe::Conductor { fresnel },
            2 => Lobe::RoughConductor { fresnel, roughness },
            3 => Lobe::Dielectric { eta, reflectance: specular, transmittance: diffuse },
            4 => Lobe::RoughDielectric { eta, roughness, reflectance: specular, transmittance: diffuse },
            5 => Lobe::ThinDielectric { eta, reflectance: specular, transmittance: diffuse },
            6 => Lobe::Null,
            7 => Lobe::Plastic(Plastic::new(eta, diffuse, specular, nonlinear)),
            8 => Lobe::RoughPlastic(RoughPlastic::new(coat_eta, (distribution, alpha), diffuse, specular, nonlinear)),
            9 => Lobe::Principled(Principled { eta, ..p }),
            _ => Lobe::PrincipledThin(PrincipledThin {
                base_color: p.base_color,
                roughness: p.roughness,
                anisotropic: p.anisotropic,
                spec_trans: p.spec_trans,
                eta,
                spec_tint: p.spec_tint,
                sheen: p.sheen,
                sheen_tint: p.sheen_tint,
                flatness: p.flatness,
                diff_trans: 2.0 * p.metallic,
            }),
        },
    )
}

/// Mostly the ends of the unit interval, where parts of a model vanish.
fn any_share() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0f32), Just(1.0f32), 0.0..=1.0f32]
}

fn any_colour() -> impl Strategy<Value = Rgb> {
    (any_share(), any_share(), any_share()).prop_map(|(r, g, b)| Rgb::new(r, g, b))
}

fn any_principled() -> impl Strategy<Value = Principled> {
    let shares = proptest::array::uniform10(any_share());
    (any_colour(), shares).prop_map(
        |(
            base_color,
            [
                roughness,
                anisotropic,
                metallic,
                spec_trans,
                spec_tint,
                sheen,
                sheen_tint,
                flatness,
                clearcoat,
                clearcoat_gloss,
            ],
        )| Principled {
            base_color,
            roughness,
            anisotropic,
            metallic,
            spec_trans,
            eta: 1.5,
            spec_tint,
            sheen,
            sheen_tint,
            flatness,
            clearcoat,
            clearcoat_gloss,
        },
    )
}

/// Whether single samples of the lobe carry no more energy than arrives. Those of lobes with several parts may.
fn is_simple(lobe: &Lobe) -> bool {
    !matches!(lobe, Lobe::Plastic(_) | Lobe::RoughPlastic(_) | Lobe::Principled(_) | Lobe::PrincipledThin(_))
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 50_000,
        rng_seed: RngSeed::Fixed(3),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn everything_is_finite_and_not_negative(
        first in any_lobe(),
        second in proptest::option::of((any_lobe(), 0.0..=1.0f32)),
        two_sided in any::<bool>(),
        (wo, wi) in (any_direction(), any_direction()),
        opposed in any::<bool>(),
        (u_lobe, x, y) in (0.0..1.0f32, 0.0..1.0f32, 0.0..1.0f32),
    ) {
        let bsdf = Bsdf { first, second, two_sided };
        let simple = is_simple(&first) && second.is_none_or(|(lobe, _)| is_simple(&lobe));
        // Exactly opposed horizontal components make the half vector vanish.
        let wi = if opposed { Vec3::new(-wo.x, -wo.y, wi.z) } else { wi };
        for mode in MODES {
            let (value, pdf_w) = bsdf.eval_pdf::<{ has::ALL }>(wo, wi, mode);
            prop_assert!(value.is_valid() && pdf_w.is_finite() && pdf_w >= 0.0, "{:?} {}", value, pdf_w);
            if let Some(s) = sample(&bsdf, wo, u_lobe, Vec2::new(x, y), mode) {
                assert_sound(&bsdf, wo, &s);
                prop_assert!(if s.delta { bsdf.has_delta() } else { !bsdf.is_delta() }, "{:?}", s);
                // No gain of energy beyond the masking's error; radiance may grow by refraction, importance may not.
                prop_assert!(mode == TransportMode::Radiance || !simple || s.weight.r < 1.01, "{:?}", s);
            }
        }
    }
}
