//! The list of techniques: a new one is one line here.

use crate::error::Error;
use etendue_core::technique::{Bias, Knob, Part, TechniqueInfo};
use serde::Serialize;
use std::collections::BTreeMap;

/// Every technique that the command line knows.
pub static TECHNIQUES: &[&TechniqueInfo] = &[
    &etendue_path::INFO,
    &etendue_bidir::LIGHT,
    &etendue_bidir::BIDIR,
    &etendue_photon::PHOTON,
    &etendue_photon::SPPM,
];

/// The technique of a name.
pub fn find(name: &str) -> Result<&'static TechniqueInfo, Error> {
    TECHNIQUES.iter().copied().find(|t| t.name == name).ok_or_else(|| {
        let known: Vec<&str> = TECHNIQUES.iter().map(|t| t.name).collect();
        Error::Input(format!("there is no technique `{name}`; there is: {}", known.join(", ")))
    })
}

/// The values of a technique's knobs where none is given.
pub fn defaults(technique: &TechniqueInfo) -> Vec<f64> {
    technique.knobs.iter().map(|k| k.default).collect()
}

/// The values of a technique's knobs, in its order: those given as `name=value`, and defaults for the rest.
pub fn knobs(technique: &TechniqueInfo, given: &[String]) -> Result<Vec<f64>, Error> {
    let mut values = defaults(technique);
    let mut seen = Vec::new();
    for text in given {
        let (name, value) =
            text.split_once('=').ok_or_else(|| Error::Input(format!("--knob {text}: not `name=value`")))?;
        let index = technique.knobs.iter().position(|k| k.name == name).ok_or_else(|| {
            let known: Vec<&str> = technique.knobs.iter().map(|k| k.name).collect();
            let known = if known.is_empty() { "it has none".into() } else { format!("it has: {}", known.join(", ")) };
            Error::Input(format!("--knob {text}: `{}` has no knob `{name}`; {known}", technique.name))
        })?;
        if seen.contains(&index) {
            return Err(Error::Input(format!("--knob {text}: `{name}` is given twice")));
        }
        seen.push(index);
        let Knob { range: (low, high), whole, .. } = technique.knobs[index];
        match value.parse::<f64>() {
            Ok(v) if (low..=high).contains(&v) && (!whole || v.fract() == 0.0) => values[index] = v,
            _ => {
                let number = if whole { "whole number" } else { "number" };
                return Err(Error::Input(format!("--knob {text}: not a {number} from {low} to {high}")));
            }
        }
    }
    Ok(values)
}

/// Values of knobs with their names.
pub fn named_knobs(technique: &TechniqueInfo, values: &[f64]) -> BTreeMap<String, f64> {
    technique.knobs.iter().zip(values).map(|(k, v)| (k.name.to_owned(), *v)).collect()
}

/// How its error behaves, as a word.
pub fn bias_word(bias: Bias) -> &'static str {
    match bias {
        Bias::Unbiased => "unbiased",
        Bias::Consistent => "consistent",
        Bias::Bounded => "bounded bias",
    }
}

/// A technique as it is listed.
#[derive(Serialize)]
pub struct TechniqueEntry {
    name: &'static str,
    summary: &'static str,
    paper: &'static str,
    bias: &'static str,
    covers: Vec<&'static str>,
    blind_spots: &'static str,
    knobs: Vec<KnobEntry>,
}

#[derive(Serialize)]
struct KnobEntry {
    name: &'static str,
    summary: &'static str,
    range: (f64, f64),
    default: f64,
    whole: bool,
}

/// The list for people or programs.
pub fn entries() -> Vec<TechniqueEntry> {
    let entry = |t: &&'static TechniqueInfo| TechniqueEntry {
        name: t.name,
        summary: t.summary,
        paper: t.paper,
        bias: bias_word(t.bias),
        covers: Part::ALL.into_iter().filter(|p| t.covers.contains(*p)).map(Part::name).collect(),
        blind_spots: t.blind_spots,
        knobs: t.knobs.iter().map(KnobEntry::from).collect(),
    };
    TECHNIQUES.iter().map(entry).collect()
}

impl From<&'static Knob> for KnobEntry {
    fn from(k: &'static Knob) -> KnobEntry {
        KnobEntry { name: k.name, summary: k.summary, range: k.range, default: k.default, whole: k.whole }
    }
}

impl TechniqueEntry {
    /// As lines of text.
    pub fn text(&self) -> String {
        let mut text = format!("{:<12} {} ({}; {})", self.name, self.summary, self.bias, self.paper);
        if !self.blind_spots.is_empty() {
            text += &format!("\n{:12} does not cover: {}", "", self.blind_spots);
        }
        for k in &self.knobs {
            let (low, high) = k.range;
            let whole = if k.whole { ", whole" } else { "" };
            text += &format!("\n{:12} --knob {}={}: {} ({low} to {high}{whole})", "", k.name, k.default, k.summary);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_core::technique::Parts;

    static KNOBBED: TechniqueInfo = TechniqueInfo {
        name: "knobbed",
        summary: "",
        paper: "",
        bias: Bias::Unbiased,
        covers: Parts::ALL,
        blind_spots: "",
        misses: |_| &[],
        knobs: &[
            Knob { name: "a", summary: "", range: (0.0, 2.0), default: 1.0, whole: false },
            Knob { name: "b", summary: "", range: (-1.0, 1.0), default: 0.5, whole: false },
            Knob { name: "n", summary: "", range: (0.0, 8.0), default: 2.0, whole: true },
        ],
        build: |_, _, _| unreachable!("only its knobs are looked at"),
    };

    #[test]
    fn knobs_are_checked() {
        let parse = |given: &[&str]| knobs(&KNOBBED, &given.iter().map(|s| s.to_string()).collect::<Vec<_>>());
        assert_eq!(parse(&[]).unwrap(), [1.0, 0.5, 2.0]);
        assert_eq!(parse(&["b=-1", "n=3.0", "a=2"]).unwrap(), [2.0, -1.0, 3.0]);
        assert!(parse(&["a=1", "b=0", "a=1"]).unwrap_err().to_string().contains("given twice"));
        for bad in ["a", "c=1", "a=2.1", "a=NaN", "a=", "a=one", "n=1.5", "n=9", "é=1", "a=²"] {
            let error = parse(&[bad]).unwrap_err();
            assert!(error.to_string().contains(bad), "{error}");
            assert_eq!(error.exit_code(), 2);
        }
    }

    #[test]
    fn names_are_unique() {
        for (i, t) in TECHNIQUES.iter().enumerate() {
            assert!(TECHNIQUES[..i].iter().all(|o| o.name != t.name), "{} twice", t.name);
            assert!(find(t.name).is_ok());
        }
        assert!(find("nonesuch").is_err());
    }
}
