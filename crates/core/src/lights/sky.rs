//! Light from infinity, ready to render.

use super::{
    environment::{Environment, Rows},
    polar::{Band, sample_linear},
};
use crate::{
    distribution::Piecewise2d,
    rgb::Rgb,
    texture::Bitmap,
    warp::{sample_sphere, sphere_pdf},
};
use glam::{Mat3, Vec2, Vec3};
use std::{f32::consts::PI, f64::consts::PI as PI64, sync::Arc};

/// An environment that can be sampled.
#[derive(Clone, Debug)]
pub(super) enum Sky {
    Constant(Rgb),
    LatLong(Box<LatLong>),
}

/// A direction towards the environment.
#[derive(Clone, Copy, Debug)]
pub(super) struct SkySample {
    /// Unit direction.
    pub direction: Vec3,
    /// Radiance from there.
    pub radiance: Rgb,
    /// Density per steradian.
    pub pdf_w: f32,
}

/// A latitude-longitude image that can be sampled.
///
/// The density follows the luminance of the interpolated image exactly, so that radiance over density is the same
/// for every sample of a grey image: a sun of one texel leaves no fireflies.
#[derive(Clone, Debug)]
pub(super) struct LatLong {
    image: Arc<Bitmap<Rgb>>,
    scale: f32,
    to_world: Mat3,
    rows: Rows,
    /// The bands, each with the texel rows at its top and bottom.
    bands: Vec<(Band, usize, usize)>,
    /// Over the cells between texel centres; column j lies between the texels j and j + 1, row i is band i. `None` for
    /// a black image.
    cells: Option<Piecewise2d>,
    /// Integral of the luminance over the sphere of directions.
    integral: f64,
}

impl Sky {
    pub fn new(environment: &Environment) -> Sky {
        match environment {
            Environment::Constant(radiance) => Sky::Constant(*radiance),
            Environment::LatLong { image, scale, to_world, rows } => {
                Sky::LatLong(Box::new(LatLong::new(image.clone(), *scale, to_world.as_mat3(), *rows)))
            }
        }
    }

    /// Integral of the luminance over the sphere of directions.
    pub fn integral(&self) -> f64 {
        match self {
            Sky::Constant(radiance) => 4.0 * PI64 * f64::from(radiance.luminance()),
            Sky::LatLong(sky) => sky.integral,
        }
    }

    /// Samples a direction towards the environment.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Option<SkySample> {
        match self {
            Sky::Constant(radiance) => {
                Some(SkySample { direction: sample_sphere(u), radiance: *radiance, pdf_w: sphere_pdf() })
            }
            Sky::LatLong(sky) => sky.sample(u),
        }
    }

    /// Radiance from a direction, and the density of [`Sky::sample`] there per steradian.
    #[inline]
    pub fn radiance_and_pdf(&self, direction: Vec3) -> (Rgb, f32) {
        match self {
            Sky::Constant(radiance) => (*radiance, sphere_pdf()),
            Sky::LatLong(sky) => {
                let radiance = sky.radiance(direction);
                (radiance, sky.pdf_w(radiance))
            }
        }
    }

    /// Radiance from a direction.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        match self {
            Sky::Constant(radiance) => *radiance,
            Sky::LatLong(sky) => sky.radiance(direction),
        }
    }

    /// Bytes held, the image left out.
    pub fn table_bytes(&self) -> u64 {
        match self {
            Sky::Constant(_) => 0,
            Sky::LatLong(sky) => {
                size_of_val(&sky.bands[..]) as u64 + sky.cells.as_ref().map_or(0, Piecewise2d::memory_bytes)
            }
        }
    }
}

impl LatLong {
    fn new(image: Arc<Bitmap<Rgb>>, scale: f32, to_world: Mat3, rows: Rows) -> LatLong {
        let (width, height) = (image.width as usize, image.height as usize);
        let mut weights = Vec::with_capacity(width * (height + 1));
        let luminance = |x: usize, y: usize| f64::from(image.texels[y * width + x].luminance());
        let bands: Vec<_> = (0..bands(rows, height)).map(|i| band(rows, height, i)).collect();
        for &(band, top, bottom) in &bands {
            let (w_top, w_bottom) = band.weights();
            // An edge of the cell is interpolated between two texels, so it has their mean.
            let mean = |x: usize, y: usize| 0.5 * (luminance(x, y) + luminance((x + 1) % width, y));
            let solid_angle = band.width * 2.0 * PI64 / width as f64;
            weights.extend((0..width).map(|x| (mean(x, top) * w_top + mean(x, bottom) * w_bottom) * solid_angle));
        }
        let integral = weights.iter().sum::<f64>() * f64::from(scale);
        let cells = Piecewise2d::new(&weights, width).filter(|_| integral > 0.0);
        LatLong { image, scale, to_world, rows, bands, cells, integral }
    }

    #[inline]
    fn radiance(&self, direction: Vec3) -> Rgb {
        // The transpose is the inverse of a rotation.
        let d = self.to_world.transpose() * direction;
        let u = d.x.atan2(-d.z) * (1.0 / (2.0 * PI));
        // As acos(d.y) / pi, which loses the neighbourhood of the poles.
        let v = (d.x * d.x + d.z * d.z).sqrt().atan2(d.y) * (1.0 / PI);
        let (width, height) = (self.image.width as i32, self.image.height as i32);
        let x = u * width as f32 - 0.5;
        let y = match self.rows {
            Rows::Centred => v * height as f32 - 0.5,
            Rows::PoleToPole => v * (height - 1) as f32,
        };
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let left = (x0 as i32).rem_euclid(width) as usize;
        let right = if left + 1 == width as usize { 0 } else { left + 1 };
        let row = |y: i32| &self.image.texels[y.clamp(0, height - 1) as usize * width as usize..][..width as usize];
        let (top, bottom) = (row(y0 as i32), row(y0 as i32 + 1));
        let across = |row: &[Rgb]| row[left] * (1.0 - fx) + row[right] * fx;
        (across(top) * (1.0 - fy) + across(bottom) * fy) * self.scale
    }

    /// The density where the image, interpolated and scaled, has this radiance.
    #[inline]
    fn pdf_w(&self, radiance: Rgb) -> f32 {
        let pdf = (f64::from(radiance.luminance()) / self.integral) as f32;
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    #[inline]
    fn sample(&self, u: Vec2) -> Option<SkySample> {
        let (column, row, within) = self.cells.as_ref()?.sample_cell(u);
        let width = self.image.width as usize;
        let (band, top, bottom) = self.bands[row];
        let next = if column + 1 == width { 0 } else { column + 1 };
        let texel = |x: usize, y: usize| self.image.texels[y * width + x];
        let corners = [texel(column, top), texel(next, top), texel(column, bottom), texel(next, bottom)];
        let luminance = corners.map(|c| f64::from(c.luminance()));
        // First the marginal density over the polar angle, then the conditional one over the azimuth.
        let t = band.sample(luminance[0] + luminance[1], luminance[2] + luminance[3], f64::from(within.y));
        let down = |a: f64, b: f64| a * (1.0 - t) + b * t;
        let s = sample_linear(down(luminance[0], luminance[2]), down(luminance[1], luminance[3]), f64::from(within.x));
        let (sin_theta, cos_theta) = ((band.start + band.width * t) as f32).sin_cos();
        let (sin_phi, cos_phi) = ((2.0 * PI64 * (column as f64 + 0.5 + s) / width as f64) as f32).sin_cos();
        // The texels are at hand: looking the direction up again would cost two arc tangents.
        let (fx, fy) = (s as f32, t as f32);
        let across = |left: Rgb, right: Rgb| left * (1.0 - fx) + right * fx;
        let radiance = (across(corners[0], corners[1]) * (1.0 - fy) + across(corners[2], corners[3]) * fy) * self.scale;
        Some(SkySample {
            direction: self.to_world * Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi),
            radiance,
            pdf_w: self.pdf_w(radiance),
        })
    }
}

/// Number of bands between rows of texel centres, or between them and a pole.
fn bands(rows: Rows, height: usize) -> usize {
    match rows {
        Rows::Centred => height + 1,
        Rows::PoleToPole => (height - 1).max(1),
    }
}

/// A band's polar angles and the texel rows at its top and bottom.
#[inline]
fn band(rows: Rows, height: usize, i: usize) -> (Band, usize, usize) {
    let (start, end, top) = match rows {
        Rows::Centred => {
            let centre = |k: usize| (k as f64 - 0.5) / height as f64;
            (centre(i).max(0.0), centre(i + 1).min(1.0), i.saturating_sub(1))
        }
        Rows::PoleToPole => {
            let n = (height - 1).max(1) as f64;
            (i as f64 / n, (i + 1) as f64 / n, i)
        }
    };
    let bottom = match rows {
        Rows::Centred => i.min(height - 1),
        Rows::PoleToPole => (i + 1).min(height - 1),
    };
    (Band::new(start * PI64, (end - start) * PI64), top, bottom)
}
