//! Shapes, the hierarchy over them, and what is known at a hit.

mod bvh;
mod cylinder;
mod disk;
mod dispatch;
mod instance;
pub mod offset;
mod space;
mod sphere;
mod surface;
mod triangle;
mod world;

pub use world::Geometry;

use crate::{digest::Digest, frame::Frame, ray::PrimitiveId, rgb::Rgb};
use glam::{Affine3A, Vec2, Vec3};
use std::fmt;

/// An indexed triangle mesh in world space (or in the space of its group).
///
/// Its `Debug` form has digests of its lists, as they are long.
#[derive(Clone, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// One shading normal a vertex, of any length but zero; empty: the faces are flat.
    pub normals: Vec<Vec3>,
    /// One texture coordinate a vertex; empty: barycentrics serve instead.
    pub uvs: Vec<Vec2>,
    /// One colour a vertex, for [`crate::texture::Texture::VertexColor`]; empty: white.
    pub colors: Vec<Rgb>,
    /// Vertex indices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl fmt::Debug for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digest = |numbers: &mut dyn Iterator<Item = u32>| numbers.collect::<Digest>();
        let vectors = |v: &[Vec3]| digest(&mut v.iter().flat_map(|v| v.to_array().map(f32::to_bits)));
        f.debug_struct("Mesh")
            .field("positions", &vectors(&self.positions))
            .field("normals", &vectors(&self.normals))
            .field("uvs", &digest(&mut self.uvs.iter().flat_map(|v| v.to_array().map(f32::to_bits))))
            .field("colors", &digest(&mut self.colors.iter().flat_map(|c| c.to_array().map(f32::to_bits))))
            .field("triangles", &digest(&mut self.triangles.iter().flatten().copied()))
            .finish()
    }
}

/// A sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, positive.
    pub radius: f32,
    /// Whether the normal points inwards.
    pub inverted: bool,
}

/// A flat disk.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    /// Centre.
    pub center: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Radius, positive.
    pub radius: f32,
}

/// The side of a cylinder, without its ends.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    /// Middle of the one end.
    pub from: Vec3,
    /// From there to the middle of the other end, not zero.
    pub axis: Vec3,
    /// Radius, positive.
    pub radius: f32,
    /// Whether the normal points inwards.
    pub inverted: bool,
}

/// The axes that the texture coordinates of a curved shape follow: orthonormal, of either handedness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Where the angle is zero.
    pub x: Vec3,
    /// Where it is a quarter turn.
    pub y: Vec3,
    /// A sphere's pole, a disk's normal, a cylinder's axis.
    pub z: Vec3,
}

impl Axes {
    /// Some axes about a unit vector.
    pub fn about(z: Vec3) -> Axes {
        let Frame { tangent, bitangent, normal } = Frame::from_normal(z);
        Axes { x: tangent, y: bitangent, z: normal }
    }

    /// Coordinates along the axes.
    #[inline]
    fn local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }
}

/// A shape placed in the world (or in the space of its group).
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles.
    Mesh(Mesh),
    /// An analytic sphere. `u` is the angle about the pole over 2 pi, `v` the angle from the pole over pi.
    Sphere(Sphere, Axes),
    /// An analytic disk. `u` is the distance from the centre over the radius, `v` the angle over 2 pi.
    Disk(Disk, Axes),
    /// An analytic cylinder. `u` is the angle over 2 pi, `v` grows from 0 to 1 along the axis.
    Cylinder(Cylinder, Axes),
}

impl Shape {
    /// Number of primitives: those of several shapes are counted one after another.
    pub fn primitive_count(&self) -> u32 {
        match self {
            Shape::Mesh(mesh) => mesh.triangles.len() as u32,
            Shape::Sphere(..) | Shape::Disk(..) | Shape::Cylinder(..) => 1,
        }
    }
}

impl From<Mesh> for Shape {
    fn from(mesh: Mesh) -> Shape {
        Shape::Mesh(mesh)
    }
}

/// With the pole at +z.
impl From<Sphere> for Shape {
    fn from(sphere: Sphere) -> Shape {
        Shape::Sphere(sphere, Axes { x: Vec3::X, y: Vec3::Y, z: Vec3::Z })
    }
}

/// With the angle zero wherever it falls.
impl From<Disk> for Shape {
    fn from(disk: Disk) -> Shape {
        Shape::Disk(disk, Axes::about(disk.normal))
    }
}

/// With the angle zero wherever it falls.
impl From<Cylinder> for Shape {
    fn from(cylinder: Cylinder) -> Shape {
        Shape::Cylinder(cylinder, Axes::about(cylinder.axis.normalize()))
    }
}

/// A group of shapes placed once more by a transform.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index of the group.
    pub group: u32,
    /// From the group's space to the world.
    pub to_world: Affine3A,
}

/// No instance: the hit is on a shape of the top level.
pub const NO_INSTANCE: u32 = u32::MAX;

/// What traversal finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter.
    pub t: f32,
    /// First barycentric coordinate (weight of vertex 1); of a sphere or cylinder 0 where the ray enters it, 1 where it
    /// leaves.
    pub u: f32,
    /// Second barycentric coordinate (weight of vertex 2); 0 for curved shapes.
    pub v: f32,
    /// Primitive, counted over all shapes of the top level or of the instance's group.
    pub primitive: u32,
    /// Index of the instance, or [`NO_INSTANCE`].
    pub instance: u32,
}

/// The geometry at a hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The point.
    pub p: Vec3,
    /// Bound of the absolute error of `p`, componentwise.
    pub p_error: Vec3,
    /// Unit geometric normal, on the side that the winding (or the shape) calls outside; never turned to the ray.
    pub ng: Vec3,
    /// Unit shading normal, in the hemisphere of `ng`.
    pub ns: Vec3,
    /// Derivative of the point by the first texture coordinate, or some tangent where it is not defined: not zero, what
    /// anisotropy is aligned to. Zero where the scene has Lambert reflection alone.
    pub dpdu: Vec3,
    /// Derivative of the point by the second texture coordinate; zero where the scene has no textures.
    pub dpdv: Vec3,
    /// Texture coordinates; zero where the scene has no textures.
    pub uv: Vec2,
    /// Interpolated vertex colour; white where there is none.
    pub color: Rgb,
    /// Index of the shape: those of the top level first, then those of each group in order.
    pub shape: u32,
    /// Index of the primitive within its shape (a mesh's triangle; 0 for others).
    pub element: u32,
    /// The primitive as rays know it.
    pub id: PrimitiveId,
}
