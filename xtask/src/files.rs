//! Files that are either whole or not there, and standard output.

use crate::error::Error;
use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

/// The root of the workspace that this program was built from.
pub fn workspace_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The folder of a file; `.` for a bare name.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Refuses a file to be written if its folder is missing, so that no time is spent on what cannot be saved.
pub fn check_output(path: &Path) -> Result<(), Error> {
    let folder = folder(path);
    if !folder.is_dir() {
        return Err(Error::Content { path: path.into(), reason: format!("there is no folder {}", folder.display()) });
    }
    if path.is_dir() {
        return Err(Error::Content { path: path.into(), reason: "is a folder".into() });
    }
    Ok(())
}

/// Writes a file under a temporary name in its own folder, then renames it: a reader, or a full disk, never finds or
/// leaves half of it.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut fs::File>) -> io::Result<()>,
) -> Result<(), Error> {
    let attempt = || -> io::Result<()> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".etendue-").suffix(".tmp");
        #[cfg(unix)]
        {
            // A temporary file is private by default; this one becomes an ordinary file (less the umask).
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let mut file = builder.tempfile_in(folder(path))?;
        let mut buffered = BufWriter::new(file.as_file_mut());
        write(&mut buffered)?;
        buffered.flush()?;
        drop(buffered);
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    attempt().map_err(|source| Error::Write { path: path.into(), source })
}

/// Reads a whole file.
pub fn read_whole(path: &Path) -> Result<Vec<u8>, Error> {
    fs::read(path).map_err(|source| Error::Read { path: path.into(), source })
}

/// Prints text on standard output; a reader that has left is no error.
pub fn print(text: &str) -> Result<(), Error> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.write_all(b"\n")).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::Write { path: "standard output".into(), source: e })
        }
        _ => Ok(()),
    }
}

/// Prints a value as indented JSON.
pub fn print_json(value: &impl serde::Serialize) -> Result<(), Error> {
    print(&json(value))
}

/// A value as indented JSON.
pub fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string_pretty(value).expect("the reports have string keys alone")
}

/// Writes a path as text in JSON, which holds Unicode alone: what is not becomes U+FFFD.
pub fn path_text<S: serde::Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}

/// The most bytes of [`plain_name`]: file systems take 255, and something is appended.
const LONGEST_NAME: usize = 180;

/// A scene's name as part of a file's: without folders and extension, as far as file systems take it. Letters of every
/// script stay; what shells or file systems treat in their own way becomes `_`. Names of two scenes may come out alike.
pub fn plain_name(scene: &str) -> String {
    let taken = |c: char| match c {
        c if c.is_ascii() => c.is_ascii_alphanumeric() || "-._=".contains(c),
        // Accents may be characters of their own, so letters alone would not do.
        c => !c.is_control() && !c.is_whitespace(),
    };
    // A built-in scene's parameters may hold a dot, which is no extension.
    let stem = Path::new(scene).file_stem().filter(|_| Path::new(scene).is_file());
    let whole = stem.map_or_else(|| scene.into(), |s| s.to_string_lossy());
    let mut plain = String::new();
    for c in whole.chars().map(|c| if taken(c) { c } else { '_' }) {
        if plain.len() + c.len_utf8() > LONGEST_NAME {
            break;
        }
        plain.push(c);
    }
    match plain.trim_start_matches('.') {
        "" => "scene".to_owned(),
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_litter() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, |w| w.write_all(b"old")).unwrap();
        let full = |w: &mut BufWriter<&mut fs::File>| {
            w.write_all(&[0; 100_000])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        };
        let error = write_whole(&path, full).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("a.txt"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn names_become_plain() {
        assert_eq!(plain_name("many-lights:n=4096"), "many-lights_n=4096");
        assert_eq!(plain_name("ring:w=0.5,h=1"), "ring_w=0.5_h=1");
        assert_eq!(plain_name("../a b/c"), "_a_b_c");
        assert_eq!(["...", ""].map(plain_name), ["scene", "scene"]);
    }

    #[test]
    fn names_keep_letters_of_every_script() {
        for name in ["é", "ü", "e\u{301}", "シーン", "сцена", "🦀"] {
            assert_eq!(plain_name(name), name);
        }
        assert_eq!(plain_name("a\u{2028}b\u{85}c\u{3000}d"), "a_b_c_d");
        let long = plain_name(&"シ".repeat(100));
        assert!(long.len() <= LONGEST_NAME && long.chars().all(|c| c == 'シ'), "{long}");
    }

    #[test]
    fn paths_that_are_no_text_are_written_as_near_to_it_as_can_be() {
        #[derive(serde::Serialize)]
        struct Holder(#[serde(serialize_with = "path_text")] PathBuf);
        #[cfg(unix)]
        {
            use std::os::unix::ffi::OsStringExt;
            let path = std::ffi::OsString::from_vec(b"a\xffb".to_vec()).into();
            assert_eq!(json(&Holder(path)), "\"a\u{fffd}b\"");
        }
        assert_eq!(json(&Holder("シ.exr".into())), "\"シ.exr\"");
    }
}
