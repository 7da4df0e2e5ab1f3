//! Charts of curves with bands over logarithmic axes.

use crate::report::{
    page::COLOURS,
    plot::{Axis, Labels, axes, opening, put},
    text::{escape, number},
};

/// A point with the ends of its interval.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    /// Along.
    pub x: f64,
    /// Up.
    pub y: f64,
    /// The interval's low end.
    pub low: f64,
    /// Its high end.
    pub high: f64,
}

impl Mark {
    /// A point without an interval.
    pub fn exact(x: f64, y: f64) -> Mark {
        Mark { x, y, low: y, high: y }
    }
}

/// A curve.
pub struct Curve {
    /// Its name.
    pub label: String,
    /// Which colour.
    pub colour: usize,
    /// Its points.
    pub marks: Vec<Mark>,
    /// What theory gives for them, dashed.
    pub theory: Vec<(f64, f64)>,
}

/// The chart as SVG, or a sentence if there is nothing to draw.
pub fn svg(title: &str, labels: &Labels, curves: &[Curve]) -> String {
    let shown = |m: &&Mark| m.y > 0.0 && m.y.is_finite();
    let all = || curves.iter().flat_map(|c| &c.marks).filter(shown);
    let theory = || curves.iter().flat_map(|c| &c.theory).filter(|t| t.1 > 0.0);
    let (left, right, top, bottom) = crate::report::plot::PLOT;
    let x = Axis::of(all().map(|m| m.x), left, right);
    let y = Axis::of(all().flat_map(|m| [m.low, m.high]).chain(theory().map(|t| t.1)), bottom, top);
    let (Some(x), Some(y)) = (x, y) else {
        return "<p class=\"none\">Nothing was measured.</p>".into();
    };
    let mut s = opening(title);
    axes(&mut s, &x, &y, labels);
    let path =
        |points: &[(f64, f64)]| points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ");
    for curve in curves {
        let marks: Vec<&Mark> = curve.marks.iter().filter(shown).collect();
        put(&mut s, format_args!("<g class=\"curve s{}\">", curve.colour % COLOURS));
        let upper = marks.iter().map(|m| (x.at(m.x), y.at(m.high)));
        let lower = marks.iter().rev().map(|m| (x.at(m.x), y.at(m.low)));
        put(
            &mut s,
            format_args!("<polygon class=\"band\" points=\"{}\"/>", path(&upper.chain(lower).collect::<Vec<_>>())),
        );
        let dashed: Vec<_> = curve.theory.iter().filter(|t| t.1 > 0.0).map(|t| (x.at(t.0), y.at(t.1))).collect();
        put(&mut s, format_args!("<polyline class=\"trimmed\" points=\"{}\"/>", path(&dashed)));
        let middle: Vec<_> = marks.iter().map(|m| (x.at(m.x), y.at(m.y))).collect();
        put(&mut s, format_args!("<polyline class=\"median\" points=\"{}\"/>", path(&middle)));
        for (m, (px, py)) in marks.iter().zip(middle) {
            let tip = format!("{}: {} at {}", curve.label, number(m.y), m.x);
            put(
                &mut s,
                format_args!(
                    "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"2.5\"><title>{}</title></circle>",
                    escape(&tip)
                ),
            );
        }
        s.push_str("</g>");
    }
    s + "</svg>"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::plot::power_mark;

    const LABELS: Labels = Labels { x: "samples", x_mark: power_mark, y: "variance < 1", y_mark: power_mark };

    #[test]
    fn a_chart_is_well_formed_and_leaves_out_what_has_no_logarithm() {
        let marks = vec![Mark { x: 4.0, y: 1.0, low: 0.5, high: 2.0 }, Mark::exact(16.0, 0.1), Mark::exact(64.0, 0.0)];
        let curve = Curve { label: "a & b".into(), colour: 1, marks, theory: vec![(4.0, 1.0), (64.0, 0.01)] };
        let svg = svg("<title>", &LABELS, &[curve]);
        let document = roxmltree::Document::parse(&svg).unwrap();
        assert_eq!(document.descendants().filter(|n| n.has_tag_name("circle")).count(), 2);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn nothing_to_draw_is_said() {
        assert!(svg("", &LABELS, &[]).starts_with("<p"));
    }
}
