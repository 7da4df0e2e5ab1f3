//! The analytic sphere.

use super::{
    Sphere,
    offset::gamma,
    surface::{Local, tangent},
};
use crate::{has::TEXTURES, ray::Ray, rgb::Rgb};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

impl Sphere {
    /// Both ray parameters, the smaller first, in double precision: with single-precision input nothing cancels.
    fn roots(&self, ray: &Ray) -> Option<[f64; 2]> {
        let d = ray.direction.as_dvec3();
        let f = ray.origin.as_dvec3() - self.center.as_dvec3();
        let r = f64::from(self.radius);
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
    pub(super) fn surface<const HAS: u32>(&self, ray: &Ray, t: f32, side: f32) -> Local {
        // `t` was rounded; the unrounded one gives the normal of a tiny sphere far away.
        let t = self.roots(ray).map_or(f64::from(t), |[t0, t1]| if side == 0.0 { t0 } else { t1 });
        let center = self.center.as_dvec3();
        let at = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t - center;
        let outward = at.try_normalize().unwrap_or(DVec3::Y);
        // Projected onto the sphere: what is left is the rounding to single precision.
        let p = (center + outward * f64::from(self.radius)).as_vec3();
        let n = outward.as_vec3();
        // The parallel of latitude through the point; at the poles any tangent.
        let east = Vec3::new(-n.z, 0.0, n.x) * (TAU * self.radius);
        let ng = if self.inverted { -n } else { n };
        let uv = if HAS & TEXTURES == 0 {
            Vec2::ZERO
        } else {
            let u = n.z.atan2(n.x) / TAU;
            Vec2::new(if u < 0.0 { u + 1.0 } else { u }, n.y.clamp(-1.0, 1.0).acos() / PI)
        };
        Local {
            p,
            p_error: p.abs() * gamma(2),
            ng,
            ns: ng,
            dpdu: if east.length_squared() > 0.0 { east } else { tangent(ng) },
            uv,
            color: Rgb::WHITE,
        }
    }
}
