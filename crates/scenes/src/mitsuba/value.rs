//! Numbers, vectors and colours as text.

use crate::{error::abridged, image_file::from_srgb, spectrum::Spectrum};
use etendue_core::rgb::Rgb;
use glam::DVec3;

/// A finite number that single precision can hold.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let value: f64 = text.parse().map_err(|_| format!("`{}` is not a number", abridged(text)))?;
    if !value.is_finite() {
        return Err(format!("`{}` is not finite", abridged(text)));
    }
    if !(value as f32).is_finite() {
        return Err(format!("{value:e} is beyond single precision"));
    }
    Ok(value)
}

/// Numbers between commas or white space, at most `most` of them.
pub(super) fn numbers(text: &str, most: usize) -> Result<Vec<f64>, String> {
    let mut all = Vec::new();
    for part in text.split(|c: char| c == ',' || c.is_whitespace()).filter(|p| !p.is_empty()) {
        if all.len() == most {
            return Err(format!("has more than {most} numbers"));
        }
        all.push(number(part)?);
    }
    Ok(all)
}

/// Three numbers.
pub(super) fn vector(text: &str) -> Result<DVec3, String> {
    match numbers(text, 3)?.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(format!("three numbers are needed, `{}` has {}", abridged(text), other.len())),
    }
}

/// A whole number.
pub(super) fn integer(text: &str) -> Result<i64, String> {
    text.trim().parse().map_err(|_| format!("`{}` is not a whole number", abridged(text)))
}

/// `true` or `false`, in letters of either case.
pub(super) fn boolean(text: &str) -> Result<bool, String> {
    match text.trim() {
        word if word.eq_ignore_ascii_case("true") => Ok(true),
        word if word.eq_ignore_ascii_case("false") => Ok(false),
        other => Err(format!("`{}` is neither true nor false", abridged(other))),
    }
}

/// What `<spectrum>` holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Spectral {
    /// The same at each wavelength.
    Uniform(f64),
    /// By points.
    Points(Spectrum),
}

/// A number, or pairs of a wavelength and a value like `400:0.1, 700:0.3`.
pub(super) fn spectrum(text: &str) -> Result<Spectral, String> {
    if !text.contains(':') {
        let value = number(text)?;
        return match value < 0.0 {
            true => Err(format!("a spectrum is not negative ({value})")),
            false => Ok(Spectral::Uniform(value)),
        };
    }
    let pairs = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|p| !p.is_empty());
    let points = pairs.map(|pair| match pair.split_once(':') {
        Some((wavelength, value)) => Ok((number(wavelength)?, number(value)?)),
        None => Err(format!("`{}` is not like `400:0.5`", abridged(pair))),
    });
    Spectrum::new(points.collect::<Result<_, _>>()?).map(Spectral::Points)
}

/// The points of a spectrum's file: a wavelength and a value a line, `#` before what is not read.
pub(super) fn spectrum_file(text: &str) -> Result<Spectral, String> {
    let mut points = Vec::new();
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        match numbers(line, 2)?.as_slice() {
            [] => {}
            &[wavelength, value] => points.push((wavelength, value)),
            _ => return Err(format!("`{}` is not a wavelength and a value", abridged(line))),
        }
    }
    Spectrum::new(points).map(Spectral::Points)
}

/// Components by `#rrggbb`, from 0 to 1.
fn hexadecimal(text: &str) -> Option<Result<[f64; 3], String>> {
    let digits = text.trim().strip_prefix('#')?;
    let whole = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let parsed = whole.then(|| u32::from_str_radix(digits, 16).ok()).flatten();
    let wrong = || format!("`{}` is not like #ff8000", abridged(text));
    let byte = |value: u32, shift: u32| f64::from(value >> shift & 0xff) / 255.0;
    Some(parsed.map(|v| [byte(v, 16), byte(v, 8), byte(v, 0)]).ok_or_else(wrong))
}

/// A colour of components as sRGB has them, from 0 to 1.
pub(super) fn srgb(text: &str) -> Result<Rgb, String> {
    let coded = colour(text)?;
    match coded.max_element() > 1.0 {
        true => Err(format!("`{}` is not sRGB, which goes from 0 to 1", abridged(text))),
        false => Ok(coded.map(from_srgb)),
    }
}

/// A colour of one or three components, none negative.
pub(super) fn colour(text: &str) -> Result<Rgb, String> {
    if let Some(components) = hexadecimal(text) {
        return grey_or_colour(components?);
    }
    let components = match numbers(text, 3)?.as_slice() {
        &[v] => [v; 3],
        &[r, g, b] => [r, g, b],
        other => return Err(format!("a colour has one or three numbers, `{}` has {}", abridged(text), other.len())),
    };
    grey_or_colour(components)
}

/// A colour from its components, none of which may be negative.
pub(super) fn grey_or_colour(components: [f64; 3]) -> Result<Rgb, String> {
    match components.iter().find(|c| **c < 0.0) {
        Some(negative) => Err(format!("a colour has no negative component ({negative})")),
        None => Ok(Rgb::from(components.map(|c| c as f32))),
    }
}

/// A name in the older style with capitals inside (`toWorld`, `intIOR`), in today's (`to_world`, `int_ior`).
pub(super) fn snake_case(name: &str) -> String {
    let mut out = String::with_capacity(name.len() + 4);
    let mut after_lower = false;
    for c in name.chars() {
        if c.is_ascii_uppercase() && after_lower {
            out.push('_');
        }
        after_lower = c.is_ascii_lowercase() || c.is_ascii_digit();
        out.push(c.to_ascii_lowercase());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number(" -4.37114e-008 "), Ok(-4.37114e-8));
        assert_eq!(number("nan").unwrap_err(), "`nan` is not finite");
        assert_eq!(number("-inf").unwrap_err(), "`-inf` is not finite");
        assert_eq!(number("1e39").unwrap_err(), "1e39 is beyond single precision");
        assert_eq!(number("1e999").unwrap_err(), "`1e999` is not finite");
        assert_eq!(number("1,5").unwrap_err(), "`1,5` is not a number");
    }

    #[test]
    fn lists_split_at_commas_and_spaces() {
        assert_eq!(vector("1, 2,3"), Ok(DVec3::new(1.0, 2.0, 3.0)));
        assert_eq!(vector("1 2\t3 "), Ok(DVec3::new(1.0, 2.0, 3.0)));
        assert_eq!(vector("1 2").unwrap_err(), "three numbers are needed, `1 2` has 2");
        assert_eq!(vector("1 2 3 4").unwrap_err(), "has more than 3 numbers");
        assert_eq!(colour("0.5"), Ok(Rgb::splat(0.5)));
        assert_eq!(colour("1 0 -1").unwrap_err(), "a colour has no negative component (-1)");
    }

    #[test]
    fn colours_may_be_hexadecimal() {
        assert_eq!(colour("#ff0033"), Ok(Rgb::new(1.0, 0.0, 0.2)));
        assert_eq!(srgb("#ff0000"), Ok(Rgb::new(1.0, 0.0, 0.0)));
        assert!((srgb("0.5").unwrap().g - 0.214_041_14).abs() < 1e-7);
        for wrong in ["#ff00", "#ff00333", "#gg0000", "#+f0000", "#äää"] {
            assert_eq!(colour(wrong).unwrap_err(), format!("`{wrong}` is not like #ff8000"));
        }
        assert_eq!(srgb("2 0 0").unwrap_err(), "`2 0 0` is not sRGB, which goes from 0 to 1");
    }

    #[test]
    fn spectra_are_numbers_or_points() {
        assert_eq!(spectrum(" 0.5 "), Ok(Spectral::Uniform(0.5)));
        let points = Spectrum::new(vec![(400.0, 1.0), (700.0, 2.0)]).unwrap();
        assert_eq!(spectrum("400:1, 700:2"), Ok(Spectral::Points(points.clone())));
        assert_eq!(spectrum_file("# nm value\n400 1\n\n700 2 # end\n"), Ok(Spectral::Points(points)));
        assert_eq!(spectrum("400:1, 700").unwrap_err(), "`700` is not like `400:0.5`");
        assert_eq!(spectrum("-1").unwrap_err(), "a spectrum is not negative (-1)");
        assert_eq!(spectrum_file("400\n").unwrap_err(), "`400` is not a wavelength and a value");
    }

    #[test]
    fn old_names_become_new() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("maxDepth", "max_depth"),
            ("to_world", "to_world"),
            ("specularReflectance", "specular_reflectance"),
        ] {
            assert_eq!(snake_case(old), new);
        }
    }
}
