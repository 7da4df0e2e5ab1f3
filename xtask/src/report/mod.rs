//! The report of a study: one page that needs nothing else.

pub mod advice;
pub mod analysis;
pub mod chart;
mod images;
pub mod page;
pub mod plot;
pub mod summary;
pub mod text;

use crate::{
    clock::human_seconds,
    error::Error,
    exr_file::read_picture,
    picture::Picture,
    reference::Reference,
    study::{
        references::{References, SceneFacts},
        results::{Cell, Group, Results},
    },
    techniques,
};
use advice::Advice;
use analysis::{Point, Reach, SlopeFit};
use etendue_core::technique::TechniqueInfo;
use std::path::Path;
pub use summary::SummaryRow;

/// The errors whose times are told: relMSE, and the root of it as a percentage.
pub const TARGETS: [(f64, &str); 3] = [(1e-2, "10 %"), (1e-3, "3 %"), (1e-4, "1 %")];

/// What was run, where.
pub struct RunFacts {
    /// The command.
    pub command: String,
    /// The processor.
    pub processor: String,
    /// Threads.
    pub threads: usize,
    /// Light that images lack, and techniques that are left out for it.
    pub gaps: Vec<String>,
}

/// A technique on a scene.
pub struct Series {
    /// What it is of.
    pub group: Group,
    /// Its name in the scene's chart and tables.
    pub label: String,
    /// Seconds that a cell was given.
    pub budget: f64,
    /// Checkpoints.
    pub points: Vec<Point>,
    /// Slope over passes.
    pub slope: Option<SlopeFit>,
    /// Times to reach [`TARGETS`].
    pub reach: [Reach; 3],
    /// The first replicate's last image, if it is there.
    pub image: Option<Picture>,
}

impl Series {
    /// The last checkpoint; there is one.
    pub fn end(&self) -> &Point {
        &self.points[self.points.len() - 1]
    }
}

/// A scene at one size and depth with one reference.
pub struct Section {
    /// What is known of it.
    pub facts: SceneFacts,
    /// The reference.
    pub reference: Reference,
    /// Techniques.
    pub series: Vec<Series>,
}

/// A page and what it sums up.
pub struct Report {
    /// The page.
    pub html: String,
    /// The summary.
    pub summary: Vec<SummaryRow>,
    /// For each scene, the technique to take.
    pub advice: Vec<Advice>,
}

/// Makes the report of all finished cells.
pub fn build(results: &Results, references: &References, images: &Path, run: &RunFacts) -> Result<Report, Error> {
    let mut sections: Vec<Section> = Vec::new();
    for group in results.groups() {
        let cells = results.of(group);
        let same = |s: &&mut Section| s.series.iter().any(|o| same_section(&o.group, group));
        let section = match sections.iter_mut().find(same) {
            Some(section) => section,
            None => {
                let (reference, facts) = references.read(&group.scene_hash, group.depth, &group.reference)?;
                sections.push(Section { facts, reference, series: Vec::new() });
                let last = sections.len() - 1;
                &mut sections[last]
            }
        };
        let series = series(group, &cells, section.facts.own_relmse.unwrap_or(0.0), images);
        section.series.push(series);
    }
    sections.iter_mut().for_each(label);
    let summary = sections.iter().flat_map(|s| s.series.iter().map(|series| SummaryRow::of(s, series))).collect();
    let advice: Vec<Advice> = sections.iter().map(Advice::of).collect();
    Ok(Report { html: page::html(&sections, &advice, run), summary, advice })
}

/// Whether two groups belong into one chart: they differ in how the image is made, not in what it should be.
fn same_section(a: &Group, b: &Group) -> bool {
    (&a.scene_hash, &a.size, a.depth, &a.reference) == (&b.scene_hash, &b.size, b.depth, &b.reference)
}

fn series(group: &Group, cells: &[&Cell], noise: f64, images: &Path) -> Series {
    let points = analysis::points(cells);
    let slope = analysis::slope_of(cells, noise);
    let image = read_picture(&images.join(format!("{}.exr", group.file_stem()))).ok();
    Series {
        group: group.clone(),
        label: group.technique.clone(),
        budget: cells.iter().map(|c| c.end().budget_seconds).fold(0.0, f64::max),
        reach: TARGETS.map(|(target, _)| analysis::reach(&points, slope, noise, target)),
        points,
        slope,
        image,
    }
}

/// Names each series of a section by what tells it from the others.
fn label(section: &mut Section) {
    let first = section.series[0].group.clone();
    let differs = |f: fn(&Group, &Group) -> bool| section.series.iter().any(|s| f(&s.group, &first));
    let sampler = differs(|a, b| a.sampler != b.sampler);
    let (seed, threads) = (differs(|a, b| a.seed != b.seed), differs(|a, b| a.threads != b.threads));
    // Of knobs those that tell series of one technique apart, and those that are not at their defaults.
    let groups: Vec<Group> = section.series.iter().map(|s| s.group.clone()).collect();
    let told_apart = |group: &Group, knob: &str| {
        groups.iter().any(|g| g.technique == group.technique && g.knobs.get(knob) != group.knobs.get(knob))
    };
    for s in &mut section.series {
        let g = &s.group;
        let mut label = g.technique.clone();
        let turned = |knob: &str, value: f64| {
            let of_it = |t: &'static TechniqueInfo| t.knobs.iter().find(|k| k.name == knob);
            techniques::find(&g.technique).ok().and_then(of_it).is_some_and(|k| k.default != value)
        };
        let told = g.knobs.iter().filter(|(k, v)| told_apart(g, k) || turned(k, **v));
        told.for_each(|(k, v)| label += &format!(" {k}={v}"));
        if sampler {
            label += &format!(" {}", g.sampler);
        }
        if seed {
            label += &format!(" seed {}", g.seed);
        }
        if threads {
            label += &format!(" {} thread{}", g.threads, if g.threads == 1 { "" } else { "s" });
        }
        s.label = label;
    }
}

/// A time to reach as text: `~` marks what is extrapolated, `<` what came with the first checkpoint.
pub fn reach_text(reach: Reach) -> String {
    match reach {
        Reach::AtOnce(s) => format!("< {}", human_seconds(s)),
        Reach::Within(s) => human_seconds(s),
        Reach::Beyond(s) => format!("~ {}", human_seconds(s)),
        Reach::BelowNoise => "below noise".into(),
        Reach::Unclear => "unclear".into(),
        Reach::Never => "not reached".into(),
    }
}
