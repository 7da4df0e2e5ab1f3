//! Advice: the technique to take for each scene, with its cost.

use crate::{
    clock::human_seconds,
    report::{
        Section, Series, TARGETS,
        analysis::Reach,
        text::{number, short_scene},
    },
    techniques,
};
use etendue_core::technique::Bias;
use serde::Serialize;

/// Index of the deciding error among [`TARGETS`].
const AIM: usize = 1;
/// Times that differ by less than this factor are alike: about what five replicates of a noisy machine can tell.
const ALIKE: f64 = 1.25;

/// The technique to take for a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// The scene.
    pub scene: String,
    /// The technique that reaches the error first; none if no time is known.
    pub technique: Option<String>,
    /// The error as relMSE.
    pub relmse: f64,
    /// Its time.
    pub seconds: Option<f64>,
    /// `true` if that lies beyond what was measured.
    pub extrapolated: bool,
    /// All of it in a sentence.
    pub text: String,
}

impl Advice {
    /// For a scene with its techniques.
    pub fn of(section: &Section) -> Advice {
        let (relmse, name) = TARGETS[AIM];
        let mut ranked: Vec<(f64, &Series)> =
            section.series.iter().filter_map(|s| Some((s.reach[AIM].seconds()?, s))).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let scene = section.facts.scene.clone();
        let short = short_scene(&scene);
        let noise = section.facts.own_relmse.filter(|own| *own > 0.25 * relmse);
        let noise =
            noise.map_or_else(String::new, |own| format!("; the reference itself is exact to {} only", error(own)));
        let Some((seconds, best)) = ranked.first() else {
            return Advice {
                technique: None,
                relmse,
                seconds: None,
                extrapolated: false,
                text: unknown(section),
                scene,
            };
        };
        let mut text = format!("{short}: take {}; {name} costs {}", best.label, cost(*seconds, best));
        match ranked.get(1) {
            Some((other, next)) if *other < ALIKE * seconds => {
                text += &format!("; {} does as well, {}", next.label, cost(*other, next));
            }
            Some((other, next)) => text += &format!("; next is {}, {}", next.label, cost(*other, next)),
            None if section.series.len() > 1 => text += "; no other is known to get there",
            None => {}
        }
        let extrapolated = is_beyond(best);
        let (technique, seconds) = (Some(best.label.clone()), Some(*seconds));
        Advice { technique, relmse, seconds, extrapolated, text: text + &noise, scene }
    }
}

fn is_beyond(series: &Series) -> bool {
    matches!(series.reach[AIM], Reach::Beyond(_))
}

fn cost(seconds: f64, series: &Series) -> String {
    let time = human_seconds(seconds);
    match series.reach[AIM] {
        Reach::Beyond(_) => {
            let biased = techniques::find(&series.group.technique).is_ok_and(|t| t.bias == Bias::Bounded);
            let biased = if biased { ", unless its bias shows" } else { "" };
            format!("~ {time} (extrapolated from {}{biased})", human_seconds(series.end().seconds))
        }
        Reach::AtOnce(_) => format!("less than {time}"),
        _ => time,
    }
}

/// A relMSE as a percentage.
fn error(relmse: f64) -> String {
    format!("{} %", number(100.0 * relmse.sqrt()))
}

/// The advice where no time to the error is known.
fn unknown(section: &Section) -> String {
    let name = TARGETS[AIM].1;
    let short = short_scene(&section.facts.scene);
    let end = |s: &&Series| s.end().relmse.1;
    let Some(best) = section.series.iter().min_by(|a, b| end(a).total_cmp(&end(b))) else {
        return format!("{short}: nothing was run");
    };
    let why = match section.facts.own_relmse {
        Some(own) if section.series.iter().any(|s| s.reach[AIM] == Reach::BelowNoise) => {
            format!("the reference is exact to {} only", error(own))
        }
        _ => "nothing is known to get there".to_owned(),
    };
    let (after, least) = (human_seconds(best.end().seconds), error(end(&best)));
    format!(
        "{short}: what {name} costs cannot be told, {why}; the least error after {after} is {least}, by {}",
        best.label
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        picture::Picture,
        reference::Reference,
        report::analysis::{points, reach, slope_of},
        study::{
            references::{SceneFacts, Source},
            results::tests::cell,
        },
    };
    use etendue_core::rgb::Rgb;

    /// A section of techniques whose errors begin at some values and fall as 1 / passes, 0.01 s each, for eight doublings.
    fn section(noise: f64, techniques: &[(&str, f64)]) -> Section {
        let series = |(name, start): &(&str, f64)| {
            let cells: Vec<_> = (0..3).map(|r| cell("a/b.xml", r, *start, 8)).collect();
            let cells: Vec<_> = cells.iter().collect();
            let (points, slope) = (points(&cells), slope_of(&cells, noise));
            let mut group = cells[0].group().clone();
            group.technique = (*name).to_owned();
            let reach = TARGETS.map(|(target, _)| reach(&points, slope, noise, target));
            Series { group, label: (*name).to_owned(), budget: 1.0, points, slope, reach, image: None }
        };
        let facts = SceneFacts {
            scene: "a/b.xml".into(),
            scene_hash: String::new(),
            width: 1,
            height: 1,
            depth: 4,
            source: Source::Given,
            made: String::new(),
            seconds: 0.0,
            own_relmse: Some(noise),
            note: String::new(),
            region: String::new(),
            census: String::new(),
            notes: Vec::new(),
        };
        let picture = Picture { size: glam::UVec2::ONE, pixels: vec![Rgb::WHITE] };
        let reference = Reference { picture, variance: None, region: None };
        Section { facts, reference, series: techniques.iter().map(series).collect() }
    }

    #[test]
    fn the_fastest_is_taken_and_the_next_is_told() {
        let advice = Advice::of(&section(0.0, &[("sppm", 0.4), ("path", 0.05)]));
        // 0.05 / 50 passes is 0.001, measured; 0.4 needs 400 passes of 128.
        assert_eq!((advice.technique.as_deref(), advice.extrapolated), (Some("path"), false));
        assert!((advice.seconds.unwrap() - 0.5).abs() < 1e-9, "{advice:?}");
        assert_eq!(
            advice.text,
            "b.xml: take path; 3 % costs 500 ms; next is sppm, ~ 4.00 s (extrapolated from 1.28 s)"
        );
        let alike = Advice::of(&section(0.0, &[("photon", 0.4), ("path", 0.36)]));
        assert!(alike.extrapolated && alike.text.contains("photon does as well"), "{alike:?}");
        assert!(alike.text.ends_with("unless its bias shows)"), "{alike:?}");
    }

    #[test]
    fn what_is_not_known_is_not_told() {
        let noisy = Advice::of(&section(2e-3, &[("path", 0.4), ("bidir", 0.8)]));
        assert_eq!((noisy.technique, noisy.seconds), (None, None));
        assert!(
            noisy.text.contains("3 % costs cannot be told, the reference is exact to 4.47 % only"),
            "{}",
            noisy.text
        );
        let near = Advice::of(&section(5e-4, &[("path", 0.4)]));
        assert!(near.text.ends_with("the reference itself is exact to 2.24 % only"), "{}", near.text);
        let mut flat = section(0.0, &[("path", 0.4)]);
        flat.series[0].reach = [Reach::Unclear; 3];
        let flat = Advice::of(&flat);
        // 0.4 / 128 is the square of 5.59 %.
        assert!(flat.text.ends_with("nothing is known to get there; the least error after 1.28 s is 5.59 %, by path"));
    }
}
