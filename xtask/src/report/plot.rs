//! What charts are made of: SVG, both axes logarithmic, colours by style sheet.

use crate::report::text::{escape, superscript};
use std::fmt::Write;

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 430.0;
/// Left, right, top and bottom of the plot.
pub const PLOT: (f64, f64, f64, f64) = (82.0, 704.0, 16.0, 382.0);

/// A logarithmic axis: from values to pixels.
pub struct Axis {
    /// Logarithm to base 10 of the least value shown.
    pub low: f64,
    /// Of the greatest.
    pub high: f64,
    start: f64,
    end: f64,
}

impl Axis {
    /// An axis that shows all values, with a margin; of at least a decade.
    pub fn of(values: impl Iterator<Item = f64>, start: f64, end: f64) -> Option<Axis> {
        let logs = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return None;
        }
        let margin = 0.06 * (high - low) + (1.0 - (high - low)).max(0.0) / 2.0;
        Some(Axis { low: low - margin, high: high + margin, start, end })
    }

    /// The pixel of a value.
    pub fn at(&self, value: f64) -> f64 {
        self.start + (value.log10() - self.low) / (self.high - self.low) * (self.end - self.start)
    }

    /// Values to mark: whole decades, and 2 and 5 between them where there is room.
    fn marks(&self) -> Vec<f64> {
        let multiples: &[f64] = if self.high - self.low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let all = decades.flat_map(|d| multiples.iter().map(move |m| m * 10f64.powi(d)));
        all.filter(|v| (self.low..=self.high).contains(&v.log10())).collect()
    }
}

/// What the axes are of, and how values on them are written.
pub struct Labels<'a> {
    /// Of the horizontal axis.
    pub x: &'a str,
    /// Its values.
    pub x_mark: fn(f64) -> String,
    /// Of the vertical axis.
    pub y: &'a str,
    /// Its values.
    pub y_mark: fn(f64) -> String,
}

/// The beginning of a chart, with what it is of for those who do not see it.
pub fn opening(title: &str) -> String {
    format!("<svg class=\"chart\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">", escape(title))
}

/// A value on an axis as a power of ten, `2·10⁻³`.
pub fn power_mark(value: f64) -> String {
    let decade = (value.log10() + 1e-9).floor() as i32;
    let multiple = (value / 10f64.powi(decade)).round();
    let power = format!("10{}", superscript(decade));
    if multiple == 1.0 { power } else { format!("{multiple:.0}·{power}") }
}

/// Adds formatted text.
pub fn put(s: &mut String, text: std::fmt::Arguments) {
    s.write_fmt(text).expect("a string takes any text");
}

/// The frame with its grid, marks and names.
pub fn axes(s: &mut String, x: &Axis, y: &Axis, labels: &Labels) {
    let (left, right, top, bottom) = PLOT;
    for v in x.marks() {
        let at = x.at(v);
        put(s, format_args!("<line class=\"grid\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{top}\" y2=\"{bottom}\"/>"));
        put(
            s,
            format_args!("<text class=\"tick x\" x=\"{at:.1}\" y=\"{}\">{}</text>", bottom + 18.0, (labels.x_mark)(v)),
        );
    }
    for v in y.marks() {
        let at = y.at(v);
        put(s, format_args!("<line class=\"grid\" x1=\"{left}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>"));
        put(
            s,
            format_args!(
                "<text class=\"tick y\" x=\"{}\" y=\"{:.1}\">{}</text>",
                left - 8.0,
                at + 4.0,
                (labels.y_mark)(v)
            ),
        );
    }
    let (w, h) = (right - left, bottom - top);
    put(s, format_args!("<rect class=\"frame\" x=\"{left}\" y=\"{top}\" width=\"{w}\" height=\"{h}\"/>"));
    let (mx, my) = (0.5 * (left + right), 0.5 * (top + bottom));
    put(s, format_args!("<text class=\"axis\" x=\"{mx}\" y=\"{}\">{}</text>", bottom + 40.0, escape(labels.x)));
    put(
        s,
        format_args!("<text class=\"axis\" transform=\"translate(18 {my}) rotate(-90)\">{}</text>", escape(labels.y)),
    );
}
