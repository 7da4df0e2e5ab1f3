//! Images in OpenEXR files.

use super::{Image, check_size, whole};
use crate::error::Flaw;
use etendue_core::{rgb::Rgb, texture::Bitmap};
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel};
use std::io::Cursor;

/// The most channels that an error names.
const NAMED: usize = 12;

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
    let any_has = |names: &[&str]| {
        meta.headers.iter().any(|h| names.iter().all(|name| h.channels.list.iter().any(|c| c.name.eq(name))))
    };
    let (in_colour, in_grey) = (any_has(&["R", "G", "B"]), any_has(&["Y"]));
    if !in_colour && !in_grey {
        let channels = meta.headers.iter().flat_map(|h| h.channels.list.iter());
        let names: Vec<String> = channels.map(|c| format!("`{}`", c.name)).collect();
        let more = names.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let named = names[..names.len().min(NAMED)].join(", ");
        return Err(whole(format!("the image has no channels `R`, `G` and `B`, and no `Y`; it has {named}{more}")));
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
    if !in_colour {
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
