//! A photon map: photons in a tree, and what they say of the light at a point.

use crate::{
    kd_tree::{KdTree, Neighbours},
    kernel::Kernel,
    octahedral::Octahedral,
    photon::Photon,
    surfaces::LEAST_COS,
};
use etendue_core::{
    bsdf::TransportMode, has, parallel, rgb::Rgb, statistics::render::RenderStatistics, technique::Parts,
    walk::SurfaceVertex,
};
use glam::Vec3;
use std::f32::consts::PI;

/// How photons are gathered.
#[derive(Clone, Copy, Debug)]
pub struct Gathering {
    /// Photons in an estimate.
    pub nearest: usize,
    /// Greatest distance, metres.
    pub radius: f32,
    /// How they count by distance.
    pub kernel: Kernel,
    /// Parts of the light that count.
    pub parts: Parts,
    /// Longest path.
    pub max_depth: u32,
}

/// An estimate of reflected light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Radiance towards the camera.
    pub radiance: Rgb,
    /// The radius that photons were gathered in.
    pub radius: f32,
}

/// Photons in a tree.
#[derive(Clone, Debug)]
pub struct PhotonMap {
    /// The photons.
    pub tree: KdTree<Photon>,
}

/// Irradiance known at a photon's place [Christensen 1999].
#[derive(Clone, Copy, Debug)]
pub struct Irradiance {
    /// In W/m², times the parts of the light that count.
    pub value: Rgb,
    /// Normal of the surface on the side that it arrives on.
    pub normal: Octahedral,
    /// The radius that photons were gathered in.
    pub radius: f32,
    /// Edges of the longest of their paths from a light.
    pub longest: u32,
}

/// Irradiance at a share of a map's photons.
#[derive(Clone, Debug)]
pub struct IrradianceMap {
    /// The places.
    pub tree: KdTree<Irradiance>,
    /// Greatest distance to the nearest place, metres.
    pub radius: f32,
}

/// The geometric normal on the side of `wo`.
#[inline]
fn facing(vertex: &SurfaceVertex) -> Vec3 {
    let ng = vertex.surface.ng;
    if ng.dot(vertex.wo) < 0.0 { -ng } else { ng }
}

/// Whether a photon that arrived on the side of `normal` belongs to a surface seen from the side of `facing`.
#[inline]
fn belongs(normal: Octahedral, facing: Vec3, opaque: bool) -> bool {
    let cos = normal.vector().dot(facing);
    if opaque { cos >= LEAST_COS } else { cos.abs() >= LEAST_COS }
}

/// Where `count` photons were found of `nearest` that were looked for: the squared radius of the disk that they stand for,
/// and whether the farthest stands on its border and does not count.
///
/// The `k` nearest of evenly spread photons lie in a disk of `k - 1` times the area that one has: with the farthest on the border
/// left out, the estimate is right on average.
#[inline]
fn disk(count: usize, farthest: f32, gathering: &Gathering) -> (f32, bool) {
    if count == gathering.nearest { (farthest, true) } else { (gathering.radius * gathering.radius, false) }
}

impl PhotonMap {
    /// Arranges photons.
    pub fn new(photons: Vec<(Vec3, Photon)>) -> PhotonMap {
        PhotonMap { tree: KdTree::new(photons) }
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> u64 {
        self.tree.memory_bytes()
    }

    /// Radiance that the map's photons have reflected from a vertex towards where the path comes from [Jensen 1996, eq. 8].
    /// `None` where the map is empty or the disk has no area: then there is no light.
    #[inline]
    pub fn radiance<const HAS: u32>(
        &self,
        vertex: &SurfaceVertex,
        gathering: &Gathering,
        found: &mut Neighbours,
    ) -> Option<Estimate> {
        let facing = facing(vertex);
        let opaque = HAS & has::LOBES == 0 || vertex.bsdf.has_opaque_back() || is_opaque(vertex);
        let nearest = self.tree.k_nearest_where(vertex.surface.p, gathering.nearest, gathering.radius, found, |i| {
            belongs(self.tree.payload(i).normal, facing, opaque)
        });
        let farthest = nearest.iter().max()?;
        let (radius2, on_border) = disk(nearest.len(), farthest.distance_squared(), gathering);
        let mut sum = Rgb::BLACK;
        for near in nearest {
            if on_border && near == farthest {
                continue;
            }
            let photon = self.tree.payload(near.index());
            sum +=
                gathering.reflected::<HAS>(vertex, photon) * gathering.kernel.weight(near.distance_squared() / radius2);
        }
        estimate(sum, radius2)
    }

    /// The same from all photons within a given radius, which does not depend on them.
    #[inline]
    pub fn radiance_within<const HAS: u32>(
        &self,
        vertex: &SurfaceVertex,
        gathering: &Gathering,
        radius: f32,
    ) -> Option<Estimate> {
        let facing = facing(vertex);
        let opaque = HAS & has::LOBES == 0 || vertex.bsdf.has_opaque_back() || is_opaque(vertex);
        let radius2 = radius * radius;
        let mut sum = Rgb::BLACK;
        self.tree.within(vertex.surface.p, radius, |near| {
            let photon = self.tree.payload(near.index());
            if belongs(photon.normal, facing, opaque) {
                let weight = gathering.kernel.weight((near.distance_squared() / radius2).min(1.0));
                sum += gathering.reflected::<HAS>(vertex, photon) * weight;
            }
        });
        estimate(sum, radius2)
    }

    /// The distance to the farthest of the photons that an estimate at a vertex would take.
    #[inline]
    pub fn reach<const HAS: u32>(&self, vertex: &SurfaceVertex, gathering: &Gathering, found: &mut Neighbours) -> f32 {
        let facing = facing(vertex);
        let opaque = HAS & has::LOBES == 0 || vertex.bsdf.has_opaque_back() || is_opaque(vertex);
        let nearest = self.tree.k_nearest_where(vertex.surface.p, gathering.nearest, gathering.radius, found, |i| {
            belongs(self.tree.payload(i).normal, facing, opaque)
        });
        let farthest = nearest.iter().max().map_or(0.0, |n| n.distance_squared());
        disk(nearest.len(), farthest, gathering).0.sqrt()
    }

    /// Irradiance at every `every`-th photon [Christensen 1999]. Photons count with paths of any length; a photon does not count
    /// at its own place, where it is by choice and not by chance: estimates would be too high by its share.
    pub fn irradiance(&self, every: usize, gathering: &Gathering) -> IrradianceMap {
        let blank = Irradiance { value: Rgb::BLACK, normal: Octahedral::new(Vec3::Y), radius: 0.0, longest: 0 };
        let mut places: Vec<(Vec3, Irradiance)> = (0..self.tree.len())
            .step_by(every)
            .map(|i| (self.tree.position(i as u32), Irradiance { normal: self.tree.payloads()[i].normal, ..blank }))
            .collect();
        parallel::for_runs_of(&mut places, 256, |first, places| {
            let mut found = Neighbours::default();
            for (number, (p, place)) in places.iter_mut().enumerate() {
                let (facing, own) = (place.normal.vector(), ((first + number) * every) as u32);
                let nearest = self.tree.k_nearest_where(*p, gathering.nearest, gathering.radius, &mut found, |i| {
                    i != own && belongs(self.tree.payload(i).normal, facing, true)
                });
                let Some(farthest) = nearest.iter().max() else { continue };
                let (radius2, on_border) = disk(nearest.len(), farthest.distance_squared(), gathering);
                let mut sum = Rgb::BLACK;
                for near in nearest.iter().filter(|near| !(on_border && *near == farthest)) {
                    let photon = self.tree.payload(near.index());
                    // Whatever part it belongs to, so that parts rendered by themselves add up.
                    place.longest = place.longest.max(photon.history().depth);
                    // Behind the final gathering's first surface, which is rough.
                    if gathering.parts.contains(photon.history().part(1)) {
                        sum += photon.power * gathering.kernel.weight(near.distance_squared() / radius2);
                    }
                }
                if let Some(e) = estimate(sum, radius2) {
                    (place.value, place.radius) = (e.radiance, e.radius);
                }
            }
            RenderStatistics::default()
        });
        IrradianceMap { tree: KdTree::new(places), radius: gathering.radius }
    }
}

/// Whether light does not pass the surface, which has one side.
#[inline]
fn is_opaque(vertex: &SurfaceVertex) -> bool {
    matches!(vertex.bsdf.first, etendue_core::bsdf::Lobe::Lambert { .. }) && vertex.bsdf.second.is_none()
}

/// A sum over a disk, by its area.
#[inline]
fn estimate(sum: Rgb, radius2: f32) -> Option<Estimate> {
    let radiance = sum * (1.0 / (PI * radius2));
    // Photons that all lie in one point have no area: what they say there is infinite, and nowhere else anything.
    radiance.is_valid().then(|| Estimate { radiance, radius: radius2.sqrt() })
}

impl Gathering {
    /// What a vertex reflects of a photon; black where the photon makes no path that counts.
    #[inline]
    fn reflected<const HAS: u32>(&self, vertex: &SurfaceVertex, photon: &Photon) -> Rgb {
        let history = photon.history();
        if history.depth + vertex.depth > self.max_depth || !self.parts.contains(history.part(vertex.history.rough)) {
            return Rgb::BLACK;
        }
        let wi = photon.wi.vector();
        // Photons are as dense as the cosine to the geometric normal says, where they arrived or here; the larger of the two is
        // safe on curved surfaces. What is scattered has the shading normal's.
        let cos = wi.dot(vertex.surface.ng).abs().max(wi.dot(photon.normal.vector()).abs());
        let (f_cos, _) = vertex.eval_pdf::<HAS>(wi, TransportMode::Radiance);
        let value = photon.power * f_cos * (1.0 / cos);
        if value.is_valid() { value } else { Rgb::BLACK }
    }
}

impl IrradianceMap {
    /// What a Lambert surface reflects by the irradiance of the nearest place; `None` where there is no place near: within the
    /// radius that its photons were gathered in (a place in bright light has a small one, and does not shine on what is dark); nor
    /// where some of those photons make paths of more than `max_depth` edges.
    #[inline]
    pub fn radiance(
        &self,
        vertex: &SurfaceVertex,
        reflectance: Rgb,
        max_depth: u32,
        found: &mut Neighbours,
    ) -> Option<Estimate> {
        let facing = facing(vertex);
        let keep = |i: u32| belongs(self.tree.payload(i).normal, facing, true);
        let near = self.tree.k_nearest_where(vertex.surface.p, 1, self.radius, found, keep).first()?;
        let place = self.tree.payload(near.index());
        if near.distance_squared() > place.radius * place.radius || vertex.depth + place.longest > max_depth {
            return None;
        }
        Some(Estimate { radiance: place.value * reflectance * (1.0 / PI), radius: place.radius })
    }
}
