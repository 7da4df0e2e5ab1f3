//! Scenes that others made, whole: image means against those of Mitsuba 3 for the same file.
//!
//! The figures are in `reference/mitsuba/means.json`, with the script that made them. `ETENDUE_REAL_SAMPLES` sets the samples a
//! pixel (default 64), in eight replicates.

use etendue_core::rgb::Rgb;
use etendue_path::INFO;
use etendue_scenes::load;
use etendue_tests::{Run, limit, shared};
use glam::UVec2;

const REPLICATES: u64 = 8;
/// How far the means may be apart beyond the noise of both: models are the same, but not every convention.
const MODEL: f64 = 0.01;

fn agrees(name: &str) {
    let Some(folder) = shared("scenes") else { return };
    let samples = std::env::var("ETENDUE_REAL_SAMPLES").map_or(64, |v| v.parse::<u32>().expect("a number"));
    let text = include_str!("../reference/mitsuba/means.json");
    let entries: serde_json::Value = serde_json::from_str(text).expect("means.json is JSON");
    let entry = &entries[name];
    let number = |v: &serde_json::Value| v.as_f64().unwrap_or_else(|| panic!("{name}: means.json has no such number"));
    let theirs = (0..3).map(|c| number(&entry["mean"][c])).sum::<f64>() / 3.0;
    let their_error = number(&entry["relative_error"]);

    let mut loaded = load(folder.join(name).to_str().expect("a UTF-8 path")).unwrap_or_else(|e| panic!("{e}"));
    let camera = loaded.description.camera.as_mut().expect("a scene has a camera");
    camera.resolution = UVec2::new(number(&entry["size"][0]) as u32, number(&entry["size"][1]) as u32);
    let run = Run::new(&loaded);
    let images = run.replicates(&INFO, 1..1 + REPLICATES, samples / REPLICATES as u32);
    let grey = |c: &Rgb| f64::from(c.r + c.g + c.b) / 3.0;
    let means: Vec<f64> = images.iter().map(|i| i.iter().map(grey).sum::<f64>() / i.len() as f64).collect();
    let ours = means.iter().sum::<f64>() / REPLICATES as f64;
    let variance = means.iter().map(|m| (m - ours).powi(2)).sum::<f64>() / (REPLICATES - 1) as f64;
    let our_error = (variance / REPLICATES as f64).sqrt() / ours;
    let ratio = ours / theirs;
    println!("{name}: {ratio:.5} of Mitsuba's mean, +- {our_error:.5} (ours) +- {their_error:.5} (theirs)");
    let error = our_error.hypot(their_error);
    assert!((ratio - 1.0).abs() < MODEL + limit(REPLICATES) * error, "{name}: {ours} against {theirs}");
}

macro_rules! scenes {
    ($($test:ident: $file:literal;)*) => {
        $(#[test]
        fn $test() {
            agrees($file);
        })*
    };
}

scenes! {
    cornell_box: "cornell-box/scene.xml";
    veach_mis: "veach-mis/scene.xml";
    veach_bidir: "veach-bidir/scene.xml";
    staircase: "staircase/scene.xml";
    living_room: "living-room/scene.xml";
    classroom: "classroom/scene.xml";
    teapot: "teapot-env/scene.xml";
    many_lights: "manylights-pbrt/scene.xml";
}
