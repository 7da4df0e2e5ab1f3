//! All strategies of one camera path and one light path.

use crate::{
    connections::{Connection, choose},
    densities::{Departure, Joint, camera_pdf_a, direct_end, emitted_end, escaped_end, hit_end},
    events::{Contribution, Event, Side},
    particle::{Particle, connects, part, see},
    splats::Splats,
    weights::{Heuristic, LightEnd, Prefix},
};
use etendue_core::{
    bsdf::TransportMode,
    filter::Filter,
    geometry::offset::{shadow_ray, spawn_ray},
    has,
    sampler::{Purpose, Sampler},
    scene::Scene,
    statistics::render::Rays,
    technique::{Part, Settings},
    walk::{EscapedVertex, SurfaceVertex, Vertex, Walk},
};
use glam::{UVec2, Vec2, Vec3};

/// A vertex of a light path that others are connected to.
#[derive(Clone, Copy, Debug)]
struct LightVertex {
    vertex: SurfaceVertex,
    prefix: Prefix,
    part: Part,
}

/// Walks pairs of paths through one scene; holds the vertices of a light path and the connections to them, in memory that is
/// used again for the next.
pub struct Paths<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    heuristic: Heuristic,
    filter: Filter,
    /// Of the film: as many paths from the camera a pass.
    pixels: f32,
    splats: Splats,
    light: Vec<LightVertex>,
    connections: Vec<Connection>,
    /// How many of a pixel's connections are tested on average; all if none.
    tests: Option<f32>,
}

impl<'a> Paths<'a> {
    /// For a film of `pixels` pixels, each of which gets one pair of paths a pass.
    pub fn new(
        scene: &'a Scene,
        settings: &'a Settings,
        heuristic: Heuristic,
        filter: Filter,
        pixels: u32,
    ) -> Paths<'a> {
        let (light, connections) = (Vec::new(), Vec::new());
        let (pixels, splats) = (pixels as f32, Splats::new(1));
        Paths { scene, settings, heuristic, filter, pixels, splats, light, connections, tests: None }
    }

    /// Tests no more than about so many of a pair's connections for what lies between: each with a probability in proportion
    /// to its weighted contribution, by which it is divided; splats of direct light by their weight. Without it every connection
    /// is tested, which is for whoever looks at strategies without their weights.
    #[must_use]
    pub fn testing(self, connections: f32) -> Paths<'a> {
        Paths { tests: Some(connections), ..self }
    }

    /// Walks a path from a light and one from the camera through a pixel, joins them in every way, and tells `tell`.
    /// Contributions of parts of the light that are not to be rendered are left out.
    #[inline]
    pub fn sample<const HAS: u32>(
        &mut self,
        pixel: UVec2,
        sampler: &mut dyn Sampler,
        rays: &mut Rays,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        self.walk_from_light::<HAS, true>(sampler, rays, tell);
        self.connections.clear();
        self.walk_from_camera::<HAS>(pixel, sampler, rays, tell);
        self.test_connections::<HAS>(sampler, rays, tell);
    }

    /// Says that for each pair of paths there are so many walks from lights that make caustics: the pair's and others, each by a
    /// call of [`Paths::caustic_particle`].
    #[must_use]
    pub fn with_caustic_particles(self, particles: u32) -> Paths<'a> {
        Paths { splats: Splats::new(particles), ..self }
    }

    /// Walks one more path from a light, and on if the first surface scatters it by a delta lobe: what the camera sees of it
    /// is a caustic.
    #[inline]
    pub fn caustic_particle<const HAS: u32>(
        &mut self,
        sampler: &mut dyn Sampler,
        rays: &mut Rays,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        self.walk_from_light::<HAS, false>(sampler, rays, tell);
    }

    /// Tests the connections, or a choice of them, for what lies between.
    #[inline]
    fn test_connections<const HAS: u32>(
        &self,
        sampler: &mut dyn Sampler,
        rays: &mut Rays,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        let Some(tests) = self.tests.filter(|tests| (self.connections.len() as f32) > *tests) else {
            self.connections.iter().for_each(|c| self.test::<HAS>(c, 1.0, rays, tell));
            return;
        };
        let u = sampler.get_1d(0, Purpose::Connections);
        choose(&self.connections, tests, u).for_each(|(c, probability)| self.test::<HAS>(c, probability, rays, tell));
    }

    /// Tests a connection that was chosen with a probability.
    #[inline]
    fn test<const HAS: u32>(
        &self,
        connection: &Connection,
        probability: f32,
        rays: &mut Rays,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        rays.shadow += 1;
        if self.scene.occluded::<HAS>(&connection.ray) {
            return;
        }
        let Connection { s, t, part, weight, .. } = *connection;
        let value = connection.value * (1.0 / probability);
        tell(Event::Contribution(Contribution { s, t, part, value, weight, film: None, light: None, lens: None }));
    }

    /// Walks from a light, remembers the vertices that can be connected if they are to be kept, and connects each to the lens
    /// (`t = 1`).
    #[inline]
    fn walk_from_light<const HAS: u32, const KEPT: bool>(
        &mut self,
        sampler: &mut dyn Sampler,
        rays: &mut Rays,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        self.light.clear();
        let (scene, settings, heuristic) = (self.scene, self.settings, self.heuristic);
        let Some(mut particle) = Particle::<HAS>::emit(scene, settings, sampler) else { return };
        tell(Event::Emission(&particle.start));
        let mut before: Option<(Prefix, Departure)> = None;
        while let Some(vertex) = particle.trace(rays) {
            tell(Event::Vertex(Side::Light, &vertex));
            if !KEPT && vertex.depth == 1 && !(HAS & has::LOBES != 0 && vertex.bsdf.has_delta()) {
                return;
            }
            let prefix = match &before {
                None => Prefix::from_light(heuristic, &emitted_end(scene.lights(), &particle.start, &vertex)),
                Some((prefix, departure)) => departure.arrive(heuristic, prefix, &vertex),
            };
            if connects::<HAS>(&vertex) && (KEPT || vertex.depth > 1) {
                let part = particle.part(&vertex, 0);
                if settings.parts.contains(part) {
                    self.see::<HAS>(&vertex, &prefix, part, sampler, rays, tell);
                }
                if KEPT {
                    self.light.push(LightVertex { part: particle.part(&vertex, 1), vertex, prefix });
                }
            }
            let Some(step) = particle.walk.go_on(&vertex, sampler) else { return };
            if !KEPT && vertex.depth == 1 && !step.delta {
                return;
            }
            tell(Event::Step(Side::Light, &step));
            let departure = Departure::new::<HAS>(heuristic, &prefix, &vertex, &step, TransportMode::Importance);
            before = Some((prefix, departure));
        }
    }

    /// `t = 1`: the vertex of a light path as the camera sees it.
    #[inline]
    fn see<const HAS: u32>(
        &self,
        vertex: &SurfaceVertex,
        prefix: &Prefix,
        part: Part,
        sampler: &mut dyn Sampler,
        rays: &mut Rays,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        let margin = self.filter.radius();
        let splats = self.splats.of(part);
        // Direct light has as many particles as other light; it only counts as if it had fewer.
        let particles = self.pixels * splats.max(1.0) as f32;
        let Some(seen) = see::<HAS>(self.scene, vertex, particles, margin, sampler) else { return };
        let (camera, h) = (&seen.camera, self.heuristic);
        let reverse = vertex.pdf_reverse::<HAS>(camera.wi, TransportMode::Importance);
        let found = camera_pdf_a(Some(camera), self.pixels, camera.wi, vertex.surface.ng) / splats;
        let weight = h.joined(h.term(found) * prefix.leave(h, f64::from(reverse), false).others);
        let mut value = seen.value;
        if self.tests.is_some() && splats < 1.0 {
            // Mostly of a weight that is not worth a ray.
            let survival = (weight / splats).min(1.0) as f32;
            if sampler.get_1d(vertex.depth, Purpose::Connections) >= survival {
                return;
            }
            value *= 1.0 / survival;
        }
        rays.shadow += 1;
        if self.scene.occluded::<HAS>(&seen.ray) {
            return;
        }
        tell(Event::Contribution(Contribution {
            s: vertex.depth + 1,
            t: 1,
            part,
            value,
            weight: weight as f32,
            film: Some(camera.film),
            light: None,
            lens: Some(camera.target),
        }));
    }

    /// Walks from the camera; each vertex may be a light (`s = 0`), is lit by a light (`s = 1`), and is connected to all
    /// vertices of the light path.
    #[inline]
    fn walk_from_camera<const HAS: u32>(
        &mut self,
        pixel: UVec2,
        sampler: &mut dyn Sampler,
        rays: &mut Rays,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        let (scene, heuristic) = (self.scene, self.heuristic);
        // The position follows the filter's own density, so that every path counts alike [Ernst et al. 2006].
        let film = pixel.as_vec2() + 0.5 + self.filter.sample(sampler.get_2d(0, Purpose::Film));
        let lens = if scene.census().lens { sampler.get_2d(0, Purpose::Lens) } else { Vec2::ZERO };
        let mut walk = Walk::<HAS>::from_camera(scene, self.settings.limits(), film, lens);
        let mut before: Option<(Prefix, Departure, Vec3)> = None;
        loop {
            let vertex = match walk.trace(rays) {
                Vertex::Surface(vertex) => vertex,
                Vertex::Escaped(end) => {
                    if HAS & has::INFINITE != 0 {
                        self.escaped(&end, walk.depth(), before.as_ref(), tell);
                    }
                    return;
                }
            };
            tell(Event::Vertex(Side::Camera, &vertex));
            if let Some(element) = scene.element(&vertex.surface) {
                self.hit::<HAS>(&vertex, element, before.as_ref(), tell);
            }
            let prefix = match &before {
                None => {
                    let camera = scene.camera().sample_direct(vertex.surface.p, lens);
                    let found = camera_pdf_a(camera.as_ref(), self.pixels, vertex.wo, vertex.surface.ng);
                    Prefix::from_camera(heuristic, found)
                }
                Some((prefix, departure, _)) => departure.arrive(heuristic, prefix, &vertex),
            };
            if !walk.is_exhausted() && connects::<HAS>(&vertex) {
                self.next_event::<HAS>(&vertex, &prefix, sampler, rays, tell);
                for i in 0..self.light.len() {
                    self.connections.extend(self.connect::<HAS>(&self.light[i], &vertex, &prefix));
                }
            }
            let Some(step) = walk.go_on(&vertex, sampler) else { return };
            tell(Event::Step(Side::Camera, &step));
            let departure = Departure::new::<HAS>(heuristic, &prefix, &vertex, &step, TransportMode::Radiance);
            before = Some((prefix, departure, vertex.surface.ng));
        }
    }

    /// `s = 0`: the path runs into an area light.
    #[inline]
    fn hit<const HAS: u32>(
        &self,
        vertex: &SurfaceVertex,
        element: u32,
        before: Option<&(Prefix, Departure, Vec3)>,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        let lights = self.scene.lights();
        let part = part(vertex.history.rough, vertex.history.last_delta, false);
        let radiance = lights.emitted::<HAS>(element, &vertex.surface, vertex.wo);
        if radiance.is_black() || !self.settings.parts.contains(part) {
            return;
        }
        let weight = before
            .map_or(1.0, |(_, departure, ng)| self.hit_weight(&hit_end(lights, element, vertex, *ng), departure, part));
        tell(Event::Contribution(Contribution {
            s: 0,
            t: vertex.depth + 1,
            part,
            value: vertex.beta * radiance,
            weight: weight as f32,
            film: None,
            light: None,
            lens: None,
        }));
    }

    /// The weight of a path that has run into a light.
    #[inline]
    fn hit_weight(&self, end: &LightEnd, departure: &Departure, part: Part) -> f64 {
        let left = departure.left.with_splats(self.heuristic, self.splats.of(part));
        self.heuristic.hit(end, departure.pdf_w, departure.delta, left)
    }

    /// `s = 0`: the path leaves the scene for the environment.
    #[inline]
    fn escaped(
        &self,
        end: &EscapedVertex,
        depth: u32,
        before: Option<&(Prefix, Departure, Vec3)>,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        let lights = self.scene.lights();
        let part = part(end.history.rough, end.history.last_delta, true);
        let Some(element) = lights.environment_element().filter(|_| self.settings.parts.contains(part)) else { return };
        let radiance = lights.environment_radiance(end.direction);
        if radiance.is_black() {
            return;
        }
        let weight = before.map_or(1.0, |(_, departure, ng)| {
            self.hit_weight(&escaped_end(lights, element, end, *ng), departure, part)
        });
        tell(Event::Contribution(Contribution {
            s: 0,
            t: depth + 1,
            part,
            value: end.beta * radiance,
            weight: weight as f32,
            film: None,
            light: None,
            lens: None,
        }));
    }

    /// `s = 1`: next-event estimation.
    #[inline]
    fn next_event<const HAS: u32>(
        &self,
        vertex: &SurfaceVertex,
        prefix: &Prefix,
        sampler: &mut dyn Sampler,
        rays: &mut Rays,
        tell: &mut impl FnMut(Event<'_>),
    ) {
        let (scene, heuristic, surface) = (self.scene, self.heuristic, &vertex.surface);
        let u_choice = sampler.get_1d(vertex.depth, Purpose::LightChoice);
        let u = sampler.get_2d(vertex.depth, Purpose::LightPoint);
        let Some(light) = scene.lights().sample_direct::<HAS>(surface.p, u_choice, u) else { return };
        let part = part(vertex.history.rough + 1, false, light.infinite && !light.delta);
        if !self.settings.parts.contains(part) {
            return;
        }
        let (f_cos, pdf_w) = vertex.eval_pdf::<HAS>(light.wi, TransportMode::Radiance);
        if f_cos.is_black() || light.radiance.is_black() {
            return;
        }
        let ray = if light.infinite {
            spawn_ray(surface, light.wi)
        } else {
            shadow_ray(surface, light.target, light.target_error, light.target_normal, light.target_id)
        };
        rays.shadow += 1;
        if scene.occluded::<HAS>(&ray) {
            return;
        }
        let mut value = vertex.beta * f_cos * light.radiance * (1.0 / light.pdf_w);
        if HAS & has::MEDIA != 0 {
            let distance = if light.infinite { f32::INFINITY } else { light.target.distance(surface.p) };
            value *= vertex.transmittance::<HAS>(scene, light.wi, distance);
        }
        let reverse = vertex.pdf_reverse::<HAS>(light.wi, TransportMode::Radiance);
        let left = prefix.leave(heuristic, f64::from(reverse), false).with_splats(heuristic, self.splats.of(part));
        let weight = heuristic.next_event(&direct_end(scene.lights(), &light, vertex), f64::from(pdf_w), left);
        tell(Event::Contribution(Contribution {
            s: 1,
            t: vertex.depth + 1,
            part,
            value,
            weight: weight as f32,
            film: None,
            light: Some(&light),
            lens: None,
        }));
    }

    /// `s >= 2`, `t >= 2`: a vertex of the light path seen from one of the camera path, if nothing lies between.
    #[inline]
    fn connect<const HAS: u32>(
        &self,
        light: &LightVertex,
        camera: &SurfaceVertex,
        prefix: &Prefix,
    ) -> Option<Connection> {
        let (scene, y, z) = (self.scene, &light.vertex, camera);
        let edges = y.depth.saturating_add(z.depth).saturating_add(1);
        if edges > self.settings.max_depth || !self.settings.parts.contains(light.part) {
            return None;
        }
        let to = y.surface.p - z.surface.p;
        let d2 = to.length_squared();
        if !d2.is_normal() {
            return None;
        }
        let wi = to / d2.sqrt();
        let (z_f_cos, camera_pdf_w) = z.eval_pdf::<HAS>(wi, TransportMode::Radiance);
        if z_f_cos.is_black() {
            return None;
        }
        let (y_f_cos, light_pdf_w) = y.eval_pdf::<HAS>(-wi, TransportMode::Importance);
        if y_f_cos.is_black() {
            return None;
        }
        // In the plane of a surface within rounding, it is not known on which side of it the other vertex is.
        let error = y.surface.p_error + z.surface.p_error;
        let beside = |ng: Vec3| to.dot(ng).abs() <= error.dot(ng.abs());
        if beside(y.surface.ng) || beside(z.surface.ng) {
            return None;
        }
        // [Veach 1997, eq. 10.8]
        let mut value = z.beta * z_f_cos * y.beta * y_f_cos * (1.0 / d2);
        if HAS & has::MEDIA != 0 {
            value *= z.transmittance::<HAS>(scene, wi, d2.sqrt());
        }
        let joint = Joint { light: (y, &light.prefix), camera: (z, prefix), wi, light_pdf_w, camera_pdf_w };
        Some(Connection {
            s: y.depth + 1,
            t: z.depth + 1,
            part: light.part,
            value,
            weight: joint.weight::<HAS>(self.heuristic, self.splats.of(light.part)) as f32,
            ray: shadow_ray(&z.surface, y.surface.p, y.surface.p_error, y.surface.ng, y.surface.id),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::{camera::*, geometry::Mesh, independent::independent, material::Material, rgb::Rgb, scene::*};
    use glam::DAffine3;

    #[test]
    fn light_paths_are_kept_in_memory_that_is_used_again() {
        // The inside of a tetrahedron that shines.
        let positions =
            vec![Vec3::new(-3.0, -1.0, -2.0), Vec3::new(3.0, -1.0, -2.0), Vec3::new(0.0, -1.0, 3.0), Vec3::Y * 3.0];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let description = SceneDescription {
            camera: Some(CameraDescription {
                projection: Projection::Perspective { fov_x: 1.0 },
                to_world: DAffine3::IDENTITY,
                resolution: UVec2::ONE,
                crop: None,
            }),
            materials: vec![NamedMaterial {
                name: "grey".into(),
                material: Material::lambert(Rgb::splat(0.7)),
                two_sided: true,
            }],
            objects: vec![Object {
                name: "room".into(),
                shape: ObjectShape::Mesh(Mesh { positions, triangles, ..Mesh::default() }),
                to_world: DAffine3::IDENTITY,
                material: 0,
                emission: Some(Rgb::WHITE.into()),
                absorption: None,
            }],
            ..SceneDescription::default()
        };
        let scene = Scene::new(&description).expect("a valid scene");
        let settings = Settings::new(10, independent);
        let mut paths = Paths::new(&scene, &settings, Heuristic::Balance, Filter::Box, 1);
        let (mut sampler, mut rays) = (independent(1, 0), Rays::default());
        let mut contributions = 0;
        let held = |paths: &Paths| {
            let (light, connections) = (&paths.light, &paths.connections);
            (light.as_ptr(), light.capacity(), connections.as_ptr(), connections.capacity())
        };
        let mut memory = None;
        for sample in 0..2000 {
            sampler.start_sample(0, sample);
            paths.sample::<0>(UVec2::ZERO, &mut *sampler, &mut rays, &mut |event| {
                contributions += u32::from(matches!(event, Event::Contribution(_)));
            });
            if sample == 1000 {
                memory = Some(held(&paths));
            }
        }
        assert!(contributions > 20_000, "{contributions}");
        assert_eq!(memory, Some(held(&paths)));
    }
}
