//! Light from infinity.
use crate::{rgb::Rgb, texture::Bitmap};
use glam::DMat3;
use std::sync::Arc;

/// Radiance that comes from infinity, by direction.
#[derive(Clone, Debug)]
pub enum Environment {
    /// The same from everywhere.
    Constant(Rgb),
    /// A latitude-longitude image.
    LatLong {
        /// The image; row 0 is towards +y, bilinearly interpolated. In the image's space a direction `d` lies at
        /// `u = atan2(d.x, -d.z) / 2 pi`, `v = acos(d.y) / pi` (v counted from the top), as in Mitsuba.
        image: Arc<Bitmap>,
        /// Factor on its values.
        scale: f32,
        /// Rotation from the image's space to the world.
        to_world: DMat3,
        /// Where the rows lie.
        rows: Rows,
    },
}

/// Where the rows of a latitude-longitude image lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    /// Row i of n is centred at `v = (i + 1/2) / n`.
    Centred,
    /// The first and last row lie on the poles: row i is centred at `v = i / (n - 1)` (as in Mitsuba).
    PoleToPole,
}
