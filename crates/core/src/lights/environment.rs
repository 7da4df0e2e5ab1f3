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
        image: Arc<Bitmap<Rgb>>,
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

impl Environment {
    /// Looks whether every value is usable; returns how many were looked at, or what is wrong and where.
    ///
    /// # Errors
    /// A texel (or the constant, or the scale) that is negative or not finite, an image whose size does not fit its
    /// texels, or a transform that is not a rotation (with or without a reflection).
    pub fn check(&self) -> Result<usize, String> {
        match self {
            Environment::Constant(radiance) if radiance.is_valid() => Ok(1),
            Environment::Constant(radiance) => Err(format!("the radiance {:?} is not usable", radiance.to_array())),
            Environment::LatLong { image, scale, to_world, .. } => {
                let (width, texels) = (image.width as usize, &image.texels);
                if texels.is_empty() || width.checked_mul(image.height as usize) != Some(texels.len()) {
                    return Err(format!("{} texels do not make {} x {}", texels.len(), image.width, image.height));
                }
                if !(scale.is_finite() && *scale >= 0.0) {
                    return Err(format!("the scale {scale} is not usable"));
                }
                // Products of unit columns; rotations written with six digits pass.
                let deviation = to_world.transpose() * *to_world - DMat3::IDENTITY;
                if !deviation.to_cols_array().iter().all(|d| d.abs() <= 1e-4) {
                    return Err(format!("the transform {to_world} is not a rotation"));
                }
                match texels.iter().position(|texel| !(texel.is_valid() && (*texel * *scale).is_valid())) {
                    None => Ok(texels.len()),
                    Some(i) => {
                        let (x, y, value) = (i % width, i / width, texels[i].to_array());
                        Err(format!("the texel at column {x}, row {y} is not usable: {value:?}"))
                    }
                }
            }
        }
    }
}
