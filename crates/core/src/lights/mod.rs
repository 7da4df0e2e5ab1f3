//! Lights: every emitter of a scene behind one choice probability.
//!
//! An *element* is what is chosen at once: an emissive triangle, sphere, disk or cylinder, a light without an extent, or the
//! environment. Elements are numbered in this order: the area lights as given, the lights without an extent as given,
//! the environment last.

mod area;
mod delta;
mod emission;
pub mod environment;
mod picture;
mod polar;
mod resampled;
mod sky;
mod textured;
mod touching;

pub use area::{AreaLight, AreaShape, Emission};
pub use emission::{EmissionDensity, EmissionSample};
pub use textured::Coordinates;

use crate::{
    distribution::AliasTable,
    geometry::{Geometry, Surface},
    has,
    ray::PrimitiveId,
    rgb::Rgb,
    scene::DeltaLight,
    texture::TexturePoint,
};
use area::{AreaPoint, Emitter, PLAIN};
use delta::Delta;
use environment::Environment;
use glam::{Vec2, Vec3};
use sky::Sky;
use std::{f64::consts::PI, sync::Arc};
use textured::{Textured, overall_mean};
use touching::Touching;

/// A sphere that bounds something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingSphere {
    /// Centre.
    pub center: Vec3,
    /// Radius.
    pub radius: f32,
}

/// How a light is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightChoice {
    /// In proportion to the luminance of its flux; light from infinity counts what passes the world's bounding sphere.
    #[default]
    Power,
    /// Every light that emits at all alike.
    Uniform,
}

/// All the lights of a scene.
#[derive(Clone, Debug)]
pub struct Lights {
    area: Vec<Emitter>,
    /// What some of them emit by.
    textured: Vec<Textured>,
    delta: Vec<Delta>,
    /// For each of them the surfaces that it lies on; empty where none does.
    touching: Vec<Touching>,
    sky: Option<Sky>,
    /// Over the elements; `None` when nothing emits.
    choice: Option<AliasTable>,
    world: BoundingSphere,
    directional: bool,
}

/// A direction in which light arrives at a point, chosen for next-event estimation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Radiance that arrives if nothing is in between. For a delta light, the irradiance on a plane that faces it.
    pub radiance: Rgb,
    /// Density of `wi` per steradian including the choice of the light, positive and finite; for a delta light the
    /// probability of the choice alone.
    pub pdf_w: f32,
    /// Whether no other technique can find this direction.
    pub delta: bool,
    /// Whether the light comes from infinity: the shadow ray is unbounded and goes along `wi`.
    pub infinite: bool,
    /// The point on the light; for light from infinity, a point outside the world.
    pub target: Vec3,
    /// Bound of the absolute error of `target`, componentwise.
    pub target_error: Vec3,
    /// Unit normal at `target` on the side that emits; zero for a light without a surface.
    pub target_normal: Vec3,
    /// What `target` lies on, for a shadow ray.
    pub target_id: PrimitiveId,
    /// The light.
    pub element: u32,
}

impl Lights {
    /// How many elements there can be.
    pub const LIMIT: usize = 1 << 24;

    /// The lights of a scene, all in the rendered world; `world` bounds everything visible.
    ///
    /// Values are expected to be valid as the scene checks them: finite, not negative, axes not zero, the environment
    /// passing [`Environment::check`]. An element whose flux is zero is never chosen.
    ///
    /// # Panics
    /// With more than [`Lights::LIMIT`] elements.
    pub fn build(
        area: Vec<AreaLight>,
        delta: Vec<DeltaLight>,
        environment: Option<Environment>,
        world: BoundingSphere,
        choice: LightChoice,
    ) -> Lights {
        let (area, textured) = emitters(area);
        let delta: Vec<Delta> = delta.iter().map(Delta::from).collect();
        let sky = environment.as_ref().map(Sky::new);
        let disk = PI * f64::from(world.radius).powi(2);
        let flux = (area.iter().map(Emitter::flux))
            .chain(delta.iter().map(|light| light.flux(world.radius)))
            .chain(sky.iter().map(|sky| disk * sky.integral()));
        let weights: Vec<f64> = flux
            .map(|flux| match choice {
                _ if !(flux.is_finite() && flux > 0.0) => 0.0,
                LightChoice::Power => flux,
                LightChoice::Uniform => 1.0,
            })
            .collect();
        assert!(weights.len() <= Lights::LIMIT, "too many lights: {}", weights.len());
        let directional = delta.iter().any(|light| matches!(light, Delta::Directional { .. }));
        let touching = Vec::new();
        Lights { area, textured, delta, touching, sky, choice: AliasTable::new(&weights), world, directional }
    }

    /// Lets lights without an extent that lie on surfaces of `geometry` shine from there.
    #[must_use]
    pub fn on_surfaces(mut self, geometry: &Geometry) -> Lights {
        let touching =
            |light: &Delta| light.position().map_or(Touching::default(), |p| Touching::find(p, geometry, self.world));
        let touching: Vec<Touching> = self.delta.iter().map(touching).collect();
        self.touching = if touching.iter().any(Touching::any) { touching } else { Vec::new() };
        self
    }

    /// The position of a light without an extent, off the surfaces that it lies on, on the side that `towards` is on.
    #[inline]
    fn off_surfaces(&self, element: u32, position: Vec3, towards: Vec3) -> Vec3 {
        if self.touching.is_empty() {
            return position;
        }
        self.touching[element as usize - self.area.len()].moved(position, towards)
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.area.len() + self.delta.len() + usize::from(self.sky.is_some())
    }

    /// Whether there is no light at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether any light comes from infinity: an environment or a directional light.
    pub fn has_infinite(&self) -> bool {
        self.sky.is_some() || self.directional
    }

    /// The element that is the environment.
    pub fn environment_element(&self) -> Option<u32> {
        self.sky.as_ref().map(|_| self.len() as u32 - 1)
    }

    /// Probability that an element is the one chosen: what next-event estimation, emission and every weight read.
    #[inline]
    pub fn choice_probability(&self, element: u32) -> f32 {
        self.choice.as_ref().map_or(0.0, |table| table.pmf(element as usize))
    }

    /// Radiance that an area element emits from a point of its surface in the direction `wo`. `HAS` must include
    /// [`has::TEXTURES`] where a shape emits by a texture.
    #[inline]
    pub fn emitted<const HAS: u32>(&self, element: u32, surface: &Surface, wo: Vec3) -> Rgb {
        if surface.ng.dot(wo) <= 0.0 {
            return Rgb::BLACK;
        }
        let light = &self.area[element as usize];
        if HAS & has::TEXTURES != 0 && light.texture != PLAIN {
            let point = TexturePoint { uv: surface.uv, color: surface.color };
            return self.textured[light.texture as usize].texture.at(&point);
        }
        light.radiance
    }

    /// Radiance from a sampled point of an area light.
    #[inline]
    fn area_radiance<const HAS: u32>(&self, light: &Emitter, point: &AreaPoint) -> Rgb {
        if HAS & has::TEXTURES != 0 && light.texture != PLAIN {
            return self.textured[light.texture as usize].radiance(&light.shape, point);
        }
        light.radiance
    }

    /// Chooses a light and a direction to it, as seen from `from`. `None` where the light that is chosen cannot send
    /// any light there, or only with a density that is not finite. `HAS` must include [`has::TEXTURES`] where a shape
    /// emits by a texture.
    #[inline]
    pub fn sample_direct<const HAS: u32>(&self, from: Vec3, u_choice: f32, u: Vec2) -> Option<DirectSample> {
        let element = self.choose(u_choice, u)?;
        let choice = self.choice_probability(element);
        let sample = match self.element(element) {
            Element::Area(light) => {
                let d = light.sample_direction(from, u)?;
                DirectSample {
                    wi: d.wi,
                    radiance: self.area_radiance::<HAS>(light, &d.point),
                    pdf_w: choice * d.pdf_w,
                    delta: false,
                    infinite: false,
                    target: d.point.p,
                    target_error: d.point.p_error,
                    target_normal: d.point.normal,
                    target_id: PrimitiveId { primitive: light.primitive, ..PrimitiveId::NONE },
                    element,
                }
            }
            Element::Delta(light) => self.delta_direct(light, from, choice, element)?,
            Element::Sky(sky) => {
                let sample = sky.sample(u)?;
                self.infinite_direct(from, sample.direction, sample.radiance, choice * sample.pdf_w, element)
            }
        };
        (sample.pdf_w > 0.0 && sample.pdf_w.is_finite() && sample.radiance.is_valid()).then_some(sample)
    }

    #[inline]
    fn delta_direct(&self, light: &Delta, from: Vec3, choice: f32, element: u32) -> Option<DirectSample> {
        if let Delta::Directional { direction, irradiance } = light {
            let sample = self.infinite_direct(from, -*direction, *irradiance, choice, element);
            return Some(DirectSample { delta: true, ..sample });
        }
        let position = light.position()?;
        let to = position - from;
        let d2 = to.length_squared();
        if d2 == 0.0 {
            return None;
        }
        let wi = to / d2.sqrt();
        let radiance = match light {
            Delta::Spot { intensity, cone, .. } => *intensity * (cone.falloff(-wi) / d2),
            Delta::Picture(picture) => picture.intensity(-wi) * (1.0 / d2),
            Delta::Point { intensity, .. } | Delta::Directional { irradiance: intensity, .. } => {
                *intensity * (1.0 / d2)
            }
        };
        (!radiance.is_black()).then_some(DirectSample {
            wi,
            radiance,
            pdf_w: choice,
            delta: true,
            infinite: false,
            target: self.off_surfaces(element, position, -to),
            target_error: Vec3::ZERO,
            target_normal: Vec3::ZERO,
            target_id: PrimitiveId::NONE,
            element,
        })
    }

    #[inline]
    fn infinite_direct(&self, from: Vec3, wi: Vec3, radiance: Rgb, pdf_w: f32, element: u32) -> DirectSample {
        // From inside the world's sphere, beyond its far side.
        let target = from + wi * (2.0 * self.world.radius);
        DirectSample {
            wi,
            radiance,
            pdf_w,
            delta: false,
            infinite: true,
            target,
            target_error: Vec3::ZERO,
            target_normal: Vec3::ZERO,
            target_id: PrimitiveId::NONE,
            element,
        }
    }

    /// The density of [`Lights::sample_direct`], choice included, for a direction `wi` from `from` that another
    /// technique found to hit the area element `element` at `p`, where its geometric normal is `ng`.
    #[inline]
    pub fn pdf_direct(&self, element: u32, from: Vec3, p: Vec3, ng: Vec3, wi: Vec3) -> f32 {
        let pdf = self.choice_probability(element) * self.area[element as usize].direction_pdf(from, p, ng, wi);
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    /// Radiance of the environment from a direction.
    #[inline]
    pub fn environment_radiance(&self, direction: Vec3) -> Rgb {
        self.sky.as_ref().map_or(Rgb::BLACK, |sky| sky.radiance(direction))
    }

    /// The density of [`Lights::sample_direct`], choice included, for the environment in a direction.
    #[inline]
    pub fn environment_pdf(&self, direction: Vec3) -> f32 {
        self.environment_radiance_and_pdf(direction).1
    }

    /// [`Lights::environment_radiance`] and [`Lights::environment_pdf`] at the price of one look-up.
    #[inline]
    pub fn environment_radiance_and_pdf(&self, direction: Vec3) -> (Rgb, f32) {
        let Some(sky) = &self.sky else { return (Rgb::BLACK, 0.0) };
        let (radiance, pdf) = sky.radiance_and_pdf(direction);
        (radiance, pdf * self.choice_probability(self.len() as u32 - 1))
    }

    /// Bytes held, images left out: they may be shared.
    pub fn table_bytes(&self) -> u64 {
        let pictures = self.delta.iter().map(|light| match light {
            Delta::Picture(picture) => picture.table_bytes(),
            _ => 0,
        });
        (self.area.capacity() * size_of::<Emitter>()
            + self.textured.capacity() * size_of::<Textured>()
            + self.delta.capacity() * size_of::<Delta>()
            + self.touching.capacity() * size_of::<Touching>()) as u64
            + pictures.sum::<u64>()
            + self.choice.as_ref().map_or(0, AliasTable::memory_bytes)
            + self.sky.as_ref().map_or(0, Sky::table_bytes)
    }

    /// Chooses an element. The bits of `u` extend those of `u_choice`: among a million elements the 24 bits of one
    /// `f32` leave four to tell an element from its alias, which would shift probabilities by several per cent.
    #[inline]
    fn choose(&self, u_choice: f32, u: Vec2) -> Option<u32> {
        let table = self.choice.as_ref()?;
        let mixed = (u64::from(u.x.to_bits()) << 32 | u64::from(u.y.to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mixed = (mixed ^ mixed >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93) >> 32;
        // 2^-24 is the spacing of the largest f32 below 1, 2^-32 that of the mixed bits.
        let extended = f64::from(u_choice) + mixed as f64 * (0.5f64).powi(56);
        Some(table.pick(extended) as u32)
    }

    #[inline]
    fn element(&self, element: u32) -> Element<'_> {
        let i = element as usize;
        match (self.area.get(i), &self.sky) {
            (Some(light), _) => Element::Area(light),
            (None, Some(sky)) if i == self.area.len() + self.delta.len() => Element::Sky(sky),
            _ => Element::Delta(&self.delta[i - self.area.len()]),
        }
    }
}

/// The area lights, and what some of them emit by.
fn emitters(area: Vec<AreaLight>) -> (Vec<Emitter>, Vec<Textured>) {
    let mut textures: Vec<Textured> = Vec::new();
    let mut overall = Rgb::BLACK;
    let emitters = area.into_iter().map(|AreaLight { shape, emission, primitive }| match emission {
        Emission::Constant(radiance) => Emitter::new(shape, radiance, primitive),
        Emission::Textured { texture, coordinates } => {
            // The elements of an object follow each other: the mean of its texture is taken once.
            if textures.last().is_none_or(|last| !Arc::ptr_eq(&last.texture, &texture)) {
                overall = overall_mean(&texture);
            }
            let mut emitter = Emitter::new(shape, Rgb::BLACK, primitive);
            let textured = Textured::new(texture, coordinates);
            emitter.radiance = textured.mean(&emitter, overall);
            emitter.texture = textures.len() as u32;
            textures.push(textured);
            emitter
        }
    });
    (emitters.collect(), textures)
}

enum Element<'a> {
    Area(&'a Emitter),
    Delta(&'a Delta),
    Sky(&'a Sky),
}
