//! The file itself: binary or text, its JSON, and what it requires.

use super::{Notes, flaw};
use crate::error::{Flaw, Place, abridged};
use gltf_json::Root;

/// The extensions that are read.
pub const EXTENSIONS: [&str; 10] = [
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_sheen",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// A file's JSON, and the bytes that come with it in a binary file.
pub(super) struct Document<'b> {
    pub(super) root: Root,
    pub(super) blob: Option<&'b [u8]>,
}

impl<'b> Document<'b> {
    /// Reads the JSON and looks at what it requires.
    pub(super) fn open(bytes: &'b [u8], lenient: bool, notes: &mut Notes) -> Result<Document<'b>, Flaw> {
        let (json, blob) = match bytes.starts_with(b"glTF") {
            true => chunks(bytes)?,
            false => (bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), None),
        };
        let root = Root::from_slice(json).map_err(|e| {
            let message = e.to_string();
            // The place stands in front; in a binary file it would mislead.
            let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(m, _)| m);
            let place = match std::ptr::eq(json, bytes) && e.line() > 0 {
                true => Place::Column(e.line() as u32, e.column() as u32),
                false => Place::Whole,
            };
            Flaw::new(place, format!("not the JSON of a glTF file: {}", message.chars().take(200).collect::<String>()))
        })?;
        if root.asset.version.split('.').next() != Some("2") {
            return Err(flaw(format!("glTF of the version `{}`; 2.0 is read", abridged(&root.asset.version))));
        }
        if let Some(least) = root.asset.min_version.as_deref().filter(|v| !matches!(*v, "2.0" | "2")) {
            return Err(flaw(format!("the file asks for a reader of glTF {}; this one is of 2.0", abridged(least))));
        }
        if let Some(name) = root.extensions_required.iter().find(|e| !EXTENSIONS.contains(&e.as_str()) && !lenient) {
            return Err(flaw(format!("the file requires the extension `{}`, which is not supported", abridged(name))));
        }
        for name in
            root.extensions_used.iter().chain(&root.extensions_required).filter(|e| !EXTENSIONS.contains(&e.as_str()))
        {
            notes.add(format!("what the extension `{}` adds is left out", abridged(name)));
        }
        Ok(Document { root, blob })
    }
}

/// The JSON and the bytes of a binary file [glTF 2.0, sec. 4.4].
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Flaw> {
    let number = |at: usize| bytes.get(at..).and_then(<[u8]>::first_chunk).map(|b| u32::from_le_bytes(*b));
    let short = || flaw("the binary file ends too early");
    let version = number(4).ok_or_else(short)?;
    if version != 2 {
        return Err(flaw(format!("a binary container of the version {version}; 2 is read")));
    }
    let length = number(8).ok_or_else(short)? as usize;
    if length > bytes.len() {
        return Err(flaw(format!("the header claims {length} bytes, and there are {}", bytes.len())));
    }
    let mut json = None;
    let mut blob = None;
    let mut at = 12;
    while at + 8 <= length {
        let size = number(at).ok_or_else(short)? as usize;
        let kind = number(at + 4).ok_or_else(short)?.to_le_bytes();
        let end = at.saturating_add(8).saturating_add(size);
        let chunk = bytes.get(at + 8..end).filter(|_| end <= length);
        let chunk = chunk.ok_or_else(|| Flaw::new(Place::Byte(at as u64), "a chunk reaches beyond the end"))?;
        match &kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if blob.is_none() => blob = Some(chunk),
            // Others are for extensions.
            _ => {}
        }
        at = end;
    }
    Ok((json.ok_or_else(|| flaw("the binary file has no JSON"))?, blob))
}
