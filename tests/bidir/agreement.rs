//! Path tracing, light tracing and bidirectional path tracing render the same images.

mod scenes;

use etendue_bidir::{BIDIR, LIGHT};
use etendue_core::{
    bsdf::{Bsdf, Lobe},
    camera::{Crop, Projection},
    filter::Filter,
    has,
    rgb::Rgb,
    scene::SceneDescription,
    statistics::{
        render::Rays,
        tiles::{Tiles, WHOLE_IMAGE, compare, replicated_tile_means},
    },
    technique::{Part, Parts, TechniqueInfo},
    walk::{Limits, Vertex, Walk},
};
use etendue_tests::{Run, shared};
use glam::{UVec2, Vec2};
use scenes::{every_light, every_material};

/// Two-sided significance of four standard errors.
const SIGNIFICANCE: f64 = 6.334e-5;
/// Pixels of a tile's side.
const TILE: usize = 4;
const REPLICATES: u64 = 12;

/// Passes of bidirectional path tracing in a replicate, times what the environment asks for.
fn passes(passes: u32) -> u32 {
    let factor = std::env::var("ETENDUE_BIDIR_FACTOR").map_or(1.0, |f| f.parse::<f64>().expect("a number"));
    (f64::from(passes) * factor) as u32
}

/// An independent estimate of the image for each seed.
fn images(run: &Run, technique: &TechniqueInfo, first: u64, passes: u32) -> Vec<Vec<Rgb>> {
    run.replicates(technique, first..first + REPLICATES, passes)
}

/// Holds the means of the tiles that `tested` chooses, and of the image where it chooses all, against each other.
fn hold(name: &str, run: &Run, a: &[Vec<Rgb>], b: &[Vec<Rgb>], tested: impl Fn(usize) -> bool) {
    let width = run.resolution.x as usize;
    let whole = (0..tiles(run).count()).all(&tested);
    for tile in if whole { vec![WHOLE_IMAGE, TILE] } else { vec![TILE] } {
        let of = |images: &[Vec<Rgb>]| {
            replicated_tile_means(&images.iter().map(Vec::as_slice).collect::<Vec<_>>(), width, tile)
        };
        let ((a, a_errors), (b, b_errors)) = (of(a), of(b));
        let chosen: Vec<usize> = (0..a.means.len()).filter(|i| whole || tested(*i)).collect();
        let pick =
            |t: &Tiles| Tiles { columns: chosen.len(), rows: 1, means: chosen.iter().map(|i| t.means[*i]).collect() };
        let errors: Vec<_> = chosen.iter().map(|i| [0, 1, 2].map(|c| a_errors[*i][c].hypot(b_errors[*i][c]))).collect();
        let found = compare(&pick(&a), &pick(&b), &errors, (REPLICATES - 1) as f64, SIGNIFICANCE);
        let (worst, channel) = (found.worst.0, found.worst.2);
        println!(
            "{name}, {} of {} tiles: worst {:+.2} standard errors, {:+.3} % +- {:.3} %",
            chosen.len(),
            a.means.len(),
            found.t,
            100.0 * found.relative,
            100.0 * errors[worst][channel] / pick(&b).means[worst][channel],
        );
        assert_eq!(found.failures, 0, "{name}: {found:?}");
    }
}

fn tiles(run: &Run) -> impl Iterator<Item = (usize, usize)> {
    let [columns, rows] = run.resolution.to_array().map(|n| (n as usize).div_ceil(TILE));
    (0..columns * rows).map(move |i| (i % columns, i / columns))
}

/// Whether a surface shows more than single directions, so that particles that land on it are seen.
fn is_plain(bsdf: &Bsdf) -> bool {
    let narrow = |lobe: &Lobe| match lobe {
        Lobe::RoughConductor { roughness, .. } | Lobe::RoughDielectric { roughness, .. } => {
            roughness.alpha.min_element() < 0.1
        }
        _ => false,
    };
    !bsdf.has_delta() && !narrow(&bsdf.first) && !bsdf.second.is_some_and(|(lobe, _)| narrow(&lobe))
}

/// Which tiles show plain surfaces only: those where light tracing sees everything.
fn plain_tiles(run: &Run) -> Vec<bool> {
    tiles(run)
        .map(|(column, row)| {
            let first = UVec2::new(column as u32, row as u32) * TILE as u32;
            // As far as filters reach, and over the lens.
            let (margin, steps) = (run.filter.radius(), 24);
            let side = TILE as f32 + 2.0 * margin;
            (0..steps * steps).all(|i| {
                let at = Vec2::new((i % steps) as f32 + 0.5, (i / steps) as f32 + 0.5) / steps as f32;
                let film = first.as_vec2() - margin + at * side;
                let lens = Vec2::new((0.618 * i as f32).fract(), (0.414 * i as f32).fract());
                let limits = Limits { max_depth: 1, roulette_depth: 1 };
                let mut walk = Walk::<{ has::ALL }>::from_camera(&run.scene, limits, film, lens);
                match walk.trace(&mut Rays::default()) {
                    Vertex::Surface(vertex) => is_plain(&vertex.bsdf),
                    Vertex::Escaped(_) => true,
                }
            })
        })
        .collect()
}

/// All three techniques agree, light tracing where it sees all that the others see.
fn agree(name: &str, run: &Run, n: u32) {
    let n = passes(n);
    let path = images(run, &etendue_path::INFO, 0, 4 * n);
    hold(&format!("{name}, bidir and path"), run, &images(run, &BIDIR, 100, n), &path, |_| true);
    let plain = plain_tiles(run);
    if plain.contains(&true) {
        hold(&format!("{name}, light and path"), run, &images(run, &LIGHT, 200, 4 * n), &path, |i| plain[i]);
    }
}

#[test]
fn in_the_built_in_scenes() {
    for (spec, n) in [
        ("furnace", 6),
        ("furnace:room=sphere", 6),
        ("furnace:material=rough-dielectric", 6),
        ("cornell", 16),
        ("many-lights:n=16", 16),
        ("veach-mis", 24),
        ("sky", 24),
        ("ajar-door", 16),
        ("bumpy", 16),
        ("bumpy:rings=4,bumps=0.3", 16),
    ] {
        agree(spec, &Run::builtin(spec, 16), n);
    }
}

/// Caustics that a path tracer finds often enough for a test: those of large lights.
#[test]
fn caustics_of_large_lights() {
    for (spec, n) in [("glass-caustic:light=0.5", 8), ("ring:light=0.5", 8), ("hidden-lights:light=0.08", 24)] {
        agree(spec, &Run::builtin(spec, 24), n);
    }
}

/// Caustics of small lights, where the two that look for them from the lights agree, and everything else.
#[test]
fn caustics_of_small_lights() {
    for spec in ["glass-caustic", "ring", "hidden-lights"] {
        // The ring is seen in all but small tiles.
        let mut run = Run::builtin(spec, 40);
        run.settings.parts = Parts::NONE.with(Part::Emission).with(Part::Direct);
        agree(&format!("{spec}, direct light"), &run, 2);
        run.settings.parts = Parts::NONE.with(Part::Caustic).with(Part::Indirect);
        let n = passes(4);
        let plain = plain_tiles(&run);
        let (light, bidir) = (images(&run, &LIGHT, 300, 2 * n), images(&run, &BIDIR, 400, n));
        hold(&format!("{spec}, caustics, light and bidir"), &run, &light, &bidir, |i| plain[i]);
    }
}

/// A scene of a user's, if it is there: two lamps that shine out of shades, a glass egg on a table.
#[test]
fn on_veach_bidir() {
    let Some(folder) = shared("scenes/veach-bidir") else { return };
    let file = folder.join("scene.xml");
    let mut loaded = etendue_scenes::load(file.to_str().expect("a UTF-8 path")).expect("the scene loads");
    let camera = loaded.description.camera.as_mut().expect("a camera");
    camera.resolution = UVec2::new(24, 24 * camera.resolution.y / camera.resolution.x);
    agree("veach-bidir", &Run::new(&loaded), 24);
}

/// A described scene.
fn agree_on(scene: &SceneDescription, filter: Filter, n: u32) {
    agree(&scene.name, &Run::of(scene, filter, 6), n);
}

#[test]
fn with_every_light_and_camera() {
    for (camera, projection) in [
        ("pinhole", Projection::Perspective { fov_x: 0.9 }),
        ("lens", Projection::ThinLens { fov_x: 0.9, aperture_radius: 0.1, focus_distance: 4.0 }),
        ("parallel", Projection::Orthographic { width: 3.0 }),
    ] {
        let mut scene = every_light(projection);
        scene.name += &format!(", {camera}");
        agree_on(&scene, Filter::Tent { radius: 1.0 }, 8);
    }
    // Through a crop of the film as well.
    let mut scene = every_light(Projection::Perspective { fov_x: 0.9 });
    scene.name += ", crop";
    let camera = scene.camera.as_mut().expect("a camera");
    camera.resolution = UVec2::new(40, 24);
    camera.crop = Some(Crop { offset: UVec2::new(13, 5), size: UVec2::new(16, 8) });
    agree_on(&scene, Filter::Gaussian { stddev: 0.5 }, 8);
}

#[test]
fn with_every_material() {
    for scene in every_material() {
        agree_on(&scene, Filter::Box, 8);
    }
}
