//! One path: the estimate of the radiance through a pixel.

use etendue_core::{
    bsdf::TransportMode,
    filter::Filter,
    geometry::offset::{shadow_ray, spawn_ray},
    has,
    lights::DirectSample,
    mis::power_heuristic,
    ray::Ray,
    rgb::Rgb,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::Rays,
    technique::{Part, Settings},
    walk::{History, SurfaceVertex, Vertex, Walk},
};
use glam::UVec2;

/// One estimate of a pixel's value. `RESAMPLED`: each vertex looks at `candidates` of next-event estimation; otherwise at
/// one, whatever `candidates` is.
#[inline]
pub fn pixel_sample<const HAS: u32, const RESAMPLED: bool>(
    scene: &Scene,
    settings: &Settings,
    candidates: u32,
    filter: Filter,
    pixel: UVec2,
    sampler: &mut dyn Sampler,
    rays: &mut Rays,
) -> Rgb {
    // The position follows the filter's own density, so that every path counts alike [Ernst et al. 2006].
    let film = pixel.as_vec2() + 0.5 + filter.sample(sampler.get_2d(0, Purpose::Film));
    let light_samples = if RESAMPLED { candidates as f32 } else { 1.0 };
    let lens = if scene.census().lens { sampler.get_2d(0, Purpose::Lens) } else { glam::Vec2::ZERO };
    let mut walk = Walk::<HAS>::from_camera(scene, settings.limits(), film, lens);
    let mut sum = Rgb::BLACK;
    loop {
        match walk.trace(rays) {
            Vertex::Escaped(end) => {
                if HAS & has::INFINITE != 0 && settings.parts.contains(seen_part(end.history, true)) {
                    let (radiance, light_pdf) = scene.lights().environment_radiance_and_pdf(end.direction);
                    sum += end.beta * radiance * bsdf_weight(end.history, end.pdf_w, light_samples * light_pdf);
                }
                return sum;
            }
            Vertex::Surface(vertex) => {
                if let Some(element) = scene.element(&vertex.surface) {
                    sum += emitted::<HAS>(scene, settings, light_samples, &vertex, element);
                }
                if !walk.is_exhausted() && (HAS & has::LOBES == 0 || !vertex.bsdf.is_delta()) {
                    sum += if RESAMPLED {
                        resampled_next_event::<HAS>(scene, settings, candidates, &vertex, sampler, rays)
                    } else {
                        next_event::<HAS>(scene, settings, &vertex, sampler, rays)
                    };
                }
                if !walk.scatter(&vertex, sampler) {
                    return sum;
                }
            }
        }
    }
}

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

/// Light that the vertex itself emits towards the path.
#[inline]
fn emitted<const HAS: u32>(
    scene: &Scene,
    settings: &Settings,
    light_samples: f32,
    vertex: &SurfaceVertex,
    element: u32,
) -> Rgb {
    let radiance = scene.lights().emitted::<HAS>(element, &vertex.surface, vertex.wo);
    if radiance.is_black() || !settings.parts.contains(seen_part(vertex.history, false)) {
        return Rgb::BLACK;
    }
    let surface = &vertex.surface;
    let light_pdf = scene.lights().pdf_direct(element, vertex.from, surface.p, surface.ng, -vertex.wo);
    vertex.beta * radiance * bsdf_weight(vertex.history, vertex.pdf_w, light_samples * light_pdf)
}

/// The part of the light that a path belongs to that ends in a sampled light.
#[inline]
fn sampled_part(history: History, light: &DirectSample) -> Part {
    match (history.rough, light.infinite && !light.delta) {
        (0, true) => Part::Environment,
        (0, false) => Part::Direct,
        _ => Part::Indirect,
    }
}

/// The ray that tests whether a sampled light is visible.
#[inline]
fn light_ray(vertex: &SurfaceVertex, light: &DirectSample) -> Ray {
    if light.infinite {
        spawn_ray(&vertex.surface, light.wi)
    } else {
        shadow_ray(&vertex.surface, light.target, light.target_error, light.target_normal)
    }
}

/// The weight of one of so many samples of the lights; a light without an extent cannot be found by sampling the BSDF.
#[inline]
fn light_weight(light: &DirectSample, light_samples: f32, bsdf_pdf: f32) -> f32 {
    if light.delta { 1.0 } else { power_heuristic(light_samples * light.pdf_w, bsdf_pdf) }
}

/// The light of a sampled light that arrives if nothing is in between.
#[inline]
fn arriving<const HAS: u32>(scene: &Scene, vertex: &SurfaceVertex, light: &DirectSample) -> Rgb {
    if HAS & has::MEDIA == 0 {
        return light.radiance;
    }
    let distance = if light.infinite { f32::INFINITY } else { light.target.distance(vertex.surface.p) };
    light.radiance * vertex.transmittance::<HAS>(scene, light.wi, distance)
}

/// Light that reaches the vertex from a sampled point of a sampled light.
#[inline]
fn next_event<const HAS: u32>(
    scene: &Scene,
    settings: &Settings,
    vertex: &SurfaceVertex,
    sampler: &mut dyn Sampler,
    rays: &mut Rays,
) -> Rgb {
    let u_choice = sampler.get_1d(vertex.depth, Purpose::LightChoice);
    let u = sampler.get_2d(vertex.depth, Purpose::LightPoint);
    let from = vertex.surface.p;
    let Some(light) = scene.lights().sample_direct::<HAS>(from, u_choice, u) else { return Rgb::BLACK };
    if !settings.parts.contains(sampled_part(vertex.history, &light)) {
        return Rgb::BLACK;
    }
    let (f_cos, bsdf_pdf) = vertex.eval_pdf::<HAS>(light.wi, TransportMode::Radiance);
    if f_cos.is_black() {
        return Rgb::BLACK;
    }
    rays.shadow += 1;
    if scene.occluded::<HAS>(&light_ray(vertex, &light)) {
        return Rgb::BLACK;
    }
    let weight = light_weight(&light, 1.0, bsdf_pdf);
    vertex.beta * f_cos * arriving::<HAS>(scene, vertex, &light) * (weight / light.pdf_w)
}

/// The same from the most promising of several samples, with one shadow ray. The weights of multiple importance sampling
/// are part of what is resampled, each by its own candidate's densities: what is kept has none in closed form. There, all
/// candidates count as samples, for together they settle the value of what is kept.
#[inline]
fn resampled_next_event<const HAS: u32>(
    scene: &Scene,
    settings: &Settings,
    candidates: u32,
    vertex: &SurfaceVertex,
    sampler: &mut dyn Sampler,
    rays: &mut Rays,
) -> Rgb {
    let numbers = (
        sampler.get_1d(vertex.depth, Purpose::LightChoice),
        sampler.get_2d(vertex.depth, Purpose::LightPoint),
        sampler.get_1d(vertex.depth, Purpose::LightCandidate),
    );
    let kept = scene.lights().resample_direct::<HAS>(vertex.surface.p, candidates, numbers, |light| {
        let (f_cos, bsdf_pdf) = vertex.eval_pdf::<HAS>(light.wi, TransportMode::Radiance);
        f_cos * arriving::<HAS>(scene, vertex, light) * light_weight(light, candidates as f32, bsdf_pdf)
    });
    let Some((light, value)) = kept else { return Rgb::BLACK };
    // Asked only now, so that the choice is the same whichever parts are rendered.
    if !settings.parts.contains(sampled_part(vertex.history, &light)) {
        return Rgb::BLACK;
    }
    rays.shadow += 1;
    if scene.occluded::<HAS>(&light_ray(vertex, &light)) {
        return Rgb::BLACK;
    }
    vertex.beta * value
}
