//! OpenEXR files: named channels of `f32` with attributes.

use crate::{
    error::Error,
    files::{read_whole, write_whole},
    picture::Picture,
};
use etendue_core::{film::Film, rgb::Rgb};
use exr::{
    compression::Compression,
    image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer},
    meta::{
        MetaData,
        attribute::{AttributeValue, LineOrder, Text},
        header::LayerAttributes,
    },
    prelude::{ReadChannels, ReadLayers, WritableImage},
};
use glam::UVec2;
use std::{
    collections::BTreeMap,
    io::{self, Cursor},
    path::Path,
};

/// The value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// Text.
    Text(String),
    /// A whole number.
    Whole(i32),
    /// A number.
    Number(f64),
}

/// An image file in memory.
#[derive(Clone, Debug, Default)]
pub struct ExrFile {
    /// Width and height.
    pub size: UVec2,
    /// Channels by name, row by row from the top.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// Attributes by name; those of other types are not read.
    pub attributes: BTreeMap<String, Attribute>,
}

/// What every program reads: lines from the top, compressed by deflate.
const ENCODING: Encoding =
    Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
/// No OpenEXR compression of real images comes near this ratio; a header that claims more is not believed.
const MOST_EXPANSION: u64 = 10_000;

impl ExrFile {
    /// A file of a picture alone.
    pub fn of(picture: &Picture) -> ExrFile {
        let mut file = ExrFile { size: picture.size, ..ExrFile::default() };
        file.add_layer("", picture.pixels.iter().map(|p| p.to_array()));
        file
    }

    /// Adds the channels R, G and B, with a prefix such as `variance.`.
    pub fn add_layer(&mut self, prefix: &str, pixels: impl Iterator<Item = [f32; 3]> + Clone) {
        for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
            self.channels.insert(format!("{prefix}{name}"), pixels.clone().map(|p| p[c]).collect());
        }
    }

    /// The channels R, G and B with a prefix, if all three are there.
    pub fn layer(&self, prefix: &str) -> Option<Vec<Rgb>> {
        let channel = |name| self.channels.get(&format!("{prefix}{name}"));
        let (r, g, b) = (channel("R")?, channel("G")?, channel("B")?);
        Some(r.iter().zip(g).zip(b).map(|((&r, &g), &b)| Rgb::new(r, g, b)).collect())
    }

    /// Writes the file, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let channel =
            |(name, values): (&String, &Vec<f32>)| AnyChannel::new(encode_text(name), FlatSamples::F32(values.clone()));
        let software = encode_text(concat!("etendue ", env!("CARGO_PKG_VERSION")));
        let mut attributes = LayerAttributes { software_name: Some(software), ..LayerAttributes::default() };
        for (name, value) in &self.attributes {
            let value = match value {
                Attribute::Text(t) => AttributeValue::Text(encode_text(t)),
                Attribute::Whole(i) => AttributeValue::I32(*i),
                Attribute::Number(x) => AttributeValue::F64(*x),
            };
            attributes.other.insert(encode_text(name), value);
        }
        let channels = AnyChannels::sort(self.channels.iter().map(channel).collect());
        let size = (self.size.x as usize, self.size.y as usize);
        let image = Image::from_layer(Layer::new(size, attributes, ENCODING, channels));
        let mut bytes = Cursor::new(Vec::new());
        // Encoded in memory: the encoder seeks, and what can fail on disk is then one plain write.
        let encoded = image.write().to_buffered(&mut bytes).map_err(io::Error::other);
        encoded.map_err(|source| Error::Write { path: path.into(), source })?;
        write_whole(path, |w| io::Write::write_all(w, bytes.get_ref()))
    }

    /// Reads the first layer of a file.
    pub fn read(path: &Path) -> Result<ExrFile, Error> {
        let bytes = read_whole(path)?;
        // The decoder is not ours; should a corrupt file make it panic, that is the file's error and not an abort.
        let decoded = quietly(|| decode(&bytes)).unwrap_or_else(|| Err("is corrupt".into()));
        decoded.map_err(|reason| Error::Content { path: path.into(), reason: format!("as an OpenEXR image: {reason}") })
    }
}

/// Text as a header holds it: UTF-8, as the format says.
fn encode_text(text: &str) -> Text {
    // `Text::from` takes Latin-1 alone and panics at anything else.
    Text::from_slice_unchecked(text.as_bytes())
}

/// Text of a header: UTF-8, or Latin-1 where it is not, as some programs write.
fn decode_text(text: &Text) -> String {
    std::str::from_utf8(text.as_slice()).map_or_else(|_| text.chars().collect(), str::to_owned)
}

/// Runs something that may panic, without the message; none if it did.
fn quietly<T: Send>(run: impl FnOnce() -> T + Send) -> Option<T> {
    // A resumed panic calls no hook and prints nothing, but one in a decoder's depths does: it runs in a thread whose
    // name the hook knows.
    static HOOK: std::sync::Once = std::sync::Once::new();
    const NAME: &str = "decoder";
    HOOK.call_once(|| {
        let previous = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some(NAME) {
                previous(info);
            }
        }));
    });
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name(NAME.into()).spawn_scoped(scope, run);
        thread.ok()?.join().ok()
    })
}

fn decode(bytes: &[u8]) -> Result<ExrFile, String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| e.to_string())?;
    let mut claimed = 0u64;
    for header in &meta.headers {
        let pixels = header.layer_size.width() as u64 * header.layer_size.height() as u64;
        if pixels > Film::MOST_PIXELS {
            return Err(format!("its header claims {pixels} pixels, more than are read"));
        }
        claimed += pixels * header.channels.bytes_per_pixel as u64;
    }
    if claimed / MOST_EXPANSION > bytes.len() as u64 {
        return Err(format!("its header claims {claimed} bytes of pixels in a file of {} bytes", bytes.len()));
    }
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let reader = reader.first_valid_layer().all_attributes().non_parallel();
    let layer = reader.from_buffered(Cursor::new(bytes)).map_err(|e| e.to_string())?.layer_data;
    let size = UVec2::new(layer.size.width() as u32, layer.size.height() as u32);
    let pixels = size.x as usize * size.y as usize;
    let mut file = ExrFile { size, ..ExrFile::default() };
    for channel in layer.channel_data.list {
        let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
        if values.len() == pixels {
            file.channels.insert(decode_text(&channel.name), values);
        }
    }
    for (name, value) in &layer.attributes.other {
        let value = match value {
            AttributeValue::Text(t) => Attribute::Text(decode_text(t)),
            AttributeValue::I32(i) => Attribute::Whole(*i),
            AttributeValue::F64(x) => Attribute::Number(*x),
            AttributeValue::F32(x) => Attribute::Number(f64::from(*x)),
            _ => continue,
        };
        file.attributes.insert(decode_text(name), value);
    }
    Ok(file)
}

/// Reads the picture of a file: its channels R, G and B.
pub fn read_picture(path: &Path) -> Result<Picture, Error> {
    picture_of(&ExrFile::read(path)?, path)
}

/// The picture of a file that was read from a path.
pub fn picture_of(file: &ExrFile, path: &Path) -> Result<Picture, Error> {
    match file.layer("") {
        Some(pixels) => Ok(Picture { size: file.size, pixels }),
        None => {
            let there: Vec<&str> = file.channels.keys().map(String::as_str).collect();
            let reason = format!("has not the channels R, G and B; it has: {}", there.join(", "));
            Err(Error::Content { path: path.into(), reason })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> ExrFile {
        let size = UVec2::new(19, 7);
        let values = (0..size.x * size.y).map(|i| [i as f32 * 0.1, 1.0 / (1.0 + i as f32), 3e6]);
        let mut file = ExrFile { size, ..ExrFile::default() };
        file.add_layer("", values.clone());
        file.add_layer("variance.", values.map(|v| v.map(|x| x * 1e-9)));
        file.attributes.insert("scene".into(), Attribute::Text("cornell".into()));
        file.attributes.insert("passes".into(), Attribute::Whole(7));
        file.attributes.insert("seconds".into(), Attribute::Number(0.125));
        file
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let written = sample();
        written.write(&path).unwrap();
        let read = ExrFile::read(&path).unwrap();
        assert_eq!(read.size, written.size);
        assert_eq!(read.channels, written.channels);
        assert_eq!(read.attributes, written.attributes);
    }

    #[test]
    fn text_in_any_script_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        for text in ["", "é", "シーン/scene.xml", "🦀.xml", "e\u{301}\u{202e}", &"ж".repeat(5000)] {
            let mut written = sample();
            written.attributes.insert("scene".into(), Attribute::Text(text.into()));
            written.attributes.insert("シーン".into(), Attribute::Text(text.into()));
            written.channels.insert("領域".into(), vec![0.5; 19 * 7]);
            written.write(&path).unwrap();
            let read = ExrFile::read(&path).unwrap();
            assert_eq!((read.attributes, read.channels), (written.attributes, written.channels), "{text}");
        }
        assert_eq!(decode_text(&Text::from("caf\u{e9}")), "caf\u{e9}");
    }

    #[test]
    fn damage_is_an_error_and_never_a_panic() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        sample().write(&path).unwrap();
        let good = std::fs::read(&path).unwrap();
        for cut in (0..good.len()).step_by(23) {
            std::fs::write(&path, &good[..cut]).unwrap();
            let error = ExrFile::read(&path).unwrap_err().to_string();
            assert!(error.contains("a.exr"), "{error}");
        }
        // A changed byte may leave a readable file; it must not do worse than an error.
        for (i, flip) in (0..good.len()).step_by(5).zip([1u8, 0x80, 0xff, 0x10].into_iter().cycle()) {
            let mut bad = good.clone();
            bad[i] ^= flip;
            std::fs::write(&path, &bad).unwrap();
            let _ = ExrFile::read(&path);
        }
    }

    #[test]
    fn a_huge_header_is_not_believed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let mut file = ExrFile { size: UVec2::new(1, 1), ..ExrFile::default() };
        file.add_layer("", [[1.0; 3]].into_iter());
        file.write(&path).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let at = bytes.windows(11).position(|w| w == b"dataWindow\0").unwrap() + 11 + 6 + 4;
        for (i, corner) in [0i32, 0, 40_000, 40_000].into_iter().enumerate() {
            bytes[at + 4 * i..at + 4 * i + 4].copy_from_slice(&corner.to_le_bytes());
        }
        std::fs::write(&path, &bytes).unwrap();
        let error = ExrFile::read(&path).unwrap_err().to_string();
        assert!(error.contains("claims"), "{error}");
    }
}
