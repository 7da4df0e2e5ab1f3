//! Light that a technique cannot render, said by name before it is missing from an image.

use crate::techniques::{TECHNIQUES, defaults};
use etendue_core::{
    effects::Census,
    scene::{DeltaLight, SceneDescription},
    technique::{Chain, Parts, TechniqueInfo},
};

/// The most lights that are named.
const NAMED: usize = 3;

/// Returns `true` if a technique, with its knobs at their defaults, leaves out light that the scene can have.
pub fn misses(technique: &TechniqueInfo, chain: Chain, scene: &SceneDescription, depth: u32) -> bool {
    (technique.misses)(&defaults(technique)).contains(&chain)
        && chain.edges() <= depth
        && Census::of(scene).chains().contains(&chain)
}

/// A technique with the values of its knobs.
pub type Choice = (&'static TechniqueInfo, Vec<f64>);

/// Every technique, with its knobs at their defaults.
pub fn every_technique() -> Vec<Choice> {
    TECHNIQUES.iter().map(|t| (*t, defaults(t))).collect()
}

/// The light that some techniques leave out of a scene's image, a sentence for each kind.
pub fn gaps(scene: &SceneDescription, depth: u32, parts: Parts, techniques: &[Choice]) -> Vec<String> {
    let chains = Census::of(scene).chains().into_iter().filter(|c| c.edges() <= depth && c.meets(parts));
    let gap = |chain: Chain| {
        let missing = names(techniques, |missed| missed.contains(&chain))?;
        let there = names(&every_technique(), |missed| !missed.contains(&chain));
        let rest = there.map_or_else(|| "no technique here renders it".into(), |t| format!("rendered by: {t}"));
        Some(format!("left out by {missing}: {}; {rest}", light(chain, scene)))
    };
    chains.filter_map(gap).collect()
}

/// The names of those techniques whose missed chains are of a kind, with commas between them; none without any.
fn names(techniques: &[Choice], of_kind: impl Fn(&[Chain]) -> bool) -> Option<String> {
    let of_kind = techniques.iter().filter(|(t, knobs)| of_kind((t.misses)(knobs)));
    let names: Vec<&str> = of_kind.map(|(t, _)| t.name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// The light of a chain in words.
fn light(chain: Chain, scene: &SceneDescription) -> String {
    let (by_way, lights) = ("by way of mirrors, glass or the holes of masks", lights(scene));
    match chain {
        Chain::LightThroughDelta => format!("{lights}, as seen in mirrors or through glass"),
        Chain::Caustic => format!("what falls on surfaces {by_way}, of {lights}"),
        Chain::CausticThroughDelta => format!("what falls on surfaces {by_way} and is seen so once more, of {lights}"),
        Chain::SurfaceThroughDelta => format!("surfaces that are seen {by_way}, whatever lights them"),
    }
}

/// The lights without an extent, by name.
fn lights(scene: &SceneDescription) -> String {
    let name = |light: &etendue_core::scene::LightDescription| {
        let kind = match light.kind {
            DeltaLight::Point { .. } => "point light",
            DeltaLight::Spot { .. } => "spot light",
            DeltaLight::Projector { .. } => "projector",
            DeltaLight::Directional { .. } => "directional light",
        };
        format!("the {kind} `{}`", light.name)
    };
    let named: Vec<String> = scene.lights.iter().take(NAMED).map(name).collect();
    match scene.lights.len().saturating_sub(NAMED) {
        0 => named.join(", "),
        more => format!("{} and {more} more", named.join(", ")),
    }
}
