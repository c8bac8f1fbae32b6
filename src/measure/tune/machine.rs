//! A studio of its own: this thread, and the pool of a scratch.

use super::{Stopped, Studio, Trial};
use crate::measure::run::{Run, timed_frame};
use crate::measure::watch::Watch;
use crate::render::{CancelToken, Film, Scratch};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use std::time::{Duration, Instant};

/// Renders on the calling thread.
pub struct Machine<'a> {
    scene: &'a Scene,
    scratch: Scratch,
    watch: Watch,
    told: &'a dyn Fn(f64),
}

impl<'a> Machine<'a> {
    /// Renders `scene` until `stop` is cancelled, and tells how far the search has come, 0 to 1.
    pub fn new(scene: &'a Scene, stop: CancelToken, told: &'a dyn Fn(f64)) -> Self {
        let watch = Watch::new(stop);
        let mut scratch = Scratch::new();
        scratch.cancel = watch.token();
        Self { scene, scratch, watch, told }
    }
}

impl Studio for Machine<'_> {
    fn frame(
        &mut self,
        camera: &Camera,
        settings: &Settings,
        film: &mut Film,
        longest: Option<Duration>,
    ) -> Result<Option<f64>, Stopped> {
        let mut run = Run::default();
        self.watch.start(longest.map(|longest| Instant::now() + longest));
        let completed = timed_frame(&mut run, self.scene, camera, settings, &mut self.scratch, film);
        self.watch.end();
        if self.watch.stop.is_cancelled() {
            return Err(Stopped);
        }
        Ok(completed.then(|| run.cpu_ms().min))
    }

    fn told(&mut self, share: f64, _trials: &[Trial]) {
        (self.told)(share);
    }
}
