//! The analytic disk.

use super::{
    Disk,
    offset::gamma,
    surface::{Local, tangent},
};
use crate::{ray::Ray, rgb::Rgb};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::TAU;

impl Disk {
    /// Where the ray meets the disk's plane, in double precision.
    #[inline]
    fn plane(&self, ray: &Ray) -> f64 {
        let n = self.normal.as_dvec3();
        n.dot(self.center.as_dvec3() - ray.origin.as_dvec3()) / n.dot(ray.direction.as_dvec3())
    }

    /// From the centre to the point at parameter `t`.
    #[inline]
    fn arm(&self, ray: &Ray, t: f64) -> DVec3 {
        ray.origin.as_dvec3() + ray.direction.as_dvec3() * t - self.center.as_dvec3()
    }

    /// The parameter in (0, t_max), exclusive; a ray within the plane meets nothing.
    #[inline]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<f64> {
        let t = self.plane(ray);
        let r = f64::from(self.radius);
        // NaN and infinity fail the comparisons.
        (t > 0.0 && t < f64::from(ray.t_max) && self.arm(ray, t).length_squared() <= r * r).then_some(t)
    }

    /// Bounds that no rounding escapes.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        let n = self.normal.as_dvec3().normalize_or(DVec3::Y);
        let extent = (DVec3::ONE - n * n).max(DVec3::ZERO).map(f64::sqrt) * f64::from(self.radius);
        let pad = (self.center.abs() + self.radius) * gamma(4);
        let extent = extent.as_vec3() + pad;
        (self.center - extent, self.center + extent)
    }

    /// What is known at the parameter `t` that [`Disk::intersect`] found.
    pub(super) fn surface(&self, ray: &Ray, t: f32) -> Local {
        let plane = self.plane(ray);
        let arm = self.arm(ray, if plane.is_finite() { plane } else { f64::from(t) });
        let n = self.normal.as_dvec3().normalize_or(DVec3::Y);
        // Projected onto the plane: what is left is the rounding to single precision.
        let arm = arm - n * arm.dot(n);
        let p = (self.center.as_dvec3() + arm).as_vec3();
        let ng = n.as_vec3();
        let s = tangent(ng);
        let (x, y) = (arm.dot(s.as_dvec3()) as f32, arm.dot(ng.cross(s).as_dvec3()) as f32);
        let u = y.atan2(x) / TAU;
        let around = ng.cross(arm.as_vec3()) * TAU;
        Local {
            p,
            p_error: p.abs() * gamma(2),
            ng,
            ns: ng,
            dpdu: if around.length_squared() > 0.0 { around } else { s },
            uv: Vec2::new(if u < 0.0 { u + 1.0 } else { u }, (arm.length() as f32 / self.radius).min(1.0)),
            color: Rgb::WHITE,
        }
    }
}
