//! A group of shapes placed in the world.

use super::{
    Instance,
    offset::{ROUNDOFF, gamma},
    surface::{Local, tangents},
};
use crate::ray::Ray;
use glam::{DMat3, DVec3, Vec3};

/// An affine map in double precision.
#[derive(Clone, Copy, Debug)]
struct Map {
    linear: DMat3,
    translation: DVec3,
}

/// An [`Instance`] with both directions of its transform.
///
/// Points go through it in double precision: what a round trip loses is then the rounding of its two ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// Index of the group.
    pub group: u32,
    to_world: Map,
    to_group: Map,
}

impl Placed {
    pub fn new(instance: &Instance) -> Placed {
        let linear = DMat3::from_cols(
            instance.to_world.matrix3.x_axis.as_dvec3(),
            instance.to_world.matrix3.y_axis.as_dvec3(),
            instance.to_world.matrix3.z_axis.as_dvec3(),
        );
        let translation = instance.to_world.translation.as_dvec3();
        let inverse = linear.inverse();
        Placed {
            group: instance.group,
            to_world: Map { linear, translation },
            to_group: Map { linear: inverse, translation: -(inverse * translation) },
        }
    }

    /// The ray in the group's space; its direction is not normalised, so `t` means the same in both.
    #[inline]
    pub fn ray_to_group(&self, ray: &Ray) -> Ray {
        Ray {
            origin: (self.to_group.linear * ray.origin.as_dvec3() + self.to_group.translation).as_vec3(),
            direction: (self.to_group.linear * ray.direction.as_dvec3()).as_vec3(),
            ..*ray
        }
    }

    /// World bounds of what the group's bounds enclose.
    pub fn bounds(&self, (lo, hi): (Vec3, Vec3)) -> (Vec3, Vec3) {
        let (center, half) = ((lo.as_dvec3() + hi.as_dvec3()) * 0.5, (hi.as_dvec3() - lo.as_dvec3()) * 0.5);
        let center = self.to_world.linear * center + self.to_world.translation;
        let extent = abs(&self.to_world.linear) * half;
        let pad = (center.abs() + extent) * f64::from(gamma(8));
        ((center - extent - pad).as_vec3(), (center + extent + pad).as_vec3())
    }

    /// What is known in the group's space, brought to the world.
    pub fn surface_to_world(&self, local: &Local) -> Local {
        let linear = &self.to_world.linear;
        let magnitude = abs(linear);
        let p = (linear * local.p.as_dvec3() + self.to_world.translation).as_vec3();
        // The error of the point itself, and that of a ray origin near it when it is rounded in the group's space again;
        // then the rounding of the result. [after Pharr et al. 2023, sec. 6.8.7]
        let group_error = local.p_error.as_dvec3() + local.p.abs().as_dvec3() * f64::from(2.0 * ROUNDOFF);
        let p_error = (magnitude * group_error).as_vec3() * (1.0 + gamma(4)) + p.abs() * gamma(2);
        let normals = self.to_group.linear.transpose();
        // A reflection turns the winding over; the side that the group calls outside stays outside.
        let ng = (normals * local.ng.as_dvec3()).normalize_or(local.ng.as_dvec3()).as_vec3();
        let ns = (normals * local.ns.as_dvec3()).try_normalize().map_or(ng, |n| n.as_vec3());
        let ns = if ns.dot(ng) < 0.0 { -ns } else { ns };
        let [dpdu, dpdv] = [local.dpdu, local.dpdv].map(|d| (linear * d.as_dvec3()).as_vec3());
        let (dpdu, dpdv) = tangents(ng, dpdu, dpdv);
        Local { p, p_error, ng, ns, dpdu, dpdv, uv: local.uv, color: local.color }
    }
}

fn abs(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}
