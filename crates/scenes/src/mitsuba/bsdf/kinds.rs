//! BSDFs that stand alone.

use super::{
    metal::conductor,
    principled::{principled, principled_thin},
};
use crate::{
    error::LoadError,
    mitsuba::{
        plugin::Plugin,
        texture::{REFLECTANCE, ROUGHNESS},
        value::number,
    },
};
use etendue_core::{
    bsdf::Distribution,
    material::{Material, RoughnessTexture},
    rgb::Rgb,
};

/// Indices of refraction by name, as Mitsuba has them.
const REFRACTION: [(&str, f64); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000036),
    ("hydrogen", 1.000132),
    ("air", 1.000277),
    ("carbon dioxide", 1.00045),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// The material of a BSDF that holds no other; none if its kind is not known.
pub(super) fn plain(plugin: &Plugin) -> Result<Option<Material>, LoadError> {
    let white = |name| plugin.texture_or(name, REFLECTANCE, Rgb::WHITE);
    Ok(Some(match plugin.kind {
        "diffuse" => diffuse(plugin, Rgb::splat(0.5))?,
        "conductor" | "roughconductor" => {
            let roughness = if plugin.kind == "conductor" { None } else { Some(roughness(plugin)?) };
            Material::Conductor { fresnel: conductor(plugin)?, tint: white("specular_reflectance")?, roughness }
        }
        "dielectric" | "roughdielectric" => Material::Dielectric {
            eta: relative_ior(plugin, "bk7")?,
            reflectance: white("specular_reflectance")?,
            transmittance: white("specular_transmittance")?,
            roughness: if plugin.kind == "dielectric" { None } else { Some(roughness(plugin)?) },
        },
        "thindielectric" => Material::ThinDielectric {
            eta: relative_ior(plugin, "bk7")?,
            reflectance: white("specular_reflectance")?,
            transmittance: white("specular_transmittance")?,
        },
        "plastic" | "roughplastic" => Material::Plastic {
            eta: relative_ior(plugin, "polypropylene")?,
            diffuse: plugin.texture_or("diffuse_reflectance", REFLECTANCE, Rgb::splat(0.5))?,
            specular: white("specular_reflectance")?,
            nonlinear: plugin.boolean("nonlinear")?.unwrap_or(false),
            roughness: if plugin.kind == "plastic" { None } else { Some(coat_roughness(plugin)?) },
        },
        "principled" => principled(plugin)?,
        "principledthin" => principled_thin(plugin)?,
        // Light passes as through glass that is no denser than what is around it.
        "null" => Material::dielectric(1.0, None),
        _ => return Ok(None),
    }))
}

fn diffuse(plugin: &Plugin, default: Rgb) -> Result<Material, LoadError> {
    let reflectance = match plugin.texture("reflectance", REFLECTANCE)? {
        Some(reflectance) => reflectance,
        // Its older name.
        None => plugin.texture_or("diffuse_reflectance", REFLECTANCE, default)?,
    };
    Ok(Material::Lambert { reflectance })
}

/// A diffuse material of the colour of one that is not supported.
pub(super) fn diffuse_stand_in(plugin: &Plugin) -> Result<Material, LoadError> {
    let default = plugin.reader.forgiven(plugin.reflectance("base_color"), "grey is taken")?.flatten();
    diffuse(plugin, default.unwrap_or(Rgb::splat(0.5)))
}

fn distribution(plugin: &Plugin) -> Result<Distribution, LoadError> {
    // A way of sampling only; the image is the same.
    plugin.boolean("sample_visible")?;
    Ok(match plugin.word("distribution", &["beckmann", "ggx"])? {
        Some("ggx") => Distribution::Ggx,
        _ => Distribution::Beckmann,
    })
}

fn roughness(plugin: &Plugin) -> Result<RoughnessTexture, LoadError> {
    let distribution = distribution(plugin)?;
    let both = plugin.texture("alpha", ROUGHNESS)?;
    let (alpha_u, alpha_v) = match (plugin.texture("alpha_u", ROUGHNESS)?, plugin.texture("alpha_v", ROUGHNESS)?) {
        (None, None) => {
            let alpha = both.unwrap_or_else(|| 0.1.into());
            (alpha.clone(), alpha)
        }
        (Some(_), Some(_)) if both.is_some() => {
            return Err(plugin.error_at("alpha", "`alpha` is given beside `alpha_u` and `alpha_v`"));
        }
        (Some(u), Some(v)) => (u, v),
        _ => return Err(plugin.error("`alpha_u` and `alpha_v` go together")),
    };
    Ok(RoughnessTexture { distribution, alpha_u, alpha_v })
}

/// The roughness of a coat, which is the same everywhere.
fn coat_roughness(plugin: &Plugin) -> Result<(Distribution, f32), LoadError> {
    let distribution = distribution(plugin)?;
    match plugin.texture_or("alpha", ROUGHNESS, 0.1)? {
        etendue_core::texture::Texture::Constant(alpha) => Ok((distribution, alpha)),
        _ => {
            let error = plugin.error_at("alpha", "the `alpha` of a coat is one number, not a texture");
            plugin.reader.forgive(error, "0.1 is taken")?;
            Ok((distribution, 0.1))
        }
    }
}

/// Index of refraction inside over outside.
fn relative_ior(plugin: &Plugin, inside: &str) -> Result<f32, LoadError> {
    Ok((ior(plugin, "int_ior", inside)? / ior(plugin, "ext_ior", "air")?) as f32)
}

/// An index of refraction by number or name.
pub(super) fn ior(plugin: &Plugin, name: &'static str, default: &str) -> Result<f64, LoadError> {
    let by_name = |wanted: &str| REFRACTION.iter().find(|(n, _)| n.eq_ignore_ascii_case(wanted)).map(|(_, ior)| *ior);
    let value = match plugin.text_or_float(name)? {
        None => by_name(default),
        Some(text) => number(&text).ok().or_else(|| by_name(&text)),
    };
    match value {
        Some(ior) if (1e-3..=1e3).contains(&ior) => Ok(ior),
        Some(ior) => Err(plugin.error_at(name, format!("the index of refraction {ior} is not from 0.001 to 1000"))),
        None => {
            let known = REFRACTION.map(|(n, _)| n).join(", ");
            Err(plugin.error_at(name, format!("the parameter `{name}` is neither a number nor one of {known}")))
        }
    }
}
