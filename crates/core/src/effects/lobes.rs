//! What lobes a material has, and how rough they are.

use crate::{
    bsdf::{clearcoat_alpha, principled_alpha, thin_roughness},
    material::{Material, RoughnessTexture},
    texture::Texture,
};

/// The sorts of lobe a material can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LobeKind {
    /// Diffuse reflection.
    Lambert,
    /// Smooth conductor.
    Conductor,
    /// Rough conductor.
    RoughConductor,
    /// Smooth dielectric.
    Dielectric,
    /// Rough dielectric.
    RoughDielectric,
    /// Thin sheet of a dielectric.
    ThinDielectric,
    /// Diffuse body under a smooth coat.
    Plastic,
    /// Diffuse body under a rough coat.
    RoughPlastic,
    /// Principled material.
    Principled,
    /// Principled material of a thin sheet.
    PrincipledThin,
    /// The holes of a mask.
    Null,
}

impl LobeKind {
    /// Its name in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            LobeKind::Lambert => "lambert",
            LobeKind::Conductor => "smooth conductor",
            LobeKind::RoughConductor => "rough conductor",
            LobeKind::Dielectric => "smooth dielectric",
            LobeKind::RoughDielectric => "rough dielectric",
            LobeKind::ThinDielectric => "thin dielectric",
            LobeKind::Plastic => "smooth plastic",
            LobeKind::RoughPlastic => "rough plastic",
            LobeKind::Principled => "principled",
            LobeKind::PrincipledThin => "thin principled",
            LobeKind::Null => "mask",
        }
    }
}

impl LobeKind {
    /// Returns `true` for lobes with a part that scatters into single directions.
    pub const fn has_delta(self) -> bool {
        matches!(self, LobeKind::Plastic) || !self.has_rough()
    }

    /// Returns `true` for lobes with a part that scatters into a range of directions.
    pub const fn has_rough(self) -> bool {
        !matches!(self, LobeKind::Conductor | LobeKind::Dielectric | LobeKind::ThinDielectric | LobeKind::Null)
    }
}

/// Whether two materials share every point.
pub(super) fn is_mixture(material: &Material) -> bool {
    match material {
        Material::Mix { .. } => true,
        Material::Relief { material, .. } => is_mixture(material),
        _ => false,
    }
}

/// The smallest and the largest of some numbers, if there are any.
fn range(values: impl Iterator<Item = f32>) -> Option<(f32, f32)> {
    values.fold(None, |range, a| Some(range.map_or((a, a), |(least, most): (f32, f32)| (least.min(a), most.max(a)))))
}

/// The range of a texture whose values are in `[0, 1]`.
fn unit_range(texture: &Texture<f32>) -> (f32, f32) {
    range(texture.values().into_iter()).unwrap_or((0.0, 1.0))
}

/// The range of the microfacet roughness of a principled material.
fn principled_range(roughness: (f32, f32), anisotropic: &Texture<f32>) -> (f32, f32) {
    let stretch = unit_range(anisotropic).1;
    (principled_alpha(roughness.0, stretch).min_element(), principled_alpha(roughness.1, stretch).max_element())
}

/// The lobes of a material with the range of their roughness.
pub(super) fn collect_lobes(material: &Material, lobes: &mut Vec<(LobeKind, (f32, f32))>) {
    let width = |r: &Option<RoughnessTexture>| {
        range(r.iter().flat_map(|r| [r.alpha_u.values(), r.alpha_v.values()]).flatten()).unwrap_or((0.0, 0.0))
    };
    match material {
        Material::Lambert { .. } => lobes.push((LobeKind::Lambert, (1.0, 1.0))),
        Material::Conductor { roughness, .. } => lobes
            .push((if roughness.is_some() { LobeKind::RoughConductor } else { LobeKind::Conductor }, width(roughness))),
        Material::Dielectric { roughness, .. } => lobes.push((
            if roughness.is_some() { LobeKind::RoughDielectric } else { LobeKind::Dielectric },
            width(roughness),
        )),
        Material::ThinDielectric { .. } => lobes.push((LobeKind::ThinDielectric, (0.0, 0.0))),
        Material::Plastic { roughness: None, .. } => lobes.push((LobeKind::Plastic, (0.0, 1.0))),
        Material::Plastic { roughness: Some((_, alpha)), .. } => lobes.push((LobeKind::RoughPlastic, (*alpha, 1.0))),
        Material::Principled(p) => {
            let mut alpha = principled_range(unit_range(&p.roughness), &p.anisotropic);
            if unit_range(&p.clearcoat).1 > 0.0 {
                alpha.0 = alpha.0.min(clearcoat_alpha(unit_range(&p.clearcoat_gloss).1));
            }
            let diffuse = unit_range(&p.spec_trans).0 < 1.0 || unit_range(&p.sheen).1 > 0.0;
            if unit_range(&p.metallic).0 < 1.0 && diffuse {
                alpha.1 = 1.0;
            }
            lobes.push((LobeKind::Principled, alpha));
        }
        Material::PrincipledThin(p) => {
            let (least, most) = unit_range(&p.roughness);
            let reflected = principled_range((least, most), &p.anisotropic);
            let through = [least, most].map(|r| thin_roughness(p.eta, r).abs());
            let transmitted = principled_range((through[0], through[1]), &p.anisotropic);
            let mut alpha = (reflected.0.min(transmitted.0), reflected.1.max(transmitted.1));
            let specular = unit_range(&p.spec_trans);
            if specular.1 == 0.0 {
                alpha.0 = 1.0;
            }
            if specular.0 < 1.0 {
                alpha.1 = 1.0;
            }
            lobes.push((LobeKind::PrincipledThin, alpha));
        }
        Material::Mask { material, .. } => {
            collect_lobes(material, lobes);
            lobes.push((LobeKind::Null, (0.0, 0.0)));
        }
        Material::Relief { material, .. } => collect_lobes(material, lobes),
        Material::Mix { first, second, .. } => {
            collect_lobes(first, lobes);
            collect_lobes(second, lobes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bsdf::Distribution,
        material::{Principled, PrincipledThin},
        rgb::Rgb,
    };

    fn lobes(material: &Material) -> Vec<(LobeKind, (f32, f32))> {
        let mut lobes = Vec::new();
        collect_lobes(material, &mut lobes);
        lobes
    }

    fn principled() -> Principled {
        Principled {
            base_color: Rgb::WHITE.into(),
            roughness: 0.5.into(),
            anisotropic: 0.0.into(),
            metallic: 0.0.into(),
            spec_trans: 0.0.into(),
            eta: 1.5,
            spec_tint: 0.0.into(),
            sheen: 0.0.into(),
            sheen_tint: 0.0.into(),
            flatness: 0.0.into(),
            clearcoat: 0.0.into(),
            clearcoat_gloss: 1.0.into(),
        }
    }

    fn thin() -> PrincipledThin {
        PrincipledThin {
            base_color: Rgb::WHITE.into(),
            roughness: 0.5.into(),
            anisotropic: 0.0.into(),
            spec_trans: 0.0.into(),
            eta: 1.0,
            spec_tint: 0.0.into(),
            sheen: 0.0.into(),
            sheen_tint: 0.0.into(),
            flatness: 0.0.into(),
            diff_trans: 0.0.into(),
        }
    }

    #[track_caller]
    fn assert_range(material: &Material, kind: LobeKind, least: f32, most: f32) {
        let found = lobes(material);
        assert!(
            matches!(found[..], [(k, (a, b))] if k == kind && (a - least).abs() < 1e-6 && (b - most).abs() < 1e-6),
            "{found:?}"
        );
    }

    #[test]
    fn principled_materials_are_as_narrow_as_their_narrowest_part() {
        let check =
            |p, least, most| assert_range(&Material::Principled(Box::new(p)), LobeKind::Principled, least, most);
        check(principled(), 0.25, 1.0);
        let metal = || Principled { metallic: 1.0.into(), ..principled() };
        check(metal(), 0.25, 0.25);
        check(Principled { clearcoat: 1.0.into(), ..metal() }, 0.001, 0.25);
        check(Principled { spec_trans: 1.0.into(), roughness: 0.0.into(), ..principled() }, 0.001, 0.001);
        check(Principled { sheen: 0.5.into(), spec_trans: 1.0.into(), ..principled() }, 0.25, 1.0);
        let aspect = 0.19f32.sqrt();
        check(Principled { anisotropic: 0.9.into(), ..metal() }, 0.25 * aspect, 0.25 / aspect);
        let board =
            Texture::Checkerboard { even: 0.2, odd: 0.8, to_uv: glam::Affine2::from_scale(glam::Vec2::splat(2.0)) };
        check(Principled { roughness: board, ..metal() }, 0.04, 0.64);
        check(Principled { roughness: Texture::VertexColor, ..metal() }, 0.001, 1.0);
    }

    #[test]
    fn thin_principled_materials_cast_only_with_specular_lobes() {
        let check = |p, least, most| {
            assert_range(&Material::PrincipledThin(Box::new(p)), LobeKind::PrincipledThin, least, most)
        };
        check(thin(), 1.0, 1.0);
        check(PrincipledThin { spec_trans: 0.5.into(), ..thin() }, 0.0225, 1.0);
        check(PrincipledThin { spec_trans: 1.0.into(), ..thin() }, 0.0225, 0.25);
    }

    #[test]
    fn coats_both_cast_and_receive() {
        let plastic = |roughness| Material::Plastic {
            eta: 1.5,
            diffuse: Rgb::WHITE.into(),
            specular: Rgb::WHITE.into(),
            nonlinear: false,
            roughness,
        };
        assert_range(&plastic(None), LobeKind::Plastic, 0.0, 1.0);
        assert_range(&plastic(Some((Distribution::Ggx, 0.1))), LobeKind::RoughPlastic, 0.1, 1.0);
    }

    #[test]
    fn masks_have_holes_and_reliefs_have_what_is_under_them() {
        let relief = |material| Material::Relief {
            relief: crate::material::Relief::Bump { height: 0.0.into(), scale: 1.0 },
            material: Box::new(material),
        };
        let mask = Material::Mask { opacity: 0.5.into(), material: Box::new(Material::lambert(Rgb::WHITE)) };
        let expected = [(LobeKind::Lambert, (1.0, 1.0)), (LobeKind::Null, (0.0, 0.0))];
        assert_eq!(lobes(&relief(mask.clone())), expected);
        assert!(!is_mixture(&relief(mask)));
        let member = || Box::new(Material::lambert(Rgb::WHITE));
        let mix = Material::Mix { first: member(), second: member(), weight: 0.5.into() };
        assert!(is_mixture(&relief(mix)));
    }
}
