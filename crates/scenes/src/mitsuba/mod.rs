//! Scenes in Mitsuba 3's XML.

use crate::{LoadError, LoadedScene};
use std::path::Path;

/// Reads a scene.
pub fn load(_path: &Path) -> Result<LoadedScene, LoadError> {
    unimplemented!()
}
