//! One frame from scene, camera and settings. No window, no file.

pub mod film;
pub mod frame;
pub mod stats;

pub use film::{Film, Planes};
pub use frame::{CancelToken, Scratch, render_frame};
pub use stats::FrameStats;
