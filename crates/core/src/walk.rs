//! The one walk, from the camera or from a light, a vertex at a time.

mod scattering;

use crate::{
    bsdf::{Bsdf, TransportMode},
    frame::Frame,
    geometry::{Surface, offset::spawn_ray},
    has,
    ray::Ray,
    relief::Tilt,
    rgb::Rgb,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::Rays,
};
use glam::{Vec2, Vec3};
use scattering::{folded, local_of};

/// Where a walk ends.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Most edges of a path, 1 or more.
    pub max_depth: u32,
    /// Edge count from which Russian roulette may end it.
    pub roulette_depth: u32,
}

/// Largest probability with which roulette lets a path live, so that even a lossless closed room ends every path.
const MOST_SURVIVAL: f32 = 0.95;

/// A vertex on a surface. It is never changed after it is made.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceVertex {
    /// Geometry.
    pub surface: Surface,
    /// Shading frame: `z` of its local space is the shading normal, a relief's where there is one.
    pub frame: Frame,
    /// The relief.
    pub tilt: Option<Tilt>,
    /// Scattering.
    pub bsdf: Bsdf,
    /// Unit direction to the previous vertex, world space.
    pub wo: Vec3,
    /// The same in the shading frame: `wo` where the shading and the geometric normal see it on one side, else `-wo`.
    pub wo_local: Vec3,
    /// Where the edge came from: a surface vertex's point, or the camera's or light's.
    pub from: Vec3,
    /// Throughput of the path up to here, this vertex's scattering not included.
    pub beta: Rgb,
    /// What the edge to here ran through absorbs a metre; black where nothing absorbs.
    pub medium: Rgb,
    /// Density per steradian with which the edge to here was sampled; a probability after a delta lobe.
    pub pdf_w: f32,
    /// Edges up to here: 1 for what the camera sees directly.
    pub depth: u32,
    /// What happened on the way.
    pub history: History,
}

/// A path that left the scene.
#[derive(Clone, Copy, Debug)]
pub struct EscapedVertex {
    /// Unit direction in which it left.
    pub direction: Vec3,
    /// Throughput.
    pub beta: Rgb,
    /// As [`SurfaceVertex::pdf_w`].
    pub pdf_w: f32,
    /// What happened on the way.
    pub history: History,
}

/// What sort of scattering a path has behind it, as far as classifying light needs it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct History {
    /// Number of non-delta scatterings.
    pub rough: u32,
    /// Whether the last scattering was by a delta lobe.
    pub last_delta: bool,
}

/// What a step finds.
#[expect(
    clippy::large_enum_variant,
    reason = "a vertex lives on the stack for one step; a box would allocate for each"
)]
#[derive(Clone, Copy, Debug)]
pub enum Vertex {
    /// A surface.
    Surface(SurfaceVertex),
    /// Nothing: the path has left the scene.
    Escaped(EscapedVertex),
}

/// How a walk goes on from a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Continuation {
    /// Unit direction, world space.
    pub wi: Vec3,
    /// Density per steradian with which it was sampled, roulette not included; a probability for a delta lobe.
    pub pdf_w: f32,
    /// Whether it was sampled from a delta lobe.
    pub delta: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`.
    pub eta: f32,
}

/// A walk through a scene whose features are `HAS` (bits of [`crate::has`]).
pub struct Walk<'a, const HAS: u32> {
    scene: &'a Scene,
    mode: TransportMode,
    limits: Limits,
    ray: Ray,
    from: Vec3,
    beta: Rgb,
    /// What the ray runs through absorbs so much a metre.
    medium: Rgb,
    /// Product of the relative indices of refraction passed, in radiance mode: what `beta` is scaled by squared.
    eta: f32,
    pdf_w: f32,
    depth: u32,
    history: History,
}

impl<'a, const HAS: u32> Walk<'a, HAS> {
    /// A walk whose first edge is `ray` (from the camera, or from a light in mode [`TransportMode::Importance`]), with
    /// throughput `beta` and the density `pdf_w` of its direction.
    #[inline]
    pub fn new(scene: &'a Scene, mode: TransportMode, limits: Limits, ray: Ray, beta: Rgb, pdf_w: f32) -> Self {
        Walk {
            scene,
            mode,
            limits,
            from: ray.origin,
            ray,
            beta,
            medium: Rgb::BLACK,
            eta: 1.0,
            pdf_w,
            depth: 0,
            history: History::default(),
        }
    }

    /// A walk from the camera through the film position `film` (pixels) and the lens position `lens` (unit square).
    #[inline]
    pub fn from_camera(scene: &'a Scene, limits: Limits, film: Vec2, lens: Vec2) -> Self {
        let ray = scene.camera().sample_ray(film, lens);
        // The density of a camera ray never enters a weight of a path from the camera: 1 stands for it.
        Walk::new(scene, TransportMode::Radiance, limits, ray, Rgb::WHITE, 1.0)
    }

    /// Follows the current edge to the next vertex.
    #[inline]
    pub fn trace(&mut self, rays: &mut Rays) -> Vertex {
        match (self.depth, self.mode) {
            (0, TransportMode::Radiance) => rays.camera += 1,
            (0, TransportMode::Importance) => rays.light += 1,
            _ => rays.scatter += 1,
        }
        self.depth += 1;
        let direction = self.ray.direction;
        match self.scene.closest::<HAS>(&self.ray) {
            None => {
                self.absorb(f32::INFINITY);
                Vertex::Escaped(EscapedVertex { direction, beta: self.beta, pdf_w: self.pdf_w, history: self.history })
            }
            Some(hit) => {
                let surface = self.scene.surface::<HAS>(&self.ray, &hit);
                let wo = -direction;
                if HAS & has::MEDIA != 0 && self.depth == 1 {
                    // What the path starts in shows when it arrives at its boundary from inside.
                    self.medium = self.scene.medium_behind(&surface, wo);
                }
                self.absorb(hit.t);
                let bsdf = self.scene.bsdf::<HAS>(&surface);
                let tilt = self.scene.tilt::<HAS>(&surface, &bsdf);
                let normal = tilt.as_ref().map_or(surface.ns, |tilt| {
                    let seen = folded(wo, surface.ns, surface.ng);
                    match self.mode {
                        TransportMode::Radiance => tilt.seen_from(seen),
                        // The direction to the viewer is not known yet.
                        TransportMode::Importance => tilt.normals(seen)[0],
                    }
                });
                let frame = frame_about::<HAS>(&bsdf, normal, &surface);
                Vertex::Surface(SurfaceVertex {
                    bsdf,
                    wo_local: local_of::<HAS>(&frame, &surface, wo),
                    surface,
                    frame,
                    tilt,
                    wo,
                    from: self.from,
                    beta: self.beta,
                    medium: self.medium,
                    pdf_w: self.pdf_w,
                    depth: self.depth,
                    history: self.history,
                })
            }
        }
    }

    /// Takes what the medium absorbs over a distance along the ray.
    #[inline]
    fn absorb(&mut self, distance: f32) {
        if HAS & has::MEDIA != 0 {
            self.beta *= transmittance(self.medium, distance);
        }
    }

    /// Edges so far.
    #[inline]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Whether the greatest depth is reached: no further edge may be added.
    #[inline]
    pub fn is_exhausted(&self) -> bool {
        self.depth >= self.limits.max_depth
    }

    /// Samples how the path goes on from the vertex that [`Walk::trace`] returned last; `false` when it ends there: it
    /// is absorbed, has reached its greatest depth, or Russian roulette takes it.
    #[inline]
    pub fn scatter(&mut self, vertex: &SurfaceVertex, sampler: &mut dyn Sampler) -> bool {
        self.go_on(vertex, sampler).is_some()
    }

    /// [`Walk::scatter`], telling how the path goes on.
    #[inline]
    pub fn go_on(&mut self, vertex: &SurfaceVertex, sampler: &mut dyn Sampler) -> Option<Continuation> {
        if self.is_exhausted() {
            return None;
        }
        let (lobe, direction, roulette) = match self.mode {
            TransportMode::Radiance => (Purpose::Lobe, Purpose::Direction, Purpose::Roulette),
            TransportMode::Importance => {
                (Purpose::LightWalkLobe, Purpose::LightWalkDirection, Purpose::LightWalkRoulette)
            }
        };
        // A single Lambert lobe needs no choice; a number that is not asked for costs nothing and shifts no other.
        let choose = HAS & has::LOBES != 0 || vertex.chooses_normal(self.mode);
        let u_lobe = if choose { sampler.get_1d(self.depth, lobe) } else { 0.0 };
        let u = sampler.get_2d(self.depth, direction);
        let (wi, sample, correction) = vertex.sample::<HAS>(u_lobe, u, self.mode)?;
        self.beta = self.beta * sample.weight * correction;
        if self.beta.is_black() {
            return None;
        }
        if HAS & has::LOBES != 0 && self.mode == TransportMode::Radiance {
            self.eta *= sample.eta;
        }
        if self.depth >= self.limits.roulette_depth {
            // Radiance scaled by a refraction is scaled back on the way out: roulette looks at what it will be.
            // [PBRT-4, sec. 14.5.4]
            let survival = (self.beta.max_element() * self.eta * self.eta).min(MOST_SURVIVAL);
            if sampler.get_1d(self.depth, roulette) >= survival {
                return None;
            }
            self.beta *= 1.0 / survival;
        }
        self.medium = self.scene.medium_towards::<HAS>(&vertex.surface, vertex.wo, wi, self.medium);
        self.history.rough += u32::from(!sample.delta);
        self.history.last_delta = sample.delta;
        self.pdf_w = sample.pdf_w;
        self.from = vertex.surface.p;
        self.ray = spawn_ray(&vertex.surface, wi);
        Some(Continuation { wi, pdf_w: sample.pdf_w, delta: sample.delta, eta: sample.eta })
    }
}

/// What is left of light over a distance in metres through a medium that absorbs so much a metre. [Beer's law]
#[inline]
pub fn transmittance(absorption: Rgb, distance: f32) -> Rgb {
    // Zero times infinity is not a number: what does not absorb lets light through from anywhere.
    let left = |a: f32| if a > 0.0 { (-a * distance).exp() } else { 1.0 };
    Rgb::new(left(absorption.r), left(absorption.g), left(absorption.b))
}

/// The frame about a shading normal. What is isotropic looks the same in every frame, and one of them is had for less.
#[inline]
fn frame_about<const HAS: u32>(bsdf: &Bsdf, normal: Vec3, surface: &Surface) -> Frame {
    if HAS & has::LOBES != 0 && bsdf.is_anisotropic() {
        Frame::from_normal_and_tangent(normal, surface.dpdu)
    } else {
        Frame::from_normal(normal)
    }
}
