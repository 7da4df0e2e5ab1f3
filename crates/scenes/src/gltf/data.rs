//! Bytes: those of buffers, and whatever a URI names.

use super::{document::Document, flaw, item};
use crate::{
    error::{Flaw, abridged, read_file},
    folders::Folders,
};
use gltf_json::{Root, buffer};
use std::{borrow::Cow, collections::HashMap, path::PathBuf, rc::Rc};

/// The largest file that is read beside the scene's.
const LARGEST_FILE: u64 = super::LARGEST_FILE;

/// The buffers of a file.
pub(super) struct Buffers<'b> {
    list: Vec<Bytes<'b>>,
}

enum Bytes<'b> {
    /// Of the file itself.
    Own(&'b [u8]),
    /// Of another file, or written in the JSON.
    Other(Rc<Vec<u8>>),
}

impl Bytes<'_> {
    fn get(&self) -> &[u8] {
        match self {
            Bytes::Own(bytes) => bytes,
            Bytes::Other(bytes) => bytes,
        }
    }
}

impl<'b> Buffers<'b> {
    /// Reads every buffer, each file once.
    pub(super) fn load(document: &Document<'b>, folders: Option<&Folders>) -> Result<Buffers<'b>, Flaw> {
        let mut files: HashMap<PathBuf, Rc<Vec<u8>>> = HashMap::new();
        let mut list = Vec::new();
        for (index, buffer) in document.root.buffers.iter().enumerate() {
            let named = |e: String| flaw(format!("buffers[{index}]: {e}"));
            let bytes = match (&buffer.uri, document.blob) {
                (None, Some(blob)) if index == 0 => Bytes::Own(blob),
                (None, _) => return Err(named("it has neither a URI nor bytes in the file".to_owned())),
                (Some(uri), _) => match Source::of(uri, folders).map_err(named)? {
                    Source::Inline(bytes) => Bytes::Other(Rc::new(bytes)),
                    Source::File(path) => match files.get(&path) {
                        Some(known) => Bytes::Other(known.clone()),
                        None => {
                            let bytes = Rc::new(read_file(&path, LARGEST_FILE).map_err(|e| named(e.to_string()))?);
                            files.insert(path, bytes.clone());
                            Bytes::Other(bytes)
                        }
                    },
                },
            };
            let (claimed, length) = (buffer.byte_length.0, bytes.get().len());
            if claimed > length as u64 {
                return Err(named(format!("it claims {claimed} bytes, and there are {length}")));
            }
            list.push(bytes);
        }
        Ok(Buffers { list })
    }

    /// The bytes of a buffer view, and the stride that it says.
    pub(super) fn view(&self, root: &Root, index: usize) -> Result<(&[u8], Option<usize>), Flaw> {
        let view: &buffer::View = item(&root.buffer_views, "bufferViews", index)?;
        let buffer = item(&self.list, "buffers", view.buffer.value())?.get();
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0).filter(|end| *end <= buffer.len() as u64);
        let end = end.ok_or_else(|| flaw(format!("bufferViews[{index}]: it reaches beyond its buffer's end")))?;
        Ok((&buffer[start as usize..end as usize], view.byte_stride.map(|s| s.0)))
    }

    /// The bytes of an image.
    pub(super) fn image(&self, root: &Root, index: usize, folders: Option<&Folders>) -> Result<Cow<'_, [u8]>, Flaw> {
        let image = item(&root.images, "images", index)?;
        let named = |e: String| flaw(format!("images[{index}]: {e}"));
        match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match Source::of(uri, folders).map_err(named)? {
                Source::Inline(bytes) => Ok(Cow::Owned(bytes)),
                Source::File(path) => Ok(Cow::Owned(read_file(&path, LARGEST_FILE).map_err(|e| named(e.to_string()))?)),
            },
            (None, Some(view)) => Ok(Cow::Borrowed(self.view(root, view.value())?.0)),
            (None, None) => Err(named("it has neither a URI nor a buffer view".to_owned())),
        }
    }
}

/// What a URI names.
#[derive(Debug, PartialEq)]
enum Source {
    Inline(Vec<u8>),
    File(PathBuf),
}

impl Source {
    fn of(uri: &str, folders: Option<&Folders>) -> Result<Source, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (kind, data) = data.split_once(',').ok_or("its data URI has no data")?;
            let bytes = match kind.ends_with(";base64") {
                true => base64(data),
                false => percent_decoded(data),
            };
            return bytes.map(Source::Inline).ok_or_else(|| "its data URI cannot be decoded".to_owned());
        }
        let refused = |why: &str| format!("the file `{}` {why}", abridged(uri));
        let decoded = percent_decoded(uri).and_then(|bytes| String::from_utf8(bytes).ok());
        let folders = folders.ok_or_else(|| refused("cannot be read: the scene has no folder"))?;
        // Some programs write names as they are, with a `%` that stands for itself.
        let written = || folders.find(uri).map_err(|_| refused("has a name that cannot be decoded"));
        let Some(name) = decoded else { return written().map(Source::File) };
        if name.contains("://") {
            return Err(refused("is not in a file"));
        }
        let found = folders.find(&name);
        if found.is_err() && name != uri && folders.find(uri).is_ok_and(|path| path.is_file()) {
            return folders.find(uri).map(Source::File);
        }
        found.map(Source::File)
    }
}

/// Text with `%41` for `A`.
fn percent_decoded(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len());
    let mut bytes = text.bytes();
    while let Some(byte) = bytes.next() {
        out.push(match byte {
            b'%' => {
                let mut digit = || bytes.next().and_then(|b| char::from(b).to_digit(16));
                (16 * digit()? + digit()?) as u8
            }
            other => other,
        });
    }
    Some(out)
}

/// [RFC 4648, sec. 4], with or without the padding.
fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut bits, mut held) = (0u32, 0);
    for byte in text {
        let six = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = (bits << 6) | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    // What is left of the last six bits fills a byte up and says nothing.
    (held < 6 && bits == 0).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_decoded() {
        for (text, bytes) in [
            ("", &b""[..]),
            ("Zg==", b"f"),
            ("Zm8=", b"fo"),
            ("Zm8", b"fo"),
            ("Zm9v", b"foo"),
            ("Zm9vYmFy", b"foobar"),
            ("+/+/", b"\xFB\xFF\xBF"),
        ] {
            assert_eq!(base64(text).as_deref(), Some(bytes), "{text}");
        }
        for wrong in ["Z", "Zm9v!", "Zm 9v", "Zm9", "Zh=="] {
            assert_eq!(base64(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn names_are_decoded_and_stay_inside() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a b.bin"), b"x").unwrap();
        std::fs::create_dir(folder.path().join("c")).unwrap();
        let folders = Folders::of(&folder.path().join("scene.gltf"), false).unwrap();
        let find = |uri: &str| Source::of(uri, Some(&folders));
        assert!(matches!(find("a%20b.bin"), Ok(Source::File(_))));
        assert!(matches!(find("c/../a b.bin"), Ok(Source::File(_))));
        // As it is written, where nothing has the decoded name.
        for name in ["at 10%.bin", "b%20c.bin"] {
            std::fs::write(folder.path().join(name), b"x").unwrap();
            let Ok(Source::File(path)) = find(name) else { panic!("{name}") };
            assert!(path.ends_with(name));
        }
        assert_eq!(find("data:text/plain,a%20b"), Ok(Source::Inline(b"a b".to_vec())));
        for outside in ["../a", "/etc/hosts", "c/../../a", "%2e%2e/a"] {
            let message = find(outside).unwrap_err();
            assert!(message.contains("lies outside of the scene's folder"), "{message}");
        }
        for wrong in
            ["none.bin", "%zz", "%f", "data:,%", "data:;base64,*", "data:nothing", "%ff", "https://example.org/a"]
        {
            find(wrong).unwrap_err();
        }
        assert!(Source::of("a%20b.bin", None).is_err());
    }
}
