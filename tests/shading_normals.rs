//! Coarse meshes with smooth vertex normals look as fine ones do, from all sides and to all techniques.

use etendue_bidir::{BIDIR, LIGHT};
use etendue_core::{
    bsdf::{ConductorFresnel, Distribution, Roughness},
    filter::Filter,
    geometry::Mesh,
    material::{Bitangent, Material, Relief},
    rgb::Rgb,
    scene::{ObjectShape, SceneDescription},
    statistics::tiles::{Tiles, WHOLE_IMAGE, compare, replicated_tile_means},
    texture::{Bitmap, Interpolation, Texture, Wrap},
};
use etendue_path::INFO as PATH;
use etendue_tests::{Run, small::*};
use glam::{Affine2, DAffine3, DVec3, Vec2, Vec3};
use std::{f32::consts::PI, sync::Arc};

const SIZE: u32 = 64;
/// Pixels of a block's side.
const BLOCK: usize = 8;

/// A grid of `columns` x `rows` cells with the positions and normals of `at`, which takes parameters in the unit square.
fn grid(columns: u32, rows: u32, at: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=rows {
        for i in 0..=columns {
            let uv = Vec2::new(i as f32 / columns as f32, j as f32 / rows as f32);
            let (p, n) = at(uv.x, uv.y);
            mesh.positions.push(p);
            mesh.normals.push(n);
            mesh.uvs.push(uv);
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let a = j * (columns + 1) + i;
            let c = a + columns + 1;
            mesh.triangles.extend([[a, a + 1, c], [a + 1, c + 1, c]]);
        }
    }
    // Triangles at a pole have no area.
    let apart = |[a, b, c]: [u32; 3]| {
        let p = |i: u32| mesh.positions[i as usize];
        (p(b) - p(a)).cross(p(c) - p(a)).length() > 1e-6
    };
    mesh.triangles = mesh.triangles.iter().copied().filter(|t| apart(*t)).collect();
    mesh
}

/// A sphere of radius 1, its normals outwards.
fn ball(columns: u32, rows: u32) -> Mesh {
    grid(columns, rows, |u, v| {
        let (sin, cos) = (PI * v).sin_cos();
        // Closed to the last bit: at the seam and at the poles.
        let (x, z) = (2.0 * PI * u.fract()).sin_cos();
        let sin = if v == 0.0 || v == 1.0 { 0.0 } else { sin };
        let p = Vec3::new(sin * x, -cos, sin * z);
        (p, p)
    })
}

/// A third of a cylinder.
fn bent_plate(columns: u32) -> Mesh {
    grid(columns, 1, |u, v| {
        let (sin, cos) = (PI * 2.0 / 3.0 * (u - 0.5)).sin_cos();
        let n = Vec3::new(sin, cos, 0.0);
        (n + Vec3::new(0.0, -0.5, 1.0 - 2.0 * v), n)
    })
}

/// A round table top with a bevelled rim: `flat` rings keep the normals of the flat part upright; without them, they turn from the
/// middle on, as modelling programs make them.
fn table(flat: bool) -> Mesh {
    let up = Vec2::Y;
    let slant = Vec2::new(1.0, 1.0).normalize();
    let mut profile = vec![(Vec2::new(0.0, 0.1), up)];
    if flat {
        profile.push((Vec2::new(0.98, 0.1), up));
    }
    profile.extend([(Vec2::new(1.0, 0.1), slant), (Vec2::new(1.1, 0.0), Vec2::X)]);
    let rows = profile.len() as u32 - 1;
    grid(12, rows, |u, v| {
        let (p, n) = profile[(v * rows as f32).round() as usize];
        let (x, z) = (2.0 * PI * u).sin_cos();
        let round = |q: Vec2| Vec3::new(q.x * x, q.y, q.x * z);
        (round(p), round(n))
    })
}

fn materials() -> Vec<(&'static str, Material)> {
    let rough = |alpha| Some(Roughness { distribution: Distribution::Ggx, alpha: Vec2::splat(alpha) });
    let white = || ConductorFresnel::Constant(Rgb::WHITE);
    let waves: Vec<f32> = (0..256).map(|i| 0.5 + 0.5 * ((i % 16) as f32 * PI / 8.0).sin()).collect();
    let heights = Texture::Bitmap {
        bitmap: Arc::new(Bitmap { width: 16, height: 16, texels: waves }).into(),
        interpolation: Interpolation::Bilinear,
        wrap: Wrap::Repeat,
        to_uv: Affine2::from_scale(Vec2::splat(4.0)),
    };
    let relief = |relief| Material::Relief { relief, material: Box::new(Material::lambert(Rgb::splat(0.8))) };
    let map = Relief::NormalMap { normals: Rgb::new(0.65, 0.55, 0.95).into(), bitangent: Bitangent::AlongV };
    vec![
        ("lambert", Material::lambert(Rgb::splat(0.8))),
        ("mirror", Material::conductor(white(), None)),
        ("rough metal", Material::conductor(white(), rough(0.25))),
        ("glass", Material::dielectric(1.5, None)),
        ("rough glass", Material::dielectric(1.5, rough(0.25))),
        ("bumps", relief(Relief::Bump { height: heights, scale: 0.02 })),
        ("normal map", relief(map)),
    ]
}

/// The mesh by itself, seen from `eye`.
fn alone(mesh: Mesh, surface: Material, eye: DVec3) -> SceneDescription {
    SceneDescription {
        name: "mesh".into(),
        camera: Some(orthographic(eye, DVec3::ZERO, DVec3::new(0.1, 1.0, 0.2), 2.6, SIZE)),
        materials: vec![material("surface", surface), material("black", Material::lambert(Rgb::BLACK))],
        objects: vec![object("mesh", ObjectShape::Mesh(mesh), DAffine3::IDENTITY, 0)],
        ..SceneDescription::default()
    }
}

/// Means of blocks, green.
fn blocks(image: &[Rgb]) -> Vec<f64> {
    let per_row = SIZE as usize / BLOCK;
    let mut means = vec![0.0; per_row * per_row];
    for (i, color) in image.iter().enumerate() {
        let (x, y) = (i % SIZE as usize, i / SIZE as usize);
        means[y / BLOCK * per_row + x / BLOCK] += f64::from(color.g) / (BLOCK * BLOCK) as f64;
    }
    means
}

fn image(scene: &SceneDescription, passes: u32, depth: u32) -> Vec<Rgb> {
    Run::of(scene, Filter::Box, depth).film(&PATH, 7, 0..passes).mean_image()
}

/// The blocks that the mesh fills.
fn filled(mesh: &Mesh, eye: DVec3) -> Vec<bool> {
    let black = Material::lambert(Rgb::BLACK);
    let seen = image(&under_sky(alone(mesh.clone(), black, eye), 1.0), 4, 2);
    blocks(&seen).iter().map(|mean| *mean == 0.0).collect()
}

/// Pairs of a coarse mesh and a fine one, with directions to look from: from above, flatly, from behind.
fn pairs() -> Vec<(&'static str, Mesh, Mesh, [DVec3; 3])> {
    let eyes = [DVec3::new(2.0, 3.0, 2.5), DVec3::new(4.0, 0.9, 1.0), DVec3::new(-1.0, -3.0, 2.0)];
    vec![
        ("ball", ball(16, 8), ball(128, 64), eyes),
        ("bent plate", bent_plate(5), bent_plate(80), eyes),
        ("table", table(false), table(true), eyes),
    ]
}

/// Under a sky that is the same everywhere, and under one that is brighter above, a block of the coarse mesh has .7 to 1.4 of
/// the fine one's light.
#[test]
fn coarse_meshes_look_as_fine_ones_under_the_sky() {
    let gradient = |mut scene: SceneDescription| {
        let roof = rectangle("roof", DVec3::Y * 20.0, DVec3::NEG_Y, (30.0, 30.0), 1);
        scene.objects.push(emitting(roof, 1.0));
        under_sky(scene, 0.3)
    };
    let mut tested = 0;
    for (name, coarse, fine, eyes) in pairs() {
        for eye in eyes {
            let both: Vec<bool> = filled(&coarse, eye).iter().zip(filled(&fine, eye)).map(|(a, b)| *a && b).collect();
            for (surface, material) in materials() {
                // The table's normals bend light on its way through as no flat glass does.
                if name == "table" && surface.contains("glass") {
                    continue;
                }
                let uniform = |scene| under_sky(scene, 1.0);
                let skies: [fn(SceneDescription) -> SceneDescription; 2] = [uniform, gradient];
                // A mirror of other normals shows another part of the sky.
                let told_apart = name == "table" && (surface == "mirror" || surface == "rough metal");
                for sky in &skies[..if told_apart { 1 } else { 2 }] {
                    let of = |mesh: &Mesh| blocks(&image(&sky(alone(mesh.clone(), material.clone(), eye)), 48, 6));
                    let (a, b) = (of(&coarse), of(&fine));
                    for (i, _) in both.iter().enumerate().filter(|(_, both)| **both) {
                        let ratio = a[i] / b[i];
                        assert!((0.7..1.4).contains(&ratio), "{name}, {surface}, {eye}, block {i}: {} {}", a[i], b[i]);
                        tested += 1;
                    }
                }
            }
        }
    }
    assert!(tested > 500, "{tested} blocks");
}

/// Under a lamp the same holds where the fine mesh is lit by more than .3 of its peak; elsewhere the coarse one has at most
/// .25 of the peak more.
#[test]
fn coarse_meshes_look_as_fine_ones_under_a_lamp() {
    let lamp = |mut scene: SceneDescription| {
        scene.objects.push(emitting(sphere("lamp", DVec3::new(3.0, 5.0, 2.0), 1.0, 1), 20.0));
        scene
    };
    let mut tested = 0;
    for (name, coarse, fine, eyes) in pairs().into_iter().filter(|(name, ..)| *name != "table") {
        let both = eyes.map(|eye| -> Vec<bool> {
            filled(&coarse, eye).iter().zip(filled(&fine, eye)).map(|(a, b)| *a && b).collect()
        });
        // Images of the lamp in mirrors and glass are smaller than a block.
        let rough = |surface: &str| !surface.contains("glass") && surface != "mirror";
        for (surface, material) in materials().into_iter().filter(|(surface, _)| rough(surface)) {
            let of =
                |mesh: &Mesh| eyes.map(|eye| blocks(&image(&lamp(alone(mesh.clone(), material.clone(), eye)), 64, 6)));
            let (coarse, fine) = (of(&coarse), of(&fine));
            let lit = |(b, both): (&Vec<f64>, &Vec<bool>)| {
                b.iter().zip(both).filter(|(_, both)| **both).map(|(b, _)| *b).fold(0.0, f64::max)
            };
            let peak = fine.iter().zip(&both).map(lit).fold(0.0, f64::max);
            for (((a, b), both), eye) in coarse.iter().zip(&fine).zip(&both).zip(eyes) {
                for (i, _) in both.iter().enumerate().filter(|(_, both)| **both) {
                    let what = format!("{name}, {surface}, {eye}, block {i}: {} {}, peak {peak}", a[i], b[i]);
                    if b[i] > 0.3 * peak {
                        assert!((0.7..1.4).contains(&(a[i] / b[i])), "{what}");
                        tested += 1;
                    } else {
                        assert!(a[i] - b[i] < 0.25 * peak, "{what}");
                    }
                }
            }
        }
    }
    assert!(tested > 100, "{tested} blocks");
}

/// A closed coarse ball with a lamp outside is dark inside, one with a lamp inside dark outside.
#[test]
fn nothing_leaks_through_coarse_meshes() {
    for (lamp, eye) in [(DVec3::new(2.0, 3.0, 1.0), DVec3::ZERO), (DVec3::ZERO, DVec3::new(2.0, 3.0, 1.0))] {
        let mut scene = alone(ball(7, 5), Material::lambert(Rgb::splat(0.8)), DVec3::ONE);
        scene.objects.push(emitting(sphere("lamp", lamp, 0.2, 1), 50.0));
        scene.camera = Some(pinhole(eye, lamp * -1.0 + DVec3::new(0.1, 0.0, 0.2), 1.2, 16));
        let run = Run::of(&scene, Filter::Box, 8);
        for technique in [&PATH, &LIGHT, &BIDIR] {
            let film = run.film(technique, 3, 0..32).mean_image();
            assert!(film.iter().all(|c| c.is_black()), "{} leaks", technique.name);
        }
    }
}

/// Path tracing, light tracing and bidirectional path tracing agree where shading normals disagree with faces.
#[test]
fn techniques_agree_on_coarse_meshes() {
    const REPLICATES: u64 = 12;
    for (name, mesh) in [("ball", ball(7, 5)), ("bent plate", bent_plate(2)), ("table", table(false))] {
        for (surface, material) in
            materials().into_iter().filter(|(surface, _)| *surface != "mirror" && *surface != "glass")
        {
            let mut scene = alone(mesh.clone(), material, DVec3::new(4.0, 0.9, 1.0));
            scene.camera = Some(orthographic(DVec3::new(4.0, 0.9, 1.0), DVec3::ZERO, DVec3::Y, 2.2, 8));
            scene.objects.push(emitting(sphere("lamp", DVec3::new(1.0, 3.0, -2.0), 0.8, 1), 8.0));
            scene.objects.push(rectangle("floor", DVec3::Y * -1.2, DVec3::Y, (4.0, 4.0), 2));
            scene.materials.push(grey(0.5));
            let run = Run::of(&scene, Filter::Box, 4);
            let means = |technique, passes| run.replicates(technique, 0..REPLICATES, passes);
            let path = means(&PATH, 96);
            for (technique, passes) in [(&LIGHT, 192), (&BIDIR, 64)] {
                let other = means(technique, passes);
                for tile in [WHOLE_IMAGE, 4] {
                    let of = |images: &[Vec<Rgb>]| -> (Tiles, Vec<[f64; 3]>) {
                        replicated_tile_means(&images.iter().map(Vec::as_slice).collect::<Vec<_>>(), 8, tile)
                    };
                    let ((a, a_errors), (b, b_errors)) = (of(&path), of(&other));
                    let errors: Vec<_> =
                        a_errors.iter().zip(&b_errors).map(|(a, b)| [0, 1, 2].map(|c| a[c].hypot(b[c]))).collect();
                    let found = compare(&a, &b, &errors, (REPLICATES - 1) as f64, 6.334e-5);
                    println!("{name}, {surface}, {}: {:+.2} standard errors", technique.name, found.t);
                    assert_eq!(found.failures, 0, "{name}, {surface}, {}: {found:?}", technique.name);
                }
            }
        }
    }
}
