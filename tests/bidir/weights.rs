//! The weights that the walks sum up are those of the strategies' densities, and sum to 1.

use crate::{
    direct::{FullPath, Origin, OriginKind, Point, Retraced},
    scenes::{every_light, every_material},
};
use etendue_bidir::{
    events::{Contribution, Event, Side},
    strategies::Paths,
    weights::Heuristic,
};
use etendue_core::{
    camera::Projection,
    filter::Filter,
    has,
    independent::independent,
    lights::EmissionSample,
    scene::SceneDescription,
    statistics::render::Rays,
    walk::{Continuation, SurfaceVertex},
};
use etendue_tests::Run;
use glam::{UVec2, Vec3};

/// What happened on one side.
#[derive(Default)]
struct Record {
    vertices: Vec<SurfaceVertex>,
    steps: Vec<Continuation>,
}

/// Origin of a walk from a light.
fn emitted(e: &EmissionSample) -> Origin {
    let kind = match (e.infinite, e.delta_position || e.delta_direction) {
        (true, true) => OriginKind::Directional,
        (true, false) => OriginKind::Environment,
        (false, true) => OriginKind::Point,
        (false, false) => OriginKind::Area,
    };
    Origin { element: e.element, kind, p: e.p, p_error: e.p_error, normal: e.normal, direction: e.direction }
}

/// The path that a strategy has made; `None` for a light that the camera sees directly.
fn full_path(
    run: &Run,
    c: &Contribution<'_>,
    start: Option<&EmissionSample>,
    light: &Record,
    camera: &Record,
    escaped: Option<Vec3>,
) -> Option<FullPath> {
    let delta = |record: &Record, i: usize, invert: bool| {
        let step = record.steps.get(i)?;
        step.delta.then_some(if invert { 1.0 / step.eta } else { step.eta })
    };
    let (s, t) = (c.s as usize, c.t as usize);
    let mut points = Vec::new();
    // The last vertex of either side is connected.
    for i in 0..s.saturating_sub(1) {
        let delta = if i + 2 < s { delta(light, i, false) } else { None };
        points.push(Point { vertex: light.vertices[i], delta });
    }
    let surfaces = if s == 0 { t - 2 } else { t - 1 };
    for i in (0..surfaces).rev() {
        let connected = s > 0 && i + 1 == surfaces;
        let delta = if connected { None } else { delta(camera, i, true) };
        points.push(Point { vertex: camera.vertices[i], delta });
    }
    if points.is_empty() {
        return None;
    }
    let origin = match s {
        0 => match escaped {
            Some(direction) => Origin {
                element: run.scene.lights().environment_element().expect("an environment"),
                kind: OriginKind::Environment,
                p: Vec3::ZERO,
                p_error: Vec3::ZERO,
                normal: Vec3::ZERO,
                direction: -direction,
            },
            None => {
                let surface = &camera.vertices[t - 2].surface;
                Origin {
                    element: run.scene.element(surface).expect("a light"),
                    kind: OriginKind::Area,
                    p: surface.p,
                    p_error: surface.p_error,
                    normal: surface.ng,
                    direction: camera.vertices[t - 2].wo,
                }
            }
        },
        1 => {
            let l = c.light.expect("a sampled light");
            let kind = match (l.infinite, l.delta) {
                (true, true) => OriginKind::Directional,
                (true, false) => OriginKind::Environment,
                (false, true) => OriginKind::Point,
                (false, false) => OriginKind::Area,
            };
            Origin {
                element: l.element,
                kind,
                p: l.target,
                p_error: l.target_error,
                normal: l.target_normal,
                direction: -l.wi,
            }
        }
        _ => emitted(start.expect("a walk from a light")),
    };
    let lens = c.lens.unwrap_or_else(|| camera.vertices[0].from);
    Some(FullPath { origin, points, lens })
}

/// Particles for each path from the camera, of caustics.
const PARTICLES: u32 = 3;

/// What was found in one scene.
#[derive(Default)]
struct Tally {
    /// Paths looked at, by how they were made: s = 0, s = 1, s and t >= 2, t = 1.
    made: [u32; 4],
    /// Of those, paths of particles for caustics alone.
    caustics: u32,
    /// Of all, paths that rays along them missed by rounding.
    missed: u32,
    /// Paths with a weight off by more than a thousandth of itself, or of a thousandth.
    apart: u32,
    worst: f64,
}

impl Tally {
    /// Checks a path that strategy `s` made with the weight `weight`.
    fn check(&mut self, retraced: &Retraced<'_>, heuristic: Heuristic, s: usize, weight: f64) {
        let (densities, recursive) = (retraced.relative_densities(), retraced.recursive(heuristic));
        let total: f64 = densities.iter().map(|p| heuristic.term(*p)).sum();
        let mut off = (recursive.iter().sum::<f64>() - 1.0).abs();
        let mut compare = |weight: f64, density: f64| match heuristic {
            Heuristic::Balance | Heuristic::Power => {
                let direct = heuristic.term(density) / total;
                off = off.max((weight - direct).abs() / direct.max(1e-3));
            }
            // Ties, up to rounding and a thousandth a vertex, may go either way.
            Heuristic::Maximum => {
                let tie = 1.0 - 2e-3 * densities.len() as f64;
                if weight != f64::from(density == 1.0) && density < tie {
                    off = f64::INFINITY;
                }
            }
        };
        compare(weight, densities[s]);
        for (weight, density) in recursive.iter().zip(&densities) {
            compare(*weight, *density);
        }
        self.worst = self.worst.max(off);
        self.apart += u32::from(off > 1e-3);
    }
}

fn check(name: &str, run: &Run, projection: Projection, heuristic: Heuristic, passes: u32) {
    let pixels = run.resolution.x * run.resolution.y;
    let mut paths =
        Paths::new(&run.scene, &run.settings, heuristic, run.filter, pixels).with_caustic_particles(PARTICLES);
    let mut sampler = independent(77, 0);
    let mut tally = Tally::default();
    for turn in 0..2 * pixels * passes {
        let (index, pair) = (turn / 2, turn % 2 == 0);
        let pixel = UVec2::new(index % run.resolution.x, index / run.resolution.x % run.resolution.y);
        sampler.start_sample(index, turn % 2);
        let (mut start, mut light, mut camera) = (None, Record::default(), Record::default());
        let mut found = Vec::new();
        let mut tell = |event: Event<'_>| match event {
            Event::Emission(e) => start = Some(*e),
            Event::Vertex(side, vertex) => match side {
                Side::Light => light.vertices.push(*vertex),
                Side::Camera => camera.vertices.push(*vertex),
            },
            Event::Step(side, step) => match side {
                Side::Light => light.steps.push(*step),
                Side::Camera => camera.steps.push(*step),
            },
            Event::Contribution(c) => {
                // A walk that has hit nothing more has escaped.
                let escaped = c.s == 0 && camera.vertices.len() as u32 + 1 < c.t;
                let escaped = camera.steps.last().filter(|_| escaped).map(|step| step.wi);
                if let Some(path) = full_path(run, &c, start.as_ref(), &light, &camera, escaped) {
                    found.push((c.s as usize, c.t, f64::from(c.weight), path));
                }
            }
        };
        if pair {
            paths.sample::<{ has::ALL }>(pixel, &mut *sampler, &mut Rays::default(), &mut tell);
        } else {
            paths.caustic_particle::<{ has::ALL }>(&mut *sampler, &mut Rays::default(), &mut tell);
        }
        for (s, t, weight, path) in &found {
            tally.made[if *t == 1 { 3 } else { (*s).min(2) }] += 1;
            tally.caustics += u32::from(!pair);
            match Retraced::new(&run.scene, projection, pixels, PARTICLES, path) {
                Some(retraced) => {
                    assert_eq!(retraced.edges() as u32, *s as u32 + t - 1);
                    tally.check(&retraced, heuristic, *s, *weight);
                }
                None => tally.missed += 1,
            }
        }
    }
    let Tally { made, caustics, missed, apart, worst } = tally;
    println!(
        "{name}, {}: {made:?} paths, {caustics} of them of particles for caustics, {missed} missed, {apart} apart, worst {worst:.1e}",
        heuristic.name()
    );
    let all: u32 = made.iter().sum();
    assert!(all > 100 && made[1] > 0 && made[3] > 0, "{name}: {made:?}");
    assert!(caustics > 0 || name != "glass-caustic", "{name}: no caustic");
    // Between surfaces that all but touch, directions have few digits.
    assert!(missed * 100 < all, "{name}: {missed} missed");
    assert_eq!(apart, 0, "{name}: of {all}, worst {worst}");
}

fn check_all(name: &str, run: &Run, projection: Projection) {
    for (heuristic, passes) in [(Heuristic::Balance, 16), (Heuristic::Power, 4), (Heuristic::Maximum, 4)] {
        check(name, run, projection, heuristic, passes);
    }
}

fn check_scene(scene: &SceneDescription) {
    let projection = scene.camera.as_ref().expect("a camera").projection;
    check_all(&scene.name, &Run::of(scene, Filter::Tent { radius: 1.0 }, 6), projection);
}

#[test]
fn weights_are_those_of_all_densities_in_the_built_in_scenes() {
    for spec in [
        "cornell",
        "furnace",
        "furnace:room=sphere",
        "furnace:material=dielectric",
        "furnace:material=rough-dielectric",
        "veach-mis",
        "glass-caustic",
        "ring",
        "ajar-door",
        "many-lights:n=16",
        "sky",
        "hidden-lights",
        "bumpy",
        "bumpy:rings=4,bumps=0.3",
    ] {
        // They all have a pinhole; its field of view is not asked for.
        check_all(spec, &Run::builtin(spec, 8), Projection::Perspective { fov_x: 1.0 });
    }
}

#[test]
fn so_they_are_with_every_light_and_camera() {
    for projection in [
        Projection::Perspective { fov_x: 0.9 },
        Projection::ThinLens { fov_x: 0.9, aperture_radius: 0.1, focus_distance: 4.0 },
        Projection::Orthographic { width: 3.0 },
    ] {
        check_scene(&every_light(projection));
    }
}

#[test]
fn so_they_are_with_every_material() {
    for scene in every_material() {
        check_scene(&scene);
    }
}
