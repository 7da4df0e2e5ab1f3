//! What can go wrong, and the exit code that says so.

use std::{io, path::PathBuf};

/// Why a command did not do what it was asked to.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// What was asked for makes no sense.
    #[error("{0}")]
    Input(String),
    /// A scene cannot be loaded.
    #[error("{0}")]
    Load(#[from] etendue_scenes::LoadError),
    /// A scene was loaded and is not valid.
    #[error("{scene}: {source}")]
    Scene {
        /// What the scene was called on the command line.
        scene: String,
        /// What is wrong with it.
        source: etendue_core::scene::SceneError,
    },
    /// A file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file or folder cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file does not hold what it should.
    #[error("{}: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A check came out negative.
    #[error("{0}")]
    Failed(String),
    /// Ctrl-C came before there was anything to save.
    #[error("interrupted before anything was finished")]
    Interrupted,
}

impl Error {
    /// The process's exit code: 2 for bad input, 1 for a failed check, 130 for an interruption with nothing saved.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Failed(_) => 1,
            Error::Interrupted => 130,
            _ => 2,
        }
    }
}
