//! What the event loop and the tracing thread see of each other.

use super::{Job, TracedFrame};
use crate::app::measuring::Search;
use crate::render::{CancelToken, Film};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// What both threads see.
#[derive(Debug, Default)]
pub struct Exchange {
    pub job: Option<Job>,
    pub(super) running: Option<(Job, Instant)>,
    /// The last view is being refined.
    pub(super) refining: bool,
    /// A search that runs while there is nothing to trace.
    pub search: Search,
    pub(super) done: Option<TracedFrame>,
    pub(super) spare: Vec<Film>,
    pub(super) stop: bool,
}

impl Exchange {
    /// Whether a search under way has to end.
    pub fn has_to_stop(&self) -> bool {
        self.stop || self.search.stop || self.search.asked.is_some()
    }

    /// Takes the job that waits, and notes that its frame begins.
    pub fn begin_frame(&mut self, cancel: &CancelToken) -> Option<Job> {
        let job = self.job.take()?;
        // Under the same lock as `post` and `drop`, so that no request to stop is lost.
        cancel.reset();
        self.running = Some((job.clone(), Instant::now()));
        Some(job)
    }

    /// A film for the picture of `job`, if one is left over; those of another size, or with other planes, are dropped.
    pub(super) fn spare_film(&mut self, job: &Job) -> Option<Film> {
        self.spare.retain(|film| job.fits(film));
        self.spare.pop()
    }

    /// Puts a frame into the box, in place of one that was not taken.
    pub(super) fn put(&mut self, frame: TracedFrame) {
        let missed = self.done.replace(frame);
        self.spare.extend(missed.into_iter().flat_map(TracedFrame::into_films));
    }
}

#[derive(Debug, Default)]
pub struct Shared {
    pub(super) exchange: Mutex<Exchange>,
    pub(super) wake: Condvar,
}

impl Shared {
    /// A panic in the renderer must not take the window down with it: poisoned data is as good as any.
    pub fn lock(&self) -> MutexGuard<'_, Exchange> {
        self.exchange.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
