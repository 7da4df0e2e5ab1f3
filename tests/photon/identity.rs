//! Only what a scene calls for is simulated.

use etendue_core::{
    film::Film,
    technique::{Part, Parts, Settings, Technique},
};
use etendue_photon::{IndirectLight, Options, PHOTON, PhotonMapper, SPPM};
use etendue_tests::Run;
use xtask::techniques::TECHNIQUES;

fn film(run: &Run, technique: &mut dyn Technique) -> Film {
    let mut film = Film::new(run.resolution, run.filter);
    for pass in 0..3 {
        technique.pass(4, pass, &mut film);
    }
    film
}

fn mapper(run: &Run, options: Options) -> PhotonMapper {
    PhotonMapper::new(run.scene.clone(), run.settings, options)
}

/// Where nothing casts caustics, asking for them changes no bit and traces nothing; with indirect light by paths, the image is
/// that of path tracing.
#[test]
fn without_casters_there_is_no_caustic_map() {
    for scene in ["cornell", "many-lights:n=32", "furnace", "furnace:material=rough-conductor,alpha=0.3"] {
        let run = Run::builtin(scene, 24);
        assert!(!run.scene.census().has_caustics(), "{scene}");
        let paths = Options { indirect: IndirectLight::Paths, ..Options::default() };
        let mut photon = mapper(&run, paths);
        let by_photons = film(&run, &mut photon);
        assert_eq!(photon.statistics().rays.light, 0, "{scene}");
        assert!(photon.caustic_map().is_none() && photon.global_map().is_none());
        let path = (etendue_path::INFO.build)(run.scene.clone(), run.settings, &[1.0]);
        assert!(by_photons == film(&run, &mut *{ path }), "{scene}");

        let gathered = film(&run, &mut mapper(&run, Options::default()));
        let off = film(&run, &mut mapper(&run, Options { caustic_photons: 0, ..Options::default() }));
        assert!(gathered == off, "{scene}");
    }
}

/// Where caustics are left to paths, they are path tracing's.
#[test]
fn without_a_caustic_map_paths_find_caustics() {
    for scene in ["ring", "veach-mis", "sky"] {
        let run = Run::builtin(scene, 24);
        assert!(run.scene.census().has_caustics());
        let options = Options { caustic_photons: 0, indirect: IndirectLight::Paths, ..Options::default() };
        let path = (etendue_path::INFO.build)(run.scene.clone(), run.settings, &[1.0]);
        let ours = film(&run, &mut mapper(&run, options)).mean_image();
        let theirs = film(&run, &mut *{ path }).mean_image();
        for (a, b) in ours.iter().zip(&theirs) {
            for c in 0..3 {
                // Loops for other sets of features may round otherwise.
                assert!((a[c] - b[c]).abs() <= 1e-4 * b[c].abs(), "{scene}: {a:?} {b:?}");
            }
        }
    }
}

/// Parts that need no photons trace none.
#[test]
fn light_that_paths_find_traces_no_photon() {
    let run = Run::builtin("glass-ball", 16);
    let parts = Parts::NONE.with(Part::Emission).with(Part::Direct).with(Part::Environment);
    for info in [&PHOTON, &SPPM] {
        let defaults: Vec<f64> = info.knobs.iter().map(|k| k.default).collect();
        for settings in [Settings { parts, ..run.settings }, Settings { max_depth: 2, ..run.settings }] {
            let mut technique = (info.build)(run.scene.clone(), settings, &defaults);
            film(&run, &mut *technique);
            assert_eq!(technique.statistics().rays.light, 0, "{}", info.name);
        }
    }
    assert!(TECHNIQUES.iter().any(|t| t.name == "photon") && TECHNIQUES.iter().any(|t| t.name == "sppm"));
}
