//! `scenes` and `techniques`: what there is.

use crate::{
    cli::ListArgs,
    error::Error,
    files,
    techniques::{TechniqueEntry, entries},
};
use etendue_scenes::{Builtin, ParameterKind, builtins};
use serde::Serialize;
use serde_json::{Value, json};

/// A built-in scene as it is listed.
#[derive(Serialize)]
struct SceneEntry {
    name: &'static str,
    summary: &'static str,
    parameters: Vec<ParameterEntry>,
}

#[derive(Serialize)]
struct ParameterEntry {
    name: &'static str,
    summary: &'static str,
    default: Value,
    values: String,
}

impl From<&'static Builtin> for SceneEntry {
    fn from(b: &'static Builtin) -> SceneEntry {
        let parameter = |p: &'static etendue_scenes::Parameter| {
            let (default, values) = match p.kind {
                ParameterKind::Integer { default, range: (low, high) } => (json!(default), format!("{low} to {high}")),
                ParameterKind::Number { default, range: (low, high) } => (json!(default), format!("{low} to {high}")),
                ParameterKind::Choice { options } => (json!(options.first()), options.join(", ")),
            };
            ParameterEntry { name: p.name, summary: p.summary, default, values }
        };
        SceneEntry { name: b.name, summary: b.summary, parameters: b.parameters.iter().map(parameter).collect() }
    }
}

impl SceneEntry {
    fn text(&self) -> String {
        let mut text = format!("{:<14} {}", self.name, self.summary);
        for p in &self.parameters {
            let default = p.default.as_str().map_or_else(|| p.default.to_string(), str::to_owned);
            text += &format!("\n{:14} {}:{}={default}  {} ({})", "", self.name, p.name, p.summary, p.values);
        }
        text
    }
}

/// Lists the built-in scenes.
pub fn scenes(args: &ListArgs) -> Result<(), Error> {
    let scenes: Vec<SceneEntry> = builtins().iter().map(SceneEntry::from).collect();
    if args.json {
        return files::print_json(&scenes);
    }
    files::print(&scenes.iter().map(SceneEntry::text).collect::<Vec<_>>().join("\n"))
}

/// Lists the techniques.
pub fn techniques(args: &ListArgs) -> Result<(), Error> {
    let techniques = entries();
    if args.json {
        return files::print_json(&techniques);
    }
    files::print(&techniques.iter().map(TechniqueEntry::text).collect::<Vec<_>>().join("\n"))
}
