//! Cameras.
mod runtime;

pub(crate) use runtime::unit_axes;
pub use runtime::{Camera, CameraError, CameraSample};

use glam::{DAffine3, DVec2, UVec2};

/// A camera as a scene describes it.
#[derive(Clone, Debug)]
pub struct CameraDescription {
    /// What kind it is.
    pub projection: Projection,
    /// From the camera's space to the world: the camera stands at the origin, looks along +z, +y is up and +x is to
    /// the left of the image (as in Mitsuba). Any scale in it is ignored.
    pub to_world: DAffine3,
    /// Pixels of the whole film.
    pub resolution: UVec2,
    /// The part of it that is rendered; all of it without one. The field of view stays that of the whole film.
    pub crop: Option<Crop>,
}

impl CameraDescription {
    /// Pixels of the image that it makes: those of the crop, or of the whole film.
    pub fn film_size(&self) -> UVec2 {
        self.crop.map_or(self.resolution, |crop| crop.size)
    }
}

/// A rectangle of pixels of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Its first column and row.
    pub offset: UVec2,
    /// Its size, positive, within the film.
    pub size: UVec2,
}

/// The kinds of projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A pinhole.
    Perspective {
        /// Full horizontal field of view, radians, in (0, pi).
        fov_x: f64,
    },
    /// A pinhole whose axis does not meet the middle of the film.
    OffAxis {
        /// Full horizontal field of view, radians, in (0, pi), of a film of the same size around the axis.
        fov_x: f64,
        /// From the point of the film that the axis meets to the film's middle, in widths to the right and heights down.
        offset: DVec2,
    },
    /// A thin lens, focused on a plane.
    ThinLens {
        /// Full horizontal field of view, radians, in (0, pi).
        fov_x: f64,
        /// Radius of the lens, positive.
        aperture_radius: f64,
        /// Distance of the plane in focus, positive.
        focus_distance: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// Width of what is seen, positive.
        width: f64,
    },
}
