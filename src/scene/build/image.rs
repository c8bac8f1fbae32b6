//! Image files: decoded once each, within a budget for all of them together.

use crate::scene::desc::NameRef;
use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{Outcome, Problem};
use crate::scene::files::{FileError, Files};
use crate::scene::limits::{Limits, exceeded};
use crate::scene::texels::Texels;
use crate::scene::texture::ImageTexture;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader};
use std::collections::HashMap;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;

/// Why an image could not be decoded.
#[derive(Debug, thiserror::Error)]
enum DecodeError {
    #[error("{0}")]
    Image(#[from] ImageError),
    #[error("width or height is {}", exceeded("texture-edge", *.0))]
    Edge(u64),
    #[error("the scene's textures have {}", exceeded("texture-bytes", *.0))]
    Budget(u64),
    #[error("the decoder gave up; the file is damaged")]
    Panicked,
    #[error("it has no pixels")]
    Empty,
    #[error("it has too many pixels")]
    Size,
}

/// The images of a scene by file, and how many bytes more they may take.
pub struct ImageStore {
    files: Files,
    decoded: HashMap<PathBuf, Arc<Texels>>,
    bytes_left: u64,
    limits: Limits,
}

impl ImageStore {
    /// No images yet; they will be read from `files`.
    pub fn new(files: Files, limits: &Limits) -> Self {
        Self { files, decoded: HashMap::new(), bytes_left: limits.texture_bytes, limits: limits.clone() }
    }

    /// The texture of an image file, repeating every `size` units.
    pub fn load(&mut self, file: &NameRef, size: f32) -> Outcome<ImageTexture> {
        let name = shortened(&file.name);
        let unreadable = |error: FileError| Problem::new(file.at, format!("cannot read image \"{name}\": {error}"));
        let path = self.files.locate(&file.name).map_err(unreadable)?;
        let texels = match self.decoded.get(&path) {
            Some(texels) => Arc::clone(texels),
            None => {
                let bytes = self.files.read(&path).map_err(unreadable)?;
                let undecodable = |error| {
                    Problem::new(
                        file.at,
                        format!("cannot decode image \"{name}\" (PNG, JPEG and BMP are known): {error}"),
                    )
                };
                let texels = Arc::new(self.decode(&bytes).map_err(undecodable)?);
                self.bytes_left = self.bytes_left.saturating_sub(decoded_bytes(texels.width(), texels.height()));
                self.decoded.insert(path, Arc::clone(&texels));
                texels
            }
        };
        Ok(ImageTexture { texels, size })
    }

    fn decode(&self, bytes: &[u8]) -> Result<Texels, DecodeError> {
        // The decoders are meant never to panic on damaged files; should one do so, only its image is lost.
        catch_unwind(AssertUnwindSafe(|| self.decode_unguarded(bytes))).unwrap_or(Err(DecodeError::Panicked))
    }

    fn decode_unguarded(&self, bytes: &[u8]) -> Result<Texels, DecodeError> {
        let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(ImageError::IoError)?;
        let mut decoder = reader.into_decoder()?;
        let (width, height) = decoder.dimensions();
        if u64::from(width.max(height)) > self.limits.texture_edge {
            return Err(DecodeError::Edge(self.limits.texture_edge));
        }
        if width == 0 || height == 0 {
            return Err(DecodeError::Empty);
        }
        if decoder.total_bytes().max(decoded_bytes(width, height)) > self.bytes_left {
            return Err(DecodeError::Budget(self.limits.texture_bytes));
        }
        let mut limits = image::Limits::no_limits();
        limits.max_alloc = Some(self.bytes_left);
        decoder.set_limits(limits)?;
        // Alpha is left out; 16-bit channels are reduced to 8.
        let pixels = DynamicImage::from_decoder(decoder)?.into_rgb8().into_raw();
        Texels::new(width, height, pixels.as_chunks().0).ok_or(DecodeError::Size)
    }
}

/// Bytes of a decoded picture, as the budget counts them.
fn decoded_bytes(width: u32, height: u32) -> u64 {
    u64::from(width) * u64::from(height) * 3
}
