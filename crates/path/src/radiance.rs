//! One path: the estimate of the radiance through a pixel.

use etendue_core::{
    bsdf::TransportMode,
    direct_light::{LightEdge, arriving, emitted, escaped, light_ray, light_weight, next_event, sampled_part},
    filter::Filter,
    has,
    rgb::Rgb,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::Rays,
    technique::Settings,
    walk::{SurfaceVertex, Vertex, Walk},
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
        // By reference: a vertex is large.
        match &walk.trace(rays) {
            Vertex::Escaped(end) => {
                return sum + escaped::<HAS>(scene, settings.parts, light_samples, end);
            }
            Vertex::Surface(vertex) => {
                if let Some(element) = scene.element(&vertex.surface) {
                    sum += emitted::<HAS>(scene, settings.parts, light_samples, vertex, element);
                }
                let light = if walk.is_exhausted() || HAS & has::LOBES != 0 && vertex.bsdf.is_delta() {
                    None
                } else if RESAMPLED {
                    resampled_next_event::<HAS>(scene, settings, candidates, vertex, sampler)
                } else {
                    next_event::<HAS>(scene, settings.parts, vertex, sampler)
                };
                let goes_on = walk.scatter(vertex, sampler);
                if let Some(light) = light {
                    sum += light.arriving::<HAS>(scene, rays);
                }
                if !goes_on {
                    return sum;
                }
            }
        }
    }
}

/// Light that reaches the vertex from the most promising of several samples of the lights, with one shadow ray. The weights of multiple importance sampling
/// are part of what is resampled, each by its own candidate's densities: what is kept has none in closed form. There, all
/// candidates count as samples, for together they settle the value of what is kept.
#[inline]
fn resampled_next_event<const HAS: u32>(
    scene: &Scene,
    settings: &Settings,
    candidates: u32,
    vertex: &SurfaceVertex,
    sampler: &mut dyn Sampler,
) -> Option<LightEdge> {
    let numbers = (
        sampler.get_1d(vertex.depth, Purpose::LightChoice),
        sampler.get_2d(vertex.depth, Purpose::LightPoint),
        sampler.get_1d(vertex.depth, Purpose::LightCandidate),
    );
    let kept = scene.lights().resample_direct::<HAS>(vertex.surface.p, candidates, numbers, |light| {
        let (f_cos, bsdf_pdf) = vertex.eval_pdf::<HAS>(light.wi, TransportMode::Radiance);
        f_cos * arriving::<HAS>(scene, vertex, light) * light_weight(light, candidates as f32, bsdf_pdf)
    });
    let (light, value) = kept?;
    // Asked only now, so that the choice is the same whichever parts are rendered.
    (settings.parts.contains(sampled_part(vertex.history, &light)))
        .then(|| LightEdge { ray: light_ray(vertex, &light), value: vertex.beta * value })
}
