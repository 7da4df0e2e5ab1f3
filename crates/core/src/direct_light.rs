//! Light at the end of a path from the camera: lights that it runs into, and lights that are sampled from its last vertex
//! (next-event estimation), weighted against each other.

use crate::{
    bsdf::TransportMode,
    geometry::offset::{shadow_ray, spawn_ray},
    has,
    lights::DirectSample,
    mis::power_heuristic,
    ray::Ray,
    rgb::Rgb,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::Rays,
    technique::{Part, Parts},
    walk::{EscapedVertex, History, SurfaceVertex},
};

/// The weight of a path whose last direction was sampled from the BSDF (or the camera): 1 where sampling the lights
/// could not have found it. `light_pdf` is times the number of samples of the lights.
#[inline]
fn bsdf_weight(history: History, bsdf_pdf: f32, light_pdf: f32) -> f32 {
    let only_way = history.last_delta || history.rough == 0;
    if only_way { 1.0 } else { power_heuristic(bsdf_pdf, light_pdf) }
}

/// The part of the light that a path belongs to that ran into a light.
#[inline]
fn seen_part(history: History, infinite: bool) -> Part {
    match history {
        History { rough: 0, .. } => Part::Emission,
        History { last_delta: true, .. } => Part::Caustic,
        History { rough: 1, .. } if infinite => Part::Environment,
        History { rough: 1, .. } => Part::Direct,
        _ => Part::Indirect,
    }
}

/// Light from infinity that a path runs into that leaves the scene, if it is among `parts`; `light_samples` is the number of
/// samples of the lights that its last vertex takes.
#[inline]
pub fn escaped<const HAS: u32>(scene: &Scene, parts: Parts, light_samples: f32, end: &EscapedVertex) -> Rgb {
    if HAS & has::INFINITE == 0 || !parts.contains(seen_part(end.history, true)) {
        return Rgb::BLACK;
    }
    let (radiance, light_pdf) = scene.lights().environment_radiance_and_pdf(end.direction);
    end.beta * radiance * bsdf_weight(end.history, end.pdf_w, light_samples * light_pdf)
}

/// Light that the vertex itself emits towards the path, if it is among `parts`; `element` is what [`Scene::element`] gives.
#[inline]
pub fn emitted<const HAS: u32>(
    scene: &Scene,
    parts: Parts,
    light_samples: f32,
    vertex: &SurfaceVertex,
    element: u32,
) -> Rgb {
    let radiance = scene.lights().emitted::<HAS>(element, &vertex.surface, vertex.wo);
    if radiance.is_black() || !parts.contains(seen_part(vertex.history, false)) {
        return Rgb::BLACK;
    }
    let surface = &vertex.surface;
    let light_pdf = scene.lights().pdf_direct(element, vertex.from, surface.p, surface.ng, -vertex.wo);
    vertex.beta * radiance * bsdf_weight(vertex.history, vertex.pdf_w, light_samples * light_pdf)
}

/// The part of the light that a path belongs to that ends in a sampled light.
#[inline]
pub fn sampled_part(history: History, light: &DirectSample) -> Part {
    match (history.rough, light.infinite && !light.delta) {
        (0, true) => Part::Environment,
        (0, false) => Part::Direct,
        _ => Part::Indirect,
    }
}

/// The ray that tests whether a sampled light is visible.
#[inline]
pub fn light_ray(vertex: &SurfaceVertex, light: &DirectSample) -> Ray {
    if light.infinite {
        spawn_ray(&vertex.surface, light.wi)
    } else {
        shadow_ray(&vertex.surface, light.target, light.target_error, light.target_normal, light.target_id)
    }
}

/// The weight of one of so many samples of the lights; a light without an extent cannot be found by sampling the BSDF.
#[inline]
pub fn light_weight(light: &DirectSample, light_samples: f32, bsdf_pdf: f32) -> f32 {
    if light.delta { 1.0 } else { power_heuristic(light_samples * light.pdf_w, bsdf_pdf) }
}

/// The light of a sampled light that arrives if nothing is in between.
#[inline]
pub fn arriving<const HAS: u32>(scene: &Scene, vertex: &SurfaceVertex, light: &DirectSample) -> Rgb {
    if HAS & has::MEDIA == 0 {
        return light.radiance;
    }
    let distance = if light.infinite { f32::INFINITY } else { light.target.distance(vertex.surface.p) };
    light.radiance * vertex.transmittance::<HAS>(scene, light.wi, distance)
}

/// Light that reaches a vertex if nothing is in between.
///
/// Whether anything is, is best asked after the path's next direction has been sampled: neither waits for the other, while a walk
/// through the hierarchy lets nothing start that comes after it.
#[derive(Clone, Copy, Debug)]
pub struct LightEdge {
    /// The way to the light.
    pub ray: Ray,
    /// What it adds to the pixel, weighted.
    pub value: Rgb,
}

impl LightEdge {
    /// What arrives.
    #[inline]
    pub fn arriving<const HAS: u32>(&self, scene: &Scene, rays: &mut Rays) -> Rgb {
        rays.shadow += 1;
        if scene.occluded::<HAS>(&self.ray) { Rgb::BLACK } else { self.value }
    }
}

/// Samples a light and a point of it for a vertex (next-event estimation); `None` where nothing can come of it, or only what is not
/// among `parts`.
#[inline]
pub fn next_event<const HAS: u32>(
    scene: &Scene,
    parts: Parts,
    vertex: &SurfaceVertex,
    sampler: &mut dyn Sampler,
) -> Option<LightEdge> {
    let u_choice = sampler.get_1d(vertex.depth, Purpose::LightChoice);
    let u = sampler.get_2d(vertex.depth, Purpose::LightPoint);
    let light = scene.lights().sample_direct::<HAS>(vertex.surface.p, u_choice, u)?;
    if !parts.contains(sampled_part(vertex.history, &light)) {
        return None;
    }
    let (f_cos, bsdf_pdf) = vertex.eval_pdf::<HAS>(light.wi, TransportMode::Radiance);
    if f_cos.is_black() {
        return None;
    }
    let weight = light_weight(&light, 1.0, bsdf_pdf);
    let value = vertex.beta * f_cos * arriving::<HAS>(scene, vertex, &light) * (weight / light.pdf_w);
    Some(LightEdge { ray: light_ray(vertex, &light), value })
}
