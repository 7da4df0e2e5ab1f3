//! The scene, ready to render: geometry, materials and lights that refer to each other by index.

mod description;
mod error;
mod images;
mod place;
mod validate;

pub use description::*;
pub use error::{Kind, Problem, SceneError};
pub use images::Images;

use crate::{
    bsdf::{Bsdf, Lobe},
    camera::Camera,
    effects::Census,
    geometry::{Axes, Geometry, Hit, Instance, Shape, Surface},
    has,
    lights::{AreaLight, AreaShape, BoundingSphere, Coordinates, Emission, LightChoice, Lights},
    material::Material,
    parallel,
    ray::Ray,
    relief::{Relief, Tilt},
    rgb::Rgb,
    texture::{Texture, TexturePoint},
};
use glam::{Affine3A, DAffine3, DVec3, Vec2, Vec3};
use place::{Placed, object_error, place};
use std::sync::Arc;

/// A shape that emits nothing.
const NO_LIGHT: u32 = u32::MAX;

/// What is looked up when a shape is hit.
#[derive(Clone, Copy, Debug)]
struct ShapeInfo {
    material: u32,
    /// Number of its first light element, or [`NO_LIGHT`].
    first_element: u32,
    /// What its inside absorbs a metre, if it bounds anything that absorbs.
    absorption: Option<Rgb>,
}

/// A material as it is hit.
#[derive(Clone, Debug)]
struct PlacedMaterial {
    /// The scattering where no texture is involved.
    constant: Bsdf,
    textured: Option<Material>,
    relief: Option<Relief>,
}

impl PlacedMaterial {
    fn new(named: &NamedMaterial) -> PlacedMaterial {
        let point = TexturePoint { uv: Vec2::ZERO, color: Rgb::WHITE };
        PlacedMaterial {
            constant: named.material.bsdf(&point, named.two_sided),
            textured: named.material.is_textured().then(|| named.material.clone()),
            relief: match &named.material {
                Material::Relief { relief, .. } => Some(relief.clone()),
                _ => None,
            },
        }
    }
}

/// A validated scene, immutable. Rendering it cannot fail.
#[derive(Debug)]
pub struct Scene {
    name: String,
    census: Census,
    has: u32,
    middle: DVec3,
    camera: Camera,
    geometry: Geometry,
    lights: Lights,
    shapes: Vec<ShapeInfo>,
    materials: Vec<PlacedMaterial>,
    images: Images,
    object_names: Vec<String>,
}

impl Scene {
    /// Validates a description, places it in the world and builds the hierarchy, with lights chosen by power.
    ///
    /// # Errors
    /// [`SceneError`] names the first thing found wrong and why.
    pub fn new(description: &SceneDescription) -> Result<Scene, SceneError> {
        Scene::with_light_choice(description, LightChoice::Power)
    }

    /// As [`Scene::new`], with another way of choosing lights.
    ///
    /// # Errors
    /// [`SceneError`] names the first thing found wrong and why.
    pub fn with_light_choice(description: &SceneDescription, choice: LightChoice) -> Result<Scene, SceneError> {
        validate::check(description)?;
        let camera =
            description.camera.as_ref().ok_or_else(|| SceneError::NoCamera { scene: description.name.clone() })?;

        let place_all = |objects: &[Object]| -> Result<Vec<Placed>, SceneError> {
            objects.iter().map(|o| place(o).map_err(|problem| object_error(o, problem))).collect()
        };
        let placed = place_all(&description.objects)?;
        let middle = middle_of_world(description, &placed);
        let round_all = |objects: &[Object], placed: Vec<Placed>, middle| -> Result<Vec<Shape>, SceneError> {
            objects
                .iter()
                .zip(placed)
                .map(|(o, p)| {
                    let bounds = p.bounds();
                    let shape = p.round(middle).and_then(|shape| place::check_reach(bounds, middle).map(|()| shape));
                    shape.map_err(|problem| object_error(o, problem))
                })
                .collect()
        };
        let shapes = round_all(&description.objects, placed, middle)?;
        let mut groups = Vec::with_capacity(description.groups.len());
        let mut group_bounds = Vec::with_capacity(description.groups.len());
        for group in &description.groups {
            let placed = place_all(&group.objects)?;
            group_bounds.push(place::union(placed.iter().map(Placed::bounds)));
            groups.push(round_all(&group.objects, placed, DVec3::ZERO)?);
        }
        let mut instances = Vec::with_capacity(description.instances.len());
        for (index, i) in description.instances.iter().enumerate() {
            let to_world = to_f32(&DAffine3 { translation: i.to_world.translation - middle, ..i.to_world });
            // Rounding may have made it singular or infinite.
            let rounded = to_world.as_daffine3();
            place::check_transform(&rounded)
                .and_then(|()| place::check_reach(place::transformed(&i.to_world, group_bounds[i.group]), middle))
                .map_err(|problem| SceneError::Item { kind: Kind::Instance, name: index.to_string(), problem })?;
            instances.push(Instance { group: i.group as u32, to_world });
        }

        let census = Census::of(description);
        let (infos, area) = emitters(description, &shapes);
        let camera = Camera::new(camera, middle)?;
        // The tables of rough coats take as long as a hierarchy of some ten thousand triangles.
        let (geometry, materials) = parallel::join(
            || Geometry::build(shapes, groups, instances),
            || description.materials.iter().map(PlacedMaterial::new).collect(),
        );
        let world = bounding_sphere(&geometry);
        let delta = description.lights.iter().map(|l| recentre(l.kind.clone(), middle)).collect();
        let lights = Lights::build(area, delta, description.environment.clone(), world, choice).on_surfaces(&geometry);
        let objects = description.objects.iter().chain(description.groups.iter().flat_map(|g| &g.objects));
        Ok(Scene {
            name: description.name.clone(),
            has: census.features(),
            census,
            middle,
            camera,
            geometry,
            lights,
            shapes: infos,
            materials,
            images: Images::of(description),
            object_names: objects.map(|o| o.name.clone()).collect(),
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What effects it has.
    pub fn census(&self) -> &Census {
        &self.census
    }

    /// Bits of [`crate::has`]: what hot loops must be able to handle.
    pub fn has(&self) -> u32 {
        self.has
    }

    /// The point of the described world that is the origin here; a position here plus this is one there.
    pub fn middle(&self) -> DVec3 {
        self.middle
    }

    /// The camera.
    #[inline]
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The lights.
    #[inline]
    pub fn lights(&self) -> &Lights {
        &self.lights
    }

    /// Shapes and hierarchy.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Name of the object that a [`Surface::shape`] index stands for: its stable identity from frame to frame.
    pub fn object_name(&self, shape: u32) -> &str {
        &self.object_names[shape as usize]
    }

    /// Bytes of geometry, hierarchy, lights, materials and of every image, each once.
    pub fn memory_bytes(&self) -> u64 {
        let tables = size_of_val(&*self.shapes) + size_of_val(&*self.materials);
        self.geometry.memory_bytes() as u64 + self.lights.table_bytes() + tables as u64 + self.images.bytes
    }

    /// The nearest hit along a ray.
    #[inline]
    pub fn closest<const HAS: u32>(&self, ray: &Ray) -> Option<Hit> {
        self.geometry.closest::<HAS>(ray)
    }

    /// Whether anything is hit along a ray.
    #[inline]
    pub fn occluded<const HAS: u32>(&self, ray: &Ray) -> bool {
        self.geometry.occluded::<HAS>(ray)
    }

    /// The geometry at a hit.
    #[inline]
    pub fn surface<const HAS: u32>(&self, ray: &Ray, hit: &Hit) -> Surface {
        self.geometry.surface::<HAS>(ray, hit)
    }

    /// How the surface scatters.
    #[inline]
    pub fn bsdf<const HAS: u32>(&self, surface: &Surface) -> Bsdf {
        let material = &self.materials[self.shapes[surface.shape as usize].material as usize];
        if HAS & has::TEXTURES != 0
            && let Some(textured) = &material.textured
        {
            let point = TexturePoint { uv: surface.uv, color: surface.color };
            return textured.bsdf(&point, material.constant.two_sided);
        }
        // A Lambert surface has little to copy; a copy of the whole is several times as long.
        match material.constant {
            Bsdf { first: Lobe::Lambert { reflectance }, second: None, two_sided } => {
                Bsdf::lambert(reflectance, two_sided)
            }
            // Without LOBES there is no other material; saying so spares the branch.
            _ if HAS & has::LOBES == 0 => Bsdf::lambert(Rgb::BLACK, true),
            other => other,
        }
    }

    /// The relief at a point of a surface that scatters by `bsdf`.
    #[inline]
    pub fn tilt<const HAS: u32>(&self, surface: &Surface, bsdf: &Bsdf) -> Option<Tilt> {
        if HAS & has::TEXTURES == 0 {
            return None;
        }
        let relief = self.materials[self.shapes[surface.shape as usize].material as usize].relief.as_ref()?;
        let mirrored = bsdf.has_opaque_back() && !matches!(relief, Relief::Sheet(_));
        Tilt::new(surface.ns, relief.normal(surface)?, mirrored)
    }

    /// What absorbs on the side of a surface that the direction `w` is on; nothing outside.
    #[inline]
    pub fn medium_behind(&self, surface: &Surface, w: Vec3) -> Rgb {
        match self.shapes[surface.shape as usize].absorption {
            Some(absorption) if w.dot(surface.ng) < 0.0 => absorption,
            _ => Rgb::BLACK,
        }
    }

    /// What a ray is in that leaves a surface in the direction `wi`, and came from the direction `wo` through `medium`: the
    /// share of light that is absorbed a metre.
    ///
    /// A surface that bounds an absorbing inside has nothing that absorbs outside; any other changes nothing.
    #[inline]
    pub fn medium_towards<const HAS: u32>(&self, surface: &Surface, wo: Vec3, wi: Vec3, medium: Rgb) -> Rgb {
        if HAS & has::MEDIA == 0 || (wo.dot(surface.ng) < 0.0) == (wi.dot(surface.ng) < 0.0) {
            return medium;
        }
        match self.shapes[surface.shape as usize].absorption {
            Some(_) => self.medium_behind(surface, wi),
            None => medium,
        }
    }

    /// The light element that the surface is part of, if it emits.
    #[inline]
    pub fn element(&self, surface: &Surface) -> Option<u32> {
        let first = self.shapes[surface.shape as usize].first_element;
        (first != NO_LIGHT).then(|| first + surface.element)
    }
}

fn to_f32(t: &DAffine3) -> Affine3A {
    Affine3A::from_mat3_translation(t.matrix3.as_mat3(), t.translation.as_vec3())
}

/// The middle of everything, the camera included.
fn middle_of_world(description: &SceneDescription, placed: &[Placed]) -> DVec3 {
    let camera = description.camera.iter().map(|c| (c.to_world.translation, c.to_world.translation));
    let instances = description.instances.iter().map(|i| (i.to_world.translation, i.to_world.translation));
    let (lo, hi) = place::union(placed.iter().map(Placed::bounds).chain(camera).chain(instances));
    // An empty mesh has infinite bounds; halves are added so that nothing overflows.
    let middle = lo * 0.5 + hi * 0.5;
    if middle.is_finite() { middle } else { DVec3::ZERO }
}

fn bounding_sphere(geometry: &Geometry) -> BoundingSphere {
    match geometry.bounds() {
        Some((lo, hi)) => BoundingSphere { center: (lo + hi) * 0.5, radius: ((hi - lo) * 0.5).length() },
        None => BoundingSphere { center: Vec3::ZERO, radius: 0.0 },
    }
}

fn recentre(light: DeltaLight, middle: DVec3) -> DeltaLight {
    match light {
        DeltaLight::Point { position, intensity } => DeltaLight::Point { position: position - middle, intensity },
        DeltaLight::Spot { position, direction, intensity, beam, cutoff, image } => {
            DeltaLight::Spot { position: position - middle, direction, intensity, beam, cutoff, image }
        }
        DeltaLight::Projector { to_world, fov_x, aspect, irradiance } => {
            let to_world = DAffine3 { translation: to_world.translation - middle, ..to_world };
            DeltaLight::Projector { to_world, fov_x, aspect, irradiance }
        }
        directional @ DeltaLight::Directional { .. } => directional,
    }
}

/// What is known of each shape when it is hit, and the light elements in the order that `first_element` counts.
fn emitters(description: &SceneDescription, shapes: &[Shape]) -> (Vec<ShapeInfo>, Vec<AreaLight>) {
    let mut area = Vec::new();
    let mut infos = Vec::with_capacity(shapes.len());
    let mut first_primitive = 0;
    for (object, shape) in description.objects.iter().zip(shapes) {
        let first_element = match &object.emission {
            None | Some(Texture::Constant(Rgb::BLACK)) => NO_LIGHT,
            Some(texture) => {
                let first = area.len() as u32;
                push_emitters(texture, shape, first_primitive, &mut area);
                first
            }
        };
        infos.push(ShapeInfo { material: object.material as u32, first_element, absorption: object.absorption });
        first_primitive += shape.primitive_count();
    }
    let grouped = description.groups.iter().flat_map(|g| &g.objects);
    infos.extend(grouped.map(|o| ShapeInfo {
        material: o.material as u32,
        first_element: NO_LIGHT,
        absorption: o.absorption,
    }));
    (infos, area)
}

/// The elements of an emissive shape, counted from a first primitive on.
fn push_emitters(texture: &Texture<Rgb>, shape: &Shape, first_primitive: u32, area: &mut Vec<AreaLight>) {
    let shared = Arc::new(texture.clone());
    let emission = |coordinates| match texture {
        Texture::Constant(radiance) => Emission::Constant(*radiance),
        _ => Emission::Textured { texture: shared.clone(), coordinates },
    };
    let curved = |shape, axes: &Axes| AreaLight {
        shape,
        emission: emission(Coordinates::Curved(*axes)),
        primitive: first_primitive,
    };
    match shape {
        Shape::Mesh(mesh) => area.extend((first_primitive..).zip(&mesh.triangles).map(|(primitive, t)| {
            let vertices = t.map(|v| v as usize);
            AreaLight {
                shape: AreaShape::Triangle(vertices.map(|v| mesh.positions[v])),
                emission: emission(Coordinates::Vertices {
                    uvs: if mesh.uvs.is_empty() {
                        [Vec2::ZERO, Vec2::X, Vec2::Y]
                    } else {
                        vertices.map(|v| mesh.uvs[v])
                    },
                    colors: vertices.map(|v| mesh.colors.get(v).copied().unwrap_or(Rgb::WHITE)),
                }),
                primitive,
            }
        })),
        Shape::Sphere(sphere, axes) => area.push(curved(AreaShape::Sphere(*sphere), axes)),
        Shape::Disk(disk, axes) => area.push(curved(AreaShape::Disk(*disk), axes)),
        Shape::Cylinder(cylinder, axes) => area.push(curved(AreaShape::Cylinder(*cylinder), axes)),
    }
}
