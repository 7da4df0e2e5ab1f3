//! Images in files of every format.

use etendue_core::rgb::Rgb;
use etendue_scenes::image_file::{Coding, Image, decode, read, read_exr};
use image::{DynamicImage, GrayImage, ImageFormat, RgbImage, RgbaImage};
use std::{io::Cursor, path::Path};

/// Two rows of two: red, green; blue, grey; half transparent.
pub(crate) fn encoded(format: ImageFormat, transparent: bool) -> Vec<u8> {
    let pixels = [[255, 0, 0, 128], [0, 255, 0, 128], [0, 0, 255, 128], [128, 128, 128, 0]];
    let rgba = RgbaImage::from_fn(2, 2, |x, y| image::Rgba(pixels[(y * 2 + x) as usize]));
    let image = DynamicImage::ImageRgba8(rgba);
    let image = match (format, transparent) {
        (ImageFormat::Hdr, _) => DynamicImage::ImageRgb32F(image.to_rgb32f()),
        (_, true) => image,
        (_, false) => DynamicImage::ImageRgb8(image.to_rgb8()),
    };
    let mut out = Cursor::new(Vec::new());
    image.write_to(&mut out, format).unwrap();
    out.into_inner()
}

fn texels(bytes: &[u8], name: &str, coding: Coding) -> Vec<[f32; 3]> {
    let bitmap = decode(bytes, Path::new(name), coding).unwrap();
    assert_eq!(bitmap.size(), [2, 2]);
    bitmap.values().into_iter().map(Rgb::to_array).collect()
}

/// Figures: Mitsuba 3.9.1, scalar_rgb, `eval` of a `bitmap` of this image.
#[test]
fn images_of_eight_bits_are_srgb_unless_raw() {
    let primaries = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (format, name, transparent) in [
        (ImageFormat::Png, "a.png", true),
        (ImageFormat::Png, "a.png", false),
        // What a file is shows in its first bytes.
        (ImageFormat::Png, "a.jpg", false),
        (ImageFormat::Bmp, "a.bmp", false),
        (ImageFormat::Tga, "a.tga", false),
        (ImageFormat::Tga, "a.tga", true),
    ] {
        let bytes = encoded(format, transparent);
        for (coding, grey) in
            [(Coding::Srgb, 0.215_860_41), (Coding::Linear, 0.501_960_8), (Coding::Gamma(2.0), 0.251_964_64)]
        {
            let found = texels(&bytes, name, coding);
            assert_eq!(found[..3], primaries, "{name}");
            assert!(found[3].iter().all(|c| (c - grey).abs() < 2e-7), "{name} {coding:?}: {:?}", found[3]);
        }
    }
}

#[test]
fn other_depths_are_read() {
    let grey = GrayImage::from_fn(2, 2, |x, y| image::Luma([[[0, 64], [128, 255]][y as usize][x as usize]]));
    let mut png = Cursor::new(Vec::new());
    DynamicImage::ImageLuma8(grey.clone()).write_to(&mut png, ImageFormat::Png).unwrap();
    let found = texels(png.get_ref(), "g.png", Coding::Srgb);
    // Mitsuba 3.9.1, `eval` of a `bitmap` of this image.
    for (texel, expected) in found.iter().zip([0.0, 0.051_269_44, 0.215_860_41, 1.0]) {
        assert!(texel.iter().all(|c| (c - expected).abs() < 2e-7), "{texel:?}");
    }
    for deep in
        [DynamicImage::ImageLuma8(grey.clone()).to_rgb16().into(), DynamicImage::ImageLuma8(grey).to_luma16().into()]
    {
        let deep: DynamicImage = deep;
        let mut png = Cursor::new(Vec::new());
        deep.write_to(&mut png, ImageFormat::Png).unwrap();
        let found = texels(png.get_ref(), "g.png", Coding::Linear);
        assert_eq!(found.iter().map(|t| t[1]).collect::<Vec<_>>(), [0.0, 64.0 / 255.0, 128.0 / 255.0, 1.0]);
    }
}

#[test]
fn photographs_and_radiance_are_read() {
    // JPEG keeps flat colour to a step or two of 255.
    let flat = DynamicImage::ImageRgb8(RgbImage::from_pixel(16, 16, image::Rgb([200, 100, 50])));
    let mut jpg = Cursor::new(Vec::new());
    flat.write_to(&mut jpg, ImageFormat::Jpeg).unwrap();
    let bitmap = decode(jpg.get_ref(), Path::new("a.jpg"), Coding::Linear).unwrap();
    let close = |t: &Rgb| t.to_array().iter().zip([200.0, 100.0, 50.0]).all(|(c, e)| (c * 255.0 - e).abs() <= 3.0);
    assert!(bitmap.len() == 256 && bitmap.values().iter().all(close));
    // Radiance has numbers with a point, which no coding touches.
    let hdr = encoded(ImageFormat::Hdr, false);
    for coding in [Coding::Srgb, Coding::Linear] {
        let found = texels(&hdr, "a.hdr", coding);
        // As other programs begin such files.
        let renamed = [b"#?RGBE", hdr.strip_prefix(b"#?RADIANCE").unwrap()].concat();
        assert_eq!(texels(&renamed, "a.hdr", coding), found);
        assert!((found[3][0] - 128.0 / 255.0).abs() < 1.0 / 256.0 && found[0] == [1.0, 0.0, 0.0], "{found:?}");
    }
}

#[test]
fn one_channel_of_luminance_is_grey() {
    use exr::prelude::{SpecificChannels, WritableImage};
    let channels =
        SpecificChannels::build().with_channel("Y").with_pixel_fn(|at: exr::math::Vec2<usize>| (at.x() as f32,));
    let mut out = Cursor::new(Vec::new());
    exr::prelude::Image::from_channels((3, 1), channels).write().non_parallel().to_buffered(&mut out).unwrap();
    let Image { bitmap, zeroed } = read_exr(out.get_ref()).unwrap();
    assert_eq!((bitmap.texels, zeroed), (vec![Rgb::BLACK, Rgb::WHITE, Rgb::splat(2.0)], 0));
}

#[test]
fn what_is_no_image_is_refused() {
    let refused = |bytes: &[u8], name: &str| decode(bytes, Path::new(name), Coding::Srgb).unwrap_err().message;
    let kinds = "images are read from .exr, .hdr, .png, .jpg, .bmp and .tga files";
    assert_eq!(refused(b"not an image", "a.txt"), kinds);
    assert_eq!(refused(b"GIF89a...", "a.gif"), kinds);
    assert!(refused(b"not an image", "a.png").starts_with("not a readable image: "));
    assert!(read_exr(b"not an image").unwrap_err().message.starts_with("not a readable OpenEXR image: "));
    assert!(read("no/such.png".as_ref()).unwrap_err().to_string().starts_with("cannot read no/such.png: "));
    let png = encoded(ImageFormat::Png, false);
    assert!(refused(&png[..png.len() / 2], "a.png").starts_with("not a readable image: "));
}

#[test]
fn a_huge_claim_is_refused_before_it_is_believed() {
    // A bitmap's width stands at byte 18, its height at 22.
    let claim = |width: u32, height: u32| {
        let mut bmp = encoded(ImageFormat::Bmp, false);
        bmp[18..22].copy_from_slice(&width.to_le_bytes());
        bmp[22..26].copy_from_slice(&height.to_le_bytes());
        decode(&bmp, Path::new("a.bmp"), Coding::Srgb).unwrap_err().message
    };
    assert_eq!(claim(16384, 16384), "the header claims 16384 x 16384 texels; 67108864 is the most");
    assert!(claim(8192, 8192).starts_with("the header claims 8192 x 8192 texels, too many for "));
    // Radiance says its size in words.
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n";
    let message = decode(hdr, Path::new("a.hdr"), Coding::Srgb).unwrap_err().message;
    assert_eq!(message, "the header claims 60000 x 60000 texels; 67108864 is the most");
}
