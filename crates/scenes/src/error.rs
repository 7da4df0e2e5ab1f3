//! What can be wrong with a scene's name or file.

use std::{
    fmt, io,
    path::{Path, PathBuf},
};
use thiserror::Error;

/// Why a scene could not be loaded.
#[derive(Debug, Error)]
pub enum LoadError {
    /// Neither a built-in scene nor a file.
    #[error("unknown scene `{name}`{}; built-in scenes are {known}, and a path to a .xml, .gltf or .glb file is a scene too", did_you_mean(*.nearest))]
    UnknownScene {
        /// What was asked for.
        name: String,
        /// The built-in scene of the most similar name.
        nearest: Option<&'static str>,
        /// The names of all built-in scenes, with commas.
        known: String,
    },
    /// A built-in scene has no such parameter.
    #[error("scene `{scene}` has no parameter `{name}`{}; {known}", did_you_mean(*.nearest))]
    UnknownParameter {
        /// The built-in scene.
        scene: &'static str,
        /// What was given.
        name: String,
        /// The parameter of the most similar name.
        nearest: Option<&'static str>,
        /// What parameters it has, as a sentence.
        known: String,
    },
    /// A built-in scene's parameter has a value that it may not have.
    #[error("scene `{scene}`: parameter {name}: `{value}` is not {expected}")]
    ParameterValue {
        /// The built-in scene.
        scene: &'static str,
        /// The parameter.
        name: String,
        /// What was given.
        value: String,
        /// What may be given.
        expected: String,
    },
    /// A file of a kind that no importer reads.
    #[error("{}: scenes are read from .xml, .gltf and .glb files; `{extension}` is not supported", .path.display())]
    UnsupportedFormat {
        /// The file.
        path: PathBuf,
        /// How its name ends.
        extension: String,
    },
    /// A file that cannot be read at all.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file with something wrong in it.
    #[error("{}{flaw}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        flaw: Flaw,
    },
}

fn did_you_mean(nearest: Option<&'static str>) -> String {
    nearest.map(|n| format!(" (did you mean `{n}`?)")).unwrap_or_default()
}

/// Something wrong in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Where.
    pub place: Place,
    /// What.
    pub message: String,
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// A line, counted from 1.
    Line(u32),
    /// A line and a column in characters, both counted from 1.
    Column(u32, u32),
    /// A byte, counted from 0.
    Byte(u64),
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Place::Whole => write!(f, ": {}", self.message),
            Place::Line(line) => write!(f, ":{line}: {}", self.message),
            Place::Column(line, column) => write!(f, ":{line}:{column}: {}", self.message),
            Place::Byte(byte) => write!(f, ": at byte {byte}: {}", self.message),
        }
    }
}

impl Flaw {
    pub(crate) fn new(place: Place, message: impl Into<String>) -> Flaw {
        Flaw { place, message: message.into() }
    }

    /// As the error of a file.
    pub(crate) fn of(self, path: &Path) -> LoadError {
        LoadError::File { path: path.to_owned(), flaw: self }
    }
}

/// Reads a whole file of at most `limit` bytes.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
    use io::Read;
    let fail = |source| LoadError::Read { path: path.to_owned(), source };
    let file = std::fs::File::open(path).map_err(fail)?;
    let mut bytes = Vec::new();
    // One byte more than may be: a special file's length is not known beforehand.
    file.take(limit + 1).read_to_end(&mut bytes).map_err(fail)?;
    if bytes.len() as u64 > limit {
        return Err(Flaw::new(Place::Whole, format!("larger than {limit} bytes, the most that is read")).of(path));
    }
    Ok(bytes)
}

/// The candidate that is most like `name`, if one is at all like it.
pub(crate) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|candidate| (edit_distance(name, candidate), candidate))
        .filter(|(distance, candidate)| *distance < candidate.len() && *distance <= candidate.len().div_ceil(3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// Levenshtein's distance, on bytes.
fn edit_distance(a: &str, b: &str) -> usize {
    // Only short words are compared; a long one is like none of them.
    if a.len() > 64 {
        return usize::MAX;
    }
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.bytes().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.bytes().enumerate() {
            let substituted = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

/// At most the first few characters of a text, for a message.
pub(crate) fn abridged(text: &str) -> String {
    const MOST: usize = 40;
    if text.chars().count() <= MOST {
        return text.to_owned();
    }
    text.chars().take(MOST).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distance_counts_edits() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("abc", "abc"), 0);
    }

    #[test]
    fn nearest_needs_likeness() {
        assert_eq!(nearest("cornel", ["furnace", "cornell"]), Some("cornell"));
        assert_eq!(nearest("zebra", ["furnace", "cornell"]), None);
    }

    #[test]
    fn long_files_are_not_read_whole() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), [0; 11]).unwrap();
        assert_eq!(read_file(file.path(), 11).unwrap().len(), 11);
        let error = read_file(file.path(), 10).unwrap_err().to_string();
        assert!(error.ends_with(": larger than 10 bytes, the most that is read"), "{error}");
    }
}
