//! Walks from lights and their connections to the camera: what both techniques are made of.

use etendue_core::{
    bsdf::TransportMode,
    camera::CameraSample,
    film::Film,
    geometry::offset::{offset_origin, shadow_ray_to_point},
    has,
    lights::EmissionSample,
    ray::Ray,
    rgb::Rgb,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::Rays,
    technique::{Part, Settings},
    walk::{Limits, SurfaceVertex, Vertex, Walk},
};
use glam::Vec2;

/// A particle under way from a light.
pub struct Particle<'a, const HAS: u32> {
    /// Its walk. Throughputs are relative to the flux that the particle starts with, so that roulette looks at what
    /// surfaces have done to it, whatever a scene's units are.
    pub walk: Walk<'a, HAS>,
    /// How it left its light.
    pub start: EmissionSample,
    /// Largest component of the flux that it starts with.
    flux: f32,
    /// Whether the first surface scattered it by a delta lobe.
    delta_first: bool,
}

/// What the film gets of a vertex that a particle has reached.
pub struct Seen {
    /// The connection.
    pub camera: CameraSample,
    /// What to splat if nothing lies between, unweighted.
    pub value: Rgb,
    /// From the vertex to the lens.
    pub ray: Ray,
}

impl<'a, const HAS: u32> Particle<'a, HAS> {
    /// Chooses a light and a ray that leaves it. `None` where it carries nothing, or no path is long enough for light to be
    /// scattered once: one edge of [`Settings::max_depth`] is left for the connection.
    #[inline]
    pub fn emit(scene: &'a Scene, settings: &Settings, sampler: &mut dyn Sampler) -> Option<Particle<'a, HAS>> {
        if settings.max_depth < 2 {
            return None;
        }
        let u_choice = sampler.get_1d(0, Purpose::EmissionChoice);
        let u_point = sampler.get_2d(0, Purpose::EmissionPoint);
        let u_direction = sampler.get_2d(0, Purpose::EmissionDirection);
        let start = scene.lights().sample_emission::<HAS>(u_choice, u_point, u_direction)?;
        let weight = start.weight();
        let flux = weight.max_element();
        if flux <= 0.0 {
            return None;
        }
        let origin = offset_origin(start.p, start.p_error, start.normal, start.direction);
        let limits = Limits { max_depth: settings.max_depth - 1, ..settings.limits() };
        let ray = Ray::new(origin, start.direction);
        let walk = Walk::new(scene, TransportMode::Importance, limits, ray, weight * (1.0 / flux), start.pdf_w);
        Some(Particle { walk, start, flux, delta_first: false })
    }

    /// The next surface that it reaches, with its whole throughput; `None` where it leaves the scene.
    #[inline]
    pub fn trace(&mut self, rays: &mut Rays) -> Option<SurfaceVertex> {
        let Vertex::Surface(vertex) = self.walk.trace(rays) else { return None };
        if vertex.depth == 2 {
            self.delta_first = vertex.history.last_delta;
        }
        // Where it came from is the light itself, not the point beside it that the ray started at.
        let from = if vertex.depth == 1 { self.start.p } else { vertex.from };
        Some(SurfaceVertex { beta: vertex.beta * self.flux, from, ..vertex })
    }

    /// The part of the light that a path belongs to which leads over a vertex of this walk, scattered there and at `rough`
    /// further places towards the camera by lobes that are no delta.
    #[inline]
    pub fn part(&self, vertex: &SurfaceVertex, rough: u32) -> Part {
        let last_delta = vertex.depth > 1 && self.delta_first;
        let environment = self.start.infinite && !self.start.delta_direction;
        part(vertex.history.rough + 1 + rough, last_delta, environment)
    }
}

/// The part of the light that a path belongs to, given how many of its surfaces scatter by lobes that are no delta, whether
/// the one next to the light scatters by a delta lobe, and whether the light is the environment.
#[inline]
pub fn part(rough: u32, last_delta: bool, environment: bool) -> Part {
    match rough {
        0 => Part::Emission,
        _ if last_delta => Part::Caustic,
        1 if environment => Part::Environment,
        1 => Part::Direct,
        _ => Part::Indirect,
    }
}

/// Whether connections can lead to a vertex.
#[inline]
pub fn connects<const HAS: u32>(vertex: &SurfaceVertex) -> bool {
    HAS & has::LOBES == 0 || !vertex.bsdf.is_delta()
}

/// Connects a vertex that a particle has reached to the camera: `None` where the film gets nothing, whatever lies between.
/// `particles` is the number of particles of the pass, `margin` how many pixels the filter reaches beyond the film.
#[inline]
pub fn see<const HAS: u32>(
    scene: &Scene,
    vertex: &SurfaceVertex,
    particles: f32,
    margin: f32,
    sampler: &mut dyn Sampler,
) -> Option<Seen> {
    let lens = if scene.census().lens { sampler.get_2d(vertex.depth, Purpose::CameraConnection) } else { Vec2::ZERO };
    let camera = scene.camera().sample_direct(vertex.surface.p, lens)?;
    if !scene.camera().film_contains(camera.film, margin) {
        return None;
    }
    let (f_cos, _) = vertex.eval_pdf::<HAS>(camera.wi, TransportMode::Importance);
    if f_cos.is_black() {
        return None;
    }
    let mut value = vertex.beta * f_cos * (camera.importance / (camera.pdf_w * particles));
    if HAS & has::MEDIA != 0 {
        value *= vertex.transmittance::<HAS>(scene, camera.wi, camera.target.distance(vertex.surface.p));
    }
    Some(Seen { camera, value, ray: shadow_ray_to_point(&vertex.surface, camera.target) })
}

/// Number of pixels: of particles, where there is one for each.
pub fn pixels(film: &Film) -> u32 {
    film.resolution().x * film.resolution().y
}
