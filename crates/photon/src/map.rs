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

/// Irradiance known at a place [Christensen 1999].
#[derive(Clone, Copy, Debug)]
pub struct Irradiance {
    /// In W/m², times the parts of the light that count.
    pub value: Rgb,
    /// Normal of the surface on the side that it arrives on.
    pub normal: Octahedral,
    /// Radius around the place, metres, within which its irradiance is used; 0 where the disk is no clear surface.
    pub reach: f32,
    /// Edges of the longest of the photons' paths from a light.
    pub longest: u32,
}

/// Irradiance at places that do not depend on the photons it is told from.
///
/// Neither does anything that decides which place is asked, and whether: a place owns a large cell just where few photons lie
/// around it, so that places among the photons themselves would show estimates that are too low more often than others.
#[derive(Clone, Debug)]
pub struct IrradianceMap {
    /// The places.
    pub tree: KdTree<Irradiance>,
}

/// The geometric normal on the side of `wo`.
#[inline]
pub(crate) fn facing(vertex: &SurfaceVertex) -> Vec3 {
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

    /// Irradiance at a point on the side of `facing`, with the edges of the longest of the photons' paths; those of more than
    /// `longest` edges do not count.
    fn irradiance_at(
        &self,
        p: Vec3,
        facing: Vec3,
        gathering: &Gathering,
        longest: u32,
        found: &mut Neighbours,
    ) -> (Rgb, u32) {
        let nearest = self.tree.k_nearest_where(p, gathering.nearest, gathering.radius, found, |i| {
            belongs(self.tree.payload(i).normal, facing, true)
        });
        let Some(farthest) = nearest.iter().max() else { return (Rgb::BLACK, 0) };
        let (radius2, on_border) = disk(nearest.len(), farthest.distance_squared(), gathering);
        let (mut sum, mut seen) = (Rgb::BLACK, 0);
        for near in nearest.iter().filter(|near| !(on_border && *near == farthest)) {
            let photon = self.tree.payload(near.index());
            // Whatever part it belongs to, so that parts rendered by themselves add up.
            seen = seen.max(photon.history().depth);
            // Behind the final gathering's first surface, which is rough.
            if photon.history().depth <= longest && gathering.parts.contains(photon.history().part(1)) {
                sum += photon.power * gathering.kernel.weight(near.distance_squared() / radius2);
            }
        }
        (estimate(sum, radius2).map_or(Rgb::BLACK, |e| e.radiance), seen)
    }

    /// Irradiance at the places of other photons, which are independent of these and one for `every` of them
    /// [Christensen 1999]. Photons count with paths of any length. Whether the surface at a point with a normal is clear as far
    /// as a radius, `is_clear` says.
    pub fn irradiance(
        &self,
        places: PhotonMap,
        every: usize,
        gathering: &Gathering,
        is_clear: impl Fn(Vec3, Vec3, f32) -> bool + Sync,
    ) -> IrradianceMap {
        // As far as an estimate reaches, told from places alone.
        let around = Gathering { nearest: gathering.nearest.div_ceil(every), ..*gathering };
        let blank = Irradiance { value: Rgb::BLACK, normal: Octahedral::new(Vec3::Y), reach: 0.0, longest: 0 };
        let mut known = vec![(Vec3::ZERO, blank); places.tree.len()];
        parallel::for_runs_of(&mut known, 256, |first, known| {
            let mut found = Neighbours::default();
            for (own, known) in (first as u32..).zip(known) {
                let (p, normal) = (places.tree.position(own), places.tree.payload(own).normal);
                let facing = normal.vector();
                let others = places.tree.k_nearest_where(p, around.nearest, around.radius, &mut found, |i| {
                    i != own && belongs(places.tree.payload(i).normal, facing, true)
                });
                let farthest = others.iter().max().map_or(0.0, |n| n.distance_squared());
                let reach = disk(others.len(), farthest, &around).0.sqrt();
                if !is_clear(p, facing, reach) {
                    *known = (p, Irradiance { normal, ..blank });
                    continue;
                }
                let (value, longest) = self.irradiance_at(p, facing, gathering, u32::MAX, &mut found);
                *known = (p, Irradiance { value, normal, reach, longest });
            }
            RenderStatistics::default()
        });
        IrradianceMap { tree: KdTree::new(known) }
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
        // Photons are as dense as the cosine to the geometric normal says where they arrived. What is scattered has the cosine to
        // the shading normal here.
        let cos = wi.dot(photon.normal.vector()).abs();
        let (f_cos, _) = vertex.eval_pdf::<HAS>(wi, TransportMode::Radiance);
        let value = photon.power * f_cos * (1.0 / cos);
        if value.is_valid() { value } else { Rgb::BLACK }
    }
}

impl IrradianceMap {
    /// The nearest place, if there is one near: within its reach. (A place in bright light has a small one, and does not shine
    /// on what is dark.)
    #[inline]
    pub fn place(&self, vertex: &SurfaceVertex, radius: f32, found: &mut Neighbours) -> Option<(Vec3, &Irradiance)> {
        let facing = facing(vertex);
        let keep = |i: u32| belongs(self.tree.payload(i).normal, facing, true);
        let near = self.tree.k_nearest_where(vertex.surface.p, 1, radius, found, keep).first()?;
        let place = self.tree.payload(near.index());
        let within = near.distance_squared() < place.reach * place.reach;
        within.then(|| (self.tree.position(near.index()), place))
    }
}

impl Irradiance {
    /// Radiance that a Lambert surface at the end of a path of `depth` edges reflects by the irradiance at a place `p`. Where some of the
    /// photons around make paths of more edges than are asked for, they are gathered anew from `map`.
    #[inline]
    pub fn reflected(
        &self,
        p: Vec3,
        depth: u32,
        reflectance: Rgb,
        (map, gathering): (&PhotonMap, &Gathering),
        found: &mut Neighbours,
    ) -> Rgb {
        let longest = gathering.max_depth.saturating_sub(depth);
        let value = if self.longest > longest {
            map.irradiance_at(p, self.normal.vector(), gathering, longest, found).0
        } else {
            self.value
        };
        value * reflectance * (1.0 / PI)
    }
}
