//! The chart of error over time: SVG, both axes logarithmic, colours by style sheet.

use crate::{
    clock::human_seconds,
    report::{
        analysis::Point,
        page::COLOURS,
        plot::{Axis, Labels, PLOT, axes, opening, power_mark, put},
        text::{escape, number},
    },
};

/// A curve.
pub struct Curve<'a> {
    /// Its name.
    pub label: &'a str,
    /// Its points.
    pub points: &'a [Point],
}

/// What a chart shows beside its curves.
pub struct Chart<'a> {
    /// What it is of, for those who do not see it.
    pub title: &'a str,
    /// The curves, in the order of their colours.
    pub curves: Vec<Curve<'a>>,
    /// The reference's own relMSE, if known.
    pub noise: Option<f64>,
    /// Errors that are marked, with their names.
    pub targets: &'a [(f64, &'a str)],
}

const LABELS: Labels = Labels { x: "seconds, building included", x_mark: time_mark, y: "relMSE", y_mark: power_mark };

fn time_mark(value: f64) -> String {
    match value {
        v if v < 1e-4 => format!("{:.0} µs", v * 1e6),
        v if v < 0.999e-3 => format!("{:.1} ms", v * 1e3),
        v if v < 0.999 => format!("{:.0} ms", v * 1e3),
        v => format!("{v:.0} s"),
    }
}

/// The chart as SVG, or a sentence if there is nothing to draw.
pub fn svg(chart: &Chart) -> String {
    let (left, right, top, bottom) = PLOT;
    let all = || chart.curves.iter().flat_map(|c| c.points);
    let errors = || all().flat_map(|p| [p.relmse.0, p.relmse.2, p.trimmed]).filter(|e| *e > 0.0);
    // What is less than two decades below the curves is shown with them.
    let least = errors().fold(f64::INFINITY, f64::min);
    let marks = chart.targets.iter().map(|t| t.0).chain(chart.noise).filter(|m| (0.01 * least..least).contains(m));
    let y = Axis::of(errors().chain(marks.filter(|_| least.is_finite())), bottom, top);
    let (Some(x), Some(y)) = (Axis::of(all().map(|p| p.seconds), left, right), y) else {
        return "<p class=\"none\">No checkpoint has an error above zero: there is nothing to draw.</p>".into();
    };
    let mut s = opening(chart.title);
    axes(&mut s, &x, &y, &LABELS);
    let shown = |v: f64| v > 0.0 && (y.low..=y.high).contains(&v.log10());
    for (value, name) in chart.targets.iter().filter(|t| shown(t.0)) {
        let at = y.at(*value);
        put(
            &mut s,
            format_args!("<line class=\"target\" x1=\"{left}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>"),
        );
        put(
            &mut s,
            format_args!("<text class=\"target\" x=\"{}\" y=\"{:.1}\">{}</text>", right + 6.0, at + 4.0, escape(name)),
        );
    }
    if let Some(noise) = chart.noise.filter(|n| shown(*n)) {
        let at = y.at(noise);
        put(&mut s, format_args!("<line class=\"noise\" x1=\"{left}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>"));
        let label = "the reference’s own error";
        put(&mut s, format_args!("<text class=\"noise\" x=\"{}\" y=\"{:.1}\">{label}</text>", left + 8.0, at - 6.0));
    }
    guide(&mut s, chart, &x, &y);
    for (i, curve) in chart.curves.iter().enumerate() {
        draw_curve(&mut s, i, curve, &x, &y);
    }
    s + "</svg>"
}

/// A line of slope -1 through the first curve's last point: what independent samples promise.
fn guide(s: &mut String, chart: &Chart, x: &Axis, y: &Axis) {
    let last = chart.curves.iter().filter_map(|c| c.points.last()).find(|p| p.relmse.1 > 0.0);
    let Some(point) = last else { return };
    let sum = point.seconds.log10() + point.relmse.1.log10();
    // Cut to the plot, in logarithms: the line is where their sum is constant.
    let (from, to) = (x.low.max(sum - y.high), x.high.min(sum - y.low));
    if from >= to {
        return;
    }
    let at = |lx: f64| (x.at(10f64.powf(lx)), y.at(10f64.powf(sum - lx)));
    let ((x1, y1), (x2, y2)) = (at(from), at(to));
    put(s, format_args!("<line class=\"guide\" x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\"/>"));
    let (lx, ly) = at(from + 0.06 * (to - from));
    let angle = (y2 - y1).atan2(x2 - x1).to_degrees();
    put(
        s,
        format_args!(
            "<text class=\"guide\" transform=\"translate({lx:.1} {ly:.1}) rotate({angle:.1})\" y=\"-6\">slope −1</text>"
        ),
    );
}

fn draw_curve(s: &mut String, index: usize, curve: &Curve, x: &Axis, y: &Axis) {
    let points: Vec<&Point> = curve.points.iter().filter(|p| p.relmse.0 > 0.0).collect();
    put(s, format_args!("<g class=\"curve s{}\">", index % COLOURS));
    let path =
        |points: &[(f64, f64)]| points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ");
    let upper = points.iter().map(|p| (x.at(p.seconds), y.at(p.relmse.2)));
    let lower = points.iter().rev().map(|p| (x.at(p.seconds), y.at(p.relmse.0)));
    put(s, format_args!("<polygon class=\"band\" points=\"{}\"/>", path(&upper.chain(lower).collect::<Vec<_>>())));
    let trimmed = points.iter().filter(|p| p.trimmed > 0.0).map(|p| (x.at(p.seconds), y.at(p.trimmed)));
    put(s, format_args!("<polyline class=\"trimmed\" points=\"{}\"/>", path(&trimmed.collect::<Vec<_>>())));
    let middle: Vec<_> = points.iter().map(|p| (x.at(p.seconds), y.at(p.relmse.1))).collect();
    put(s, format_args!("<polyline class=\"median\" points=\"{}\"/>", path(&middle)));
    for (p, (px, py)) in points.iter().zip(middle) {
        let tip = format!(
            "{}: {} passes, {}, relMSE {} ({} to {} over {} replicates)",
            curve.label,
            p.passes,
            human_seconds(p.seconds),
            number(p.relmse.1),
            number(p.relmse.0),
            number(p.relmse.2),
            p.replicates
        );
        put(
            s,
            format_args!("<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"3.5\"><title>{}</title></circle>", escape(&tip)),
        );
    }
    s.push_str("</g>");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{report::analysis::points, study::results::tests::cell};

    #[test]
    fn a_chart_is_well_formed_and_escaped() {
        let cells = [cell("a", 0, 0.1, 6), cell("a", 1, 0.2, 6)];
        let points = points(&cells.iter().collect::<Vec<_>>());
        let curves = vec![Curve { label: "<path> & co", points: &points }];
        let chart = Chart { title: "\"a\"", curves, noise: Some(5e-3), targets: &[(0.01, "10 %"), (1e-9, "never")] };
        let svg = svg(&chart);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let count = |class: &str| document.descendants().filter(|n| n.attribute("class") == Some(class)).count();
        assert_eq!((count("band"), count("median"), count("guide"), count("noise")), (1, 1, 2, 2));
        assert_eq!(count("trimmed"), 1);
        assert_eq!(document.descendants().filter(|n| n.has_tag_name("circle")).count(), 6);
        assert!(svg.contains("10 %") && !svg.contains("never"));
        for n in document.descendants() {
            for a in ["x1", "x2", "cx"].iter().filter_map(|a| n.attribute(*a)) {
                assert!((PLOT.0 - 0.1..=PLOT.1 + 0.1).contains(&a.parse().unwrap()), "{a}");
            }
        }
    }

    #[test]
    fn nothing_to_draw_is_said() {
        let exact = cell("a", 0, 0.0, 3);
        let points = points(&[&exact]);
        let curves = vec![Curve { label: "path", points: &points }];
        assert!(svg(&Chart { title: "", curves, noise: None, targets: &[] }).starts_with("<p"));
    }

    #[test]
    fn one_point_is_drawn() {
        let one = cell("a", 0, 0.5, 1);
        let points = points(&[&one]);
        let curves = vec![Curve { label: "path", points: &points }];
        let svg = svg(&Chart { title: "", curves, noise: None, targets: &[] });
        assert!(roxmltree::Document::parse(&svg).is_ok() && !svg.contains("NaN"));
    }
}
