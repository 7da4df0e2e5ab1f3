//! The scene as importers and code describe it: plain data.

use crate::{
    camera::CameraDescription, geometry::Mesh, lights::environment::Environment, material::Material, rgb::Rgb,
    texture::Texture,
};
use glam::{DAffine3, DVec3};

/// A scene as importers and code describe it. Transforms are `f64`; [`Scene::new`](super::Scene::new) places everything in the world,
/// moves the world's middle to the origin, and only then rounds to `f32`.
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    /// Name, for messages.
    pub name: String,
    /// The camera; a scene without one is refused.
    pub camera: Option<CameraDescription>,
    /// Materials.
    pub materials: Vec<NamedMaterial>,
    /// Shapes.
    pub objects: Vec<Object>,
    /// Groups of shapes that only instances place.
    pub groups: Vec<Group>,
    /// Placements of groups.
    pub instances: Vec<GroupInstance>,
    /// Point, spot and directional lights.
    pub lights: Vec<LightDescription>,
    /// Light from infinity.
    pub environment: Option<Environment>,
}

/// A material with its name.
#[derive(Clone, Debug)]
pub struct NamedMaterial {
    /// Name, for messages.
    pub name: String,
    /// What it is.
    pub material: Material,
    /// Whether its back side scatters as its front side does; no effect on a dielectric.
    pub two_sided: bool,
}

/// A shape with its material and, for a light, what it emits.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name, for messages; also the stable identity from frame to frame.
    pub name: String,
    /// The shape in its own space.
    pub shape: ObjectShape,
    /// From its own space to the world (or to its group's space).
    pub to_world: DAffine3,
    /// Index into [`SceneDescription::materials`].
    pub material: usize,
    /// Radiance emitted from the side that the normal points to.
    pub emission: Option<Texture<Rgb>>,
    /// What is inside absorbs this share of the light a metre (Beer's law), where the surface lets light in at all.
    pub absorption: Option<Rgb>,
}

/// A shape in its own space.
#[derive(Clone, Debug)]
pub enum ObjectShape {
    /// Triangles.
    Mesh(Mesh),
    /// A sphere; its transform may scale uniformly only.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius, positive.
        radius: f64,
        /// Whether the normal points inwards.
        inverted: bool,
    },
    /// The disk of radius 1 about the origin in the plane z = 0, normal +z; its transform may scale x and y alike only.
    Disk,
    /// The side of a cylinder, without its ends; its transform may scale uniformly only.
    Cylinder {
        /// Middle of the one end.
        from: DVec3,
        /// Middle of the other end.
        to: DVec3,
        /// Radius, positive.
        radius: f64,
        /// Whether the normal points inwards.
        inverted: bool,
    },
    /// The square from -1 to 1 in x and y in the plane z = 0, normal +z (two triangles).
    Rectangle,
    /// The cube from -1 to 1 in each coordinate, normals outwards (twelve triangles).
    Cube,
}

/// A named group of shapes.
#[derive(Clone, Debug)]
pub struct Group {
    /// Name, for messages.
    pub name: String,
    /// Its shapes; none may emit.
    pub objects: Vec<Object>,
}

/// A placement of a group.
#[derive(Clone, Debug)]
pub struct GroupInstance {
    /// Index into [`SceneDescription::groups`].
    pub group: usize,
    /// From the group's space to the world.
    pub to_world: DAffine3,
}

/// A light without an extent.
#[derive(Clone, Debug)]
pub struct LightDescription {
    /// Name, for messages.
    pub name: String,
    /// What it is.
    pub kind: DeltaLight,
}

/// The kinds of light without an extent.
#[derive(Clone, Debug)]
pub enum DeltaLight {
    /// The same in every direction.
    Point {
        /// Position.
        position: DVec3,
        /// Radiant intensity, W/sr.
        intensity: Rgb,
    },
    /// A cone: full intensity within `beam`, falling linearly in the angle to zero at `cutoff` (as in Mitsuba).
    Spot {
        /// Position.
        position: DVec3,
        /// Axis, not zero.
        direction: DVec3,
        /// Radiant intensity on the axis, W/sr.
        intensity: Rgb,
        /// Half-angle of full intensity, radians, at most `cutoff`.
        beam: f64,
        /// Half-angle beyond which there is none, radians, in (0, pi].
        cutoff: f64,
        /// Factor on the intensity over the cone, and which way is up in it.
        image: Option<(Texture<Rgb>, DVec3)>,
    },
    /// A slide projector: the radiant intensity is that which makes `irradiance` on a plane at right angles to the axis at
    /// distance 1, the image filling the field of view.
    Projector {
        /// From the projector's space to the world; it projects along +z, with +y up and +x to the left.
        to_world: DAffine3,
        /// Full horizontal field of view, radians, in (0, pi).
        fov_x: f64,
        /// Width of the image over its height, positive.
        aspect: f64,
        /// Irradiance over the image, W/m².
        irradiance: Texture<Rgb>,
    },
    /// Parallel light from infinity.
    Directional {
        /// Direction in which the light travels, not zero.
        direction: DVec3,
        /// Irradiance on a plane that faces the light, W/m².
        irradiance: Rgb,
    },
}
