//! What can go wrong with a picture file: what, where, and what to do.

use std::path::{Path, PathBuf};

/// Why a picture could not be written or read. The text is one line.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// No writer for this extension.
    #[error("{}: unknown picture format; known: {known}", path.display())]
    UnknownExtension {
        /// The file asked for.
        path: PathBuf,
        /// Extensions that can be written.
        known: String,
    },
    /// The format cannot hold a picture of this size.
    #[error("{}: {width}x{height} is too large for this format (at most {limit} a side); choose .png or .exr", path.display())]
    TooLargeForFormat {
        /// The file asked for.
        path: PathBuf,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Greatest width and height.
        limit: u32,
    },
    /// The system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried, such as `write`.
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The encoder refused.
    #[error("cannot encode the picture: {0}")]
    Encode(String),
    /// The file is no picture, or a damaged one.
    #[error("{}: cannot read the picture: {message}", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        message: String,
    },
}

impl PictureError {
    /// A refusal of the system, for use with `map_err`.
    pub(super) fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, action, source }
    }

    /// A damaged file, for use with `map_err`; keeps the decoder's text on one line.
    pub(super) fn decode(path: &Path, message: impl std::fmt::Display) -> Self {
        let message = message.to_string().replace('\n', " ");
        Self::Decode { path: path.to_owned(), message }
    }
}

impl From<image::ImageError> for PictureError {
    fn from(error: image::ImageError) -> Self {
        Self::Encode(error.to_string())
    }
}

impl From<::exr::error::Error> for PictureError {
    fn from(error: ::exr::error::Error) -> Self {
        Self::Encode(error.to_string())
    }
}

impl From<std::io::Error> for PictureError {
    fn from(error: std::io::Error) -> Self {
        Self::Encode(error.to_string())
    }
}
