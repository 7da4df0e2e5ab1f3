//! Lights without an extent that lie on surfaces.
//!
//! Rounding puts such a light on either side of the surface, which would then hide it from all that it lights. Its shadow
//! rays end, and its own rays start, off the surface on the side that they come from or go to, as those of points on
//! surfaces do ([`crate::geometry::offset`]). A light on a surface shines to both sides of it.

use crate::{
    geometry::{
        Geometry,
        offset::{ROUNDOFF, gamma},
    },
    has::ALL,
    lights::BoundingSphere,
    ray::Ray,
};
use glam::Vec3;

/// The surfaces that a light lies on, within rounding: as many as meet in a corner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Touching {
    /// Along each surface's normal, as long as rays have to stay off it; zero where there is no surface.
    offsets: [Vec3; 3],
}

impl Touching {
    /// Finds the surfaces at a position.
    pub fn find(position: Vec3, geometry: &Geometry, world: BoundingSphere) -> Touching {
        let scale = position.abs().max_element().max(world.radius + world.center.abs().max_element());
        // Farther than any rounding of what is met, along some axis at most 3^.5 times as far as along the normal.
        let reach = 256.0 * ROUNDOFF * scale;
        let mut found = Touching::default();
        let mut count = 0;
        for axis in Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
            let ray = Ray::segment(position - axis * reach, axis * (2.0 * reach));
            let Some(hit) = geometry.closest::<ALL>(&ray) else { continue };
            let surface = geometry.surface::<ALL>(&ray, &hit);
            let error = surface.p_error + position.abs() * gamma(2);
            let bound = surface.ng.abs().dot(error);
            let known = |offset: &Vec3| offset.dot(surface.ng).abs() > 0.999 * offset.length();
            if (position - surface.p).dot(surface.ng).abs() > bound || found.offsets[..count].iter().any(known) {
                continue;
            }
            // The directions of shadow rays are rounded, too.
            found.offsets[count] = surface.ng * (2.0 * bound + gamma(8) * scale);
            count += 1;
            if count == found.offsets.len() {
                break;
            }
        }
        found
    }

    /// Returns `true` if the light lies on a surface.
    pub fn any(&self) -> bool {
        self.offsets[0] != Vec3::ZERO
    }

    /// The position moved off the surfaces, to the sides that `towards` is on.
    #[inline]
    pub fn moved(&self, position: Vec3, towards: Vec3) -> Vec3 {
        self.offsets
            .iter()
            .fold(position, |p, offset| if towards.dot(*offset) < 0.0 { p - *offset } else { p + *offset })
    }
}
