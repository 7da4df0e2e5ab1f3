//! Numbers and text as a page shows them.

/// Text with what HTML reads as markup escaped.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}

/// A scene as it is called for short: a file without its folders.
pub fn short_scene(scene: &str) -> &str {
    scene.rsplit(['/', '\\']).next().filter(|name| !name.is_empty()).unwrap_or(scene)
}

/// An exponent in raised digits.
pub fn superscript(exponent: i32) -> String {
    let raise = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        // The other raised digits stand in order from U+2070.
        d => char::from_u32(0x2070 + d.to_digit(10).unwrap_or(0)).unwrap_or(d),
    };
    exponent.to_string().chars().map(raise).collect()
}

/// A number with three digits: `0.123`, or `1.23·10⁻⁵`.
pub fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return "–".into();
    }
    let sign = if x < 0.0 { "−" } else { "" };
    let a = x.abs();
    if (0.01..1000.0).contains(&a) {
        let digits = (2 - a.log10().floor() as i32).clamp(0, 4) as usize;
        return format!("{sign}{a:.digits$}");
    }
    // Formatting rounds and may carry into the next power of ten; the exponent is what it then says.
    let scientific = format!("{a:.2e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    format!("{sign}{mantissa}·10{}", superscript(exponent.parse().unwrap_or(0)))
}

/// A share as a percentage.
pub fn percent(x: f64) -> String {
    let sign = if x < 0.0 { "−" } else { "" };
    let a = (100.0 * x).abs();
    match a {
        a if !a.is_finite() => "–".into(),
        a if a >= 99.95 => format!("{sign}{a:.0} %"),
        a if a >= 0.095 => format!("{sign}{a:.1} %"),
        a if a >= 0.0095 => format!("{sign}{a:.2} %"),
        0.0 => "0 %".into(),
        _ => format!("{sign}{} %", number(a)),
    }
}

/// A count with a letter for its magnitude.
pub fn count(n: u64) -> String {
    match n as f64 {
        x if x >= 1e9 => format!("{:.2} G", x / 1e9),
        x if x >= 1e6 => format!("{:.1} M", x / 1e6),
        x if x >= 1e4 => format!("{:.0} k", x / 1e3),
        x => format!("{x:.0}"),
    }
}

/// Bytes.
pub fn bytes(n: u64) -> String {
    format!("{:.0} MB", n as f64 / 1e6)
}

/// A file as a `data:` URL.
pub fn png_url(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(png))
}

/// Base64 [RFC 4648, sec. 4].
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let group = chunk.iter().fold(0u32, |g, b| g << 8 | u32::from(*b)) << (8 * (3 - chunk.len()));
        for i in 0..4 {
            let digit = DIGITS[(group >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_matches_the_standard() {
        for (text, code) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(text.as_bytes()), code);
        }
    }

    #[test]
    fn numbers_read_well() {
        let cases = [
            (0.0, "0"),
            (0.1234, "0.123"),
            (-12.34, "−12.3"),
            (999.4, "999"),
            (1.234e-5, "1.23·10⁻⁵"),
            (9.999e-7, "1.00·10⁻⁶"),
        ];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
        assert_eq!(superscript(-1045), "⁻¹⁰⁴⁵");
        assert_eq!([percent(1.0), percent(0.1234), percent(-0.0002)], ["100 %", "12.3 %", "−0.02 %"]);
    }

    #[test]
    fn scenes_are_called_for_short() {
        assert_eq!(["a/b/c.xml", "ring:light=0.1", "x/"].map(short_scene), ["c.xml", "ring:light=0.1", "x/"]);
    }

    #[test]
    fn markup_is_escaped() {
        assert_eq!(escape("<a href=\"x\">'&'"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;");
    }
}
