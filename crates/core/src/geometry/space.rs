//! The shapes of the top level, or of one group, with the hierarchy over them.

use super::{
    Cylinder, Disk, Hit, Instance, NO_INSTANCE, Shape, Sphere,
    bvh::{Bvh, Child, Kind, Prepared, Reference, traverse::Best},
    dispatch::Kernel,
    instance::Placed,
    surface::Local,
    triangle,
};
use crate::ray::Ray;
use glam::Vec3;

/// A shape that is not made of triangles.
#[derive(Clone, Copy, Debug)]
enum Curved {
    Sphere(Sphere),
    Disk(Disk),
    Cylinder(Cylinder),
}

impl Curved {
    /// The parameter in (0, t_max), and what [`Hit::u`] is to keep.
    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<(f64, f32)> {
        match self {
            Curved::Sphere(sphere) => sphere.intersect(ray),
            Curved::Disk(disk) => disk.intersect(ray).map(|t| (t, 0.0)),
            Curved::Cylinder(cylinder) => cylinder.intersect(ray),
        }
    }
}

/// Shapes and their hierarchy.
#[derive(Debug, Default)]
pub(super) struct Space {
    pub bvh: Bvh,
    pub shapes: Vec<Shape>,
    /// The curved shapes with their primitives.
    curved: Vec<(Curved, u32)>,
    /// First primitive of each shape, and at the end their number.
    first: Vec<u32>,
    /// Shape of each primitive.
    shape: Vec<u32>,
    /// Triangles that are in no hierarchy because they have no area.
    pub dropped: usize,
}

impl Space {
    /// Builds the hierarchy over the shapes and, at the top level, the instances.
    pub fn build(shapes: Vec<Shape>, placed: &[(Placed, Option<(Vec3, Vec3)>)]) -> Space {
        let mut space = Space::default();
        let mut references = Vec::new();
        for (i, shape) in shapes.iter().enumerate() {
            let first = space.shape.len() as u32;
            space.first.push(first);
            match shape {
                Shape::Mesh(mesh) => {
                    for element in 0..mesh.triangles.len() as u32 {
                        let vertices = mesh.vertices(element);
                        if triangle::normal(vertices).is_some() {
                            let (lo, hi) = triangle::bounds(vertices);
                            references.push(Reference { lo, hi, kind: Kind::Triangle, index: first + element });
                        } else {
                            space.dropped += 1;
                        }
                        space.shape.push(i as u32);
                    }
                }
                Shape::Sphere(sphere, _) => {
                    space.push_curved(Curved::Sphere(*sphere), sphere.bounds(), i, &mut references)
                }
                Shape::Disk(disk, _) => space.push_curved(Curved::Disk(*disk), disk.bounds(), i, &mut references),
                Shape::Cylinder(cylinder, _) => {
                    space.push_curved(Curved::Cylinder(*cylinder), cylinder.bounds(), i, &mut references)
                }
            }
        }
        space.first.push(space.shape.len() as u32);
        for (i, (placed, bounds)) in placed.iter().enumerate() {
            if let Some(bounds) = bounds {
                let (lo, hi) = placed.bounds(*bounds);
                references.push(Reference { lo, hi, kind: Kind::Instance, index: i as u32 });
            }
        }
        space.shapes = shapes;
        space.bvh = Bvh::build(references, |primitive| space.triangle(primitive));
        space
    }

    fn push_curved(&mut self, curved: Curved, (lo, hi): (Vec3, Vec3), shape: usize, references: &mut Vec<Reference>) {
        references.push(Reference { lo, hi, kind: Kind::Curved, index: self.curved.len() as u32 });
        self.curved.push((curved, self.shape.len() as u32));
        self.shape.push(shape as u32);
    }

    /// Whether there is a shape that is not made of triangles.
    pub fn has_curved(&self) -> bool {
        !self.curved.is_empty()
    }

    /// Number of primitives.
    pub fn primitive_count(&self) -> usize {
        self.shape.len()
    }

    /// Number of triangles, the dropped ones included.
    pub fn triangle_count(&self) -> usize {
        self.shape.len() - self.curved.len()
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        let shapes: usize = self
            .shapes
            .iter()
            .map(|shape| match shape {
                Shape::Mesh(mesh) => {
                    size_of_val(&mesh.positions[..])
                        + size_of_val(&mesh.normals[..])
                        + size_of_val(&mesh.uvs[..])
                        + size_of_val(&mesh.colors[..])
                        + size_of_val(&mesh.triangles[..])
                }
                Shape::Sphere(..) | Shape::Disk(..) | Shape::Cylinder(..) => 0,
            })
            .sum();
        shapes
            + size_of_val(&self.shapes[..])
            + size_of_val(&self.curved[..])
            + size_of_val(&self.first[..])
            + size_of_val(&self.shape[..])
            + self.bvh.memory_bytes()
    }

    /// Shape of a primitive, and its number within the shape.
    #[inline]
    pub fn locate(&self, primitive: u32) -> (u32, u32) {
        let shape = self.shape[primitive as usize];
        (shape, primitive - self.first[shape as usize])
    }

    /// Vertices of a primitive that is a triangle.
    fn triangle(&self, primitive: u32) -> [Vec3; 3] {
        let (shape, element) = self.locate(primitive);
        match &self.shapes[shape as usize] {
            Shape::Mesh(mesh) => mesh.vertices(element),
            Shape::Sphere(..) | Shape::Disk(..) | Shape::Cylinder(..) => {
                unreachable!("primitive {primitive} is no triangle")
            }
        }
    }

    /// Looks for hits among the shapes of this space; `instance` is the one that it is seen through.
    #[inline(always)]
    pub fn walk<K: Kernel, const ANY: bool, const CURVED: bool>(
        &self,
        ray: &Ray,
        instance: u32,
        best: &mut Best,
    ) -> bool {
        self.bvh.walk::<K, ANY, CURVED>(&Prepared::new(ray, instance), instance, best, |child, best| {
            self.curved(child, ray, instance, best)
        })
    }

    /// As [`Space::walk`], with instances of groups among the shapes.
    #[inline(always)]
    pub fn walk_placed<K: Kernel, const ANY: bool, const CURVED: bool>(
        &self,
        ray: &Ray,
        placed: &[Placed],
        groups: &[Space],
        best: &mut Best,
    ) -> bool {
        self.bvh.walk::<K, ANY, true>(&Prepared::new(ray, NO_INSTANCE), NO_INSTANCE, best, |child, best| {
            if CURVED && !child.is_instance() {
                return self.curved(child, ray, NO_INSTANCE, best);
            }
            let instance = &placed[child.index()];
            let group = &groups[instance.group as usize];
            group.walk::<K, ANY, CURVED>(&instance.ray_to_group(ray), child.index() as u32, best)
        })
    }

    #[inline(always)]
    fn curved(&self, child: Child, ray: &Ray, instance: u32, best: &mut Best) -> bool {
        let (curved, primitive) = &self.curved[child.index()];
        let Some((t, u)) = curved.intersect(ray) else { return false };
        // What rounding moved onto an end goes back inside.
        let t = (t as f32).max(f32::from_bits(1)).min(ray.t_max.next_down());
        best.offer(Hit { t, u, v: 0.0, primitive: *primitive, instance });
        true
    }

    /// What is known at a hit, in this space.
    #[inline]
    pub fn surface<const HAS: u32>(&self, ray: &Ray, hit: &Hit) -> (Local, u32, u32) {
        let (shape, element) = self.locate(hit.primitive);
        let local = match &self.shapes[shape as usize] {
            Shape::Mesh(mesh) => mesh.surface::<HAS>(element, hit.u, hit.v),
            Shape::Sphere(sphere, axes) => sphere.surface::<HAS>(axes, ray, hit.t, hit.u),
            Shape::Disk(disk, axes) => disk.surface::<HAS>(axes, ray, hit.t),
            Shape::Cylinder(cylinder, axes) => cylinder.surface::<HAS>(axes, ray, hit.t, hit.u),
        };
        (local, shape, element)
    }
}

/// Groups' bounds beside the instances that place them.
pub(super) fn place(instances: &[Instance], groups: &[Space]) -> Vec<(Placed, Option<(Vec3, Vec3)>)> {
    instances.iter().map(|i| (Placed::new(i), groups[i.group as usize].bvh.bounds())).collect()
}
