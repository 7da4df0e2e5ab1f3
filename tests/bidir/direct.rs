//! The weights of a path's strategies the slow way: each strategy's density is multiplied together from scratch, over
//! vertices found again by tracing rays along the path in both directions.

use etendue_bidir::{
    densities::{Departure, Joint, camera_pdf_a, direct_end, emitted_end, escaped_end, hit_end},
    splats::Splats,
    weights::{Heuristic, Prefix},
};
use etendue_core::{
    bsdf::TransportMode,
    camera::{CameraSample, Projection},
    geometry::{
        Surface,
        offset::{offset_origin, spawn_ray},
    },
    has,
    lights::{DirectSample, EmissionDensity, EmissionSample},
    ray::{PrimitiveId, Ray},
    rgb::Rgb,
    scene::Scene,
    statistics::render::Rays,
    walk::{Continuation, EscapedVertex, Limits, SurfaceVertex, Vertex, Walk},
};
use glam::Vec3;

const ALL: u32 = has::ALL;

/// Where a path starts.
#[derive(Clone, Copy, Debug)]
pub struct Origin {
    /// The light.
    pub element: u32,
    /// What sort it is.
    pub kind: OriginKind,
    /// Where it starts, or any point of the ray for light from infinity.
    pub p: Vec3,
    /// Bound of the error of that.
    pub p_error: Vec3,
    /// The side that emits.
    pub normal: Vec3,
    /// Where the light travels.
    pub direction: Vec3,
}

/// Sorts of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OriginKind {
    Area,
    Environment,
    /// Also spots and projectors.
    Point,
    Directional,
}

/// A surface on a path.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub vertex: SurfaceVertex,
    /// Whether it scatters by a delta lobe, and the index of refraction on the side of the camera over that on the light's.
    pub delta: Option<f32>,
}

/// A path from a light to the camera: its surfaces in that order.
pub struct FullPath {
    pub origin: Origin,
    pub points: Vec<Point>,
    pub lens: Vec3,
}

/// A path of which each surface is known from either side.
pub struct Retraced<'a> {
    scene: &'a Scene,
    projection: Projection,
    pixels: f64,
    caustic_particles: u32,
    path: &'a FullPath,
    /// As a walk from the light finds them, and as one from the camera does.
    from_light: Vec<SurfaceVertex>,
    from_camera: Vec<SurfaceVertex>,
}

fn trace(scene: &Scene, mode: TransportMode, ray: Ray, from: Vec3, expected: &SurfaceVertex) -> Option<SurfaceVertex> {
    let limits = Limits { max_depth: 1, roulette_depth: 1 };
    let mut walk = Walk::<ALL>::new(scene, mode, limits, ray, Rgb::WHITE, 1.0);
    let Vertex::Surface(vertex) = walk.trace(&mut Rays::default()) else { return None };
    let same = (vertex.surface.shape, vertex.surface.element) == (expected.surface.shape, expected.surface.element);
    let off = vertex.surface.p.distance(expected.surface.p);
    let bound = 1e-5 * (from.distance(expected.surface.p) + expected.surface.p.length());
    // The path is where it is: on which side of a sphere's surface rounding leaves a point, and how exactly rays graze it,
    // must not depend on who asks; nor whether its two normals are one.
    let Surface { p, ng, ns, .. } = expected.surface;
    let is_one = vertex.frame.normal == vertex.surface.ng;
    let frame = if is_one { expected.frame } else { vertex.frame };
    let wo_local = if is_one { frame.to_local(vertex.wo) } else { vertex.wo_local };
    let surface = Surface { p, ng, ns, ..vertex.surface };
    (same && off <= bound).then_some(SurfaceVertex { surface, frame, wo_local, from, ..vertex })
}

fn cos(n: Vec3, w: Vec3) -> f64 {
    f64::from(n.dot(w)).abs()
}

fn d2(a: Vec3, b: Vec3) -> f64 {
    a.as_dvec3().distance_squared(b.as_dvec3())
}

impl<'a> Retraced<'a> {
    /// Traces a path again. `None` where a ray misses by rounding what it is aimed at.
    pub fn new(
        scene: &'a Scene,
        projection: Projection,
        pixels: u32,
        caustic_particles: u32,
        path: &'a FullPath,
    ) -> Option<Retraced<'a>> {
        let points = &path.points;
        let origin = &path.origin;
        let mut from_light = Vec::new();
        let mut from_camera = Vec::new();
        for (i, point) in points.iter().enumerate() {
            let p = point.vertex.surface.p;
            let ray = match (i, origin.kind) {
                (0, OriginKind::Environment | OriginKind::Directional) => {
                    // From outside, without trusting where the sampled ray began.
                    let (lo, hi) = scene.geometry().bounds().expect("surfaces");
                    Ray::new(p - origin.direction * lo.distance(hi), origin.direction)
                }
                (0, _) => {
                    let direction = (p - origin.p).normalize();
                    Ray::new(offset_origin(origin.p, origin.p_error, origin.normal, direction), direction)
                }
                _ => {
                    let before = &points[i - 1].vertex.surface;
                    spawn_ray(before, (p - before.p).normalize())
                }
            };
            let from = if i == 0 { origin.p } else { points[i - 1].vertex.surface.p };
            from_light.push(trace(scene, TransportMode::Importance, ray, from, &point.vertex)?);
            let (ray, from) = match points.get(i + 1) {
                Some(next) => {
                    let next = &next.vertex.surface;
                    (spawn_ray(next, (p - next.p).normalize()), next.p)
                }
                None => (Ray::new(path.lens, (p - path.lens).normalize()), path.lens),
            };
            from_camera.push(trace(scene, TransportMode::Radiance, ray, from, &point.vertex)?);
        }
        Some(Retraced {
            scene,
            projection,
            pixels: f64::from(pixels),
            caustic_particles,
            path,
            from_light,
            from_camera,
        })
    }

    /// Edges.
    pub fn edges(&self) -> usize {
        self.path.points.len() + 1
    }

    /// Direction from the surface `i` (0 is the first) to the light.
    fn to_light(&self, i: usize) -> Vec3 {
        let p = self.path.points[i].vertex.surface.p;
        if i > 0 {
            (self.path.points[i - 1].vertex.surface.p - p).normalize()
        } else {
            match self.path.origin.kind {
                OriginKind::Environment | OriginKind::Directional => -self.path.origin.direction,
                _ => (self.path.origin.p - p).normalize(),
            }
        }
    }

    /// Direction from the surface `i` to the camera.
    fn to_camera(&self, i: usize) -> Vec3 {
        let p = self.path.points[i].vertex.surface.p;
        let target = self.path.points.get(i + 1).map_or(self.path.lens, |next| next.vertex.surface.p);
        (target - p).normalize()
    }

    fn p(&self, i: usize) -> Vec3 {
        self.path.points[i].vertex.surface.p
    }

    fn ng(&self, i: usize) -> Vec3 {
        self.path.points[i].vertex.surface.ng
    }

    fn emission_density(&self) -> EmissionDensity {
        let Origin { element, normal, .. } = self.path.origin;
        self.scene.lights().emission_density(element, normal, -self.to_light(0))
    }

    /// Density, choice included, with which next-event estimation at the first surface finds the light, per steradian; of
    /// a light without an extent its probability.
    fn direct_pdf_w(&self) -> f32 {
        let Origin { element, kind, p, normal, .. } = self.path.origin;
        let lights = self.scene.lights();
        let wi = self.to_light(0);
        match kind {
            OriginKind::Area => lights.pdf_direct(element, self.p(0), p, normal, wi),
            OriginKind::Environment => lights.environment_pdf(wi),
            OriginKind::Point | OriginKind::Directional => lights.choice_probability(element),
        }
    }

    /// Steradians at the first surface for each unit of the light's own measure.
    fn hit(&self) -> f64 {
        let Origin { kind, p, normal, .. } = self.path.origin;
        match kind {
            OriginKind::Area => cos(normal, self.to_light(0)) / d2(p, self.p(0)),
            OriginKind::Environment => 1.0,
            OriginKind::Point | OriginKind::Directional => 0.0,
        }
    }

    /// Density of each surface by a walk from the light.
    fn light_density(&self, i: usize) -> f64 {
        let arriving = cos(self.ng(i), self.to_light(i));
        if i == 0 {
            let e = self.emission_density();
            return match self.path.origin.kind {
                OriginKind::Area | OriginKind::Point => {
                    f64::from(e.pdf_w) * arriving / d2(self.path.origin.p, self.p(0))
                }
                OriginKind::Environment | OriginKind::Directional => f64::from(e.pdf_a) * arriving,
            };
        }
        let pdf_w = match self.path.points[i - 1].delta {
            Some(_) => 1.0,
            None => {
                let wi = self.to_camera(i - 1);
                f64::from(self.from_light[i - 1].eval_pdf::<ALL>(wi, TransportMode::Importance).1)
            }
        };
        pdf_w * arriving / d2(self.p(i - 1), self.p(i))
    }

    /// Density per steradian (for a delta lobe, relative to that of the light's walk) with which a walk from the camera goes
    /// on from a surface towards the light.
    fn camera_pdf_w(&self, i: usize) -> f64 {
        match self.path.points[i].delta {
            Some(eta) => {
                // Étendue: eta² cos domega is the same on both sides.
                let (light, camera) = (cos(self.ng(i), self.to_light(i)), cos(self.ng(i), self.to_camera(i)));
                light / (f64::from(eta * eta) * camera)
            }
            None => {
                let wi = self.to_light(i);
                f64::from(self.from_camera[i].eval_pdf::<ALL>(wi, TransportMode::Radiance).1)
            }
        }
    }

    /// Density of each surface by a walk from the camera, as many of them as pixels.
    fn camera_density(&self, i: usize) -> f64 {
        let arriving = cos(self.ng(i), self.to_camera(i));
        if i + 1 == self.path.points.len() {
            let camera = self.scene.camera();
            return match self.projection {
                Projection::Orthographic { .. } => f64::from(camera.pdf_a()) * arriving,
                _ => f64::from(camera.pdf_w(-self.to_camera(i))) * arriving / d2(self.path.lens, self.p(i)),
            };
        }
        self.camera_pdf_w(i + 1) * arriving / d2(self.p(i), self.p(i + 1))
    }

    /// Particles for each path from the camera, of the part of the light that the path belongs to.
    fn splats(&self) -> f64 {
        if self.is_delta(0) {
            f64::from(self.caustic_particles)
        } else if self.path.points.len() == 1 {
            Splats::DIRECT
        } else {
            1.0
        }
    }

    fn is_delta(&self, i: usize) -> bool {
        self.path.points[i].delta.is_some()
    }

    /// The density of each strategy, by the number of vertices made from the light; what is common to all is left out.
    fn densities(&self) -> Vec<f64> {
        // The path is x_0 (the light), x_1 ... x_n (surfaces), x_{n+1} (the lens).
        let n = self.path.points.len();
        let e = self.emission_density();
        let emitted = match self.path.origin.kind {
            OriginKind::Area => f64::from(e.choice * e.pdf_a),
            OriginKind::Environment => f64::from(e.choice * e.pdf_w),
            OriginKind::Point | OriginKind::Directional => f64::from(e.choice),
        };
        let of_hit = if self.path.origin.kind == OriginKind::Area { self.hit() } else { 1.0 };
        let light: Vec<f64> = (0..n).map(|i| self.light_density(i)).collect();
        let camera: Vec<f64> = (0..n).map(|i| self.camera_density(i)).collect();
        (0..=n + 1)
            .map(|s| {
                // Surface i is x_{i + 1}.
                let joined = match s {
                    0 => true,
                    1 => !self.is_delta(0),
                    s => !self.is_delta(s - 2) && (s > n || !self.is_delta(s - 1)),
                };
                let first = match s {
                    0 => self.camera_pdf_w(0) * self.hit(),
                    1 => f64::from(self.direct_pdf_w()) * of_hit,
                    _ => emitted,
                };
                let rest = (0..n).map(|i| if i + 1 < s { light[i] } else { camera[i] }).product::<f64>();
                let number = if s == n + 1 { self.splats() } else { 1.0 };
                if joined { first * rest * number } else { 0.0 }
            })
            .collect()
    }

    /// The density of each strategy over the largest.
    pub fn relative_densities(&self) -> Vec<f64> {
        let p = self.densities();
        let largest = p.iter().copied().fold(0.0, f64::max);
        p.iter().map(|p| p / largest).collect()
    }

    /// The weight of each strategy as the walks sum it up: the recursion, fed with this path.
    pub fn recursive(&self, h: Heuristic) -> Vec<f64> {
        let n = self.path.points.len();
        let lights = self.scene.lights();
        let camera = self.camera_sample();
        let step = |mode: TransportMode, i: usize| {
            let (vertex, wi) = match mode {
                TransportMode::Importance => (&self.from_light[i], self.to_camera(i)),
                TransportMode::Radiance => (&self.from_camera[i], self.to_light(i)),
            };
            let eta = self.path.points[i].delta.unwrap_or(1.0);
            let eta = if mode == TransportMode::Importance { eta } else { 1.0 / eta };
            let pdf_w = vertex.eval_pdf::<ALL>(wi, mode).1;
            Continuation { wi, pdf_w, delta: self.is_delta(i), eta }
        };
        let mut y = vec![Prefix::from_light(h, &emitted_end(lights, &self.emission(), &self.from_light[0]))];
        for i in 1..n {
            let (before, mode) = (&self.from_light[i - 1], TransportMode::Importance);
            let departure = Departure::new::<ALL>(h, &y[i - 1], before, &step(mode, i - 1), mode);
            y.push(departure.arrive(h, &y[i - 1], &self.from_light[i]));
        }
        let last = &self.from_camera[n - 1];
        let mut z =
            vec![Prefix::from_camera(h, camera_pdf_a(Some(&camera), self.pixels as f32, last.wo, last.surface.ng))];
        for i in (0..n - 1).rev() {
            let (before, mode) = (&self.from_camera[i + 1], TransportMode::Radiance);
            let departure = Departure::new::<ALL>(h, &z[0], before, &step(mode, i + 1), mode);
            z.insert(0, departure.arrive(h, &z[0], &self.from_camera[i]));
        }
        let origin = &self.path.origin;
        (0..=n + 1)
            .map(|s| match s {
                0 => {
                    let first = &self.from_camera[0];
                    let mode = TransportMode::Radiance;
                    let departure = Departure::new::<ALL>(h, &z[0], first, &step(mode, 0), mode);
                    let end = match origin.kind {
                        OriginKind::Area => {
                            let light = self.light_vertex(origin);
                            hit_end(lights, origin.element, &light, first.surface.ng)
                        }
                        OriginKind::Environment => {
                            let escaped = EscapedVertex {
                                direction: self.to_light(0),
                                beta: Rgb::WHITE,
                                pdf_w: 1.0,
                                history: Default::default(),
                            };
                            escaped_end(lights, origin.element, &escaped, first.surface.ng)
                        }
                        OriginKind::Point | OriginKind::Directional => return 0.0,
                    };
                    let left = departure.left.with_splats(h, self.splats());
                    h.hit(&end, departure.pdf_w, departure.delta, left)
                }
                1 if !self.is_delta(0) => {
                    let first = &self.from_camera[0];
                    let wi = self.to_light(0);
                    let end = direct_end(lights, &self.direct(), first);
                    let pdf_w = first.eval_pdf::<ALL>(wi, TransportMode::Radiance).1;
                    let reverse = first.pdf_reverse::<ALL>(wi, TransportMode::Radiance);
                    let left = z[0].leave(h, f64::from(reverse), false).with_splats(h, self.splats());
                    h.next_event(&end, f64::from(pdf_w), left)
                }
                s if s == n + 1 && !self.is_delta(n - 1) => {
                    let vertex = &self.from_light[n - 1];
                    let reverse = vertex.pdf_reverse::<ALL>(camera.wi, TransportMode::Importance);
                    let found = camera_pdf_a(Some(&camera), self.pixels as f32, camera.wi, vertex.surface.ng);
                    let left = y[n - 1].leave(h, f64::from(reverse), false).others;
                    h.joined(h.term(found / self.splats()) * left)
                }
                s if (2..=n).contains(&s) && !self.is_delta(s - 2) && !self.is_delta(s - 1) => {
                    let (light, camera) = (&self.from_light[s - 2], &self.from_camera[s - 1]);
                    let wi = self.to_light(s - 1);
                    let joint = Joint {
                        light: (light, &y[s - 2]),
                        camera: (camera, &z[s - 1]),
                        wi,
                        light_pdf_w: light.eval_pdf::<ALL>(-wi, TransportMode::Importance).1,
                        camera_pdf_w: camera.eval_pdf::<ALL>(wi, TransportMode::Radiance).1,
                    };
                    joint.weight::<ALL>(h, self.splats())
                }
                _ => 0.0,
            })
            .collect()
    }

    fn emission(&self) -> EmissionSample {
        let Origin { element, kind, p, p_error, normal, .. } = self.path.origin;
        let EmissionDensity { choice, pdf_a, pdf_w } = self.emission_density();
        let direction = -self.to_light(0);
        EmissionSample {
            p,
            p_error,
            normal,
            direction,
            radiance: Rgb::WHITE,
            cos: if kind == OriginKind::Area { normal.dot(direction) } else { 1.0 },
            pdf_a,
            pdf_w,
            choice,
            delta_position: kind == OriginKind::Point,
            delta_direction: kind == OriginKind::Directional,
            infinite: matches!(kind, OriginKind::Environment | OriginKind::Directional),
            element,
        }
    }

    fn direct(&self) -> DirectSample {
        let Origin { element, kind, p, p_error, normal, .. } = self.path.origin;
        DirectSample {
            wi: self.to_light(0),
            radiance: Rgb::WHITE,
            pdf_w: self.direct_pdf_w(),
            delta: matches!(kind, OriginKind::Point | OriginKind::Directional),
            infinite: matches!(kind, OriginKind::Environment | OriginKind::Directional),
            target: p,
            target_error: p_error,
            target_normal: normal,
            target_id: PrimitiveId::NONE,
            element,
        }
    }

    /// The light as a surface that is hit from the first surface.
    fn light_vertex(&self, origin: &Origin) -> SurfaceVertex {
        let mut vertex = self.from_camera[0];
        vertex.from = self.p(0);
        vertex.surface.p = origin.p;
        vertex.surface.ng = origin.normal;
        vertex.wo = -self.to_light(0);
        vertex
    }

    /// The connection of the last surface to the lens, from what the camera says of its rays.
    fn camera_sample(&self) -> CameraSample {
        let n = self.path.points.len();
        let (wi, camera) = (self.to_camera(n - 1), self.scene.camera());
        let per_area = match self.projection {
            Projection::Orthographic { .. } => f64::from(camera.pdf_a()),
            _ => f64::from(camera.pdf_w(-wi)) / d2(self.path.lens, self.p(n - 1)),
        };
        let importance = (per_area * self.pixels) as f32;
        CameraSample { wi, film: glam::Vec2::ZERO, importance, pdf_w: 1.0, target: self.path.lens, delta: true }
    }
}
