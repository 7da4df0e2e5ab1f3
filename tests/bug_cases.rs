//! Small scenes in which renderers of others, or this one, were wrong: means of whole images.

use etendue_core::rgb::Rgb;
use etendue_scenes::load;
use etendue_tests::{Run, limit, shared};

const REPLICATES: u64 = 8;

/// The mean by path tracing is `right`, a figure of three or four digits, within noise.
fn is(file: &str, right: f64) {
    let Some(path) = shared("bugcases").map(|folder| folder.join(file)) else { return };
    let loaded = load(path.to_str().expect("a UTF-8 path")).unwrap_or_else(|e| panic!("{e}"));
    let images = Run::new(&loaded).replicates(&etendue_path::INFO, 0..REPLICATES, 32);
    let mean =
        |image: &Vec<Rgb>| image.iter().map(|c| f64::from(c.r + c.g + c.b) / 3.0).sum::<f64>() / image.len() as f64;
    let means: Vec<f64> = images.iter().map(mean).collect();
    let found = means.iter().sum::<f64>() / REPLICATES as f64;
    let variance = means.iter().map(|m| (m - found).powi(2)).sum::<f64>() / (REPLICATES - 1) as f64;
    let noise = (variance / REPLICATES as f64).sqrt();
    println!("{file}: {found:.5} +- {noise:.5}, right {right}");
    // The figures come from images of thousands of samples a pixel, and are rounded.
    assert!((found - right).abs() < limit(REPLICATES) * noise + 0.002 * right, "{file}: {found}, right {right}");
}

/// Figures of Mitsuba 3.9.1.
#[test]
fn vertex_normals_against_the_winding() {
    is("winding/winding-in-normals-out-emitter.xml", 1.417);
    is("winding/winding-in-normals-out-diffuse.xml", 0.6132);
    is("winding/winding-in-normals-out-dielectric.xml", 0.862);
}

/// The figure of Mitsuba 3.9.1 with flat faces. With the normals that it computes, by which its lights emit and ours do not, it
/// has .502.
#[test]
fn a_mirrored_mesh_without_normals() {
    is("mirror/plain-emitter-mirrored.xml", 0.4018);
}

/// An integral of `1 / (pi d^3)`.
#[test]
fn a_point_light_on_a_disk() {
    is("touching-point/scene.xml", 0.1176);
}

/// A figure of Mitsuba 3.9.1.
#[test]
fn a_mesh_with_a_line() {
    is("obj-line-lenient/scene.xml", 0.7585);
}
