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

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::{
        bsdf::{ConductorFresnel, Distribution, Principled, PrincipledThin, RoughPlastic, Roughness},
        rgb::Rgb,
    };

    /// Glass of the microfacet roughness 0.04.
    const GLASS: Principled = Principled {
        base_color: Rgb::WHITE,
        roughness: 0.2,
        anisotropic: 0.0,
        metallic: 0.0,
        spec_trans: 1.0,
        eta: 1.5,
        spec_tint: 0.0,
        sheen: 0.0,
        sheen_tint: 0.0,
        flatness: 0.0,
        clearcoat: 0.0,
        clearcoat_gloss: 0.0,
    };

    fn narrow(first: Lobe, second: Option<Lobe>) -> bool {
        is_narrow::<{ has::ALL }>(&Bsdf { first, second: second.map(|lobe| (lobe, 0.5)), two_sided: true })
    }

    #[test]
    fn principled_surfaces_are_as_wide_as_their_widest_part() {
        let principled = |p| narrow(Lobe::Principled(p), None);
        assert!(principled(GLASS));
        assert!(principled(Principled { clearcoat: 1.0, ..GLASS }));
        assert!(!principled(Principled { roughness: 0.5, ..GLASS }));
        assert!(!principled(Principled { spec_trans: 0.9, ..GLASS }));
        assert!(!principled(Principled { sheen: 0.5, ..GLASS }));
        let metal = Principled { metallic: 1.0, spec_trans: 0.0, ..GLASS };
        assert!(principled(metal));
        assert!(principled(Principled { sheen: 0.5, clearcoat: 1.0, ..metal }));
        assert!(!principled(Principled { metallic: 0.9, ..metal }));
        assert!(principled(Principled { spec_trans: 0.0, base_color: Rgb::BLACK, ..GLASS }));
    }

    #[test]
    fn blends_and_coats_are_narrow_where_all_of_them_is() {
        let roughness = |alpha| Roughness { distribution: Distribution::Ggx, alpha: glam::Vec2::splat(alpha) };
        let metal = |alpha| Lobe::RoughConductor {
            fresnel: ConductorFresnel::Constant(Rgb::WHITE),
            roughness: roughness(alpha),
        };
        assert!(narrow(metal(0.1), Some(Lobe::Principled(GLASS))));
        assert!(!narrow(metal(0.3), Some(Lobe::Principled(GLASS))));
        assert!(!narrow(Lobe::Lambert { reflectance: Rgb::WHITE }, Some(Lobe::Principled(GLASS))));
        let plastic = |diffuse: f32, alpha| {
            let diffuse = Rgb::splat(diffuse);
            narrow(
                Lobe::RoughPlastic(RoughPlastic::new(1.5, (Distribution::Ggx, alpha), diffuse, Rgb::WHITE, false)),
                None,
            )
        };
        assert!(plastic(0.0, 0.1) && !plastic(0.0, 0.3) && !plastic(0.5, 0.1));
        let Principled { base_color, roughness, anisotropic, spec_trans, eta, spec_tint, .. } = GLASS;
        let sheet = PrincipledThin {
            base_color,
            roughness,
            anisotropic,
            spec_trans,
            eta,
            spec_tint,
            sheen: 1.0,
            sheen_tint: 0.0,
            flatness: 0.0,
            diff_trans: 1.0,
        };
        assert!(narrow(Lobe::PrincipledThin(sheet), None));
        assert!(!narrow(Lobe::PrincipledThin(PrincipledThin { spec_trans: 0.5, ..sheet }), None));
        assert!(!narrow(Lobe::PrincipledThin(PrincipledThin { roughness: 0.9, ..sheet }), None));
    }
}
