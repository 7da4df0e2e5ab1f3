//! Constant diffuse reflection, for directions in front of the surface.

use crate::{rgb::Rgb, warp};
use std::f32::consts::FRAC_1_PI;

/// Value and density; `cos_i` is the cosine of the direction that the density is of.
#[inline]
pub(super) fn eval_pdf(reflectance: Rgb, cos_i: f32) -> (Rgb, f32) {
    (reflectance * FRAC_1_PI, warp::cosine_hemisphere_pdf(cos_i))
}

pub(super) use warp::sample_cosine_hemisphere as sample;
