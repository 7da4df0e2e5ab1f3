//! What the principled materials have in common [Burley 2012, 2015].

use super::fresnel::scaled_transmitted_cos2;
use crate::rgb::Rgb;
use glam::Vec2;

/// Schlick's weight `(1 - cos)⁵`.
#[inline]
pub(super) fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// The weight of white in Schlick's approximation of a reflectance [Schlick 1994, eq. 15]; into a medium of lower index
/// of refraction by the cosine on the far side, so that total internal reflection is reached [Burley 2015, sec. 5.2].
#[inline]
pub(super) fn fresnel_weight(cos: f32, eta: f32) -> f32 {
    schlick_weight(if eta > 1.0 { cos } else { scaled_transmitted_cos2(cos, eta).max(0.0).sqrt() / eta })
}

/// Schlick's approximation of a reflectance of `r0` along the normal.
#[inline]
pub(super) fn schlick(r0: Rgb, cos: f32, eta: f32) -> Rgb {
    let w = fresnel_weight(cos, eta);
    r0 * (1.0 - w) + Rgb::splat(w)
}

/// Reflectance along the normal of a dielectric, in the hue and saturation of a colour.
#[inline]
pub(super) fn tinted_r0(color: Rgb, eta: f32) -> Rgb {
    let root = (eta - 1.0) / (eta + 1.0);
    hue(color) * (root * root)
}

/// A colour at luminance 1: its hue and saturation. White for black.
#[inline]
fn hue(color: Rgb) -> Rgb {
    let luminance = color.luminance();
    if luminance > 0.0 { color / luminance } else { Rgb::WHITE }
}

/// Microfacet roughness [Burley 2012, sec. 5.4], at least 0.001.
#[inline]
pub(crate) fn principled_alpha(roughness: f32, anisotropic: f32) -> Vec2 {
    let squared = roughness * roughness;
    if anisotropic == 0.0 {
        return Vec2::splat(squared.max(SMALLEST_ALPHA));
    }
    let aspect = (1.0 - 0.9 * anisotropic).sqrt();
    Vec2::new(squared / aspect, squared * aspect).max(Vec2::splat(SMALLEST_ALPHA))
}

/// Least microfacet roughness.
const SMALLEST_ALPHA: f32 = 1e-3;

/// Diffuse reflection with its retro-reflection, relative to a Lambert surface of the same colour, and blended with
/// `flatness` into an approximation of subsurface scattering. Cosines of both directions to the normal, and of either to
/// the half vector.
#[inline]
pub(super) fn diffuse(roughness: f32, flatness: f32, cos_o: f32, cos_i: f32, cos_d: f32) -> f32 {
    let (weight_o, weight_i) = (schlick_weight(cos_o), schlick_weight(cos_i));
    // [Burley 2015, eq. 4]
    let plain = (1.0 - 0.5 * weight_o) * (1.0 - 0.5 * weight_i);
    let rr = 2.0 * roughness * cos_d * cos_d;
    let retro = rr * (weight_o + weight_i + weight_o * weight_i * (rr - 1.0));
    if flatness == 0.0 {
        return plain + retro;
    }
    // After [Hanrahan and Krueger 1993], as in [Burley 2012, sec. 5.3].
    let toward = |weight: f32| 1.0 + (0.5 * rr - 1.0) * weight;
    let fss = toward(weight_o) * toward(weight_i);
    // The quotient of subnormal cosines would overflow.
    let inverse = 1.0 / (cos_o + cos_i).max(f32::MIN_POSITIVE);
    let flat = 1.25 * (fss * (inverse - 0.5) + 0.5);
    (1.0 - flatness) * (plain + retro) + flatness * flat
}

/// Sheen of a surface of the given colour [Burley 2012, sec. 5.5], with a factor on it. No 1 / pi stands before it.
#[inline]
pub(super) fn sheen(strength: f32, tint: f32, color: Rgb, cos_d: f32) -> Rgb {
    (Rgb::splat(1.0 - tint) + hue(color) * tint) * (strength * schlick_weight(cos_d))
}

/// A rough guess at the energy of sheen of strength 1, for choosing what to sample: it is strong only where both
/// directions graze.
#[inline]
pub(super) fn sheen_energy(cos_o: f32) -> f32 {
    0.1 * schlick_weight(cos_o)
}
