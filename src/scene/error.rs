//! What can be wrong with a scene file: what, where, and what to do.

use super::files::CANCELLED;
use std::path::PathBuf;

/// A place in a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// 1-based line and column, where known.
    pub line_column: Option<(usize, usize)>,
    /// The value's JSON pointer, such as `/objects/3/radius`, or XPath, such as `/scene/objects/sphere[4]/@radius`;
    /// empty for the whole file and in formats without names for their parts.
    pub pointer: String,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some((line, column)) = self.line_column {
            write!(f, ":{line}:{column}")?;
        }
        if !self.pointer.is_empty() {
            write!(f, " ({})", self.pointer)?;
        }
        Ok(())
    }
}

/// Why a scene could not be loaded. The text is one line: place, problem, remedy.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file, or one it refers to, could not be read.
    #[error("{place}: cannot read {what}: {source}")]
    Io {
        /// Where the file was asked for.
        place: Place,
        /// What was to be read.
        what: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file's contents are wrong.
    #[error("{place}: {message}")]
    Invalid {
        /// Where.
        place: Place,
        /// What is wrong, and what would be right.
        message: String,
    },
    /// It was ended early by [`Progress::cancel`](super::Progress::cancel).
    #[error("{place}: {CANCELLED}")]
    Cancelled {
        /// The scene.
        place: Place,
    },
    /// A reader gave up in a way that it never should.
    #[error("{place}: cannot be read, since the program has a fault: {message}; please report it with this file")]
    Broken {
        /// The scene.
        place: Place,
        /// What the fault says of itself.
        message: String,
    },
    /// No reader for this kind of file.
    #[error("{file}: unknown scene format; known: {known}")]
    UnknownFormat {
        /// The file.
        file: String,
        /// Extensions that can be read.
        known: String,
    },
}

/// Something odd that was worked around.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Where.
    pub place: Place,
    /// What was odd and what was done about it.
    pub message: String,
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}
