//! Pictures on disk: a film written by its file's extension, and pictures read back to be compared.
//!
//! [`FORMATS`] is the list of what can be written; to add a format, add its file and one row.
//! A picture reaches its final name only when it is complete: see [`PendingFile`].

mod annotated;
mod eight_bit;
mod error;
mod exr;
mod format;
mod numbered;
mod pending_file;
mod ppm;
mod read;
mod transfer;

pub use annotated::{Note, write_annotated};
pub use eight_bit::EightBit;
pub use error::PictureError;
pub use format::{FORMATS, Format, WriteOptions};
pub use numbered::NumberedName;
pub use pending_file::{PendingFile, exit};
pub use read::{Encoding, Picture, read};
pub use transfer::{srgb_decode, srgb_encode};
