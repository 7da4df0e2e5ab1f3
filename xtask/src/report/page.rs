//! The page's markup.

use crate::{
    clock::human_seconds,
    report::{
        RunFacts, Section, Series, TARGETS,
        advice::Advice,
        analysis::{Reach, SlopeFit},
        chart::{self, Chart, Curve},
        images, reach_text,
        text::{bytes, count, escape, number, percent, png_url, short_scene, superscript},
    },
};

/// The style sheet of pages and charts.
pub const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// How many curves have colours of their own.
pub const COLOURS: usize = 12;

/// The page of all scenes.
pub fn html(sections: &[Section], advice: &[Advice], run: &RunFacts) -> String {
    let body: String = sections.iter().enumerate().map(|(i, s)| section(i, s)).collect();
    let lead = format!("Rendering error over time, from independent replicates, for {}.", scenes_text(sections));
    let body = format!("{}{}{body}{}", in_short(advice, run), summary(sections), about(run));
    document("What accuracy costs", &lead, &body)
}

/// A page that needs nothing else: its heading, a sentence below it, and markup.
pub fn document(heading: &str, lead: &str, body: &str) -> String {
    let heading = escape(heading);
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><title>Étendue: {heading}</title>\
         <style>{STYLE}</style></head><body><header><h1>{heading}</h1>\
         <p class=\"lead\">{}</p></header><main>{body}</main>\
         <script>{SCRIPT}</script></body></html>\n",
        escape(lead)
    )
}

/// The advice, with the light that is left out.
fn in_short(advice: &[Advice], run: &RunFacts) -> String {
    let item = |a: &Advice| format!("<li>{}</li>", escape(&a.text));
    let items: String = advice.iter().map(item).collect();
    let list = |gaps: &[String]| gaps.iter().map(|gap| format!("<li>{}</li>", escape(gap))).collect::<String>();
    let gaps = match &run.gaps[..] {
        [] => String::new(),
        gaps => format!("<h3>Light that is left out</h3><ul class=\"note\">{}</ul>", list(gaps)),
    };
    format!(
        "<section class=\"card\"><h2>In short</h2><ul>{items}</ul><p class=\"note\">An error of 3 % is a relMSE of 10⁻³; the \
         table below says more. Seconds are those of this machine.</p>{gaps}</section>"
    )
}

fn scenes_text(sections: &[Section]) -> String {
    let n = sections.len();
    if n == 1 { "one scene".into() } else { format!("{n} scenes") }
}

fn summary(sections: &[Section]) -> String {
    let rows: String = sections.iter().enumerate().map(|(i, s)| summary_rows(i, s)).collect();
    let targets = target_heads();
    format!(
        "<section class=\"card\"><h2>Time to reach an error of 10 %, 3 %, 1 %</h2><div class=\"scroll\"><table class=\"summary\"><thead><tr><th></th>\
         <th>scene</th><th>technique</th>{targets}<th class=\"n\">relMSE</th><th class=\"n\">after</th>\
         <th class=\"n\">slope<br><small>independent: −1</small></th></tr></thead><tbody>{rows}</tbody></table></div>\
         <p class=\"note\">An error of 10 %, 3 % or 1 % is a relMSE of 10⁻², 10⁻³ or 10⁻⁴: the mean over pixels of \
         (image − reference)² / (reference² + 0.01). <span class=\"beyond\">~</span> is extrapolated beyond the time \
         measured; &lt; came with the first pass; <em>below noise</em>: the reference itself is not that exact; \
         <em>unclear</em>: the error falls too unevenly to extrapolate. Times include building.</p></section>"
    )
}

/// The heads of the columns of times: an error as a percentage, and what that means.
fn target_heads() -> String {
    let head = |(relmse, name): &(f64, &str)| {
        let exponent = superscript(relmse.log10().round() as i32);
        format!("<th class=\"n\">to {name}<br><small>relMSE 10{exponent}</small></th>")
    };
    TARGETS.iter().map(head).collect()
}

fn summary_rows(index: usize, section: &Section) -> String {
    let picture = &section.reference.picture;
    let thumbnail = png_url(&picture.png(picture.exposure()));
    let n = section.series.len();
    let head = format!(
        "<td class=\"thumb\" rowspan=\"{n}\"><img src=\"{thumbnail}\" alt=\"\"></td>\
         <td rowspan=\"{n}\"><a href=\"#scene{index}\">{}</a></td>",
        escape(short_scene(&section.facts.scene))
    );
    let row = |(i, s): (usize, &Series)| {
        let end = s.end();
        format!(
            "<tr>{}<td class=\"name\">{}{}</td>{}<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>",
            if i == 0 { head.as_str() } else { "" },
            swatch(i),
            name(s),
            reach_cells(s),
            number(end.relmse.1),
            human_seconds(end.seconds),
            slope(s.slope),
        )
    };
    section.series.iter().enumerate().map(row).collect()
}

/// A patch of a curve's colour.
pub fn swatch(index: usize) -> String {
    format!("<span class=\"swatch s{}\"></span>", index % COLOURS)
}

fn reach_cells(series: &Series) -> String {
    let cell = |r: &Reach| {
        let class = match r {
            Reach::AtOnce(_) | Reach::Within(_) => "n within",
            Reach::Beyond(_) => "n beyond",
            Reach::BelowNoise | Reach::Unclear | Reach::Never => "n none",
        };
        format!("<td class=\"{class}\">{}</td>", escape(&reach_text(*r)))
    };
    series.reach.iter().map(cell).collect()
}

fn slope(fit: Option<SlopeFit>) -> String {
    let signed = |x: f64| format!("{x:.2}").replace('-', "−");
    match fit {
        Some(SlopeFit { slope, half_width: Some(h) }) => format!("{} <small>± {h:.2}</small>", signed(slope)),
        Some(SlopeFit { slope, half_width: None }) => format!("{} <small>one replicate</small>", signed(slope)),
        None => "–".into(),
    }
}

fn section(index: usize, section: &Section) -> String {
    let f = &section.facts;
    let depth = if f.depth == u32::MAX { "no bound on depth".into() } else { format!("depth {}", f.depth) };
    let curves = section.series.iter().map(|s| Curve { label: &s.label, points: &s.points }).collect();
    let title = format!("relMSE over seconds: {}", f.scene);
    let chart = chart::svg(&Chart { title: &title, curves, noise: f.own_relmse, targets: &TARGETS });
    let legend: String = section.series.iter().enumerate().map(|(i, s)| legend_entry(i, s)).collect();
    let figures: String = section.series.iter().map(|s| images::figure(section, s)).collect();
    format!(
        "<section class=\"card\" id=\"scene{index}\"><h2>{} <small>{}×{}, {depth}</small></h2>\
         <div class=\"top\"><div class=\"plot\"><div class=\"legend\">{legend}</div>{chart}\
         <p class=\"note\">{} Dashed, without the worst 0.1 % of the pixels: far below the line, few pixels hold the error.</p></div>\
         <aside>{}{}</aside></div><div class=\"figures\">{figures}</div>{}{}</section>",
        escape(short_scene(&f.scene)),
        f.width,
        f.height,
        replicates(section),
        census(section),
        reference(section),
        errors(section),
        checkpoints(section),
    )
}

fn legend_entry(index: usize, series: &Series) -> String {
    format!("<span>{}{} <small>slope {}</small></span>", swatch(index), name(series), slope(series.slope))
}

/// A series' technique, and in small letters what else tells it apart.
fn name(series: &Series) -> String {
    match series.label.split_once(' ') {
        Some((technique, rest)) => format!("{} <small>{}</small>", escape(technique), escape(rest)),
        None => escape(&series.label),
    }
}

/// The number of replicates behind the lines and bands of a chart.
fn replicates(section: &Section) -> String {
    let counts = section.series.iter().map(|s| s.end().replicates);
    let (least, most) = (counts.clone().min().unwrap_or(0), counts.max().unwrap_or(0));
    match (least, most) {
        (1, 1) => "Of one replicate each.".into(),
        (least, most) if least == most => format!("Lines: the median of {most} replicates; bands: their range."),
        (least, most) => format!("Lines: the median of {least} to {most} replicates; bands: their range."),
    }
}

fn census(section: &Section) -> String {
    let line = |l: &str| {
        let class = if is_absent(l) { " class=\"absent\"" } else { "" };
        format!("<li{class}>{}</li>", escape(l.trim()))
    };
    let lines: String = section.facts.census.lines().filter(|l| !l.trim().is_empty()).map(line).collect();
    let notes: String = section.facts.notes.iter().map(|n| format!("<p class=\"warn\">{}</p>", escape(n))).collect();
    format!("<h3>What the scene calls for</h3><ul class=\"census\">{lines}</ul>{notes}")
}

/// Whether a line of the census says that there is none of something: `instances: 0`, `environment: none`.
fn is_absent(line: &str) -> bool {
    let value = line.split_once(':').map_or("", |(_, value)| value.trim());
    let zeros = |v: &str| !v.is_empty() && v.split(',').all(|n| matches!(n.split_whitespace().next(), Some("0")));
    value.starts_with("none") || zeros(value)
}

fn reference(section: &Section) -> String {
    let f = &section.facts;
    let time = if f.seconds > 0.0 { format!(", {}", human_seconds(f.seconds)) } else { String::new() };
    let own = match f.own_relmse {
        Some(e) => format!("Its own relMSE is {}; errors near it say only “converged”.", number(e)),
        None => "Its own error is not known.".into(),
    };
    let mut note = if f.note.is_empty() { String::new() } else { format!("<p class=\"warn\">{}</p>", escape(&f.note)) };
    if !f.region.is_empty() {
        note += &format!("<p class=\"warn\">Errors are measured {} alone.</p>", escape(&f.region));
    }
    format!("<h3>Reference</h3><p>{}{}. {own}</p>{note}", escape(&f.made), escape(&time))
}

fn errors(section: &Section) -> String {
    let targets = target_heads();
    let columns = [
        "relMSE",
        "trimmed",
        "share trimmed",
        "SMAPE",
        "MSE",
        "bias²",
        "variance",
        "mean error",
        "build",
        "CPU",
        "rays",
        "memory",
        "rejected",
    ];
    let head: String = columns.iter().map(|c| format!("<th class=\"n\">{c}</th>")).collect();
    let row = |(i, s): (usize, &Series)| {
        let l = &s.end().typical;
        let cells = [
            number(s.end().relmse.1),
            number(l.relmse_trimmed),
            percent(l.trimmed_share),
            number(l.smape),
            number(l.mse),
            l.bias2.map_or("–".into(), number),
            l.variance.map_or("–".into(), number),
            percent(l.mean_error_relative),
            human_seconds(l.build_seconds),
            human_seconds(l.cpu_seconds),
            count(l.rays),
            l.peak_bytes.map_or("–".into(), bytes),
            count(l.rejected),
        ];
        let cells: String = cells.iter().map(|c| format!("<td class=\"n\">{c}</td>")).collect();
        let name = format!("{}{}", swatch(i), name(s));
        (
            format!("<tr><td>{name}</td>{}<td class=\"n\">{}</td></tr>", reach_cells(s), slope(s.slope)),
            format!("<tr><td>{name}</td>{cells}</tr>"),
        )
    };
    let (reach, rows): (String, String) = section.series.iter().enumerate().map(row).unzip();
    format!(
        "<h3>Time to reach an error</h3><div class=\"scroll\"><table><thead><tr><th>technique</th>{targets}\
         <th class=\"n\">slope of relMSE over passes, 95 % interval</th></tr></thead><tbody>{reach}</tbody></table></div>\
         <h3>Errors at the end</h3><div class=\"scroll\"><table class=\"dense\"><thead><tr><th>technique</th>{head}</tr></thead>\
         <tbody>{rows}</tbody></table></div>\
         <p class=\"note\">Of the replicate with the median relMSE. Trimmed: without the worst 0.1 % of the pixels, which hold \
         the share of the error beside it. Bias² (an estimate that scatters about 0 where there is none, with the \
         reference’s own error in it) and variance are over all replicates and add up to their mean MSE. The mean error is \
         relative to the reference’s mean.</p>"
    )
}

fn checkpoints(section: &Section) -> String {
    let rows = section.series.iter().enumerate().flat_map(|(i, s)| {
        s.points.iter().map(move |p| {
            format!(
                "<tr><td>{}{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
                 <td class=\"n\">{} – {}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>",
                swatch(i),
                escape(&s.label),
                p.passes,
                human_seconds(p.seconds),
                number(p.relmse.1),
                number(p.relmse.0),
                number(p.relmse.2),
                number(p.typical.smape),
                p.replicates
            )
        })
    });
    format!(
        "<details><summary>All checkpoints</summary><div class=\"scroll\"><table><thead><tr><th>technique</th>\
         <th class=\"n\">passes</th><th class=\"n\">seconds</th><th class=\"n\">relMSE</th><th class=\"n\">least – greatest</th>\
         <th class=\"n\">SMAPE</th><th class=\"n\">replicates</th></tr></thead><tbody>{}</tbody></table></div></details>",
        rows.collect::<String>()
    )
}

fn about(run: &RunFacts) -> String {
    format!(
        "<section class=\"card\"><h2>What was run</h2><p><code>{}</code></p><p>{} thread{} on {}. On the clock: building the scene and \
         the technique, and the passes. Off it: loading, errors, files. The first replicate of each technique takes the time \
         given; the others make as many passes with other seeds.</p></section>",
        escape(&run.command),
        run.threads,
        if run.threads == 1 { "" } else { "s" },
        escape(&run.processor)
    )
}

#[cfg(test)]
mod tests {
    use super::is_absent;

    #[test]
    fn what_a_scene_lacks_is_seen() {
        for line in
            ["instances: 0", "point, spot, projector, directional lights: 0, 0, 0, 0", "caustics: none (0 casters)"]
        {
            assert!(is_absent(line), "{line}");
        }
        for line in ["triangles: 36", "lights: 0, 1, 0", "lens: pinhole", "nothing", "lambert: 10 objects"] {
            assert!(!is_absent(line), "{line}");
        }
    }
}
