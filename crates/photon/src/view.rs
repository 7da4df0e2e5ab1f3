//! Where the camera looks, so that photons are sent there.

use crate::{
    aim::Worth,
    kd_tree::{KdTree, Neighbours},
    surfaces::is_narrow,
    trace::{Fruitful, Pilot},
};
use etendue_core::{
    has, parallel,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::{Rays, RenderStatistics},
    technique::Settings,
    walk::{Vertex, Walk},
};
use glam::{UVec2, Vec2, Vec3};

/// Paths from the camera.
const PATHS: u32 = 4096;
/// Paths that share a sampler.
const RUN: usize = 256;
/// Points that a density is told from.
const NEAREST: usize = 8;

/// Points that paths from the camera have come to where photons are asked for, evenly spread over the image.
#[derive(Clone, Debug)]
pub struct View {
    tree: KdTree<()>,
}

impl View {
    /// Follows paths from the camera; `set` is the number of their set, as that of photons.
    pub fn new<const HAS: u32>(
        scene: &Scene,
        settings: &Settings,
        resolution: UVec2,
        seed: u64,
        set: u32,
    ) -> (View, RenderStatistics) {
        let mut points = vec![None; PATHS as usize];
        let statistics = parallel::for_runs_of(&mut points, RUN, |first, points| {
            let mut statistics = RenderStatistics::default();
            let mut sampler = (settings.sampler)(seed, PATHS);
            for (i, point) in points.iter_mut().enumerate() {
                sampler.start_sample(set, (first + i) as u32);
                let film = sampler.get_2d(0, Purpose::Film) * resolution.as_vec2();
                let lens = if scene.census().lens { sampler.get_2d(0, Purpose::Lens) } else { Vec2::ZERO };
                let mut walk = Walk::<HAS>::from_camera(scene, settings.limits(), film, lens);
                *point = end::<HAS>(&mut walk, &mut *sampler, &mut statistics.rays);
            }
            statistics
        });
        (View { tree: KdTree::new(points.into_iter().flatten().map(|p| (p, ())).collect()) }, statistics)
    }

    /// What each of a pilot's emissions is worth: its photons count by how densely the camera's points lie around them, over how
    /// densely photons do, so that all that is seen gets its share [Peter and Pietrek 1998, for the purpose].
    pub fn worth(&self, pilot: &Pilot) -> Vec<Worth> {
        let photons = KdTree::new(pilot.photons.iter().map(|(p, _)| (*p, ())).collect());
        let mut worths = vec![0.0; pilot.photons.len()];
        parallel::for_runs_of(&mut worths, RUN, |first, worths| {
            let mut found = Neighbours::default();
            for (worth, (p, _)) in worths.iter_mut().zip(&pilot.photons[first..]) {
                let ratio = spread(&photons, *p, &mut found) / spread(&self.tree, *p, &mut found);
                *worth = if ratio.is_finite() { f64::from(ratio) } else { 0.0 };
            }
            RenderStatistics::default()
        });
        let mut rest = worths.iter();
        let worth = |e: &Fruitful| (e.0, e.1, rest.by_ref().take(e.2 as usize).sum());
        pilot.emissions.iter().map(worth).collect()
    }
}

/// The square of the distance within which the nearest points lie.
fn spread(points: &KdTree<()>, p: Vec3, found: &mut Neighbours) -> f32 {
    let nearest = points.k_nearest(p, NEAREST, f32::INFINITY, found);
    nearest.iter().max().map_or(f32::INFINITY, |n| n.distance_squared())
}

/// Where a path from the camera comes to a surface that takes photons.
fn end<const HAS: u32>(walk: &mut Walk<HAS>, sampler: &mut dyn Sampler, rays: &mut Rays) -> Option<Vec3> {
    while let Vertex::Surface(vertex) = walk.trace(rays) {
        let takes = !is_narrow::<HAS>(&vertex.bsdf);
        let step = walk.go_on(&vertex, sampler);
        if takes && (HAS & has::LOBES == 0 || step.is_none_or(|step| !step.delta)) {
            return Some(vertex.surface.p);
        }
        step?;
    }
    None
}
