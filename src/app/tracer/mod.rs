//! The tracing thread: the newest job in, the newest frame out, nothing in between ever waits.
//!
//! The event loop posts what to trace and goes on; a job that was not begun is replaced by the next. Finished frames
//! wait in a box of one, and their films travel back to be used again. Without a new job the last view is refined, and
//! then the thread sleeps.

mod exchange;
mod job;
#[cfg(test)]
mod trials;
mod worker;

pub use job::{Job, Render, TracedFrame};
pub(super) use worker::Worker;

use super::exam::Exam;
use super::measuring::Inquiry;
use super::survey::Survey;
use crate::measure::tune;
use crate::render::{CancelToken, Film, FrameStats, Scratch, render_frame};
use crate::scene::Scene;
use exchange::{Exchange, Shared};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What the tracing thread sends word of. Called on that thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// A frame can be [taken](Tracer::take), or a [survey](Tracer::take_survey).
    Frame,
    /// The thread is gone: after a stop, or because the renderer panicked.
    Gone,
}

/// The handle to the tracing thread. Dropping it stops and joins the thread.
#[derive(Debug)]
pub struct Tracer {
    shared: Arc<Shared>,
    cancel: CancelToken,
    thread: Option<JoinHandle<()>>,
}

impl Tracer {
    /// Starts a thread that traces at most one frame per `interval`, and sends `word`.
    ///
    /// # Errors
    /// The system's reason when no thread can be started.
    pub fn start(interval: Duration, word: impl Fn(Word) + Send + 'static) -> std::io::Result<Self> {
        let mut scratch = Scratch::new();
        let cancel = scratch.cancel.clone();
        let render =
            move |job: &Job, film: &mut Film| render_frame(&job.scene, &job.camera, &job.settings, &mut scratch, film);
        Self::start_with(render, cancel, interval, word)
    }

    fn start_with(
        mut render: impl FnMut(&Job, &mut Film) -> FrameStats + Send + 'static,
        cancel: CancelToken,
        interval: Duration,
        word: impl Fn(Word) + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let worker = Worker { shared: shared.clone(), cancel: cancel.clone(), interval };
        let thread = std::thread::Builder::new().name("tracer".to_owned()).spawn(move || {
            let parting = Parting(&word);
            worker.run(&mut render, parting.0);
        })?;
        Ok(Self { shared, cancel, thread: Some(thread) })
    }

    /// Asks for a frame, in place of one that was asked for and not begun. What is refined or measured is dropped at once.
    pub fn post(&self, job: Job) {
        self.interrupt(|exchange| exchange.job = Some(job));
    }

    /// Starts a search in `scene` between the frames, in place of one that is under way; tells of it in `survey`.
    pub fn search(&self, scene: Arc<Scene>, task: tune::Task, survey: Survey) {
        self.inquire(scene, Inquiry::Search(Box::new((task, survey))));
    }

    /// Starts an exam in `scene` between the frames, in place of what is measured.
    pub fn examine(&self, scene: Arc<Scene>, exam: Exam) {
        self.inquire(scene, Inquiry::Exam(Box::new(exam)));
    }

    fn inquire(&self, scene: Arc<Scene>, inquiry: Inquiry) {
        self.interrupt(|exchange| exchange.search.asked = Some((scene, inquiry)));
    }

    /// Has the thread look at what it is asked for by `ask`, at once if it only refines or measures.
    fn interrupt(&self, ask: impl FnOnce(&mut Exchange)) {
        let mut exchange = self.shared.lock();
        ask(&mut exchange);
        if exchange.refining || exchange.search.in_frame {
            self.cancel.cancel();
        }
        drop(exchange);
        self.shared.wake.notify_one();
    }

    /// Ends the search or exam that is under way, or was asked for.
    pub fn stop_search(&self) {
        let mut exchange = self.shared.lock();
        (exchange.search.stop, exchange.search.asked) = (true, None);
        if exchange.search.in_frame {
            self.cancel.cancel();
        }
    }

    /// The newest news of a search in `scene`, once; those of another come too late.
    pub fn take_survey(&self, scene: &Scene) -> Option<Survey> {
        self.shared.lock().search.survey.take().filter(|(of, _)| **of == *scene).map(|(_, survey)| survey)
    }

    /// The newest news of an exam in `scene`, once; those of another come too late.
    pub fn take_exam(&self, scene: &Scene) -> Option<Exam> {
        self.shared.lock().search.exam.take().filter(|(of, _)| **of == *scene).map(|(_, exam)| exam)
    }

    /// Drops the running frame if newer settings have waited for long enough; else says when to ask again, if ever.
    pub fn drop_outdated(&self) -> Option<Instant> {
        let exchange = self.shared.lock();
        let (running, began) = exchange.running.as_ref()?;
        let waiting = exchange.job.as_ref()?;
        let patience = waiting.patience(running).filter(|_| !self.cancel.is_cancelled())?;
        if began.elapsed() >= patience {
            self.cancel.cancel();
            return None;
        }
        Some(*began + patience)
    }

    /// The newest finished frame, once.
    pub fn take(&self) -> Option<TracedFrame> {
        self.shared.lock().done.take()
    }

    /// Gives a film back to be traced into again.
    pub fn recycle(&self, film: Film) {
        self.shared.lock().spare.push(film);
    }

    /// Whether the last view is being refined.
    pub fn is_refining(&self) -> bool {
        self.shared.lock().refining
    }

    /// Whether a frame is being traced or waits to be, refinement aside.
    pub fn is_busy(&self) -> bool {
        let exchange = self.shared.lock();
        exchange.running.is_some() || exchange.job.is_some()
    }
}

impl Drop for Tracer {
    fn drop(&mut self) {
        let mut exchange = self.shared.lock();
        exchange.stop = true;
        self.cancel.cancel();
        drop(exchange);
        self.shared.wake.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic was already reported on stderr, and `Word::Gone` was sent.
            let _ = thread.join();
        }
    }
}

/// Sends [`Word::Gone`] however the thread ends.
struct Parting<'a, F: Fn(Word)>(&'a F);

impl<F: Fn(Word)> Drop for Parting<'_, F> {
    fn drop(&mut self) {
        (self.0)(Word::Gone);
    }
}
