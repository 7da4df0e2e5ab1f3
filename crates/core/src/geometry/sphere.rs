//! The analytic sphere.

use super::{
    Axes, Sphere,
    offset::gamma,
    surface::{Local, tangents, turn},
};
use crate::{
    has::{LOBES, TEXTURES},
    ray::Ray,
    rgb::Rgb,
};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// The parameters at which `f + t d` is `r` from the origin, the smaller first.
#[inline]
pub(super) fn round_roots(f: DVec3, d: DVec3, r: f64) -> Option<[f64; 2]> {
    let a = d.length_squared();
    let b = -f.dot(d);
    // The discriminant from the distance between line and centre: stable for far, tiny and huge spheres alike.
    // [Haines et al. 2019, Ray Tracing Gems ch. 7, eq. 5]
    let perpendicular = f + d * (b / a);
    let discriminant = r * r - perpendicular.length_squared();
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let root = (a * discriminant).sqrt();
    // The root that adds equal signs first, the other from the product of the two. [ibid., eq. 10 and 11]
    let q = if b < 0.0 { b - root } else { b + root };
    let distance = f.length();
    let c = (distance - r) * (distance + r);
    // q = 0: tangent ray whose closest point is its origin; the double root lies there.
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
    Some(if t0 < t1 { [t0, t1] } else { [t1, t0] })
}

impl Sphere {
    /// Both ray parameters, the smaller first, in double precision: with single-precision input nothing cancels.
    #[inline]
    fn roots(&self, ray: &Ray) -> Option<[f64; 2]> {
        round_roots(ray.origin.as_dvec3() - self.center.as_dvec3(), ray.direction.as_dvec3(), f64::from(self.radius))
    }

    /// The smallest parameter in (0, t_max), exclusive; and 0 if the ray enters there, 1 if it leaves.
    ///
    /// The latter because the two may round to the same single-precision number.
    #[inline]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<(f64, f32)> {
        let t_max = f64::from(ray.t_max);
        let [t0, t1] = self.roots(ray)?;
        let within = |t: f64| t > 0.0 && t < t_max;
        if within(t0) { Some((t0, 0.0)) } else { within(t1).then_some((t1, 1.0)) }
    }

    /// Bounds that no rounding escapes.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        let pad = (self.center.abs() + self.radius) * gamma(4);
        let extent = Vec3::splat(self.radius) + pad;
        (self.center - extent, self.center + extent)
    }

    /// What is known where the ray enters (`side` 0) or leaves (1), near the parameter `t` that was found.
    pub(super) fn surface<const HAS: u32>(&self, axes: &Axes, ray: &Ray, t: f32, side: f32) -> Local {
        // `t` was rounded; the unrounded one gives the normal of a tiny sphere far away.
        let t = self.roots(ray).map_or(f64::from(t), |[t0, t1]| if side == 0.0 { t0 } else { t1 });
        let center = self.center.as_dvec3();
        let at = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t - center;
        let outward = at.try_normalize().unwrap_or(DVec3::Y);
        // Projected onto the sphere: what is left is the rounding to single precision.
        let p = (center + outward * f64::from(self.radius)).as_vec3();
        let n = outward.as_vec3();
        let ng = if self.inverted { -n } else { n };
        let p_error = p.abs() * gamma(2);
        if HAS & (TEXTURES | LOBES) == 0 {
            return Local::bare(p, p_error, ng, ng);
        }
        let q = axes.local(n);
        let across = (q.x * q.x + q.y * q.y).sqrt();
        // Along the parallel of latitude and along the meridian; at the poles any tangent.
        let dpdu = (axes.y * q.x - axes.x * q.y) * (TAU * self.radius);
        let dpdv = ((axes.x * q.x + axes.y * q.y) * (q.z / across) - axes.z * across) * (PI * self.radius);
        let (dpdu, dpdv) = tangents(ng, dpdu, dpdv);
        Local { p, p_error, ng, ns: ng, dpdu, dpdv, uv: Sphere::uv(axes, n), color: Rgb::WHITE }
    }

    /// Texture coordinates in a unit direction from the centre.
    #[inline]
    pub(crate) fn uv(axes: &Axes, outward: Vec3) -> Vec2 {
        let q = axes.local(outward);
        // As acos(q.z), which loses the neighbourhood of the poles.
        Vec2::new(turn(q.x, q.y), (q.x * q.x + q.y * q.y).sqrt().atan2(q.z) * (1.0 / PI))
    }
}
