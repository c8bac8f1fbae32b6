//! A search or an exam on the tracing thread: frames that the window waits for come first, what is measured goes on in
//! between.

use super::exam::{Exam, Examiner};
use super::lowering::Lowering;
use super::methods::Aspect;
use super::survey::{End, Survey};
use super::tracer::{Job, Render, Word, Worker};
use super::views::Views;
use crate::measure::Run;
use crate::measure::tune::{self, Stopped, Studio, Task, Trial};
use crate::measure::watch::Watch;
use crate::render::{CancelToken, Film};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What is to be measured.
#[derive(Debug)]
pub enum Inquiry {
    /// Settings are searched.
    Search(Box<(Task, Survey)>),
    /// Errors or costs of the settings as they are.
    Exam(Box<Exam>),
}

/// What both threads know of a search or an exam.
#[derive(Debug, Default)]
pub struct Search {
    /// What is to be measured next, and in which scene.
    pub asked: Option<(Arc<Scene>, Inquiry)>,
    /// What is under way has to stop.
    pub stop: bool,
    /// One of its frames is being traced.
    pub in_frame: bool,
    /// What is known of a search by now, and in which scene, to be taken once.
    pub survey: Option<(Arc<Scene>, Survey)>,
    /// What is known of an exam by now, and in which scene, to be taken once.
    pub exam: Option<(Arc<Scene>, Exam)>,
}

/// The studio of what is measured on a thread that it shares with the window's frames.
pub struct Measuring<'a> {
    worker: &'a Worker,
    render: Render<'a>,
    views: &'a mut Views,
    word: &'a dyn Fn(Word),
    scene: Arc<Scene>,
    watch: Watch,
    /// The search, if that is what it is.
    survey: Option<Survey>,
    /// When the next frame of the window may begin.
    next_start: Instant,
}

impl<'a> Measuring<'a> {
    /// Sets up what is needed for measuring in `scene`.
    pub fn new(
        worker: &'a Worker,
        render: Render<'a>,
        views: &'a mut Views,
        word: &'a dyn Fn(Word),
        scene: Arc<Scene>,
    ) -> Self {
        let watch = Watch::over(CancelToken::default(), worker.cancel.clone());
        Self { worker, render, views, word, scene, watch, survey: None, next_start: Instant::now() }
    }

    /// Measures until there is an end.
    pub fn run(mut self, inquiry: Inquiry) {
        match inquiry {
            Inquiry::Search(search) => {
                let (task, survey) = *search;
                self.survey = Some(survey);
                self.search(&task);
            }
            Inquiry::Exam(mut exam) => {
                exam.run(&mut self);
                self.publish_exam(&exam);
            }
        }
    }

    fn search(&mut self, task: &Task) {
        self.publish();
        let found = tune::tune(task, self);
        if let Some(survey) = &mut self.survey {
            match found {
                Ok(found) => survey.ended(&found),
                Err(Stopped) => survey.end = Some(End::Stopped),
            }
        }
        self.publish();
    }

    fn publish(&self) {
        self.worker.shared.lock().search.survey = self.survey.clone().map(|survey| (Arc::clone(&self.scene), survey));
        (self.word)(Word::Frame);
    }

    fn publish_exam(&self, exam: &Exam) {
        self.worker.shared.lock().search.exam = Some((Arc::clone(&self.scene), exam.clone()));
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
            if self.worker.trace(job, self.render, self.views) {
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
        let (lowering, aspect) = (Lowering::NONE, Aspect::default());
        let job = Job { scene, camera: *camera, settings, width, height, lowering, aspect };
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
        if let Some(survey) = &mut self.survey {
            survey.measured(share, trials);
        }
        self.publish();
    }
}

impl Examiner for Measuring<'_> {
    fn hear(&mut self, exam: &Exam) -> Result<(), Stopped> {
        self.publish_exam(exam);
        self.serve()
    }
}
