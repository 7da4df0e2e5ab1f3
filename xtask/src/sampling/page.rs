//! The page of the study.

use super::{
    Measured, Results,
    chart::{Curve, Mark, svg},
    convergence::{FIT_FROM, INTEGRANDS, SLOW_MOST},
    penumbra::{Penumbra, SAMPLES},
    pictures::{COUNTS, POINTS, Pictures, REALISATIONS},
};
use crate::{
    clock::human_seconds,
    report::{
        page::{STYLE, document, swatch},
        plot::{Labels, power_mark},
        text::{escape, number, percent, png_url},
    },
};
use etendue_sampling::{integrands::Integrand, pattern::Pattern};

/// How it was run.
pub struct Facts {
    /// Threads.
    pub threads: usize,
    /// The processor.
    pub processor: String,
    /// Seconds in all.
    pub seconds: f64,
}

/// The whole page.
pub fn html(results: &Results, penumbrae: &[Penumbra], pictures: &Pictures, facts: &Facts) -> String {
    let body = [
        slopes(results),
        convergence(results),
        lights(penumbrae),
        points(results, pictures),
        resampling(results),
        allocation(results),
        about(results, facts),
    ];
    let lead = "Variance, spectra and images of every sample pattern, measured against theory.";
    document("What sample patterns buy", lead, &body.concat())
}

fn card(title: &str, content: &str, note: &str) -> String {
    format!("<section class=\"card\"><h2>{title}</h2>{content}<p class=\"note\">{note}</p></section>")
}

fn table(head: &[&str], rows: &str) -> String {
    let head: String = head
        .iter()
        .enumerate()
        .map(|(i, h)| format!("<th{}>{}</th>", if i == 0 { "" } else { " class=\"n\"" }, escape(h)))
        .collect();
    format!(
        "<div class=\"scroll\"><table class=\"dense\"><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"
    )
}

fn row(name: &str, cells: impl IntoIterator<Item = String>) -> String {
    let cells: String = cells.into_iter().map(|c| format!("<td class=\"n\">{c}</td>")).collect();
    format!("<tr><td>{name}</td>{cells}</tr>")
}

fn pattern_name(index: usize) -> String {
    format!("{}{}", swatch(index), Pattern::ALL[index].name())
}

/// A row for each pattern.
fn by_pattern(cells: impl Fn(usize, &'static str) -> Vec<String>) -> String {
    Pattern::ALL.iter().enumerate().map(|(i, p)| row(&pattern_name(i), cells(i, p.name()))).collect()
}

fn legend() -> String {
    let entries: String = (0..Pattern::ALL.len()).map(|i| format!("<span>{}</span>", pattern_name(i))).collect();
    format!("<div class=\"legend\">{entries}</div>")
}

fn interval(m: &Measured) -> String {
    format!("{} <small>{} to {}</small>", number(m.mean), number(m.low), number(m.high))
}

fn slopes(results: &Results) -> String {
    let names = INTEGRANDS.map(Integrand::name);
    let head: Vec<&str> = std::iter::once("pattern").chain(names).collect();
    let cell = |pattern: &str, integrand: &str| {
        let series = results.convergence.iter().find(|s| s.pattern == pattern && s.integrand == integrand);
        series.map_or("–".into(), super::convergence::Series::slope_text)
    };
    let rows = by_pattern(|_, pattern| names.iter().map(|i| cell(pattern, i)).collect());
    let note = format!(
        "The exponent of variance over samples, fitted to powers of four from {FIT_FROM} on, with its interval of 95 %. Theory: \
         independent −1; jittered −1.5 on edges and −2 on what is smooth in two dimensions; Owen-scrambled Sobol points \
         −3 on what is smooth, but for a logarithm; best candidates −1 in the end. Of poisson-disk and best-candidate, \
         points go to {SLOW_MOST}; in four and more dimensions samplers are measured, which draw numbers in pairs. The grid has \
         nothing random as points: its squared error is fitted."
    );
    card("Slopes", &table(&head, &rows), &note)
}

const OVER_SAMPLES: Labels = Labels { x: "samples", x_mark: whole, y: "variance", y_mark: power_mark };

fn whole(x: f64) -> String {
    format!("{x}")
}

fn curves(results: &Results, integrand: Integrand) -> Vec<Curve> {
    let of = |s: &&super::convergence::Series| s.integrand == integrand.name();
    let curve = |s: &super::convergence::Series| Curve {
        label: s.pattern.into(),
        colour: Pattern::ALL.iter().position(|p| p.name() == s.pattern).unwrap_or(0),
        marks: s.levels.iter().map(|l| mark(l.samples, &l.variance)).collect(),
        theory: vec![],
    };
    results.convergence.iter().filter(of).map(curve).collect()
}

fn mark(x: u32, m: &Measured) -> Mark {
    Mark { x: x.into(), y: m.mean, low: m.low, high: m.high }
}

fn convergence(results: &Results) -> String {
    let chart = |integrand: Integrand| {
        let title = format!("variance over samples: {}", integrand.name());
        format!("<div><h3>{}</h3>{}</div>", integrand.name(), svg(&title, &OVER_SAMPLES, &curves(results, integrand)))
    };
    let charts: String = INTEGRANDS.into_iter().map(chart).collect();
    let note = "Mean squared error over many trials, with its interval of 95 %. Smooth: products of eˣ. Gaussian: a bump. Edge, \
                corner and disk: 1 inside and 0 outside, as a pixel’s coverage.";
    card("Variance against samples", &format!("{}<div class=\"charts\">{charts}</div>", legend()), note)
}

/// The chart of the edge as a picture that stands alone.
pub fn standalone_slopes(results: &Results) -> String {
    let chart = svg("variance over samples: edge", &OVER_SAMPLES, &curves(results, Integrand::Edge));
    // A file of its own says what it is made of; in a page that is known.
    chart.replacen(
        '>',
        &format!(" xmlns=\"http://www.w3.org/2000/svg\"><style>{STYLE} svg {{ background: var(--card); font-family: sans-serif; }}</style>"),
        1,
    )
}

fn lights(penumbrae: &[Penumbra]) -> String {
    let sections: String = penumbrae.iter().map(light).collect();
    let size = penumbrae.first().map_or(0, |p| p.truth.size.x);
    let note = format!(
        "A floor under a light, half of which a screen hides: {size} × {size} pixels, {} samples of a pixel and {} of the light for \
         each. Mean squared error against quadrature, relative to the open floor’s brightness, over images with other seeds; \
         blocks are the means of 4 × 4 pixels, in which errors that neighbours share out cancel.",
        SAMPLES.0, SAMPLES.1
    );
    card("Visibility of area lights", &sections, &note)
}

fn light(penumbra: &Penumbra) -> String {
    let figure = |url: String, name: &str, text: String| {
        format!(
            "<figure><img src=\"{url}\" alt=\"{name}\"><figcaption>{name}<br><small>{text}</small></figcaption></figure>"
        )
    };
    let pictures: String = penumbra
        .pictures
        .iter()
        .zip(&penumbra.rows)
        .map(|(picture, row)| {
            let text = format!("RMSE {}", percent(row.error.mean.sqrt()));
            figure(png_url(&picture.png(1.0)), row.pattern, text)
        })
        .collect();
    let truth = figure(png_url(&penumbra.truth.png(1.0)), "quadrature", "the truth".into());
    let independent = &penumbra.rows[0];
    let rows = by_pattern(|i, _| {
        let r = &penumbra.rows[i];
        let gain = |a: &Measured, b: &Measured| format!("{}×", number(a.mean / b.mean));
        vec![
            interval(&r.error),
            gain(&independent.error, &r.error),
            interval(&r.blurred),
            gain(&independent.blurred, &r.blurred),
        ]
    });
    let head = ["pattern", "squared error", "below independent", "of blocks", "below independent"];
    format!("<h3>{} light</h3><div class=\"sheet\">{truth}{pictures}</div>{}", penumbra.light, table(&head, &rows))
}

fn points(results: &Results, pictures: &Pictures) -> String {
    let pair = |(i, p): (usize, &Pattern)| {
        let [points, spectrum] = pictures.png(i).map(|png| png_url(&png));
        format!(
            "<figure><div class=\"pair\"><img src=\"{points}\" alt=\"points\"><img src=\"{spectrum}\" alt=\"spectrum\"></div>\
             <figcaption>{}</figcaption></figure>",
            p.name()
        )
    };
    let sheet: String = Pattern::ALL.iter().enumerate().map(pair).collect();
    let chart = |name: &'static str, of: fn(&(u32, f64, f64)) -> f64| {
        let curve = |(colour, r): (usize, &super::pictures::Rings)| Curve {
            label: r.pattern.into(),
            colour,
            // What cancels to rounding is no power.
            marks: r.rings.iter().map(|ring| Mark::exact(ring.0.into(), of(ring))).filter(|m| m.y > 1e-6).collect(),
            theory: vec![],
        };
        let curves: Vec<Curve> = results.spectra.iter().enumerate().map(curve).collect();
        let labels = Labels { x: "frequency", x_mark: whole, y: name, y_mark: power_mark };
        format!("<div><h3>{name} over frequency</h3>{}</div>", svg(name, &labels, &curves))
    };
    let charts = [chart("mean power", |r| r.1), chart("anisotropy", |r| r.2)].concat();
    let rows = by_pattern(|i, _| {
        let (d, r) = (&results.discrepancies[i], &results.spectra[i]);
        let spectrum = [percent(r.low_frequencies), format!("{:.1} dB", r.anisotropy_db).replace('-', "−")];
        d.star.iter().map(|s| number(*s)).chain(spectrum).collect()
    });
    let counts = COUNTS.map(|n| format!("star discrepancy, {n}"));
    let head = ["pattern", &counts[0], &counts[1], &counts[2], "low frequencies", "anisotropy"];
    let note = format!(
        "{POINTS} points, and the mean power of {REALISATIONS} patterns of them, frequency 0 in the middle; white noise is a middle \
         grey. Low frequencies: mean power below half of that at which a regular grid has its first, of white noise’s. \
         Anisotropy: variance over squared mean within a ring; about −18 dB where no direction differs (a single pattern of \
         the grid is taken). Star discrepancies are means over patterns."
    );
    let content = format!(
        "<div class=\"sheet wide\">{sheet}</div><h3>Spectra</h3>{}<div class=\"charts\">{charts}</div>{}",
        legend(),
        table(&head, &rows)
    );
    card("Points and spectra", &content, &note)
}

fn resampling(results: &Results) -> String {
    let curve = |(colour, s): (usize, &super::resampling::Series)| Curve {
        label: s.target.into(),
        colour,
        marks: s.levels.iter().map(|l| mark(l.candidates, &l.variance)).collect(),
        theory: s.levels.iter().map(|l| (l.candidates.into(), l.theory)).collect(),
    };
    let curves: Vec<Curve> = results.resampling.iter().enumerate().map(curve).collect();
    let legend: String =
        curves.iter().map(|c| format!("<span>{}{}</span>", swatch(c.colour), escape(&c.label))).collect();
    let labels = Labels { x: "candidates", x_mark: whole, y: "variance", y_mark: power_mark };
    let levels = results.resampling.first().map_or(0, |s| s.levels.len());
    let rows: String = (0..levels)
        .map(|i| {
            let cells = results.resampling.iter().map(|s| &s.levels[i]);
            let name = results.resampling[0].levels[i].candidates.to_string();
            row(&name, cells.flat_map(|l| [interval(&l.variance), number(l.theory)]))
        })
        .collect();
    let names = results.resampling.iter().flat_map(|s| [s.target, "formula"]);
    let head: Vec<&str> = std::iter::once("candidates").chain(names).collect();
    let chart = svg("variance over candidates", &labels, &curves);
    let note = "One sample of a bump, resampled from uniform candidates; dashed, I(f²) / M + (1 − 1 / M) I(t) I(f² / t) − I(f)², t being \
                the target. With the integrand as target the estimate is the candidates’ mean, and its variance falls for \
                ever; with another it tends to what a sample of the target’s own density would have.";
    card("Resampling", &format!("<div class=\"legend\">{legend}</div>{chart}{}", table(&head, &rows)), note)
}

fn allocation(results: &Results) -> String {
    let line = |r: &super::allocation::Row| {
        let counts = r.counts.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
        let cells = [
            counts,
            interval(&r.variance),
            number(r.formula),
            r.proportional_formula.map_or("–".into(), number),
            number(r.variance.mean / r.formula),
        ];
        row(&format!("{}, {}", r.integrand, r.allocation), cells)
    };
    let rows: String = results.allocation.iter().map(line).collect();
    let head =
        ["integrand, allocation", "samples", "variance", "Σ mᵢ² Vᵢ / Nᵢ", "Σ Nᵢ Vᵢ / N²", "measured over formula"];
    let note = "64 samples in five columns of the square, of widths 1, 3, 4, 6 and 2 sixteenths. Variance-optimal numbers are \
                those that a pilot of 256 samples in each column asks for.";
    card("Stratified allocation", &table(&head, &rows), note)
}

fn about(results: &Results, facts: &Facts) -> String {
    let content = format!(
        "<p><code>{}</code></p><p>Seed {}, {} on {} with {} thread{}. The figures are the same with any number of threads.</p>",
        escape(&results.command),
        results.seed,
        human_seconds(facts.seconds),
        escape(&facts.processor),
        facts.threads,
        if facts.threads == 1 { "" } else { "s" }
    );
    card("What was run", &content, "All figures are in results.json beside this page.")
}
