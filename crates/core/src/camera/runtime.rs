//! The camera, ready to render.

use super::{CameraDescription, Crop, Projection};
use crate::{ray::Ray, warp::sample_disk};
use glam::{DMat3, DVec2, DVec3, UVec2, Vec2, Vec3};
use std::f64::consts::PI;
use thiserror::Error;

/// Why a camera is refused.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CameraError {
    /// The film has no pixels.
    #[error("the camera's resolution is {} x {}", .0.x, .0.y)]
    Resolution(UVec2),
    /// The field of view is not between 0 and pi.
    #[error("the camera's horizontal field of view is {0} radians, not between 0 and pi")]
    FieldOfView(f64),
    /// The offset of the film's middle from the axis is not finite.
    #[error("the camera's film lies ({}, {}) sizes off its axis, which is not finite in single precision", .0.x, .0.y)]
    Offset(DVec2),
    /// The crop is empty or does not lie within the film.
    #[error("the camera's crop of {} x {} pixels from ({}, {}) is not a part of its film of {} x {}", .crop.size.x, .crop.size.y, .crop.offset.x, .crop.offset.y, .film.x, .film.y)]
    Crop {
        /// The crop.
        crop: Crop,
        /// Pixels of the film.
        film: UVec2,
    },
    /// A length is not positive and finite.
    #[error("the camera's {name} is {value}, not positive")]
    Length {
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The transform is not finite, or flattens space, or skews it.
    #[error("the camera's transform is {0}")]
    Transform(&'static str),
}

/// A camera in the rendered world.
///
/// Film positions are in pixels, (0, 0) at the top left corner of the image, x to the right, y down. They are not
/// bounded by the film: what lies just outside matters to filters wider than a pixel. Of a cropped film the image is the
/// crop.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    resolution: UVec2,
    /// Film position of the camera's axis.
    middle: Vec2,
    position: Vec3,
    /// Unit axes of the camera's space in the world: to the left of the image, up, and forwards.
    left: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Pixels per metre: at distance 1 where there is a field of view, anywhere for parallel rays.
    pixels_per_metre: f64,
    lens: Lens,
}

#[derive(Clone, Copy, Debug)]
enum Lens {
    Pinhole,
    Thin { radius: f32, focus_distance: f32, area: f32 },
    Parallel,
}

/// A connection from a point to the camera.
///
/// Its contribution to the film at `film` is `beta f cos importance / pdf_w`, with the cosine at the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSample {
    /// Unit direction from the point to the lens.
    pub wi: Vec3,
    /// Where on the film the point appears, in pixels; may lie outside (see [`Camera::film_contains`]).
    pub film: Vec2,
    /// Importance that arrives from the lens, such that the sum of all contributions to a pixel, over the number of
    /// light paths, is the mean radiance over the pixel. Where `delta` is set it holds the inverse squared distance
    /// (parallel rays: nothing) in place of a density.
    pub importance: f32,
    /// Density of the lens point as seen from the point, per steradian; 1 where `delta` is set.
    pub pdf_w: f32,
    /// The point on the lens; for parallel rays, on the plane they start from.
    pub target: Vec3,
    /// Whether the lens has no area (a pinhole) or a single direction (parallel rays).
    pub delta: bool,
}

impl Camera {
    /// A camera as described, in a world whose point `recentre` has been moved to the origin.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn new(description: &CameraDescription, recentre: DVec3) -> Result<Camera, CameraError> {
        let CameraDescription { projection, to_world, resolution, crop } = *description;
        if resolution.x == 0 || resolution.y == 0 {
            return Err(CameraError::Resolution(resolution));
        }
        let offset = crop.map_or(UVec2::ZERO, |c| c.offset);
        if let Some(crop) = crop {
            // Written so that nothing overflows.
            let fits = |size, offset, film| size > 0 && size <= film && offset <= film - size;
            let Crop { size, offset } = crop;
            if !(fits(size.x, offset.x, resolution.x) && fits(size.y, offset.y, resolution.y)) {
                return Err(CameraError::Crop { crop, film: resolution });
            }
        }
        let axes = unit_axes(to_world.matrix3)?;
        let position = to_world.translation - recentre;
        if !position.as_vec3().is_finite() {
            return Err(CameraError::Transform("not finite"));
        }
        let half_width = match projection {
            Projection::Perspective { fov_x }
            | Projection::OffAxis { fov_x, .. }
            | Projection::ThinLens { fov_x, .. } => {
                if !(fov_x > 0.0 && fov_x < PI) {
                    return Err(CameraError::FieldOfView(fov_x));
                }
                (0.5 * fov_x).tan()
            }
            Projection::Orthographic { width } => 0.5 * positive("width", width)?,
        };
        let lens = match projection {
            Projection::Perspective { .. } | Projection::OffAxis { .. } => Lens::Pinhole,
            Projection::ThinLens { aperture_radius, focus_distance, .. } => {
                let radius = positive("aperture radius", aperture_radius)?;
                let focus_distance = positive("focus distance", focus_distance)? as f32;
                let area = positive("aperture area", f64::from((PI * radius * radius) as f32))? as f32;
                Lens::Thin { radius: radius as f32, focus_distance, area }
            }
            Projection::Orthographic { .. } => Lens::Parallel,
        };
        let mut middle = 0.5 * resolution.as_vec2() - offset.as_vec2();
        if let Projection::OffAxis { offset, .. } = projection {
            middle -= (offset * resolution.as_dvec2()).as_vec2();
            if !middle.is_finite() {
                return Err(CameraError::Offset(offset));
            }
        }
        Ok(Camera {
            resolution: description.film_size(),
            middle,
            position: position.as_vec3(),
            left: axes.x_axis.as_vec3(),
            up: axes.y_axis.as_vec3(),
            forward: axes.z_axis.as_vec3(),
            pixels_per_metre: 0.5 * f64::from(resolution.x) / half_width,
            lens,
        })
    }

    /// Pixels of the image: those of the film, or of its crop.
    #[inline]
    pub fn resolution(&self) -> UVec2 {
        self.resolution
    }

    /// Where it stands: the pinhole, the middle of the lens, or the middle of the plane that parallel rays start from.
    #[inline]
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// Unit direction in which it looks.
    #[inline]
    pub fn forward(&self) -> Vec3 {
        self.forward
    }

    /// Whether a light path can only be connected to it by a delta density (see [`CameraSample::delta`]).
    #[inline]
    pub fn is_delta(&self) -> bool {
        !matches!(self.lens, Lens::Thin { .. })
    }

    /// Whether a film position lies on the film, or not further than `margin` pixels outside.
    #[inline]
    pub fn film_contains(&self, film: Vec2, margin: f32) -> bool {
        let far = self.resolution.as_vec2() + margin;
        film.x >= -margin && film.y >= -margin && film.x < far.x && film.y < far.y
    }

    /// The ray through a film position, in pixels, and a point of the lens; its direction is of unit length. `lens` is
    /// read by a thin lens alone.
    #[inline]
    pub fn sample_ray(&self, film: Vec2, lens: Vec2) -> Ray {
        let offset = self.offset(film);
        match self.lens {
            Lens::Pinhole => Ray::new(self.position, (offset + self.forward).normalize()),
            Lens::Thin { focus_distance, .. } => {
                let on_lens = self.lens_point(lens);
                Ray::new(self.position + on_lens, ((offset + self.forward) * focus_distance - on_lens).normalize())
            }
            Lens::Parallel => Ray::new(self.position + offset, self.forward),
        }
    }

    /// Connects a point to the lens by two numbers that only a thin lens reads. `None` for a point that is not in
    /// front of the camera.
    #[inline]
    pub fn sample_direct(&self, p: Vec3, lens_u: Vec2) -> Option<CameraSample> {
        let target = match self.lens {
            Lens::Pinhole => self.position,
            Lens::Thin { .. } => self.position + self.lens_point(lens_u),
            Lens::Parallel => p - self.forward * (p - self.position).dot(self.forward),
        };
        let from_lens = p - target;
        let d2 = from_lens.length_squared();
        let direction = match self.lens {
            Lens::Parallel if from_lens.dot(self.forward) > 0.0 => self.forward,
            _ => from_lens / d2.sqrt(),
        };
        let cos = direction.dot(self.forward);
        // Also where the point is on the lens and `cos` is not a number.
        if cos.is_nan() || cos <= 0.0 {
            return None;
        }
        let film = self.film_position(target, direction)?;
        let per_pixel = self.pdf_w_of_pixel(cos);
        let (importance, pdf_w) = match self.lens {
            Lens::Pinhole => (per_pixel / d2, 1.0),
            // [Pharr et al. 2016, sec. 16.1.1]: the importance per area of the lens, and area turned to solid angle.
            Lens::Thin { area, .. } => (per_pixel / (cos * area), d2 / (cos * area)),
            Lens::Parallel => ((self.pixels_per_metre * self.pixels_per_metre) as f32, 1.0),
        };
        let valid = importance.is_finite() && pdf_w.is_finite() && pdf_w > 0.0;
        valid.then_some(CameraSample { wi: -direction, film, importance, pdf_w, target, delta: self.is_delta() })
    }

    /// Where a ray that leaves the lens at `origin` meets the film, in pixels: the inverse of [`Camera::sample_ray`].
    /// `None` for a direction that does not lead forwards, or not to a finite position. A pinhole does not read
    /// `origin`, parallel rays do not read `direction`.
    #[inline]
    pub fn film_position(&self, origin: Vec3, direction: Vec3) -> Option<Vec2> {
        let on_lens = origin - self.position;
        let offset = match self.lens {
            Lens::Parallel => on_lens,
            Lens::Pinhole | Lens::Thin { .. } => {
                let cos = direction.dot(self.forward);
                if cos.is_nan() || cos <= 0.0 {
                    return None;
                }
                let through_pinhole = direction / cos;
                match self.lens {
                    Lens::Thin { focus_distance, .. } => through_pinhole + on_lens / focus_distance,
                    _ => through_pinhole,
                }
            }
        };
        let scale = self.pixels_per_metre as f32;
        let film = self.middle - Vec2::new(offset.dot(self.left), offset.dot(self.up)) * scale;
        film.is_finite().then_some(film)
    }

    /// Density per square metre of a camera ray's origin: over the lens, over the image's rectangle in the world for
    /// parallel rays, and 1 (delta) for a pinhole.
    #[inline]
    pub fn pdf_a(&self) -> f32 {
        match self.lens {
            Lens::Pinhole => 1.0,
            Lens::Thin { area, .. } => 1.0 / area,
            Lens::Parallel => (self.pixels_per_metre * self.pixels_per_metre / self.pixels()) as f32,
        }
    }

    /// Density per steradian of a camera ray's unit direction, given its origin and a film position that is uniform
    /// over the film; 0 for a direction that does not lead forwards, 1 (delta) for parallel rays. Whether the direction
    /// meets the film is not asked: see [`Camera::film_position`].
    #[inline]
    pub fn pdf_w(&self, direction: Vec3) -> f32 {
        if matches!(self.lens, Lens::Parallel) {
            return 1.0;
        }
        let cos = direction.dot(self.forward);
        if cos > 0.0 { self.pdf_w_of_pixel(cos) / self.pixels() as f32 } else { 0.0 }
    }

    /// Density per steradian of a direction whose film position is uniform over one pixel.
    #[inline]
    fn pdf_w_of_pixel(&self, cos: f32) -> f32 {
        // A pixel's area at distance 1, where an area is seen at 1 / cos³ of its size [Pharr et al. 2016, sec. 16.1.1].
        (self.pixels_per_metre * self.pixels_per_metre) as f32 / (cos * cos * cos)
    }

    fn pixels(&self) -> f64 {
        f64::from(self.resolution.x) * f64::from(self.resolution.y)
    }

    /// From the camera's axis to a film position: at distance 1 where there is a field of view.
    #[inline]
    fn offset(&self, film: Vec2) -> Vec3 {
        let q = (self.middle - film) * (1.0 / self.pixels_per_metre) as f32;
        self.left * q.x + self.up * q.y
    }

    /// From the middle of the lens to a point of it.
    #[inline]
    fn lens_point(&self, u: Vec2) -> Vec3 {
        match self.lens {
            Lens::Thin { radius, .. } => {
                let q = sample_disk(u) * radius;
                self.left * q.x + self.up * q.y
            }
            Lens::Pinhole | Lens::Parallel => Vec3::ZERO,
        }
    }
}

/// A length that is also positive and finite as an `f32`.
fn positive(name: &'static str, value: f64) -> Result<f64, CameraError> {
    let rounded = value as f32;
    if rounded > 0.0 && rounded.is_finite() { Ok(value) } else { Err(CameraError::Length { name, value }) }
}

/// The axes of a transform without their scale, at exact right angles; a reflection stays.
pub(crate) fn unit_axes(m: DMat3) -> Result<DMat3, CameraError> {
    if !m.is_finite() {
        return Err(CameraError::Transform("not finite"));
    }
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::try_normalize);
    let (Some(x), Some(y), Some(z)) = (x, y, z) else {
        return Err(CameraError::Transform("singular"));
    };
    // The volume of the unit axes is 1 unless they are skew; a transform written with few digits passes.
    let volume = x.cross(y).dot(z).abs();
    if volume < 1e-6 {
        return Err(CameraError::Transform("singular"));
    }
    if 1.0 - volume > 1e-4 {
        return Err(CameraError::Transform("skew"));
    }
    let up = (y - z * y.dot(z)).normalize();
    let left = up.cross(z);
    Ok(DMat3::from_cols(if left.dot(x) < 0.0 { -left } else { left }, up, z))
}
