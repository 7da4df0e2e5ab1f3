//! Shapes that emit: points on them, and their densities.

use super::textured::Coordinates;
use crate::{
    frame::Frame,
    geometry::{Cylinder, Disk, Sphere, offset::gamma},
    rgb::Rgb,
    texture::Texture,
    warp::{cone_pdf, sample_cone, sample_disk, sample_sphere, sample_triangle},
};
use glam::{Vec2, Vec3};
use std::{f32::consts::TAU, f64::consts::PI, sync::Arc};

/// An emissive shape in the world: it emits from the side its normal points to, into every direction alike.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// The shape.
    pub shape: AreaShape,
    /// Emitted radiance.
    pub emission: Emission,
    /// Which primitive of the geometry's top level it is; `u32::MAX`: none.
    pub primitive: u32,
}

/// Radiance over a shape.
#[derive(Clone, Debug)]
pub enum Emission {
    /// The same from every point.
    Constant(Rgb),
    /// By a texture.
    Textured {
        /// The texture.
        texture: Arc<Texture<Rgb>>,
        /// What it is looked up with.
        coordinates: Coordinates,
    },
}

impl From<Rgb> for Emission {
    fn from(radiance: Rgb) -> Emission {
        Emission::Constant(radiance)
    }
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
    /// The side of a cylinder; an inverted one emits inwards.
    Cylinder(Cylinder),
}

/// A point on a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct AreaPoint {
    pub p: Vec3,
    /// Bound of the error of `p`.
    pub p_error: Vec3,
    /// Unit normal on the side that emits.
    pub normal: Vec3,
    /// The weights of a triangle's vertices; zero on other shapes.
    pub weights: Vec3,
}

/// A point of a shape as it is seen from elsewhere.
pub(super) struct AreaDirection {
    pub point: AreaPoint,
    /// Unit direction to it.
    pub wi: Vec3,
    /// Density per steradian.
    pub pdf_w: f32,
}

/// An area light with what every sample of it needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emitter {
    pub shape: AreaShape,
    /// Emitted radiance; where it varies, what the choice of lights goes by.
    pub radiance: Rgb,
    /// Area in square metres.
    pub area: f32,
    /// Unit normal of a triangle.
    normal: Vec3,
    /// Which primitive of the geometry's top level it is; `u32::MAX`: none.
    pub primitive: u32,
    /// Index of the [`super::textured::Textured`] that it emits by, or [`PLAIN`].
    pub texture: u32,
}

/// The radiance does not vary.
pub(super) const PLAIN: u32 = u32::MAX;

impl Emitter {
    /// An emitter of the same radiance everywhere.
    pub fn new(shape: AreaShape, radiance: Rgb, primitive: u32) -> Emitter {
        let (area, normal) = match shape {
            AreaShape::Triangle([p0, p1, p2]) => {
                let n = (p1.as_dvec3() - p0.as_dvec3()).cross(p2.as_dvec3() - p0.as_dvec3());
                (0.5 * n.length(), n.normalize_or_zero().as_vec3())
            }
            AreaShape::Sphere(s) => (4.0 * f64::from(s.radius).powi(2) * PI, Vec3::ZERO),
            AreaShape::Disk(d) => (f64::from(d.radius).powi(2) * PI, d.normal),
            AreaShape::Cylinder(c) => (c.axis.as_dvec3().length() * f64::from(c.radius) * 2.0 * PI, Vec3::ZERO),
        };
        Emitter { shape, radiance, area: area as f32, normal, primitive, texture: PLAIN }
    }

    /// Flux in watts, by luminance.
    pub fn flux(&self) -> f64 {
        PI * f64::from(self.area) * f64::from(self.radiance.luminance())
    }

    /// A point with uniform density over the area.
    #[inline]
    pub fn sample_point(&self, u: Vec2) -> AreaPoint {
        match &self.shape {
            AreaShape::Triangle([p0, p1, p2]) => {
                let b = sample_triangle(u);
                AreaPoint {
                    p: b.x * *p0 + b.y * *p1 + b.z * *p2,
                    p_error: gamma(6) * (b.x * p0.abs() + b.y * p1.abs() + b.z * p2.abs()),
                    normal: self.normal,
                    weights: b,
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
                    weights: Vec3::ZERO,
                }
            }
            AreaShape::Cylinder(c) => {
                let frame = Frame::from_normal(c.axis.normalize());
                let (sin, cos) = (TAU * u.x).sin_cos();
                let outwards = frame.tangent * cos + frame.bitangent * sin;
                let (along, arm) = (c.axis * u.y, outwards * c.radius);
                AreaPoint {
                    p: c.from + along + arm,
                    p_error: gamma(6) * (c.from.abs() + along.abs() + arm.abs()),
                    normal: if c.inverted { -outwards } else { outwards },
                    weights: Vec3::ZERO,
                }
            }
        }
    }

    /// A direction from `from` to a point of the side that emits; `None` where there is none, or none with a finite
    /// density.
    #[inline]
    pub fn sample_direction(&self, from: Vec3, u: Vec2) -> Option<AreaDirection> {
        if let AreaShape::Sphere(s) = &self.shape
            && let Some(cone) = Cone::new(s, from)
        {
            return if s.inverted { None } else { cone.sample(s, u) };
        }
        let point = self.sample_point(u);
        let to = point.p - from;
        let d2 = to.length_squared();
        let wi = to * (1.0 / d2.sqrt());
        // Where a square is no normal number, the density is none either, and the direction is not one.
        let pdf_w = self.area_pdf(d2, -point.normal.dot(wi));
        (pdf_w > 0.0 && d2.is_normal()).then_some(AreaDirection { point, wi, pdf_w })
    }

    /// Density per steradian at which [`AreaShape::sample_direction`] finds the direction `wi` from `from`, which hits
    /// the shape at `p` where its normal is `normal`; 0 where it is not sampled.
    #[inline]
    pub fn direction_pdf(&self, from: Vec3, p: Vec3, normal: Vec3, wi: Vec3) -> f32 {
        if let AreaShape::Sphere(s) = &self.shape {
            match Cone::new(s, from) {
                Some(cone) => return if s.inverted { 0.0 } else { cone.pdf() },
                None if !s.inverted => return 0.0,
                None => (),
            }
        }
        self.area_pdf(p.distance_squared(from), -normal.dot(wi))
    }

    /// The uniform density over the area as one per steradian, at a squared distance and a cosine at the light.
    #[inline]
    fn area_pdf(&self, d2: f32, cos: f32) -> f32 {
        let pdf = d2 / (cos * self.area);
        if cos > 0.0 && pdf.is_finite() { pdf } else { 0.0 }
    }
}

/// The point of a sphere at a unit vector from its centre.
#[inline]
fn sphere_point(s: &Sphere, outwards: Vec3) -> AreaPoint {
    AreaPoint {
        p: s.center + s.radius * outwards,
        p_error: gamma(5) * (s.center.abs() + s.radius * outwards.abs()),
        normal: if s.inverted { -outwards } else { outwards },
        weights: Vec3::ZERO,
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
        let pdf = cone_pdf(self.one_minus_cos_max());
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    #[inline]
    fn sample(&self, s: &Sphere, u: Vec2) -> Option<AreaDirection> {
        let pdf_w = self.pdf();
        if pdf_w == 0.0 {
            return None;
        }
        let frame = Frame::from_normal(self.axis);
        let local = sample_cone(u, self.one_minus_cos_max());
        // The point lies at an angle alpha about the centre, and sin(alpha + theta) = sin(theta) / sin(theta_max).
        let (sin_max, cos) = (self.sin2_max.sqrt(), local.z);
        let sin = local.truncate().length();
        let sin_sum = (sin / sin_max).min(1.0);
        let cos_sum = (1.0 - sin_sum * sin_sum).sqrt();
        // Of sin(alpha) the factor sin(theta) is left in the local x and y.
        let across = local.truncate() * (cos / sin_max - cos_sum);
        let outwards = frame.to_world(across.extend(-(cos_sum * cos + sin_sum * sin)));
        let point = sphere_point(s, outwards.normalize());
        let wi = frame.to_world(local);
        Some(AreaDirection { point, wi, pdf_w })
    }
}
