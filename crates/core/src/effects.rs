//! A census of the effects that a scene has, so that only those are simulated.

mod lobes;

pub use lobes::LobeKind;

use crate::{
    camera::Projection,
    has,
    lights::environment::Environment,
    material::Material,
    rgb::Rgb,
    scene::{DeltaLight, ObjectShape, SceneDescription},
    technique::Chain,
    texture::Texture,
};
use lobes::{collect_lobes, is_mixture};
use std::fmt;

/// Roughness up to which a lobe counts as narrow: light that it gathers makes caustics that sampling the lights from
/// the receiver misses. At 0.15 a GGX lobe holds half its energy within about 9 degrees of the mirror direction.
pub const NARROW_ALPHA: f32 = 0.15;

/// A sort of lobe and how it is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeUse {
    /// What sort.
    pub kind: LobeKind,
    /// Objects whose material has it.
    pub objects: usize,
    /// Smallest and largest roughness among them; 0 for smooth ones and holes, 1 for Lambert and for diffuse bodies.
    pub alpha: (f32, f32),
}

/// Lights by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightCount {
    /// Emitting objects.
    pub area_objects: usize,
    /// Emitting triangles, spheres, disks and cylinders.
    pub area_elements: usize,
    /// Point lights.
    pub point: usize,
    /// Spot lights.
    pub spot: usize,
    /// Projectors.
    pub projector: usize,
    /// Directional lights.
    pub directional: usize,
}

/// The environment, as far as it decides what to simulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EnvironmentUse {
    /// The same from everywhere.
    Constant,
    /// An image.
    LatLong {
        /// Width and height in texels.
        size: (u32, u32),
        /// Share of its power in the strongest thousandth of the sphere's solid angle: near 1 it is a sun.
        peak_share: f64,
    },
}

/// What a scene has. Everything here is read off the description: nothing is estimated.
#[derive(Clone, Debug, PartialEq)]
pub struct Census {
    /// Triangles as placed (instances counted once a group).
    pub triangles: usize,
    /// Analytic spheres, disks and cylinders.
    pub curved: usize,
    /// Placements of groups.
    pub instances: usize,
    /// Lobes in use, in order of kind.
    pub lobes: Vec<LobeUse>,
    /// Objects whose material is a mixture.
    pub mixtures: usize,
    /// Materials in use with a texture.
    pub textured_materials: usize,
    /// Objects whose material has a relief.
    pub reliefs: usize,
    /// Lights.
    pub lights: LightCount,
    /// Emitting objects whose radiance varies.
    pub textured_lights: usize,
    /// Objects whose inside absorbs light.
    pub absorbing: usize,
    /// Light from infinity.
    pub environment: Option<EnvironmentUse>,
    /// Objects with a smooth or narrow lobe: what can cast a caustic.
    pub casters: usize,
    /// Objects with a lobe wide enough to show one.
    pub receivers: usize,
    /// Whether the camera has a lens.
    pub lens: bool,
}

impl Census {
    /// Counts what a description has. Meant for a description that [`crate::scene::Scene::new`] accepts; indices out
    /// of range are passed over.
    pub fn of(scene: &SceneDescription) -> Census {
        let mut census = Census {
            triangles: 0,
            curved: 0,
            instances: scene.instances.len(),
            lobes: Vec::new(),
            mixtures: 0,
            textured_materials: 0,
            reliefs: 0,
            lights: LightCount::default(),
            textured_lights: 0,
            absorbing: 0,
            environment: scene.environment.as_ref().and_then(environment_use),
            casters: 0,
            receivers: 0,
            lens: matches!(scene.camera.as_ref().map(|c| c.projection), Some(Projection::ThinLens { .. })),
        };
        let mut used = vec![false; scene.materials.len()];
        for object in scene.objects.iter().chain(scene.groups.iter().flat_map(|g| &g.objects)) {
            let elements = match &object.shape {
                ObjectShape::Mesh(mesh) => mesh.triangles.len(),
                ObjectShape::Rectangle => 2,
                ObjectShape::Cube => 12,
                ObjectShape::Sphere { .. } | ObjectShape::Disk | ObjectShape::Cylinder { .. } => 0,
            };
            census.triangles += elements;
            census.curved += usize::from(elements == 0 && !matches!(object.shape, ObjectShape::Mesh(_)));
            if let Some(emission) = object.emission.as_ref().filter(|e| **e != Texture::Constant(Rgb::BLACK)) {
                census.textured_lights += usize::from(!emission.is_constant());
                census.lights.area_objects += 1;
                census.lights.area_elements += elements.max(1);
            }
            census.absorbing += usize::from(object.absorption.is_some_and(|a| !a.is_black()));
            if let Some(named) = scene.materials.get(object.material) {
                used[object.material] = true;
                census.mixtures += usize::from(is_mixture(&named.material));
                census.reliefs += usize::from(matches!(named.material, Material::Relief { .. }));
                census.count_lobes(&named.material);
            }
        }
        for light in &scene.lights {
            *match light.kind {
                DeltaLight::Point { .. } => &mut census.lights.point,
                DeltaLight::Spot { .. } => &mut census.lights.spot,
                DeltaLight::Projector { .. } => &mut census.lights.projector,
                DeltaLight::Directional { .. } => &mut census.lights.directional,
            } += 1;
        }
        census.textured_materials =
            scene.materials.iter().zip(&used).filter(|(m, used)| **used && m.material.is_textured()).count();
        census.lobes.sort_by_key(|l| l.kind);
        census
    }

    fn count_lobes(&mut self, material: &Material) {
        let mut lobes = Vec::new();
        collect_lobes(material, &mut lobes);
        let (mut caster, mut receiver) = (false, false);
        for (kind, alpha) in lobes {
            // A hole gathers nothing: light passes as if it were not there.
            caster |= kind != LobeKind::Null && alpha.0 <= NARROW_ALPHA;
            receiver |= alpha.1 > NARROW_ALPHA;
            match self.lobes.iter_mut().find(|l| l.kind == kind) {
                Some(l) => {
                    l.objects += 1;
                    l.alpha = (l.alpha.0.min(alpha.0), l.alpha.1.max(alpha.1));
                }
                None => self.lobes.push(LobeUse { kind, objects: 1, alpha }),
            }
        }
        self.casters += usize::from(caster);
        self.receivers += usize::from(receiver);
    }

    /// Whether there is any light.
    pub fn is_lit(&self) -> bool {
        let l = &self.lights;
        l.area_elements + l.point + l.spot + l.projector + l.directional > 0 || self.environment.is_some()
    }

    /// Whether light can reach a receiver by way of a caster.
    pub fn has_caustics(&self) -> bool {
        self.casters > 0 && self.receivers > 0 && self.is_lit()
    }

    /// The chains of vertices that the scene can hold, as far as its lights and lobes tell: where things stand is not looked at.
    pub fn chains(&self) -> Vec<Chain> {
        let l = &self.lights;
        let without_extent = l.point + l.spot + l.projector + l.directional > 0;
        let any = |f: fn(LobeKind) -> bool| self.lobes.iter().any(|l| f(l.kind));
        let (delta, rough) = (any(LobeKind::has_delta), any(LobeKind::has_rough));
        // What is behind a hole is where it would be without it, and a light without an extent is not seen at all.
        let bends = any(|kind| kind.has_delta() && kind != LobeKind::Null);
        let holds = |chain: &Chain| match chain {
            Chain::LightThroughDelta => without_extent && bends,
            Chain::Caustic | Chain::CausticThroughDelta => without_extent && delta && rough,
            Chain::SurfaceThroughDelta => self.is_lit() && delta && rough,
        };
        Chain::ALL.into_iter().filter(holds).collect()
    }

    /// The features that hot loops must be able to handle: bits of [`crate::has`].
    pub fn features(&self) -> u32 {
        let mut bits = 0;
        let mut set = |bit, present: bool| bits |= if present { bit } else { 0 };
        set(has::CURVED, self.curved > 0);
        set(has::INSTANCES, self.instances > 0);
        set(has::LOBES, self.mixtures > 0 || self.lobes.iter().any(|l| l.kind != LobeKind::Lambert));
        set(has::INFINITE, self.environment.is_some() || self.lights.directional > 0);
        set(has::MEDIA, self.absorbing > 0);
        set(has::TEXTURES, self.textured_materials + self.reliefs + self.textured_lights > 0);
        bits
    }
}

fn environment_use(environment: &Environment) -> Option<EnvironmentUse> {
    match environment {
        Environment::Constant(c) => (!c.is_black()).then_some(EnvironmentUse::Constant),
        Environment::LatLong { image, .. } => {
            let mut texels: Vec<(f64, f64)> = image
                .texels
                .iter()
                .enumerate()
                .map(|(i, c)| {
                    let row = i / image.width as usize;
                    let theta = (row as f64 + 0.5) / f64::from(image.height) * std::f64::consts::PI;
                    (f64::from(c.luminance()), theta.sin())
                })
                .collect();
            let total: f64 = texels.iter().map(|(l, w)| l * w).sum();
            let solid: f64 = texels.iter().map(|(_, w)| w).sum();
            texels.sort_by(|a, b| b.0.total_cmp(&a.0));
            let (mut seen, mut power) = (0.0, 0.0);
            for (luminance, weight) in texels {
                let taken = weight.min(1e-3 * solid - seen);
                if taken <= 0.0 {
                    break;
                }
                seen += taken;
                power += luminance * taken;
            }
            (total > 0.0)
                .then(|| EnvironmentUse::LatLong { size: (image.width, image.height), peak_share: power / total })
        }
    }
}

/// One effect a line, what is absent included: that is what costs nothing.
impl fmt::Display for Census {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "triangles: {}", self.triangles)?;
        writeln!(f, "spheres, disks and cylinders: {}", self.curved)?;
        writeln!(f, "instances: {}", self.instances)?;
        for l in &self.lobes {
            write!(f, "{}: {} objects", l.kind.name(), l.objects)?;
            match l.kind {
                LobeKind::RoughConductor
                | LobeKind::RoughDielectric
                | LobeKind::RoughPlastic
                | LobeKind::Principled
                | LobeKind::PrincipledThin => {
                    writeln!(f, ", roughness {} to {}", l.alpha.0, l.alpha.1)?;
                }
                _ => writeln!(f)?,
            }
        }
        writeln!(f, "mixtures: {} objects", self.mixtures)?;
        writeln!(f, "textured materials: {}", self.textured_materials)?;
        writeln!(f, "reliefs: {} objects", self.reliefs)?;
        writeln!(f, "absorbing insides: {} objects", self.absorbing)?;
        let l = &self.lights;
        writeln!(f, "area lights: {} ({} elements)", l.area_objects, l.area_elements)?;
        writeln!(f, "textured lights: {} objects", self.textured_lights)?;
        let (spot, projector, directional) = (l.spot, l.projector, l.directional);
        writeln!(f, "point, spot, projector, directional lights: {}, {spot}, {projector}, {directional}", l.point)?;
        match &self.environment {
            None => writeln!(f, "environment: none")?,
            Some(EnvironmentUse::Constant) => writeln!(f, "environment: constant")?,
            Some(EnvironmentUse::LatLong { size: (w, h), peak_share }) => writeln!(
                f,
                "environment: {w}x{h}, {:.1} % of its power in the strongest thousandth of the sphere",
                100.0 * peak_share
            )?,
        }
        if self.has_caustics() {
            writeln!(
                f,
                "caustics: {} casters (smooth, or roughness at most {NARROW_ALPHA}), {} receivers",
                self.casters, self.receivers
            )?;
        } else {
            writeln!(f, "caustics: none ({} casters, {} receivers)", self.casters, self.receivers)?;
        }
        write!(f, "lens: {}", if self.lens { "thin lens" } else { "pinhole" })
    }
}
