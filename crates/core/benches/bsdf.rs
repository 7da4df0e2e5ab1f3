//! Time of one evaluation and of one sample of each lobe.

use criterion::{Criterion, criterion_group, criterion_main};
use etendue_core::{
    bsdf::{
        Bsdf, ConductorFresnel, Distribution, Lobe, Plastic, Principled, PrincipledThin, RoughPlastic, Roughness,
        TransportMode,
    },
    has,
    rgb::Rgb,
    warp,
};
use glam::{Vec2, Vec3};
use std::hint::black_box;

/// How many calls one measurement makes, each with its own directions; the figure is for all of them.
const CALLS: usize = 1000;

fn lobes() -> Vec<(&'static str, Bsdf)> {
    let metal =
        ConductorFresnel::Complex { eta: Rgb::new(0.2, 0.92, 1.1), k: Rgb::new(3.9, 2.45, 2.14), tint: Rgb::WHITE };
    let white = ConductorFresnel::Constant(Rgb::WHITE);
    let rough = |distribution| Roughness { distribution, alpha: Vec2::new(0.2, 0.3) };
    let (ggx, beckmann) = (rough(Distribution::Ggx), rough(Distribution::Beckmann));
    let lambert = Lobe::Lambert { reflectance: Rgb::splat(0.5) };
    let mixed = Bsdf {
        first: lambert,
        second: Some((Lobe::RoughConductor { fresnel: white, roughness: ggx }, 0.5)),
        two_sided: true,
    };
    let single = |lobe| Bsdf::single(lobe, true);
    let (body, gold) = (Rgb::splat(0.5), Rgb::new(0.8, 0.5, 0.1));
    let principled = Principled {
        base_color: gold,
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
    let everything = Principled {
        anisotropic: 0.3,
        metallic: 0.2,
        spec_trans: 0.6,
        spec_tint: 0.5,
        sheen: 0.3,
        sheen_tint: 0.2,
        flatness: 0.5,
        clearcoat: 0.5,
        clearcoat_gloss: 0.5,
        ..principled
    };
    let leaf = PrincipledThin {
        base_color: gold,
        roughness: 0.5,
        anisotropic: 0.0,
        spec_trans: 0.2,
        eta: 1.5,
        spec_tint: 0.0,
        sheen: 0.0,
        sheen_tint: 0.0,
        flatness: 0.0,
        diff_trans: 1.0,
    };
    let masked = Bsdf { first: Lobe::Null, second: Some((lambert, 0.5)), two_sided: true };
    let coated = RoughPlastic::new(1.5, (Distribution::Ggx, 0.2), body, Rgb::WHITE, false);
    vec![
        ("lambert", single(lambert)),
        ("conductor", single(Lobe::Conductor { fresnel: metal })),
        ("ggx conductor", single(Lobe::RoughConductor { fresnel: white, roughness: ggx })),
        ("ggx gold", single(Lobe::RoughConductor { fresnel: metal, roughness: ggx })),
        ("beckmann conductor", single(Lobe::RoughConductor { fresnel: white, roughness: beckmann })),
        ("dielectric", single(Lobe::dielectric(1.5))),
        ("ggx dielectric", single(Lobe::rough_dielectric(1.5, ggx))),
        ("beckmann dielectric", single(Lobe::rough_dielectric(1.5, beckmann))),
        ("lambert and ggx", mixed),
        ("thin dielectric", single(Lobe::ThinDielectric { eta: 1.5, reflectance: body, transmittance: body })),
        ("masked lambert", masked),
        ("plastic", single(Lobe::Plastic(Plastic::new(1.5, body, Rgb::WHITE, false)))),
        ("ggx plastic", single(Lobe::RoughPlastic(coated))),
        ("principled", single(Lobe::Principled(principled))),
        ("principled metal", single(Lobe::Principled(Principled { metallic: 1.0, ..principled }))),
        ("principled with everything", single(Lobe::Principled(everything))),
        ("thin principled", single(Lobe::PrincipledThin(leaf))),
    ]
}

/// Well spread points of the unit square.
fn points() -> Vec<Vec2> {
    (0..CALLS).map(|i| Vec2::new((i as f32 + 0.5) / CALLS as f32, (i as f32 * 0.618_034).fract())).collect()
}

fn eval_pdf<const HAS: u32>(bsdf: &Bsdf, wo: Vec3, directions: &[Vec3]) -> (Rgb, f32) {
    directions.iter().fold((Rgb::BLACK, 0.0), |(value, pdf_w), &wi| {
        let (v, p) = bsdf.eval_pdf::<HAS>(wo, wi, TransportMode::Radiance);
        (value + v, pdf_w + p)
    })
}

fn sample<const HAS: u32>(bsdf: &Bsdf, wo: Vec3, points: &[Vec2]) -> (Rgb, Vec3) {
    points.iter().fold((Rgb::BLACK, Vec3::ZERO), |(weight, wi), &u| {
        match bsdf.sample::<HAS>(wo, u.y, u, TransportMode::Radiance) {
            Some(s) => (weight + s.weight, wi + s.wi),
            None => (weight, wi),
        }
    })
}

fn benches(c: &mut Criterion) {
    let points = points();
    let wo = Vec3::new(0.6, 0.0, 0.8);
    // Without the feature of other lobes first, then with all.
    let lambert = black_box(Bsdf::lambert(Rgb::splat(0.5), true));
    let hemisphere: Vec<Vec3> = points.iter().map(|&u| warp::sample_cosine_hemisphere(u)).collect();
    let mut group = c.benchmark_group("bsdf, 1000 calls");
    group.bench_function("eval_pdf/lambert alone", |b| b.iter(|| eval_pdf::<0>(&lambert, black_box(wo), &hemisphere)));
    group.bench_function("sample/lambert alone", |b| b.iter(|| sample::<0>(&lambert, black_box(wo), &points)));
    for (name, bsdf) in lobes() {
        let bsdf = black_box(bsdf);
        if !bsdf.is_delta() {
            // Directions that the lobe itself proposes, so that nothing leaves early.
            let sampled: Vec<Vec3> = points
                .iter()
                .filter_map(|&u| bsdf.sample::<{ has::ALL }>(wo, u.y, u, TransportMode::Radiance))
                .map(|s| s.wi)
                .cycle()
                .take(CALLS)
                .collect();
            group.bench_function(format!("eval_pdf/{name}"), |b| {
                b.iter(|| eval_pdf::<{ has::ALL }>(&bsdf, black_box(wo), &sampled));
            });
        }
        group.bench_function(format!("sample/{name}"), |b| {
            b.iter(|| sample::<{ has::ALL }>(&bsdf, black_box(wo), &points));
        });
    }
    group.finish();
}

criterion_group!(bsdf, benches);
criterion_main!(bsdf);
