//! Names of images to write, checked before time is spent on rendering.

use crate::{
    error::Error,
    exr_file::{Attribute, ExrFile},
    files::{check_output, plain_name},
    film_file::{FilmFile, film_path},
};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// The image file of a scene: the one that is given, or the scene's name and a suffix in the current folder. A file that was
/// not named is not written over images of other scenes, or over anything else.
pub fn image_path(given: Option<&Path>, scene: &str, suffix: &str) -> Result<PathBuf, Error> {
    let out = given.map_or_else(|| format!("{}{suffix}.exr", plain_name(scene)).into(), Path::to_owned);
    check_image_path(&out)?;
    if given.is_none() {
        check_owner(&out, scene)?;
    }
    Ok(out)
}

/// Refuses an output file that is not an OpenEXR file or whose folder is missing.
pub fn check_image_path(out: &Path) -> Result<(), Error> {
    if out.extension().is_none_or(|e| !e.eq_ignore_ascii_case("exr")) {
        return Err(Error::Content { path: out.into(), reason: "an image's name must end in .exr".into() });
    }
    check_output(out)
}

/// Refuses an image file that is there, or whose film or PNG is, unless the scene is known to be the same.
fn check_owner(out: &Path, scene: &str) -> Result<(), Error> {
    let (film, png) = (film_path(out), out.with_extension("png"));
    let (owner, path) = if out.exists() {
        let scene = ExrFile::read(out).ok().and_then(|mut file| match file.attributes.remove("scene") {
            Some(Attribute::Text(scene)) => Some(scene),
            _ => None,
        });
        (scene, out)
    } else if film.exists() {
        (FilmFile::read(&film).ok().map(|film| film.key.scene), &*film)
    } else if png.exists() {
        (None, &*png)
    } else {
        return Ok(());
    };
    let what = match owner {
        Some(owner) if is_same(&owner, scene) => return Ok(()),
        Some(owner) => format!("is of another scene, `{owner}`"),
        None => "is not known to be a render of this scene".to_owned(),
    };
    let reason = format!("is there and {what}: --out names the file to write");
    Err(Error::Content { path: path.into(), reason })
}

/// Returns `true` if two names of scenes are one file, or one built-in scene.
fn is_same(a: &str, b: &str) -> bool {
    a == b || fs::canonicalize(a).ok().is_some_and(|a| fs::canonicalize(b).is_ok_and(|b| a == b))
}
