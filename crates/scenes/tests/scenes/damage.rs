//! Damaged input: truncated anywhere, with bytes changed anywhere, it gives a result or an error and never a panic. What is read
//! holds no more memory than a small multiple of the input; that claims beyond it are refused is tested with the readers.

use crate::{
    images::encoded,
    meshes::{ASCII_PLY, OBJ, binary_ply, exr_bytes},
};
use etendue_core::{geometry::Mesh, rgb::Rgb, texture::Raster};
use etendue_scenes::{
    Flaw, LoadOptions,
    image_file::{Coding, decode, read_exr},
    load, load_with, obj, ply,
};
use image::ImageFormat;
use proptest::prelude::*;

/// The memory that a mesh holds, in bytes.
fn held(mesh: &Mesh) -> usize {
    let threes =
        mesh.positions.capacity() + mesh.normals.capacity() + mesh.triangles.capacity() + mesh.colors.capacity();
    12 * threes + 8 * mesh.uvs.capacity()
}

/// Cuts `bytes` and changes some of them.
fn damaged(bytes: &[u8], cut: f64, changes: &[(f64, u8)]) -> Vec<u8> {
    let mut out = bytes[..(bytes.len() as f64 * cut) as usize].to_vec();
    for (place, value) in changes {
        let at = (out.len() as f64 * place) as usize;
        if let Some(byte) = out.get_mut(at) {
            *byte = *value;
        }
    }
    out
}

fn cut() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), 0.0..1.0]
}

fn changes() -> impl Strategy<Value = Vec<(f64, u8)>> {
    // Bytes that mean something in text are chosen as often as any others.
    let byte = prop_oneof![any::<u8>(), prop::sample::select(b"0123456789-+.e/ \n\t<>\"=$&".to_vec())];
    prop::collection::vec((0.0..1.0, byte), 0..8)
}

fn xml() -> String {
    "<scene version=\"3.0.0\">\n<default name=\"spp\" value=\"4\"/>\n<integrator type=\"path\"><integer name=\"max_depth\" \
     value=\"3\"/></integrator>\n<sensor type=\"perspective\"><float name=\"fov\" value=\"30\"/><transform name=\"to_world\">\
     <lookat origin=\"0 0 4\" target=\"0 0 0\" up=\"0 1 0\"/></transform><sampler type=\"independent\"><integer \
     name=\"sample_count\" value=\"$spp\"/></sampler></sensor>\n<bsdf type=\"twosided\" id=\"a\"><bsdf type=\"diffuse\">\
     <rgb name=\"reflectance\" value=\".1 .2 .3\"/></bsdf></bsdf>\n<shape type=\"cube\"><ref id=\"a\"/><transform \
     name=\"to_world\"><scale value=\"2\"/><rotate y=\"1\" angle=\"30\"/></transform></shape>\n<emitter \
     type=\"constant\"/>\n<include filename=\"part.xml\"/>\n<shape type=\"instance\"><ref id=\"g\"/></shape>\n\
     <shape type=\"sphere\"><ref id=\"b\"/><medium name=\"interior\" type=\"homogeneous\"><float name=\"albedo\" \
     value=\"0\"/><spectrum name=\"sigma_t\" value=\"400:1, 700:2\"/></medium></shape>\n</scene>\n"
        .to_owned()
}

/// What [`xml`] includes.
fn part() -> String {
    "<scene version=\"3.0.0\">\n<default name=\"spp\" value=\"8\"/><default name=\"k\" value=\"checkerboard\"/>\n<shape \
     type=\"shapegroup\" id=\"g\"><shape type=\"cylinder\"><point name=\"p1\" value=\"0 0 2\"/></shape></shape>\n<bsdf \
     type=\"bumpmap\" id=\"b\"><texture name=\"t\" type=\"$k\"><transform name=\"to_uv\"><scale x=\"3\"/></transform>\
     </texture><bsdf type=\"mask\"><texture name=\"opacity\" type=\"bitmap\"><string name=\"filename\" value=\"q.png\"/>\
     </texture><bsdf type=\"roughplastic\"><rgb name=\"diffuse_reflectance\" value=\"#102030\"/></bsdf></bsdf></bsdf>\n\
     <alias id=\"b\" as=\"c\"/>\n</scene>\n"
        .to_owned()
}

/// A folder with what [`xml`] names, and the two files as given.
fn folder(xml: &[u8], part: &[u8]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("q.png"), encoded(ImageFormat::Png, true)).unwrap();
    std::fs::write(folder.path().join("part.xml"), part).unwrap();
    std::fs::write(folder.path().join("s.xml"), xml).unwrap();
    folder
}

#[test]
fn the_undamaged_inputs_are_good() {
    ply::read(&binary_ply(true)).unwrap();
    ply::read(ASCII_PLY.as_bytes()).unwrap();
    obj::read(OBJ.as_bytes()).unwrap();
    read_exr(&sample_exr()).unwrap();
    let folder = folder(xml().as_bytes(), part().as_bytes());
    load(folder.path().join("s.xml").to_str().unwrap()).unwrap();
    for format in IMAGES {
        decode(&encoded(format, false), NAMELESS.as_ref(), Coding::Srgb)
            .or_else(|_| tga(&encoded(format, false)))
            .unwrap();
    }
}

const IMAGES: [ImageFormat; 4] = [ImageFormat::Png, ImageFormat::Bmp, ImageFormat::Tga, ImageFormat::Hdr];
const NAMELESS: &str = "image";

/// Targa files say what they are by their name alone.
fn tga(bytes: &[u8]) -> Result<Raster<Rgb>, Flaw> {
    decode(bytes, "image.tga".as_ref(), Coding::Linear)
}

fn sample_exr() -> Vec<u8> {
    exr_bytes(9, 7, |x, y| (x as f32, y as f32, (x * y) as f32))
}

/// How many bytes a mesh may hold for each byte of its file: a vertex of three bytes takes 12, and vectors double as they grow.
const GROWTH: usize = 24;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(3000) })]

    #[test]
    fn damaged_binary_ply(big in any::<bool>(), cut in cut(), changes in changes()) {
        let bytes = damaged(&binary_ply(big), cut, &changes);
        if let Ok(mesh) = ply::read(&bytes) {
            prop_assert!(held(&mesh) <= GROWTH * bytes.len() + 256);
            prop_assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < mesh.positions.len()));
            prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
        }
    }

    #[test]
    fn damaged_ascii_ply(cut in cut(), changes in changes()) {
        let bytes = damaged(ASCII_PLY.as_bytes(), cut, &changes);
        if let Ok(mesh) = ply::read(&bytes) {
            prop_assert!(held(&mesh) <= GROWTH * bytes.len() + 256);
            prop_assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < mesh.positions.len()));
            prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
        }
    }

    #[test]
    fn damaged_obj(cut in cut(), changes in changes()) {
        let bytes = damaged(OBJ.as_bytes(), cut, &changes);
        if let Ok(mesh) = obj::read(&bytes) {
            prop_assert!(held(&mesh) <= GROWTH * bytes.len() + 256);
            prop_assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < mesh.positions.len()));
            prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
        }
    }

    #[test]
    fn damaged_exr(cut in cut(), changes in changes()) {
        let bytes = damaged(&sample_exr(), cut, &changes);
        if let Ok(image) = read_exr(&bytes) {
            let bitmap = image.bitmap;
            let expected = bitmap.width as usize * bitmap.height as usize;
            prop_assert_eq!(bitmap.texels.len(), expected);
            prop_assert!(bitmap.texels.iter().all(|t| t.is_valid()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1500) })]

    #[test]
    fn damaged_xml(cut in cut(), changes in changes(), lenient in any::<bool>()) {
        let folder = folder(&damaged(xml().as_bytes(), cut, &changes), part().as_bytes());
        sound(&folder, lenient)?;
    }

    #[test]
    fn damaged_inclusions(cut in cut(), changes in changes(), lenient in any::<bool>()) {
        let folder = folder(xml().as_bytes(), &damaged(part().as_bytes(), cut, &changes));
        sound(&folder, lenient)?;
    }

    #[test]
    fn damaged_images(format in 0..IMAGES.len(), cut in cut(), changes in changes()) {
        let bytes = damaged(&encoded(IMAGES[format], true), cut, &changes);
        let read = [decode(&bytes, NAMELESS.as_ref(), Coding::Gamma(2.2)), tga(&bytes)];
        for bitmap in read.into_iter().flatten() {
            let [width, height] = bitmap.size();
            prop_assert_eq!(bitmap.len(), width as usize * height as usize);
            prop_assert!(bitmap.len() <= 1032 * bytes.len());
        }
    }
}

fn sound(folder: &tempfile::TempDir, lenient: bool) -> Result<(), TestCaseError> {
    let options = LoadOptions { lenient, ..LoadOptions::default() };
    if let Ok(scene) = load_with(folder.path().join("s.xml").to_str().unwrap(), options) {
        prop_assert!(scene.description.camera.is_some_and(|c| c.to_world.is_finite()));
        prop_assert!(scene.description.objects.iter().all(|o| o.to_world.is_finite()));
    }
    Ok(())
}
