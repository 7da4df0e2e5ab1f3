//! The images that a scene's textures and lights hold, as a report has them.

use etendue_core::scene::{self, SceneDescription};
use serde::Serialize;

/// How many images there are and what they take, each counted once.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Images {
    /// Images.
    pub count: usize,
    /// Their texels.
    pub texels: u64,
    /// Bytes that these take.
    pub bytes: u64,
}

/// Counts the images of a scene.
pub fn images(scene: &SceneDescription) -> Images {
    let scene::Images { count, texels, bytes } = scene::Images::of(scene);
    Images { count, texels, bytes }
}
