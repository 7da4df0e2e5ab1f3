//! Scenes that others made, whole: image means against those of Mitsuba 3 for the same file.
//!
//! The figures are in `reference/mitsuba/means.json`, with the script that made them. `ETENDUE_REAL_SAMPLES` sets the samples a
//! pixel (default 64), in eight replicates. Five of them also against the image that the scene's author ships, made by his
//! own renderer, Tungsten: as far from it as Mitsuba is.

use etendue_core::rgb::Rgb;
use etendue_path::INFO;
use etendue_scenes::load;
use etendue_tests::{Run, limit, shared};
use glam::UVec2;
use xtask::exr_file::read_picture;

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

/// The mean with values clamped at 10, against that of the author's image: within .01 of the `ratio` that the scene's
/// SOURCE.txt states for Mitsuba. The ratio falls with the size of the image, as the clamp spares what lamps share a pixel with;
/// no size is stated, so it is one at which Mitsuba 3.9.1 has that ratio.
fn as_far_from_the_authors_image(name: &str, size: [u32; 2], samples: u32, ratio: f64) {
    let Some(folder) = shared("scenes") else { return };
    let folder = folder.join(name);
    let author = read_picture(&folder.join("TungstenRender_halfres.exr")).expect("the author's image is readable");
    let mut loaded = load(folder.join("scene.xml").to_str().expect("a UTF-8 path")).unwrap_or_else(|e| panic!("{e}"));
    loaded.description.camera.as_mut().expect("a scene has a camera").resolution = UVec2::from(size);
    let ours = Run::new(&loaded).film(&INFO, 1, 0..samples).mean_image();
    let clamped = |image: &[Rgb]| {
        let sum: f64 = image.iter().flat_map(|c| c.to_array()).map(|v| f64::from(v.min(10.0))).sum();
        sum / (3 * image.len()) as f64
    };
    let found = clamped(&ours) / clamped(&author.pixels);
    println!("{name}: {found:.4} of the author's mean, Mitsuba {ratio}");
    assert!((found - ratio).abs() < 0.01, "{name}: {found} of the author's mean, Mitsuba {ratio}");
}

macro_rules! authors_images {
    ($($test:ident: $name:literal, $size:expr, $samples:literal, $ratio:literal;)*) => {
        mod authors_image {
            $(#[test]
            fn $test() {
                super::as_far_from_the_authors_image($name, $size, $samples, $ratio);
            })*
        }
    };
}

// Mitsuba at these sizes: 1.0205, 1.0404, 1.0263 (1024 samples), .9710, .9836.
authors_images! {
    cornell_box: "cornell-box", [192, 192], 64, 1.020;
    veach_mis: "veach-mis", [256, 144], 64, 1.041;
    veach_bidir: "veach-bidir", [96, 96], 1024, 1.030;
    staircase: "staircase", [144, 256], 64, 0.968;
    living_room: "living-room", [512, 288], 16, 0.980;
}
