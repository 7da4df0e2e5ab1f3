//! The analytic disk.

use super::{
    Axes, Disk,
    offset::gamma,
    surface::{Local, tangents, turn},
};
use crate::{
    has::{LOBES, TEXTURES},
    ray::Ray,
    rgb::Rgb,
};
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
    pub(super) fn surface<const HAS: u32>(&self, axes: &Axes, ray: &Ray, t: f32) -> Local {
        let plane = self.plane(ray);
        let arm = self.arm(ray, if plane.is_finite() { plane } else { f64::from(t) });
        let n = self.normal.as_dvec3().normalize_or(DVec3::Y);
        // Projected onto the plane: what is left is the rounding to single precision.
        let arm = arm - n * arm.dot(n);
        let p = (self.center.as_dvec3() + arm).as_vec3();
        let p_error = p.abs() * gamma(2);
        let ng = n.as_vec3();
        if HAS & (TEXTURES | LOBES) == 0 {
            return Local::bare(p, p_error, ng, ng);
        }
        let arm = arm.as_vec3();
        let q = axes.local(arm);
        // Outwards and around; in the middle there is neither.
        let (dpdu, dpdv) = tangents(ng, arm * (self.radius / arm.length()), (axes.y * q.x - axes.x * q.y) * TAU);
        Local { p, p_error, ng, ns: ng, dpdu, dpdv, uv: self.uv(axes, arm), color: Rgb::WHITE }
    }

    /// Texture coordinates at a point of the disk, as seen from its centre.
    #[inline]
    pub(crate) fn uv(&self, axes: &Axes, arm: Vec3) -> Vec2 {
        let q = axes.local(arm);
        Vec2::new(((q.x * q.x + q.y * q.y).sqrt() / self.radius).min(1.0), turn(q.x, q.y))
    }
}
