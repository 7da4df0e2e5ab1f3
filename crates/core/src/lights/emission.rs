//! Light leaving the lights: where walks from lights start.

use super::{Element, Lights, delta::Delta};
use crate::{
    frame::Frame,
    rgb::Rgb,
    warp::{cosine_hemisphere_pdf, sample_cosine_hemisphere, sample_disk, sample_sphere, sphere_pdf},
};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// A ray that leaves a light.
///
/// | element | `p` | `radiance` | `cos` | `pdf_a` | `pdf_w` |
/// | --- | --- | --- | --- | --- | --- |
/// | area | on the light | radiance | at the light | per m² of the light | per steradian |
/// | point, spot, projector | the light | intensity | 1 | 1 (delta) | per steradian |
/// | directional | on a disk outside the world | irradiance | 1 | per m² of the disk | 1 (delta) |
/// | environment | on a disk outside the world | radiance | 1 | per m² of the disk | per steradian |
///
/// The disk has the radius of the world's bounding sphere, touches the sphere and faces `direction`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionSample {
    /// Where the ray starts.
    pub p: Vec3,
    /// Bound of the absolute error of `p`, componentwise; zero unless `p` is on a surface.
    pub p_error: Vec3,
    /// Unit normal at `p` on the side that emits; `direction` for a light without a surface.
    pub normal: Vec3,
    /// Unit direction in which the light travels.
    pub direction: Vec3,
    /// What is emitted, in the units of the table.
    pub radiance: Rgb,
    /// Cosine between `normal` and `direction`.
    pub cos: f32,
    /// Density of the position, choice not included.
    pub pdf_a: f32,
    /// Density of the direction, choice not included.
    pub pdf_w: f32,
    /// Probability of the choice of the light.
    pub choice: f32,
    /// Whether the position has no density: no other technique finds the light by hitting it.
    pub delta_position: bool,
    /// Whether the direction has no density.
    pub delta_direction: bool,
    /// Whether the light comes from infinity.
    pub infinite: bool,
    /// The light.
    pub element: u32,
}

impl EmissionSample {
    /// Flux that the ray stands for: `radiance cos / (choice pdf_a pdf_w)`. Its mean is the flux of all lights.
    #[inline]
    pub fn weight(&self) -> Rgb {
        self.radiance * (self.cos / (self.choice * self.pdf_a * self.pdf_w))
    }
}

/// How densely [`Lights::sample_emission`] samples a ray; the fields mean what they mean in [`EmissionSample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionDensity {
    /// Probability of the choice of the light.
    pub choice: f32,
    /// Density of the position, choice not included.
    pub pdf_a: f32,
    /// Density of the direction, choice not included.
    pub pdf_w: f32,
}

impl Lights {
    /// Chooses a light and a ray that leaves it. `None` where the ray carries nothing or has no finite density.
    ///
    /// `HAS` must include [`crate::has::TEXTURES`] where a shape emits by a texture.
    pub fn sample_emission<const HAS: u32>(
        &self,
        u_choice: f32,
        u_point: Vec2,
        u_direction: Vec2,
    ) -> Option<EmissionSample> {
        let element = self.choose(u_choice, u_point)?;
        let (p, p_error, normal, direction, radiance) = match self.element(element) {
            Element::Area(light) => {
                let point = light.sample_point(u_point);
                let local = sample_cosine_hemisphere(u_direction);
                let direction = Frame::from_normal(point.normal).to_world(local);
                (point.p, point.p_error, point.normal, direction, self.area_radiance::<HAS>(light, &point))
            }
            Element::Delta(Delta::Point { position, intensity }) => {
                let direction = sample_sphere(u_direction);
                (self.off_surfaces(element, *position, direction), Vec3::ZERO, direction, direction, *intensity)
            }
            Element::Delta(Delta::Spot { position, intensity, cone }) => {
                let direction = cone.sample(u_direction);
                let p = self.off_surfaces(element, *position, direction);
                (p, Vec3::ZERO, direction, direction, *intensity * cone.falloff(direction))
            }
            Element::Delta(Delta::Picture(picture)) => {
                let direction = picture.sample(u_direction)?;
                let p = self.off_surfaces(element, picture.position, direction);
                (p, Vec3::ZERO, direction, direction, picture.intensity(direction))
            }
            Element::Delta(Delta::Directional { direction, irradiance }) => {
                (self.outside(*direction, u_point), Vec3::ZERO, *direction, *direction, *irradiance)
            }
            Element::Sky(sky) => {
                let sample = sky.sample(u_direction)?;
                let away = -sample.direction;
                (self.outside(away, u_point), Vec3::ZERO, away, away, sample.radiance)
            }
        };
        let EmissionDensity { choice, pdf_a, pdf_w } = self.emission_density(element, normal, direction);
        let kind = self.element(element);
        let infinite = matches!(kind, Element::Sky(_) | Element::Delta(Delta::Directional { .. }));
        let sample = EmissionSample {
            p,
            p_error,
            normal,
            direction,
            radiance,
            cos: if matches!(kind, Element::Area(_)) { normal.dot(direction) } else { 1.0 },
            pdf_a,
            pdf_w,
            choice,
            delta_position: matches!(
                kind,
                Element::Delta(Delta::Point { .. } | Delta::Spot { .. } | Delta::Picture(_))
            ),
            delta_direction: matches!(kind, Element::Delta(Delta::Directional { .. })),
            infinite,
            element,
        };
        let valid = sample.cos > 0.0 && pdf_a * pdf_w > 0.0 && sample.weight().is_valid() && !radiance.is_black();
        valid.then_some(sample)
    }

    /// How densely [`Lights::sample_emission`] samples a ray that leaves `element` in the unit `direction` in which
    /// the light travels; `ng` is the geometric normal where it leaves an area element and is not read for others.
    ///
    /// Whether a light without an extent can emit that ray at all is not asked: where it cannot, a delta density of 1
    /// stands; a spot's `pdf_w` is 0 outside its cone, a picture's past it.
    #[inline]
    pub fn emission_density(&self, element: u32, ng: Vec3, direction: Vec3) -> EmissionDensity {
        let disk = 1.0 / (PI * self.world.radius * self.world.radius);
        let (pdf_a, pdf_w) = match self.element(element) {
            Element::Area(light) => (1.0 / light.area, cosine_hemisphere_pdf(ng.dot(direction))),
            Element::Delta(Delta::Point { .. }) => (1.0, sphere_pdf()),
            Element::Delta(Delta::Spot { cone, .. }) => (1.0, cone.pdf(direction)),
            Element::Delta(Delta::Picture(picture)) => (1.0, picture.pdf(direction)),
            Element::Delta(Delta::Directional { .. }) => (disk, 1.0),
            Element::Sky(sky) => (disk, sky.radiance_and_pdf(-direction).1),
        };
        EmissionDensity { choice: self.choice_probability(element), pdf_a, pdf_w }
    }

    /// A uniform point of the disk outside the world that faces a direction.
    #[inline]
    fn outside(&self, direction: Vec3, u: Vec2) -> Vec3 {
        let d = sample_disk(u);
        self.world.center + Frame::from_normal(direction).to_world(d.extend(-1.0)) * self.world.radius
    }
}
