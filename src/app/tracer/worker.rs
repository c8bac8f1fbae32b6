//! The thread's own side: what it does next, and doing it.

use super::exchange::Shared;
use super::{Job, Render, TracedFrame, Word};
use crate::app::at_rest;
use crate::app::measuring::{Inquiry, Measuring};
use crate::app::views::Views;
use crate::render::{CancelToken, Film};
use crate::scene::Scene;
use cpu_time::ProcessTime;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// What the thread does next.
#[allow(clippy::large_enum_variant, reason = "there is one at a time, and a box would be an allocation a frame")]
enum Task {
    /// A frame.
    Frame(Job),
    /// One more sample a pixel of the last view.
    Pass,
    /// What is measured.
    Inquiry(Arc<Scene>, Inquiry),
}

pub struct Worker {
    pub shared: Arc<Shared>,
    pub cancel: CancelToken,
    pub interval: Duration,
}

impl Worker {
    pub(super) fn run(&self, render: Render<'_>, word: &dyn Fn(Word)) {
        let mut next_start = Instant::now();
        let mut views = Views::default();
        while let Some(task) = self.begin(next_start, views.at_rest.due()) {
            let has_frame = match task {
                Task::Frame(job) => {
                    next_start = Instant::now() + self.interval;
                    self.trace(job, render, &mut views)
                }
                Task::Pass => self.refine(render, &mut views),
                Task::Inquiry(scene, inquiry) => {
                    Measuring::new(self, render, &mut views, word, scene).run(inquiry);
                    false
                }
            };
            if has_frame {
                word(Word::Frame);
            }
        }
    }

    /// Sleeps until there is a job and it is time, then takes the newest; or until a pass is due. `None` to stop.
    fn begin(&self, not_before: Instant, pass_due: Option<Instant>) -> Option<Task> {
        let mut exchange = self.shared.lock();
        let job = loop {
            if exchange.stop {
                return None;
            }
            if exchange.job.is_none()
                && let Some((scene, inquiry)) = exchange.search.asked.take()
            {
                exchange.search.stop = false;
                return Some(Task::Inquiry(scene, inquiry));
            }
            let due = if exchange.job.is_some() { Some(not_before) } else { pass_due };
            let wait = due.map(|due| due.saturating_duration_since(Instant::now()));
            exchange = match wait {
                None => self.shared.wake.wait(exchange).unwrap_or_else(PoisonError::into_inner),
                Some(Duration::ZERO) => break exchange.begin_frame(&self.cancel),
                Some(wait) => self.shared.wake.wait_timeout(exchange, wait).unwrap_or_else(PoisonError::into_inner).0,
            };
        };
        if job.is_none() {
            self.cancel.reset();
            exchange.refining = true;
        }
        Some(job.map_or(Task::Pass, Task::Frame))
    }

    /// Traces a frame and puts it into the box; false for one that was dropped on the way.
    pub fn trace(&self, job: Job, render: Render<'_>, views: &mut Views) -> bool {
        let mut film = self.film_for(&job);
        let (began, cpu) = (Instant::now(), ProcessTime::now());
        let stats = render(&job, &mut film);
        let (cpu_ms, finished, completed) = (1e3 * cpu.elapsed().as_secs_f64(), Instant::now(), stats.completed);
        let (whole_ms, samples) = (stats.frame_ms, None);
        let mut frame =
            TracedFrame { film, stats, cpu_ms, whole_ms, finished, job, samples, beside: None, legend: None };
        let completed = completed && views.complete(&mut frame, &|job| self.film_for(job), render);
        frame.whole_ms = 1e3 * began.elapsed().as_secs_f64();
        let mut exchange = self.shared.lock();
        exchange.running = None;
        if !completed {
            exchange.spare.extend(frame.into_films());
            return false;
        }
        views.at_rest.begin(frame.job.clone(), Instant::now());
        exchange.put(frame);
        true
    }

    /// Traces one sample more of each pixel, and puts the picture into the box where that made it better.
    fn refine(&self, render: Render<'_>, views: &mut Views) -> bool {
        let pass = views.at_rest.pass(render);
        let mut exchange = self.shared.lock();
        exchange.refining = false;
        let is_left = exchange.job.is_some();
        drop(exchange);
        let Some((job, refined, stats)) = pass.filter(|_| !is_left) else { return false };
        let samples = refined.samples();
        if !samples.is_some_and(|samples| at_rest::is_better(samples, job.settings.supersample)) {
            return false;
        }
        let mut film = self.film_for(job);
        film.copy_rgba(refined);
        let (finished, job) = (Instant::now(), job.clone());
        // Of one pass of many, times say nothing.
        let (cpu_ms, whole_ms) = (0.0, 0.0);
        let frame = TracedFrame { film, stats, cpu_ms, whole_ms, finished, job, samples, beside: None, legend: None };
        self.shared.lock().put(frame);
        true
    }

    /// A film for the picture of `job`. Made without the lock: the event loop does not wait for memory.
    pub fn film_for(&self, job: &Job) -> Film {
        let spare = self.shared.lock().spare_film(job);
        spare.unwrap_or_else(|| Film::new(job.width, job.height, job.aspect.map.planes()))
    }
}
