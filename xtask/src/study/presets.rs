//! Knobs that a study turns for certain scenes: the photon counts that the figures of the literature go with, and for `studio`,
//! of which it tells none, one of their kind.

/// A scene, a technique, and its knobs as `name=value`.
type Preset = (&'static str, &'static str, &'static [&'static str]);

const PRESETS: [Preset; 6] = [
    ("glass-ball", "photon", &["caustic_photons=10000", "nearest=50"]),
    ("ring", "photon", &["caustic_photons=50000", "nearest=50"]),
    ("glossy-caustic", "photon", &["caustic_photons=340000", "nearest=100"]),
    ("studio", "photon", &["caustic_photons=100000", "nearest=50"]),
    ("cornell", "photon", &["global_photons=200000", "nearest=100"]),
    ("pool", "photon", &["caustic_photons=300000", "nearest=50"]),
];

/// The knobs of a technique in a study of a scene, which may have parameters: those that are given, and before them the
/// scene's own of other names; what is not named has its default.
pub fn knobs(scene: &str, technique: &str, given: &[&str]) -> Vec<String> {
    let name = scene.split(':').next().unwrap_or(scene);
    let preset = PRESETS.iter().find(|(s, t, _)| (*s, *t) == (name, technique));
    let knob = |text: &str| text.split('=').next().map(str::to_owned);
    let own = preset.into_iter().flat_map(|(_, _, own)| own.iter());
    let own = own.filter(|own| given.iter().all(|given| knob(given) != knob(own)));
    own.chain(given).map(|k| k.to_string()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::techniques;

    #[test]
    fn presets_are_of_scenes_and_knobs_that_there_are() {
        for (scene, technique, turned) in PRESETS {
            assert!(etendue_scenes::builtin::builtins().iter().any(|b| b.name == scene), "{scene}");
            let given: Vec<String> = turned.iter().map(|k| k.to_string()).collect();
            techniques::knobs(techniques::find(technique).unwrap(), &given).unwrap();
        }
        assert_eq!(knobs("ring:radius=1", "photon", &[]).len(), 2);
        assert!(knobs("ring", "path", &[]).is_empty() && knobs("veach-mis", "photon", &[]).is_empty());
        assert_eq!(knobs("ring", "photon", &["nearest=7"]), ["caustic_photons=50000", "nearest=7"]);
    }
}
