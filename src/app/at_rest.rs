//! A view at rest: pass after pass, each pixel gets one sample more, until nothing is left to trace.

use super::tracer::{Job, Render};
use crate::render::{Film, FrameStats};
use crate::settings::{Settings, Supersample};
use std::time::{Duration, Instant};

/// Without a new view for this long, motion has stopped: longer than a pause between two movements of a mouse.
pub const REST: Duration = Duration::from_millis(150);

/// Samples a pixel that a view at rest comes to.
pub const SAMPLES: u32 = Supersample::REFINED;

/// The refinement of the last finished frame.
#[derive(Debug, Default)]
pub struct AtRest {
    job: Option<Job>,
    film: Option<Film>,
    due: Option<Instant>,
}

impl AtRest {
    /// A frame of `job` was finished: once the view has rested it is refined, if that is wanted and makes it better.
    pub fn begin(&mut self, job: Job, now: Instant) {
        self.due = is_refined(&job.settings).then_some(now + REST);
        self.job = Some(job);
        if let Some(film) = &mut self.film {
            film.start_over();
        }
    }

    /// When the next pass is due, if any.
    pub fn due(&self) -> Option<Instant> {
        self.due
    }

    /// Traces one pass. `None` when it was cancelled: the view is left then.
    pub fn pass(&mut self, render: Render<'_>) -> Option<(&Job, &Film, FrameStats)> {
        self.due = None;
        let job = self.job.as_ref()?;
        let fits = |film: &Film| (film.width(), film.height()) == (job.width, job.height);
        let film = match self.film.take().filter(fits) {
            Some(film) => self.film.insert(film),
            None => self.film.insert(Film::accumulating(job.width, job.height)),
        };
        let stats = render(job, film);
        if !stats.completed {
            return None;
        }
        if film.samples() < Some(SAMPLES) {
            self.due = Some(Instant::now());
        }
        Some((job, film, stats))
    }
}

/// Whether a view by these settings gathers samples at rest: that is wanted, and they have fewer of them.
pub fn is_refined(settings: &Settings) -> bool {
    let has_them = matches!(settings.supersample, Supersample::Grid { side } if side * side >= SAMPLES);
    settings.refine_at_rest && !has_them
}

/// Whether the picture after `samples` passes is worth showing in place of a frame with `supersample`: with fewer samples
/// than that it would be a step back.
pub fn is_better(samples: u32, supersample: Supersample) -> bool {
    samples == SAMPLES || samples > supersample.rays()
}
