//! The analytic cylinder.

use super::{
    Axes, Cylinder,
    offset::gamma,
    sphere::round_roots,
    surface::{Local, tangents, turn},
};
use crate::{
    has::{LOBES, TEXTURES},
    ray::Ray,
    rgb::Rgb,
};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::TAU;

/// A ray as a cylinder sees it, in double precision: with single-precision input nothing cancels.
struct Seen {
    /// The ray's origin from the middle of the one end, and its direction, at right angles to the axis.
    across: [DVec3; 2],
    /// The same along the axis, over its length.
    along: [f64; 2],
}

impl Seen {
    /// What is left at right angles to the axis at a parameter, and how far along the axis that is, over its length.
    #[inline]
    fn at(&self, t: f64) -> (DVec3, f64) {
        (self.across[0] + self.across[1] * t, self.along[0] + self.along[1] * t)
    }
}

impl Cylinder {
    #[inline]
    fn see(&self, ray: &Ray) -> Seen {
        let (axis, f, d) =
            (self.axis.as_dvec3(), (ray.origin.as_dvec3() - self.from.as_dvec3()), ray.direction.as_dvec3());
        let along = [f, d].map(|v| v.dot(axis) / axis.length_squared());
        Seen { across: [f - axis * along[0], d - axis * along[1]], along }
    }

    #[inline]
    fn roots(&self, seen: &Seen) -> Option<[f64; 2]> {
        round_roots(seen.across[0], seen.across[1], f64::from(self.radius))
    }

    /// The smallest parameter in (0, t_max), exclusive, between the ends; and 0 if the ray enters the infinite cylinder
    /// there, 1 if it leaves it. A ray along the axis meets nothing.
    #[inline]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<(f64, f32)> {
        let t_max = f64::from(ray.t_max);
        let seen = self.see(ray);
        let [t0, t1] = self.roots(&seen)?;
        let within = |t: f64| t > 0.0 && t < t_max && (0.0..=1.0).contains(&seen.at(t).1);
        if within(t0) { Some((t0, 0.0)) } else { within(t1).then_some((t1, 1.0)) }
    }

    /// Bounds that no rounding escapes.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        let direction = self.axis.as_dvec3().normalize_or_zero();
        let extent = (DVec3::ONE - direction * direction).max(DVec3::ZERO).map(f64::sqrt) * f64::from(self.radius);
        let (from, to) = (self.from.as_dvec3(), self.from.as_dvec3() + self.axis.as_dvec3());
        let pad = (self.from.abs() + self.axis.abs() + self.radius) * gamma(4);
        ((from.min(to) - extent).as_vec3() - pad, (from.max(to) + extent).as_vec3() + pad)
    }

    /// What is known where the ray enters (`side` 0) or leaves (1), near the parameter `t` that was found.
    pub(super) fn surface<const HAS: u32>(&self, axes: &Axes, ray: &Ray, t: f32, side: f32) -> Local {
        let seen = self.see(ray);
        // `t` was rounded; the unrounded one gives the normal of a thin cylinder far away.
        let t = self.roots(&seen).map_or(f64::from(t), |[t0, t1]| if side == 0.0 { t0 } else { t1 });
        let (across, v) = seen.at(t);
        let outward = across.try_normalize().unwrap_or(axes.x.as_dvec3());
        // Projected onto the side: what is left is the rounding to single precision.
        let p = self.from.as_dvec3() + self.axis.as_dvec3() * v + outward * f64::from(self.radius);
        let (p, n) = (p.as_vec3(), outward.as_vec3());
        let p_error = p.abs() * gamma(2);
        let ng = if self.inverted { -n } else { n };
        if HAS & (TEXTURES | LOBES) == 0 {
            return Local::bare(p, p_error, ng, ng);
        }
        let q = axes.local(n);
        let around = (axes.y * q.x - axes.x * q.y) * (TAU * self.radius);
        let (dpdu, dpdv) = tangents(ng, around, self.axis);
        let uv = Vec2::new(Cylinder::u(axes, n), v as f32);
        Local { p, p_error, ng, ns: ng, dpdu, dpdv, uv, color: Rgb::WHITE }
    }

    /// The first texture coordinate in a unit direction from the axis.
    #[inline]
    pub(crate) fn u(axes: &Axes, outward: Vec3) -> f32 {
        let q = axes.local(outward);
        turn(q.x, q.y)
    }
}
