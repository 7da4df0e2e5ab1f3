//! Shapes that emit: points on them, and their densities.

use crate::{
    frame::Frame,
    geometry::{Disk, Sphere},
    rgb::Rgb,
    warp::{sample_disk, sample_sphere, sample_triangle},
};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// An emissive shape in the world: the same radiance from every point of the side its normal points to.
#[derive(Clone, Copy, Debug)]
pub struct AreaLight {
    /// The shape.
    pub shape: AreaShape,
    /// Emitted radiance.
    pub radiance: Rgb,
}

/// A shape that can emit.
#[derive(Clone, Copy, Debug)]
pub enum AreaShape {
    /// A triangle by its vertices, counter-clockwise seen from the side that emits.
    Triangle([Vec3; 3]),
    /// A sphere; an inverted one emits inwards.
    Sphere(Sphere),
    /// A disk.
    Disk(Disk),
}

/// A point on a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct AreaPoint {
    pub p: Vec3,
    /// Bound of the error of `p`.
    pub p_error: Vec3,
    /// Unit normal on the side that emits.
    pub normal: Vec3,
}

/// A point of a shape as it is seen from elsewhere.
pub(super) struct AreaDirection {
    pub point: AreaPoint,
    /// Unit direction to it.
    pub wi: Vec3,
    /// Density per steradian.
    pub pdf_w: f32,
}

/// Bound of the relative error of `n` roundings in a row [Higham 2002, lemma 3.1].
const fn gamma(n: u32) -> f32 {
    let ne = n as f32 * (f32::EPSILON / 2.0);
    ne / (1.0 - ne)
}

impl AreaShape {
    /// Area in square metres.
    #[inline]
    pub fn area(&self) -> f32 {
        match self {
            AreaShape::Triangle(vertices) => 0.5 * length(doubled_area_normal(vertices)),
            AreaShape::Sphere(s) => 4.0 * PI * s.radius * s.radius,
            AreaShape::Disk(d) => PI * d.radius * d.radius,
        }
    }

    /// A point with uniform density over the area.
    #[inline]
    pub(super) fn sample_point(&self, u: Vec2) -> AreaPoint {
        match self {
            AreaShape::Triangle(vertices) => {
                let [p0, p1, p2] = *vertices;
                let n = doubled_area_normal(vertices);
                let b = sample_triangle(u);
                AreaPoint {
                    p: b.x * p0 + b.y * p1 + b.z * p2,
                    p_error: gamma(6) * (b.x * p0.abs() + b.y * p1.abs() + b.z * p2.abs()),
                    normal: n / length(n),
                }
            }
            AreaShape::Sphere(s) => sphere_point(s, sample_sphere(u)),
            AreaShape::Disk(d) => {
                let q = d.radius * sample_disk(u);
                let frame = Frame::from_normal(d.normal);
                let (x, y) = (frame.tangent * q.x, frame.bitangent * q.y);
                AreaPoint {
                    p: d.center + x + y,
                    p_error: gamma(6) * (d.center.abs() + x.abs() + y.abs()),
                    normal: d.normal,
                }
            }
        }
    }

    /// A direction from `from` to a point of the side that emits; `None` where there is none, or none with a finite
    /// density.
    #[inline]
    pub(super) fn sample_direction(&self, from: Vec3, u: Vec2) -> Option<AreaDirection> {
        if let AreaShape::Sphere(s) = self
            && let Some(cone) = Cone::new(s, from)
        {
            return if s.inverted { None } else { cone.sample(s, u) };
        }
        let point = self.sample_point(u);
        let to = point.p - from;
        let wi = to / length(to);
        let pdf_w = self.direction_pdf(from, point.p, point.normal, wi);
        (pdf_w > 0.0).then_some(AreaDirection { point, wi, pdf_w })
    }

    /// Density per steradian at which [`AreaShape::sample_direction`] finds the direction `wi` from `from`, which hits
    /// the shape at `p` where its normal is `normal`; 0 where it is not sampled.
    #[inline]
    pub(super) fn direction_pdf(&self, from: Vec3, p: Vec3, normal: Vec3, wi: Vec3) -> f32 {
        if let AreaShape::Sphere(s) = self {
            match Cone::new(s, from) {
                Some(cone) => return if s.inverted { 0.0 } else { cone.pdf() },
                None if !s.inverted => return 0.0,
                None => (),
            }
        }
        let cos = -normal.dot(wi);
        let pdf = p.as_dvec3().distance_squared(from.as_dvec3()) / (f64::from(cos) * f64::from(self.area()));
        let pdf = pdf as f32;
        if cos > 0.0 && pdf.is_finite() { pdf } else { 0.0 }
    }
}

/// The normal of a triangle, as long as twice its area.
#[inline]
fn doubled_area_normal([p0, p1, p2]: &[Vec3; 3]) -> Vec3 {
    (*p1 - *p0).cross(*p2 - *p0)
}

/// The length, also where its square does not fit an `f32`.
#[inline]
fn length(v: Vec3) -> f32 {
    v.as_dvec3().length() as f32
}

/// The point of a sphere at a unit vector from its centre.
#[inline]
fn sphere_point(s: &Sphere, outwards: Vec3) -> AreaPoint {
    AreaPoint {
        p: s.center + s.radius * outwards,
        p_error: gamma(5) * (s.center.abs() + s.radius * outwards.abs()),
        normal: if s.inverted { -outwards } else { outwards },
    }
}

/// The cone of directions in which a sphere is seen from outside [Pharr et al. 2023, sec. 6.2.4].
struct Cone {
    /// Unit direction to the centre.
    axis: Vec3,
    /// Squared sine of the half-angle, at most 1.
    sin2_max: f32,
}

impl Cone {
    /// The cone, or `None` from inside.
    #[inline]
    fn new(s: &Sphere, from: Vec3) -> Option<Cone> {
        let to = s.center.as_dvec3() - from.as_dvec3();
        let (d2, r2) = (to.length_squared(), f64::from(s.radius) * f64::from(s.radius));
        (d2 > r2).then(|| Cone { axis: (to / d2.sqrt()).as_vec3(), sin2_max: (r2 / d2) as f32 })
    }

    /// One minus the cosine of the half-angle, without cancellation however small it is.
    #[inline]
    fn one_minus_cos_max(&self) -> f32 {
        self.sin2_max / (1.0 + (1.0 - self.sin2_max).sqrt())
    }

    #[inline]
    fn pdf(&self) -> f32 {
        let pdf = 1.0 / (2.0 * PI * self.one_minus_cos_max());
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    #[inline]
    fn sample(&self, s: &Sphere, u: Vec2) -> Option<AreaDirection> {
        let pdf_w = self.pdf();
        if pdf_w == 0.0 {
            return None;
        }
        let one_minus_cos = u.x * self.one_minus_cos_max();
        let cos = 1.0 - one_minus_cos;
        let sin2 = one_minus_cos * (2.0 - one_minus_cos);
        // The point subtends alpha at the centre: sin(alpha + theta) = sin(theta) / sin(theta_max).
        let sin = sin2.sqrt();
        let sin_sum = (sin / self.sin2_max.sqrt()).min(1.0);
        let cos_sum = (1.0 - sin_sum * sin_sum).sqrt();
        let sin_alpha = sin_sum * cos - cos_sum * sin;
        let cos_alpha = cos_sum * cos + sin_sum * sin;
        let (sin_phi, cos_phi) = (2.0 * PI * u.y).sin_cos();
        let frame = Frame::from_normal(self.axis);
        let across = frame.tangent * cos_phi + frame.bitangent * sin_phi;
        let wi = (across * sin + self.axis * cos).normalize();
        let point = sphere_point(s, (across * sin_alpha - self.axis * cos_alpha).normalize());
        Some(AreaDirection { point, wi, pdf_w })
    }
}
