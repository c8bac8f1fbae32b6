//! Images of the sky: Radiance and OpenEXR files of linear radiance, reduced to what a sky needs.
//!
//! | file | what |
//! |---|---|
//! | [`radiance`] | Radiance pictures (`.hdr`) |
//! | [`openexr`] | OpenEXR pictures (`.exr`) |
//! | [`canvas`] | the picture under construction: smaller, finite, not negative |

mod canvas;
mod openexr;
mod radiance;

use super::refused::Refused;
use crate::scene::environment::SkyImage;
use crate::scene::guard::guarded;
use crate::scene::limits::Limits;
use crate::scene::progress::Progress;
use canvas::Canvas;

/// Why an image of the sky could not be decoded.
#[derive(Debug, thiserror::Error)]
pub enum SkyError {
    #[error("it is neither a Radiance picture (.hdr) nor an OpenEXR picture (.exr)")]
    Unknown,
    #[error("{0}")]
    Radiance(#[from] radiance::RadianceError),
    #[error("{0}")]
    Exr(#[from] openexr::ExrError),
    #[error("{0}")]
    Refused(#[from] Refused),
}

/// What an image may ask for, and who may end it.
#[derive(Clone, Copy)]
pub struct Allowed<'a> {
    /// The limits of the load.
    pub limits: &'a Limits,
    /// How many bytes more its textures may take.
    pub bytes: u64,
    /// May be cancelled.
    pub progress: &'a Progress,
}

impl Allowed<'_> {
    /// Whether a picture of this size may be decoded.
    fn check_size(&self, width: u64, height: u64) -> Result<(), SkyError> {
        if width == 0 || height == 0 {
            return Err(Refused::Empty.into());
        }
        if width.max(height) > self.limits.texture_edge {
            return Err(Refused::Edge(self.limits.texture_edge).into());
        }
        let kept = Canvas::bytes(width, height);
        if kept > self.bytes { Err(Refused::Budget(self.limits.texture_bytes).into()) } else { Ok(()) }
    }

    fn check_cancelled(&self) -> Result<(), SkyError> {
        if self.progress.is_cancelled() { Err(Refused::Cancelled.into()) } else { Ok(()) }
    }
}

/// A decoded image, and what was odd about it.
#[derive(Debug)]
pub struct Decoded {
    pub image: SkyImage,
    pub odd: Vec<String>,
}

/// The bytes that an image takes once it is decoded.
pub fn size_of(image: &SkyImage) -> u64 {
    size_of_val(&*image.texels) as u64
}

/// Decodes the image in `bytes`, which is called `name`. Its kind is known by its contents.
///
/// # Errors
/// It is no such image, is damaged, or asks for more than is allowed.
pub fn decode(name: &str, bytes: &[u8], allowed: Allowed) -> Result<Decoded, SkyError> {
    let paint = |stand_in| {
        guarded(|| match openexr::is(bytes) {
            true => openexr::decode(bytes, stand_in, allowed),
            false => radiance::decode(bytes, stand_in, allowed),
        })
        .unwrap_or(Err(Refused::Panicked.into()))
    };
    let (mut canvas, mut odd) = paint(0.0)?;
    if canvas.faults.infinite > 0 && canvas.largest > 0.0 {
        // Which value stands in for infinity is known by now.
        (canvas, odd) = paint(canvas.largest)?;
    }
    odd.extend(canvas.faults.told());
    Ok(Decoded { image: canvas.finish(name), odd })
}

#[cfg(test)]
mod trials;
