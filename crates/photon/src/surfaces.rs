//! Which surfaces take photons.

use etendue_core::{
    bsdf::{Bsdf, Lobe},
    effects::{Census, LobeKind, NARROW_ALPHA},
    has,
};

/// Whether a surface scatters by delta lobes and lobes of a roughness of at most [`NARROW_ALPHA`] alone: paths are led on over
/// it, and photons are not stored, for too few of them arrive from where it looks.
///
/// A narrow lobe beside a wide one, as the coat of rough plastic over its body, does not make a surface narrow: it takes photons,
/// and its coat reflects what they carry. Light that such a coat throws onto another surface is indirect light there, and no
/// caustic: the global map has it, or paths. Only delta lobes are told apart within a surface.
#[inline]
pub fn is_narrow<const HAS: u32>(bsdf: &Bsdf) -> bool {
    HAS & has::LOBES != 0 && is_narrow_lobe(&bsdf.first) && bsdf.second.is_none_or(|(lobe, _)| is_narrow_lobe(&lobe))
}

#[inline]
fn is_narrow_lobe(lobe: &Lobe) -> bool {
    lobe.width() <= NARROW_ALPHA
}

/// Whether any surface of a scene may take photons.
pub fn takes_photons(census: &Census) -> bool {
    census.is_lit() && census.lobes.iter().any(|l| l.alpha.1 > NARROW_ALPHA)
}

/// Whether light can reach a surface that takes photons by way of one that does not: else no caustic photon is traced.
pub fn has_caustics(census: &Census) -> bool {
    // Light that passes the holes of a mask has been scattered by a delta lobe, as far as paths are concerned.
    takes_photons(census) && (census.casters > 0 || census.lobes.iter().any(|l| l.kind == LobeKind::Null))
}

/// The smallest cosine between the normals of a surface and of a photon's for the photon to count there: photons from around
/// a corner, or from the other side of a thin wall, do not.
pub const LEAST_COS: f32 = 0.7;
