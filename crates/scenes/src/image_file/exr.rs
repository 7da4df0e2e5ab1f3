//! Images in OpenEXR files.

use super::{Image, check_size, whole};
use crate::error::Flaw;
use etendue_core::{rgb::Rgb, texture::Bitmap};
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel};
use std::io::Cursor;

/// Reads the channels R, G and B, or Y for each, of an OpenEXR image's first layer that has them, in 16 or 32 bits, as radiance.
///
/// # Errors
///
/// Anything that is wrong, an image of more than [`super::MOST_TEXELS`], or one that is too large to be in so small a file.
pub fn read_exr(bytes: &[u8]) -> Result<Image, Flaw> {
    decode(bytes).map(Image::of)
}

/// As [`read_exr`], the values as they are.
pub(super) fn decode(bytes: &[u8]) -> Result<Bitmap<Rgb>, Flaw> {
    let unreadable = |e: exr::error::Error| whole(format!("not a readable OpenEXR image: {e}"));
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(unreadable)?;
    for header in &meta.headers {
        check_size(header.layer_size.width() as u64, header.layer_size.height() as u64, bytes.len())?;
    }
    let has = |name: &str| meta.headers.iter().any(|h| h.channels.list.iter().any(|c| c.name.eq(name)));
    let names = |channel: &exr::meta::attribute::ChannelDescription| channel.name.to_string();
    let complete = |h: &exr::meta::header::Header| {
        let named = |name: &str| h.channels.list.iter().any(|c| c.name.eq(name));
        named("Y") || ["R", "G", "B"].iter().all(|name| named(name))
    };
    if !meta.headers.iter().any(complete) {
        let mut channels: Vec<String> = meta.headers.iter().flat_map(|h| h.channels.list.iter().map(names)).collect();
        channels.truncate(12);
        let list = channels.join("`, `");
        return Err(whole(format!("the image has no channels `R`, `G` and `B`, and no `Y`; it has `{list}`")));
    }
    let blank = |size: exr::math::Vec2<usize>| Bitmap {
        width: size.width() as u32,
        height: size.height() as u32,
        texels: vec![Rgb::BLACK; size.area()],
    };
    let set = |bitmap: &mut Bitmap<Rgb>, at: exr::math::Vec2<usize>, value: Rgb| {
        let index = at.y() * bitmap.width as usize + at.x();
        bitmap.texels[index] = value;
    };
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
    if has("Y") && !has("R") {
        let grey = reader
            .specific_channels()
            .required("Y")
            .collect_pixels(move |size, _| blank(size), move |bitmap, at, (y,): (f32,)| set(bitmap, at, Rgb::splat(y)));
        let image = grey.first_valid_layer().all_attributes().non_parallel();
        return Ok(image.from_buffered(Cursor::new(bytes)).map_err(unreadable)?.layer_data.channel_data.pixels);
    }
    let image = reader
        .rgb_channels(
            move |size, _| blank(size),
            move |bitmap, at, (r, g, b): (f32, f32, f32)| set(bitmap, at, Rgb::new(r, g, b)),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(unreadable)?;
    Ok(image.layer_data.channel_data.pixels)
}
