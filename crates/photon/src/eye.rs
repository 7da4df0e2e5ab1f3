//! Paths from the camera: as in path tracing, but for what photon maps take over.
//!
//! A scattering is *wide* where it is by a lobe that is no delta, on a surface that takes photons
//! ([`is_narrow`](crate::surfaces::is_narrow)); any other is *narrow*. A path that reaches the light by way of narrow
//! scatterings alone, after a wide one, is a caustic path, and belongs to the caustic map where there is one; paths from here
//! drop it. Every path is counted once.

use crate::{
    clear::is_clear,
    kd_tree::Neighbours,
    map::{Estimate, Gathering, IrradianceMap, PhotonMap, facing},
    surfaces::is_narrow,
};
use etendue_core::{
    bsdf::{Bsdf, Lobe},
    direct_light::{emitted, escaped, next_event},
    filter::Filter,
    has,
    rgb::Rgb,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::Rays,
    technique::Settings,
    walk::{SurfaceVertex, Vertex, Walk},
};
use glam::{UVec2, Vec2};

/// What a map is asked and how.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub map: &'a PhotonMap,
    pub gathering: Gathering,
}

impl Source<'_> {
    #[inline]
    fn reflected<const HAS: u32>(&self, vertex: &SurfaceVertex, found: &mut Neighbours) -> Option<Estimate> {
        self.map.radiance::<HAS>(vertex, &self.gathering, found)
    }
}

/// Where indirect light comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Indirect<'a> {
    /// Paths go on.
    Paths,
    /// The second surface that takes photons is asked for what it reflects of the global map.
    Gather { global: Option<Source<'a>>, irradiance: Option<&'a IrradianceMap> },
    /// The first one is, for direct light as well.
    Show { global: Option<Source<'a>> },
    /// The first one is asked for what it reflects of photons that are scattered before, within the `shrink`-fold radius that
    /// the pilot's photons suggest, which is at most so many pixels of a size.
    Progressive { photons: Source<'a>, pilot: Source<'a>, shrink: f32, pixels: f32, footprint: Footprint },
}

/// How pixels are estimated.
pub(crate) struct Eye<'a> {
    pub scene: &'a Scene,
    pub settings: &'a Settings,
    pub filter: Filter,
    /// The caustic map, where there is one.
    pub caustics: Option<Source<'a>>,
    pub indirect: Indirect<'a>,
}

/// Smallest first radius of progressive estimates, in pixels. Below it blur is not seen; but where photons of the pilot happen to
/// lie close together, a disk of next to no size would get few photons, of enormous weight.
const FINEST: f32 = 0.5;

/// How large a pixel is, by how far what it shows is away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    /// Its width at the camera, metres.
    origin: f32,
    /// What it grows by a metre.
    spread: f32,
}

impl Footprint {
    /// A pixel's in the middle of the film.
    pub fn of(scene: &Scene, resolution: UVec2) -> Footprint {
        let ray = |x: f32| {
            let film = resolution.as_vec2() * 0.5 + Vec2::X * x;
            scene.camera().sample_ray(film, Vec2::ZERO)
        };
        let (a, b) = (ray(-0.5), ray(0.5));
        Footprint { origin: a.origin.distance(b.origin), spread: a.direction.distance(b.direction) }
    }

    /// Its width in metres at the end of a path of so many metres.
    #[inline]
    fn at(self, length: f32) -> f32 {
        self.origin + self.spread * length
    }
}

/// What maps say of a vertex, and what is left to do there.
struct Look {
    reflected: Rgb,
    /// Whether lights are to be sampled.
    direct: bool,
    /// Whether all wide scattering is accounted for.
    ends: bool,
}

impl Eye<'_> {
    /// Whether paths drop caustics.
    #[inline]
    fn has_caustics(&self) -> bool {
        self.caustics.is_some() || matches!(self.indirect, Indirect::Progressive { .. })
    }

    /// One estimate of a pixel's value.
    #[inline]
    pub fn pixel_sample<const HAS: u32>(
        &self,
        pixel: UVec2,
        sampler: &mut dyn Sampler,
        found: &mut Neighbours,
        rays: &mut Rays,
    ) -> Rgb {
        let (scene, settings) = (self.scene, self.settings);
        let film = pixel.as_vec2() + 0.5 + self.filter.sample(sampler.get_2d(0, Purpose::Film));
        let lens = if scene.census().lens { sampler.get_2d(0, Purpose::Lens) } else { Vec2::ZERO };
        let mut walk = Walk::<HAS>::from_camera(scene, settings.limits(), film, lens);
        let mut sum = Rgb::BLACK;
        // Wide scatterings so far, and whether a narrow one has followed the last of them.
        let (mut wide, mut narrow_since) = (0, false);
        let mut length = 0.0;
        loop {
            let counts = !(wide > 0 && narrow_since && self.has_caustics());
            match walk.trace(rays) {
                Vertex::Escaped(end) => {
                    return if counts { sum + escaped::<HAS>(scene, settings.parts, 1.0, &end) } else { sum };
                }
                Vertex::Surface(vertex) => {
                    if matches!(self.indirect, Indirect::Progressive { .. }) {
                        length += vertex.from.distance(vertex.surface.p);
                    }
                    if counts && let Some(element) = scene.element(&vertex.surface) {
                        sum += emitted::<HAS>(scene, settings.parts, 1.0, &vertex, element);
                    }
                    if wide > 0 && matches!(self.indirect, Indirect::Progressive { .. }) {
                        return sum;
                    }
                    let narrow = is_narrow::<HAS>(&vertex.bsdf);
                    let look = if narrow {
                        Look { reflected: Rgb::BLACK, direct: wide == 0 || !self.has_caustics(), ends: false }
                    } else {
                        self.look::<HAS>(&vertex, wide, length, found)
                    };
                    sum += vertex.beta * look.reflected;
                    if look.direct && !walk.is_exhausted() && (HAS & has::LOBES == 0 || !vertex.bsdf.is_delta()) {
                        sum += next_event::<HAS>(scene, settings.parts, &vertex, sampler)
                            .map_or(Rgb::BLACK, |light| light.arriving::<HAS>(scene, rays));
                    }
                    if look.ends && (HAS & has::LOBES == 0 || !vertex.bsdf.has_delta()) {
                        return sum;
                    }
                    match walk.go_on(&vertex, sampler) {
                        None => return sum,
                        Some(step) if narrow || step.delta => narrow_since |= wide > 0,
                        Some(_) if look.ends => return sum,
                        Some(_) => (wide, narrow_since) = (wide + 1, false),
                    }
                }
            }
        }
    }

    /// What the maps say of a surface that takes photons, at the end of a path whose length progressive estimates ask for.
    #[inline]
    fn look<const HAS: u32>(&self, vertex: &SurfaceVertex, wide: u32, length: f32, found: &mut Neighbours) -> Look {
        let reflected = |e: Option<Estimate>| e.map_or(Rgb::BLACK, |e| e.radiance);
        match &self.indirect {
            Indirect::Show { global } => {
                Look { reflected: reflected(ask::<HAS>(global, vertex, found)), direct: false, ends: true }
            }
            Indirect::Progressive { photons, pilot, shrink, pixels, footprint } => {
                let pixel = footprint.at(length);
                let most = pilot.gathering.radius.min(pixels * pixel);
                let gathering = Gathering { radius: most, ..pilot.gathering };
                let least = most.min(FINEST * pixel);
                let mut radius = pilot.map.reach::<HAS>(vertex, &gathering, found).max(least) * shrink;
                // In corners and over edges disks are as small as it takes for them to be surface, if that is to be seen.
                let normal = facing(vertex);
                while radius > least * shrink && !is_clear::<HAS>(self.scene, vertex.surface.p, normal, radius) {
                    radius = (0.5 * radius).max(least * shrink);
                }
                let estimate = photons.map.radiance_within::<HAS>(vertex, &photons.gathering, radius);
                Look { reflected: reflected(estimate), direct: true, ends: false }
            }
            Indirect::Gather { global: Some(global), irradiance } if wide > 0 => {
                // Nearer than photons resolve, the first surface would show their blur: there paths go on once more
                // [Jensen 1996, sec. 4.2].
                let from2 = vertex.from.distance_squared(vertex.surface.p);
                let resolves = |radius: f32| wide > 1 || from2 >= radius * radius;
                let known = match irradiance {
                    // Where no place stands for what is around, they always do.
                    Some(places) => places
                        .place(vertex, global.gathering.radius, found)
                        .filter(|(_, place)| resolves(place.reach))
                        .map(|(p, place)| match lambert(vertex) {
                            Some(reflectance) => {
                                let map = (global.map, &global.gathering);
                                place.reflected(p, vertex.depth, reflectance, map, found)
                            }
                            None => reflected(global.reflected::<HAS>(vertex, found)),
                        }),
                    None => match global.reflected::<HAS>(vertex, found) {
                        Some(estimate) => resolves(estimate.radius).then_some(estimate.radiance),
                        None => Some(Rgb::BLACK),
                    },
                };
                match known {
                    Some(reflected) => Look { reflected, direct: false, ends: true },
                    None => Look {
                        reflected: reflected(ask::<HAS>(&self.caustics, vertex, found)),
                        direct: true,
                        ends: false,
                    },
                }
            }
            Indirect::Gather { global: None, .. } if wide > 0 => {
                Look { reflected: Rgb::BLACK, direct: false, ends: true }
            }
            _ => Look { reflected: reflected(ask::<HAS>(&self.caustics, vertex, found)), direct: true, ends: false },
        }
    }
}

/// Asks a map, if there is one.
#[inline]
fn ask<const HAS: u32>(source: &Option<Source>, vertex: &SurfaceVertex, found: &mut Neighbours) -> Option<Estimate> {
    source.as_ref()?.reflected::<HAS>(vertex, found)
}

/// The albedo of a surface that shows irradiance alone.
#[inline]
fn lambert(vertex: &SurfaceVertex) -> Option<Rgb> {
    match vertex.bsdf {
        Bsdf { first: Lobe::Lambert { reflectance }, second: None, two_sided } if vertex.tilt.is_none() => {
            Some(if two_sided || vertex.wo_local.z > 0.0 { reflectance } else { Rgb::BLACK })
        }
        _ => None,
    }
}
