//! Next-event estimation that looks at several candidates and goes for one.

use super::{DirectSample, Lights};
use crate::{reservoir::Reservoir, rgb::Rgb, warp::ONE_MINUS_EPSILON};
use glam::{Vec2, Vec3};

/// Spacing of uniform numbers.
const STEP: f32 = 1.0 / (1 << 24) as f32;

/// One over the plastic number and its square as fractions of 2^32: multiples of the pair fill the unit square evenly
/// [Roberts 2018].
const PLASTIC: [u32; 2] = [3_242_174_889, 2_447_445_414];

impl Lights {
    /// Chooses one of several candidates of [`Lights::sample_direct`] by resampled importance sampling [Talbot et al. 2005],
    /// in proportion to what each would bring if nothing were in between.
    ///
    /// `integrand` is that at a candidate: scattering times radiance, and the weight of a sample of the lights where other
    /// samples find the same light. For the sample that is kept has no density in closed form, multiple importance sampling
    /// takes the candidates' densities, inside the integrand: `E[value V(wi)]` is the integral of `integrand V` over
    /// directions, whatever `V` is, and `value` without it is the mean of `integrand / pdf_w` over the candidates, but for
    /// the colour. `None` where no candidate brings any light.
    ///
    /// One address gives all candidates: they are the first one, of numbers `u_choice` and `u`, shifted cyclically through
    /// the strata of the choice and over a lattice of points. So each is spread over a pixel's samples as well as the first,
    /// and they are spread against each other. `u_kept` decides which is kept.
    #[inline]
    pub fn resample_direct<const HAS: u32>(
        &self,
        from: Vec3,
        candidates: u32,
        (u_choice, u, u_kept): (f32, Vec2, f32),
        mut integrand: impl FnMut(&DirectSample) -> Rgb,
    ) -> Option<(DirectSample, Rgb)> {
        let mut reservoir = Reservoir::default();
        let mut u_kept = f64::from(u_kept);
        for k in 0..candidates {
            let [x, y] = PLASTIC.map(|p| k.wrapping_mul(p) >> 8);
            let choice = shifted(u_choice, ((u64::from(k) << 24) / u64::from(candidates)) as u32);
            let point = Vec2::new(shifted(u.x, x), shifted(u.y, y));
            let Some(light) = self.sample_direct::<HAS>(from, choice, point) else { continue };
            let value = integrand(&light);
            let weight = f64::from(value.luminance()) / f64::from(light.pdf_w);
            if !(weight.is_finite() && weight >= 0.0) {
                // What is no light is not lost unseen here: it goes on to where it is counted.
                return Some((light, value * (1.0 / light.pdf_w)));
            }
            let before = reservoir.weight_sum();
            let kept = reservoir.update((light, value), weight, u_kept.min(f64::from(ONE_MINUS_EPSILON)) as f32);
            if weight > 0.0 {
                // What is left of the number, stretched to the unit interval, serves for the next candidate.
                let (sum, threshold) = (reservoir.weight_sum(), weight / reservoir.weight_sum());
                u_kept = if kept { u_kept / threshold } else { (u_kept - threshold) * (sum / before) };
                u_kept = u_kept.clamp(0.0, f64::from(ONE_MINUS_EPSILON));
            }
        }
        // The contribution weight [Bitterli et al. 2020, eq. 6].
        let sum = reservoir.weight_sum();
        let (light, value) = reservoir.into_sample()?;
        let contribution = sum / (f64::from(candidates) * f64::from(value.luminance()));
        Some((light, value.map(|c| (f64::from(c) * contribution) as f32)))
    }
}

/// A uniform number shifted cyclically by so many steps, without rounding.
#[inline]
fn shifted(u: f32, steps: u32) -> f32 {
    let shift = steps as f32 * STEP;
    let rest = 1.0 - shift;
    if u < rest { u + shift } else { u - rest }
}
