//! Why an image is not decoded, whatever its format.

use crate::scene::files::CANCELLED;
use crate::scene::limits::exceeded;

/// What no decoder is to blame for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    #[error("it has no pixels")]
    Empty,
    #[error("width or height is {}", exceeded("texture-edge", *.0))]
    Edge(u64),
    #[error("the scene's textures have {}", exceeded("texture-bytes", *.0))]
    Budget(u64),
    #[error("bytes that it takes to decode it: {}", exceeded("texture-bytes", *.0))]
    Effort(u64),
    #[error("{CANCELLED}")]
    Cancelled,
    #[error("the decoder gave up; the file is damaged")]
    Panicked,
}
