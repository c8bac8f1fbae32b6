//! A search on the tracing thread: frames that the window waits for come first, what is measured goes on in between.

use super::at_rest::AtRest;
use super::lowering::Lowering;
use super::survey::{End, Survey};
use super::tracer::{Job, Render, Word, Worker};
use crate::measure::Run;
use crate::measure::tune::{self, Stopped, Studio, Task, Trial};
use crate::measure::watch::Watch;
use crate::render::{CancelToken, Film};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What both threads know of a search.
#[derive(Debug, Default)]
pub struct Search {
    /// What is to be searched next.
    pub asked: Option<(Arc<Scene>, Task, Survey)>,
    /// The search under way has to stop.
    pub stop: bool,
    /// One of its frames is being traced.
    pub in_frame: bool,
    /// What is known by now, to be taken once.
    pub survey: Option<Survey>,
}

/// The studio of a search that shares its thread with the window's frames.
pub struct Measuring<'a> {
    worker: &'a Worker,
    render: Render<'a>,
    at_rest: &'a mut AtRest,
    word: &'a dyn Fn(Word),
    scene: Arc<Scene>,
    watch: Watch,
    survey: Survey,
    /// When the next frame of the window may begin.
    next_start: Instant,
}

impl<'a> Measuring<'a> {
    /// Sets up a search in `scene` that tells of itself in `survey`.
    pub fn new(
        worker: &'a Worker,
        render: Render<'a>,
        at_rest: &'a mut AtRest,
        word: &'a dyn Fn(Word),
        scene: Arc<Scene>,
        survey: Survey,
    ) -> Self {
        let watch = Watch::over(CancelToken::default(), worker.cancel.clone());
        Self { worker, render, at_rest, word, scene, watch, survey, next_start: Instant::now() }
    }

    /// Searches until there is an end.
    pub fn run(mut self, task: &Task) {
        self.publish();
        match tune::tune(task, &mut self) {
            Ok(found) => self.survey.ended(&found),
            Err(Stopped) => self.survey.end = Some(End::Stopped),
        }
        self.publish();
    }

    fn publish(&self) {
        self.worker.shared.lock().search.survey = Some(self.survey.clone());
        (self.word)(Word::Frame);
    }

    /// Traces the frames that the window waits for.
    fn serve(&mut self) -> Result<(), Stopped> {
        loop {
            let mut exchange = self.worker.shared.lock();
            if exchange.has_to_stop() {
                return Err(Stopped);
            }
            if exchange.job.is_none() {
                return Ok(());
            }
            let early = self.next_start.saturating_duration_since(Instant::now());
            if !early.is_zero() {
                drop(exchange);
                std::thread::sleep(early);
                continue;
            }
            let Some(job) = exchange.begin_frame(&self.worker.cancel) else { return Ok(()) };
            drop(exchange);
            self.next_start = Instant::now() + self.worker.interval;
            if self.worker.trace(job, self.render, self.at_rest) {
                (self.word)(Word::Frame);
            }
        }
    }

    /// Notes that a measured frame begins; false where one of the window came in between.
    fn begin(&self, longest: Option<Duration>) -> bool {
        let mut exchange = self.worker.shared.lock();
        if exchange.job.is_some() || exchange.has_to_stop() {
            return false;
        }
        // Under the lock, so that no request to stop is lost.
        self.watch.start(longest.map(|longest| Instant::now() + longest));
        exchange.search.in_frame = true;
        true
    }
}

impl Studio for Measuring<'_> {
    fn frame(
        &mut self,
        camera: &Camera,
        settings: &Settings,
        film: &mut Film,
        longest: Option<Duration>,
    ) -> Result<Option<f64>, Stopped> {
        let (width, height) = (film.width(), film.height());
        let (scene, settings) = (Arc::clone(&self.scene), settings.clone());
        let job = Job { scene, camera: *camera, settings, width, height, lowering: Lowering::NONE };
        loop {
            self.serve()?;
            if !self.begin(longest) {
                continue;
            }
            let (start, mut run) = (Instant::now(), Run::default());
            let completed = run.time(|| (self.render)(&job, film));
            self.watch.end();
            self.worker.shared.lock().search.in_frame = false;
            if completed {
                return Ok(Some(run.cpu_ms().min));
            }
            if longest.is_some_and(|longest| start.elapsed() >= longest) {
                return Ok(None);
            }
            // The window had a frame to trace: once more, from the start.
        }
    }

    fn told(&mut self, share: f64, trials: &[Trial]) {
        self.survey.measured(share, trials);
        self.publish();
    }
}
