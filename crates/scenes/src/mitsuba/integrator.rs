//! The integrator: how long paths are.

use super::{document::Reader, plugin::Plugin, tree::Node};
use crate::error::{LoadError, abridged};

/// Integrators that trace paths whose length they bound: what they are to render is what path tracing renders.
const PATHS: [&str; 21] = [
    "path",
    "volpath",
    "volpathmis",
    "volpath_simple",
    "ptracer",
    "bdpt",
    "photonmapper",
    "ppm",
    "sppm",
    "pssmlt",
    "mlt",
    "erpt",
    "vpl",
    "prb",
    "prb_basic",
    "prbvolpath",
    "path_guiding_integrator",
    "guided_path",
    "adaptive",
    "irrcache",
    "direct",
];

/// Integrators around another.
const AROUND: [&str; 4] = ["moment", "aov", "adaptive", "irrcache"];

/// How deep integrators nest at most.
const DEEPEST: usize = 8;

/// What an integrator says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Depths {
    /// Longest path.
    pub(super) max: u32,
    /// Depth from which Russian roulette may end a path.
    pub(super) roulette: u32,
}

/// Mitsuba's own: no bound.
const DEFAULT: Depths = Depths { max: u32::MAX, roulette: 5 };

/// Reads an integrator.
pub(super) fn integrator<'d>(reader: &Reader<'d>, node: Node<'d>) -> Result<Depths, LoadError> {
    let read = nested(reader, node, 0);
    Ok(reader.forgiven(read, "path tracing without a bound is taken")?.unwrap_or(DEFAULT))
}

/// The integrator of a file that has none: Mitsuba's default.
pub(super) fn missing(reader: &Reader) -> Depths {
    reader.note("the scene has no integrator: path tracing without a bound is taken");
    DEFAULT
}

fn nested<'d>(reader: &Reader<'d>, node: Node<'d>, level: usize) -> Result<Depths, LoadError> {
    if level == DEEPEST {
        return Err(node.error(format!("integrators are nested more than {DEEPEST} deep")));
    }
    let plugin = Plugin::new(reader, node)?;
    let kind = plugin.kind;
    if AROUND.contains(&kind)
        && let Some(inner) = plugin.single("integrator")?
    {
        reader.note(format!("the integrator `{kind}` has no effect; what is in it is taken"));
        return nested(reader, inner, level + 1);
    }
    if AROUND.contains(&kind) && !PATHS.contains(&kind) {
        return Err(plugin.error(format!("the integrator type `{kind}` needs an integrator in it")));
    }
    if !PATHS.contains(&kind) {
        return Err(plugin.unknown_kind(&["path", "volpath", "direct", "ptracer", "bdpt", "moment", "aov"]));
    }
    let most = i64::from(u32::MAX);
    // Mitsuba: -1 is no bound.
    let max = match plugin.integer("max_depth", -1..=most)?.unwrap_or(-1) {
        -1 => u32::MAX,
        0 => return Err(plugin.error_at("max_depth", "a max_depth of 0 renders nothing; 1 is emission alone")),
        depth => depth as u32,
    };
    let roulette = plugin.integer("rr_depth", 1..=most)?.map_or(DEFAULT.roulette, |depth| depth as u32);
    if plugin.boolean("hide_emitters")? == Some(true) {
        reader.note("the integrator's hide_emitters has no effect: the camera sees emitters and the environment");
    }
    if kind == "direct" {
        reader.note("the integrator `direct` is taken as path tracing to depth 2".to_owned());
        return Ok(Depths { max: 2, roulette });
    }
    // How the work is split; no matter to the image.
    for name in ["samples_per_pass", "block_size"] {
        plugin.integer(name, 0..=most)?;
    }
    if plugin.float("timeout")?.is_some_and(|seconds| seconds > 0.0) {
        reader.note("the integrator's timeout has no effect");
    }
    if kind == "path" {
        // Old files may ask that shading normals agree with geometric ones, as they do here.
        plugin.boolean("strict_normals")?;
        plugin.finish()?;
    } else {
        reader.note(format!("the integrator `{}` is taken as path tracing to the same depth", abridged(kind)));
    }
    Ok(Depths { max, roulette })
}
