//! Pixel filters.

/// A pixel filter, separable, normalised to integrate to 1; units are pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant over the pixel's square (radius 0.5).
    Box,
    /// Tent of the given radius; Mitsuba's default radius is 1.
    Tent {
        /// Where it reaches zero.
        radius: f32,
    },
    /// Gaussian less its value at the radius `4 stddev`, so that it ends at zero there.
    Gaussian {
        /// Standard deviation; Mitsuba's default is 0.5.
        stddev: f32,
    },
}
