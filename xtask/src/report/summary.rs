//! The summary of a study, for programs and terminals.

use crate::{
    clock::human_seconds,
    report::{Section, Series, TARGETS, analysis::Reach, reach_text, text::short_scene},
};
use serde::Serialize;

/// A line of the summary, for programs and terminals.
#[derive(Clone, Debug, Serialize)]
pub struct SummaryRow {
    scene: String,
    technique: String,
    replicates: usize,
    passes: u32,
    seconds: f64,
    relmse: f64,
    reference_relmse: Option<f64>,
    slope: Option<f64>,
    slope_half_width: Option<f64>,
    seconds_to_reach: [ReachRow; 3],
}

#[derive(Clone, Debug, Serialize)]
struct ReachRow {
    relmse: f64,
    #[serde(skip)]
    text: String,
    seconds: Option<f64>,
    kind: &'static str,
}

impl SummaryRow {
    /// That of a technique on a scene.
    pub fn of(section: &Section, series: &Series) -> SummaryRow {
        let end = series.end();
        let row = |(reach, (relmse, _)): (Reach, (f64, &str))| ReachRow {
            relmse,
            text: reach_text(reach),
            seconds: reach.seconds(),
            kind: match reach {
                Reach::AtOnce(_) => "at once",
                Reach::Within(_) => "measured",
                Reach::Beyond(_) => "extrapolated",
                Reach::BelowNoise => "below the reference's own error",
                Reach::Unclear => "too uneven to extrapolate",
                Reach::Never => "not reached",
            },
        };
        let [a, b, c] = [0, 1, 2].map(|i| row((series.reach[i], TARGETS[i])));
        SummaryRow {
            scene: section.facts.scene.clone(),
            technique: series.label.clone(),
            replicates: end.replicates,
            passes: end.passes,
            seconds: end.seconds,
            relmse: end.relmse.1,
            reference_relmse: section.facts.own_relmse,
            slope: series.slope.map(|s| s.slope),
            slope_half_width: series.slope.and_then(|s| s.half_width),
            seconds_to_reach: [a, b, c],
        }
    }
}

/// The meaning of the columns of times, above their heads.
const LEGEND: &str = "\
to 10 %, 3 %, 1 %: time until the error is that, building included. The error is the root of relMSE, the mean over pixels
and channels of (image - reference)^2 / (reference^2 + 0.01), without the reference's own part; relMSE at 3 % is 10^-3.
  ~ 5 s        extrapolated beyond the time measured, along the slope of relMSE over passes
  < 5 s        with the first pass
  unclear      the error falls too unevenly to extrapolate
  below noise  the reference itself is not that exact: at most, converged to it
";

/// Rows with heads and the meaning of the columns, aligned.
pub fn table(rows: &[SummaryRow]) -> String {
    let names = TARGETS.map(|(_, name)| format!("to {name}"));
    let [a, b, c] = names.each_ref().map(String::as_str);
    let heads = ["scene", "technique", "relMSE", "after", a, b, c, "slope"].map(str::to_owned);
    let mut lines = vec![heads];
    lines.extend(rows.iter().map(SummaryRow::columns));
    let widths: [usize; 8] = std::array::from_fn(|i| lines.iter().map(|l| l[i].chars().count()).max().unwrap_or(0));
    let line = |cells: &[String; 8]| {
        let cells = cells.iter().zip(widths).enumerate().map(|(i, (cell, width))| match i {
            0 | 1 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ")
    };
    let lines: Vec<String> = lines.iter().map(line).collect();
    format!("{LEGEND}\n{}", lines.join("\n"))
}

impl SummaryRow {
    fn columns(&self) -> [String; 8] {
        let slope = match (self.slope, self.slope_half_width) {
            (Some(s), Some(h)) => format!("{s:.2} ± {h:.2}"),
            (Some(s), None) => format!("{s:.2}"),
            (None, _) => "none".into(),
        };
        let [a, b, c] = self.seconds_to_reach.each_ref().map(|r| r.text.clone());
        let scene = short_scene(&self.scene).to_owned();
        let error = format!("{:.2e}", self.relmse);
        [scene, self.technique.clone(), error, human_seconds(self.seconds), a, b, c, slope]
    }
}
