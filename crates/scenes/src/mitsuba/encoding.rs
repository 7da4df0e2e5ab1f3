//! Encodings of scene files.

use crate::error::{Flaw, Place, abridged};
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE};

/// The text of an XML file: in the encoding of its byte order mark, in UTF-16 if every other byte is zero, in the one that
/// its declaration states, or else in UTF-8.
pub(super) fn text(bytes: Vec<u8>) -> Result<String, Flaw> {
    let (encoding, mark) = match (Encoding::for_bom(&bytes), bytes.as_slice()) {
        (Some(marked), _) => marked,
        (None, [b'<', 0, ..]) => (UTF_16LE, 0),
        (None, [0, b'<', ..]) => (UTF_16BE, 0),
        (None, _) => (declared(&bytes)?, 0),
    };
    if encoding == UTF_8 {
        return String::from_utf8(bytes).map_err(|e| {
            Flaw::new(
                Place::Byte(e.utf8_error().valid_up_to() as u64),
                "the text is not UTF-8, the encoding it is read in",
            )
        });
    }
    let text = encoding.decode_without_bom_handling_and_without_replacement(&bytes[mark..]);
    let wrong = || Flaw::new(Place::Whole, format!("the text is not {}, its encoding", encoding.name()));
    text.map(|text| text.into_owned()).ok_or_else(wrong)
}

/// The encoding that the declaration in the first line states.
fn declared(bytes: &[u8]) -> Result<&'static Encoding, Flaw> {
    let end = bytes.windows(2).position(|pair| pair == b"?>").filter(|_| bytes.starts_with(b"<?xml"));
    let declaration = String::from_utf8_lossy(&bytes[..end.unwrap_or(0)]);
    let Some((_, after)) = declaration.split_once("encoding") else { return Ok(UTF_8) };
    let label = after.trim_start().trim_start_matches('=').trim().split(['"', '\'']).nth(1).unwrap_or_default();
    match Encoding::for_label(label.as_bytes()) {
        // A text whose declaration could be read byte by byte is not of 16 bits, whatever it says.
        Some(encoding) if encoding == UTF_16LE || encoding == UTF_16BE => Ok(UTF_8),
        Some(encoding) => Ok(encoding),
        None => Err(Flaw::new(Place::Whole, format!("the encoding `{}` is not known", abridged(label)))),
    }
}
