//! The waist of the program: one frame from scene, camera and settings.

use super::{Film, FrameStats};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Asks a frame to stop between tiles.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks the current frame to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Makes the token usable again.
    pub fn reset(&self) {
        self.0.store(false, Ordering::Relaxed);
    }

    /// Whether a stop was asked for.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Everything a frame needs that outlives it: threads, queues, caches.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Stops a frame early.
    pub cancel: CancelToken,
}

impl Scratch {
    /// An empty scratch; the thread pool is made by the first frame.
    pub fn new() -> Self {
        Self::default()
    }
}

/// Renders one frame into `film`.
pub fn render_frame(
    _scene: &Scene,
    _camera: &Camera,
    _settings: &Settings,
    scratch: &mut Scratch,
    _film: &mut Film,
) -> FrameStats {
    FrameStats { completed: !scratch.cancel.is_cancelled(), ..FrameStats::default() }
}
