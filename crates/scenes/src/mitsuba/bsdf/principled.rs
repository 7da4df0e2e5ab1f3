//! The principled materials.

use crate::{
    error::LoadError,
    mitsuba::{
        plugin::Plugin,
        texture::{REFLECTANCE, TRANSMISSION},
    },
};
use etendue_core::{
    material::{Material, Principled, PrincipledThin},
    rgb::Rgb,
};

/// Ways of sampling only; the image is the same.
const SAMPLING_RATES: [&str; 7] = [
    "main_specular_sampling_rate",
    "clearcoat_sampling_rate",
    "diffuse_reflectance_sampling_rate",
    "specular_reflectance_sampling_rate",
    "specular_transmittance_sampling_rate",
    "diffuse_transmittance_sampling_rate",
    "spec_refl_sampling_rate",
];

pub(super) fn principled(plugin: &Plugin) -> Result<Material, LoadError> {
    let share = |name, default: f32| plugin.texture_or(name, REFLECTANCE, default);
    pass_over_sampling_rates(plugin)?;
    let eta = match (eta(plugin)?, plugin.float("specular")?) {
        (Some(_), Some(_)) => return Err(plugin.error_at("specular", "`specular` is given beside `eta`")),
        (Some(eta), None) => eta,
        (None, specular) => {
            let specular = specular.unwrap_or(0.5);
            if !(0.0..=1.0).contains(&specular) {
                let message = format!("the parameter `specular` is {specular}, not from 0 to 1");
                return Err(plugin.error_at("specular", message));
            }
            // The index whose reflectance at normal incidence is 8 % of it [Burley 2015, sec. 2.2].
            2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
        }
    };
    Ok(Material::Principled(Box::new(Principled {
        base_color: plugin.texture_or("base_color", REFLECTANCE, Rgb::splat(0.5))?,
        roughness: share("roughness", 0.5)?,
        anisotropic: share("anisotropic", 0.0)?,
        metallic: share("metallic", 0.0)?,
        spec_trans: share("spec_trans", 0.0)?,
        eta: eta as f32,
        spec_tint: share("spec_tint", 0.0)?,
        sheen: share("sheen", 0.0)?,
        sheen_tint: share("sheen_tint", 0.0)?,
        flatness: share("flatness", 0.0)?,
        clearcoat: share("clearcoat", 0.0)?,
        clearcoat_gloss: share("clearcoat_gloss", 0.0)?,
    })))
}

pub(super) fn principled_thin(plugin: &Plugin) -> Result<Material, LoadError> {
    let share = |name, default: f32| plugin.texture_or(name, REFLECTANCE, default);
    pass_over_sampling_rates(plugin)?;
    Ok(Material::PrincipledThin(Box::new(PrincipledThin {
        base_color: plugin.texture_or("base_color", REFLECTANCE, Rgb::splat(0.5))?,
        roughness: share("roughness", 0.5)?,
        anisotropic: share("anisotropic", 0.0)?,
        spec_trans: share("spec_trans", 0.0)?,
        eta: eta(plugin)?.unwrap_or(1.5) as f32,
        spec_tint: share("spec_tint", 0.0)?,
        sheen: share("sheen", 0.0)?,
        sheen_tint: share("sheen_tint", 0.0)?,
        flatness: share("flatness", 0.0)?,
        diff_trans: plugin.texture_or("diff_trans", TRANSMISSION, 0.0)?,
    })))
}

fn eta(plugin: &Plugin) -> Result<Option<f64>, LoadError> {
    match plugin.positive("eta")? {
        Some(eta) if !(1e-3..=1e3).contains(&eta) => {
            Err(plugin.error_at("eta", format!("the index of refraction {eta} is not from 0.001 to 1000")))
        }
        other => Ok(other),
    }
}

fn pass_over_sampling_rates(plugin: &Plugin) -> Result<(), LoadError> {
    SAMPLING_RATES.into_iter().try_for_each(|name| plugin.float(name).map(drop))
}
