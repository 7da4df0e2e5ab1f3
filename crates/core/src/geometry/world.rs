//! All geometry of a scene, ready for rays.

use super::{
    Hit, Instance, NO_INSTANCE, Shape, Surface,
    bvh::traverse::Best,
    dispatch::{Kernel, Simd},
    instance::Placed,
    space::{Space, place},
};
use crate::{
    has::{CURVED, INSTANCES},
    ray::{PrimitiveId, Ray},
};
use glam::Vec3;

/// All geometry of a scene with the hierarchy over it.
///
/// ```
/// use etendue_core::{geometry::{Geometry, Sphere}, ray::Ray, specialise};
/// use glam::Vec3;
///
/// let ball = Sphere { center: Vec3::ZERO, radius: 1.0, inverted: false };
/// let geometry = Geometry::build(vec![ball.into()], vec![], vec![]);
/// let ray = Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::NEG_Z);
/// let hit = specialise!(geometry.has(), HAS => geometry.closest::<HAS>(&ray)).unwrap();
/// assert_eq!(hit.t, 2.0);
/// assert_eq!(geometry.surface::<0>(&ray, &hit).ng, Vec3::Z);
/// ```
#[derive(Debug)]
pub struct Geometry {
    top: Space,
    groups: Vec<Space>,
    placed: Vec<Placed>,
    /// Index of each group's first shape, counted after those of the top level and of the groups before.
    first_shape: Vec<u32>,
    simd: Simd,
}

impl Geometry {
    /// Builds the hierarchies over the shapes of the top level, and over the groups of shapes that the instances place.
    ///
    /// Everything must be finite, indices within range, radii positive, transforms invertible: [`crate::scene::Scene`]
    /// refuses what is not. Triangles without area are left out of the hierarchy and counted.
    pub fn build(shapes: Vec<Shape>, groups: Vec<Vec<Shape>>, instances: Vec<Instance>) -> Geometry {
        let mut count = shapes.len();
        let mut first_shape = Vec::with_capacity(groups.len());
        for group in &groups {
            first_shape.push(count as u32);
            count += group.len();
        }
        let groups: Vec<Space> = groups.into_iter().map(|shapes| Space::build(shapes, &[])).collect();
        let placed = place(&instances, &groups);
        let top = Space::build(shapes, &placed);
        let placed = placed.into_iter().map(|(placed, _)| placed).collect();
        Geometry { top, groups, placed, first_shape, simd: Simd::detect() }
    }

    /// The nearest hit in (0, `t_max`); of several at the same distance the one with the smallest instance, then the
    /// smallest primitive. `HAS` must include [`Geometry::has`].
    #[inline]
    pub fn closest<const HAS: u32>(&self, ray: &Ray) -> Option<Hit> {
        debug_assert_eq!(self.has() & !HAS, 0, "shapes of a kind that HAS leaves out");
        // The kinds that the walk knows of; other bits would only multiply its copies.
        match HAS & (CURVED | INSTANCES) {
            0 => self.simd.closest::<0>(self, ray),
            CURVED => self.simd.closest::<CURVED>(self, ray),
            INSTANCES => self.simd.closest::<INSTANCES>(self, ray),
            _ => self.simd.closest::<{ CURVED | INSTANCES }>(self, ray),
        }
    }

    /// Whether anything lies in (0, `t_max`). `HAS` must include [`Geometry::has`].
    #[inline]
    pub fn occluded<const HAS: u32>(&self, ray: &Ray) -> bool {
        debug_assert_eq!(self.has() & !HAS, 0, "shapes of a kind that HAS leaves out");
        match HAS & (CURVED | INSTANCES) {
            0 => self.simd.occluded::<0>(self, ray),
            CURVED => self.simd.occluded::<CURVED>(self, ray),
            INSTANCES => self.simd.occluded::<INSTANCES>(self, ray),
            _ => self.simd.occluded::<{ CURVED | INSTANCES }>(self, ray),
        }
    }

    /// Walks the hierarchy; compiled once for each instruction set, into the functions of [`super::dispatch`].
    #[inline(always)]
    pub(super) fn walk<K: Kernel, const HAS: u32, const ANY: bool>(&self, ray: &Ray, best: &mut Best) -> bool {
        match (HAS & CURVED != 0, HAS & INSTANCES != 0) {
            (false, false) => self.top.walk::<K, ANY, false>(ray, NO_INSTANCE, best),
            (true, false) => self.top.walk::<K, ANY, true>(ray, NO_INSTANCE, best),
            (false, true) => self.top.walk_placed::<K, ANY, false>(ray, &self.placed, &self.groups, best),
            (true, true) => self.top.walk_placed::<K, ANY, true>(ray, &self.placed, &self.groups, best),
        }
    }

    /// What is known at a hit that this ray has found; texture coordinates and their direction only where `HAS` asks for them.
    #[inline]
    pub fn surface<const HAS: u32>(&self, ray: &Ray, hit: &Hit) -> Surface {
        let (local, shape, element) = if HAS & INSTANCES == 0 || hit.instance == NO_INSTANCE {
            self.top.surface::<HAS>(ray, hit)
        } else {
            let placed = &self.placed[hit.instance as usize];
            let group = &self.groups[placed.group as usize];
            let (local, shape, element) = group.surface::<HAS>(&placed.ray_to_group(ray), hit);
            (placed.surface_to_world(&local), shape + self.first_shape[placed.group as usize], element)
        };
        Surface {
            p: local.p,
            p_error: local.p_error,
            ng: local.ng,
            ns: local.ns,
            dpdu: local.dpdu,
            dpdv: local.dpdv,
            uv: local.uv,
            color: local.color,
            shape,
            element,
            id: PrimitiveId { primitive: hit.primitive, instance: hit.instance },
        }
    }

    /// Which of [`CURVED`] and [`INSTANCES`] the geometry needs.
    #[inline]
    pub fn has(&self) -> u32 {
        let curved = self.top.has_curved() || self.groups.iter().any(Space::has_curved);
        let instances = !self.placed.is_empty();
        (if curved { CURVED } else { 0 }) | (if instances { INSTANCES } else { 0 })
    }

    /// Bounds of everything that is placed, lower and upper; `None` when there is nothing. They may exceed the shapes by
    /// some units in the last place.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.top.bvh.bounds()
    }

    /// Number of shapes: those of the top level first, then those of each group in order.
    pub fn shape_count(&self) -> usize {
        self.top.shapes.len() + self.groups.iter().map(|g| g.shapes.len()).sum::<usize>()
    }

    /// A shape by the number that [`Surface::shape`] gives; those of groups are in their group's space.
    ///
    /// # Panics
    /// If there is no such shape.
    pub fn shape(&self, index: u32) -> &Shape {
        match self.top.shapes.get(index as usize) {
            Some(shape) => shape,
            None => {
                let group = self.first_shape.partition_point(|&first| first <= index) - 1;
                &self.groups[group].shapes[(index - self.first_shape[group]) as usize]
            }
        }
    }

    /// World-space vertices of a triangle of a mesh of the top level.
    ///
    /// # Panics
    /// If `shape` is no such mesh or has no such triangle.
    pub fn triangle(&self, shape: u32, element: u32) -> [Vec3; 3] {
        match &self.top.shapes[shape as usize] {
            Shape::Mesh(mesh) => mesh.vertices(element),
            Shape::Sphere(..) | Shape::Disk(..) | Shape::Cylinder(..) => panic!("shape {shape} is no mesh"),
        }
    }

    /// Number of triangles stored, those of groups once, the dropped ones included.
    pub fn triangle_count(&self) -> usize {
        self.spaces().map(Space::triangle_count).sum()
    }

    /// Number of triangles, spheres, disks and cylinders stored, those of groups once.
    pub fn primitive_count(&self) -> usize {
        self.spaces().map(Space::primitive_count).sum()
    }

    /// Bytes that shapes and hierarchies hold.
    pub fn memory_bytes(&self) -> usize {
        self.spaces().map(Space::memory_bytes).sum::<usize>() + size_of_val(&self.placed[..])
    }

    /// Triangles without area, which no ray hits.
    pub fn degenerate_dropped(&self) -> usize {
        self.spaces().map(|s| s.dropped).sum()
    }

    /// The instruction set in use.
    #[cfg(test)]
    pub(super) fn simd(&self) -> Simd {
        self.simd
    }

    fn spaces(&self) -> impl Iterator<Item = &Space> {
        std::iter::once(&self.top).chain(&self.groups)
    }
}
