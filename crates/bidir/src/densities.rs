//! Densities of a path's ends and steps in a scene, as [`crate::weights`] takes them.
//!
//! Russian roulette is left out of all of them: it is a property of a walk, not of a path, and weights need only sum to 1.

use crate::weights::{Heuristic, Left, LightEnd, Prefix};
use etendue_core::{
    bsdf::TransportMode,
    camera::CameraSample,
    lights::{DirectSample, EmissionDensity, EmissionSample, Lights},
    walk::{Continuation, EscapedVertex, SurfaceVertex},
};
use glam::Vec3;

/// A cosine to the geometric normal. A ray that just grazes a surface has a density there all the same.
#[inline]
fn cosine(normal: Vec3, w: Vec3) -> f64 {
    f64::from(normal.dot(w).abs().max(f32::MIN_POSITIVE))
}

#[inline]
fn distance_squared(a: Vec3, b: Vec3) -> f64 {
    a.as_dvec3().distance_squared(b.as_dvec3())
}

/// Where a walk goes on from a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// [`Prefix::leave`] of the vertex.
    pub left: Left,
    /// Density per steradian of the direction; 1 for a delta lobe.
    pub pdf_w: f64,
    /// Whether it goes on by a delta lobe.
    pub delta: bool,
    /// Cosine at the vertex.
    cos: f64,
}

impl Departure {
    /// From a vertex of known prefix.
    #[inline]
    pub fn new<const HAS: u32>(
        heuristic: Heuristic,
        prefix: &Prefix,
        vertex: &SurfaceVertex,
        step: &Continuation,
        mode: TransportMode,
    ) -> Departure {
        let ng = vertex.surface.ng;
        let cos = cosine(ng, step.wi);
        let (pdf_w, reverse) = if step.delta {
            // One direction for one direction: what solid angle is to the other is the quotient of the densities, in which
            // refraction keeps eta² cos [Veach 1997, sec. 5.2]. The probability of the lobe counts as the same both ways.
            (1.0, cosine(ng, vertex.wo) / (f64::from(step.eta * step.eta) * cos))
        } else {
            (f64::from(step.pdf_w), f64::from(vertex.pdf_reverse::<HAS>(step.wi, mode)))
        };
        Departure { left: prefix.leave(heuristic, reverse, step.delta), pdf_w, delta: step.delta, cos }
    }

    /// The prefix of the vertex that it arrives at.
    #[inline]
    pub fn arrive(&self, heuristic: Heuristic, prefix: &Prefix, vertex: &SurfaceVertex) -> Prefix {
        let d2 = distance_squared(vertex.from, vertex.surface.p);
        let pdf_a = self.pdf_w * cosine(vertex.surface.ng, vertex.wo) / d2;
        prefix.next(heuristic, self.left, self.delta, self.cos / d2, pdf_a)
    }
}

/// The light's end of a path to `x_1`, which is at the point `p` with normal `ng`.
#[inline]
fn light_end(ray: &LightRay, density: EmissionDensity, direct_pdf_w: f32, p: Vec3, ng: Vec3) -> LightEnd {
    let [choice, pdf_a, pdf_w] = [density.choice, density.pdf_a, density.pdf_w].map(f64::from);
    let cos = cosine(ng, ray.direction);
    let d2 = distance_squared(ray.p, p);
    let direct = f64::from(direct_pdf_w);
    match ray.kind {
        LightKind::Area => {
            let hit = cosine(ray.normal, ray.direction) / d2;
            LightEnd { direct: direct * hit, emitted: choice * pdf_a, onward: pdf_w * cos / d2, hit }
        }
        LightKind::Environment => LightEnd { direct, emitted: choice * pdf_w, onward: pdf_a * cos, hit: 1.0 },
        LightKind::Point => LightEnd { direct: choice, emitted: choice, onward: pdf_w * cos / d2, hit: 0.0 },
        LightKind::Directional => LightEnd { direct: choice, emitted: choice, onward: pdf_a * cos, hit: 0.0 },
    }
}

/// A ray from a light, wherever it was found.
struct LightRay {
    kind: LightKind,
    p: Vec3,
    normal: Vec3,
    direction: Vec3,
}

/// What measures a light's end has.
#[derive(Clone, Copy)]
enum LightKind {
    Area,
    Environment,
    /// Also spots and projectors.
    Point,
    Directional,
}

/// The light's end of a walk from a light whose first surface is `vertex`.
#[inline]
pub fn emitted_end(lights: &Lights, start: &EmissionSample, vertex: &SurfaceVertex) -> LightEnd {
    let EmissionSample { p, normal, direction, choice, pdf_a, pdf_w, element, .. } = *start;
    let surface = &vertex.surface;
    let (kind, direct_pdf_w) = match (start.infinite, start.delta_position || start.delta_direction) {
        (true, true) => (LightKind::Directional, choice),
        (true, false) => (LightKind::Environment, choice * pdf_w),
        (false, true) => (LightKind::Point, choice),
        (false, false) => (LightKind::Area, lights.pdf_direct(element, surface.p, p, normal, -direction)),
    };
    let ray = LightRay { kind, p, normal, direction };
    light_end(&ray, EmissionDensity { choice, pdf_a, pdf_w }, direct_pdf_w, surface.p, surface.ng)
}

/// The light's end where next-event estimation at `vertex` has chosen a light.
#[inline]
pub fn direct_end(lights: &Lights, light: &DirectSample, vertex: &SurfaceVertex) -> LightEnd {
    let kind = match (light.infinite, light.delta) {
        (true, true) => LightKind::Directional,
        (true, false) => LightKind::Environment,
        (false, true) => LightKind::Point,
        (false, false) => LightKind::Area,
    };
    let ray = LightRay { kind, p: light.target, normal: light.target_normal, direction: -light.wi };
    let density = lights.emission_density(light.element, light.target_normal, -light.wi);
    light_end(&ray, density, light.pdf_w, vertex.surface.p, vertex.surface.ng)
}

/// The light's end where a walk from the camera has run into the area light `element` at `vertex`; `ng` is the geometric
/// normal where it came from.
#[inline]
pub fn hit_end(lights: &Lights, element: u32, vertex: &SurfaceVertex, ng: Vec3) -> LightEnd {
    let surface = &vertex.surface;
    let direct_pdf_w = lights.pdf_direct(element, vertex.from, surface.p, surface.ng, -vertex.wo);
    let density = lights.emission_density(element, surface.ng, vertex.wo);
    let ray = LightRay { kind: LightKind::Area, p: surface.p, normal: surface.ng, direction: vertex.wo };
    light_end(&ray, density, direct_pdf_w, vertex.from, ng)
}

/// The light's end where a walk from the camera has left the scene from a surface with geometric normal `ng`; `element` is
/// the environment.
#[inline]
pub fn escaped_end(lights: &Lights, element: u32, end: &EscapedVertex, ng: Vec3) -> LightEnd {
    let density = lights.emission_density(element, Vec3::ZERO, -end.direction);
    let ray = LightRay { kind: LightKind::Environment, p: Vec3::ZERO, normal: Vec3::ZERO, direction: -end.direction };
    light_end(&ray, density, density.choice * density.pdf_w, Vec3::ZERO, ng)
}

/// Density per square metre with which walks from the camera find a surface first, one of them a pixel, relative to as many
/// walks from lights; `camera` is the connection of the surface to the camera, none where the density is beyond numbers.
#[inline]
pub fn camera_pdf_a(camera: Option<&CameraSample>, pixels: f32, wo: Vec3, ng: Vec3) -> f64 {
    // What arrives from the lens for each unit of density is what the lens sends out per square metre and pixel.
    camera.map_or(f64::INFINITY, |c| f64::from(c.importance / (c.pdf_w * pixels)) * cosine(ng, wo))
}

/// Two vertices of walks from either end that a straight line joins.
#[derive(Clone, Copy, Debug)]
pub struct Joint<'a> {
    /// The vertex that the walk from the light ends at, and its prefix.
    pub light: (&'a SurfaceVertex, &'a Prefix),
    /// The vertex that the walk from the camera ends at, and its prefix.
    pub camera: (&'a SurfaceVertex, &'a Prefix),
    /// Unit direction from the camera's vertex to the light's.
    pub wi: Vec3,
    /// Density per steradian with which the walk from the light would go on to the camera's vertex.
    pub light_pdf_w: f32,
    /// Density per steradian with which the walk from the camera would go on to the light's vertex.
    pub camera_pdf_w: f32,
}

impl Joint<'_> {
    /// Its weight, with so many particles for each path from the camera.
    #[inline]
    pub fn weight<const HAS: u32>(&self, heuristic: Heuristic, splats: f64) -> f64 {
        let ((y, y_prefix), (z, z_prefix)) = (self.light, self.camera);
        let d2 = distance_squared(y.surface.p, z.surface.p);
        let y_reverse = y.pdf_reverse::<HAS>(-self.wi, TransportMode::Importance);
        let z_reverse = z.pdf_reverse::<HAS>(self.wi, TransportMode::Radiance);
        heuristic.connected(
            y_prefix.leave(heuristic, f64::from(y_reverse), false).others,
            f64::from(self.camera_pdf_w) * cosine(y.surface.ng, self.wi) / d2,
            z_prefix.leave(heuristic, f64::from(z_reverse), false).with_splats(heuristic, splats),
            f64::from(self.light_pdf_w) * cosine(z.surface.ng, self.wi) / d2,
        )
    }
}
