//! The tracing thread: the newest job in, the newest frame out, nothing in between ever waits.
//!
//! The event loop posts what to trace and goes on; a job that was not begun is replaced by the next. Finished frames
//! wait in a box of one, and their films travel back to be used again. Without a new job the last view is refined, and
//! then the thread sleeps.

use super::at_rest;
use super::exam::Exam;
use super::lowering::Lowering;
use super::maps::Legend;
use super::measuring::{Inquiry, Measuring, Search};
use super::methods::Aspect;
use super::survey::Survey;
use super::views::Views;
use crate::measure::tune;
use crate::render::{CancelToken, Film, FrameStats, Scratch, render_frame};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A frame of other settings is given this long before it is dropped for the new ones: dragging a slider
/// still shows frames, and a mode that takes minutes can be left at once.
const PATIENCE: Duration = Duration::from_millis(300);

/// What to trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// What is seen.
    pub scene: Arc<Scene>,
    /// From where.
    pub camera: Camera,
    /// How.
    pub settings: Settings,
    /// Picture width in pixels, at least 1.
    pub width: u32,
    /// Picture height in pixels, at least 1.
    pub height: u32,
    /// What of it was given up for speed.
    pub lowering: Lowering,
    /// What of the view is to be shown.
    pub aspect: Aspect,
}

impl Job {
    /// The same view by other settings, and nothing but its picture.
    pub fn with_settings(&self, settings: Settings) -> Self {
        Self { settings, aspect: Aspect::default(), ..self.clone() }
    }

    /// Whether a film has the size and the planes of its picture.
    fn fits(&self, film: &Film) -> bool {
        (film.width(), film.height(), film.planes()) == (self.width, self.height, self.aspect.map.planes())
    }

    /// Whether a frame of `other` shows this one from elsewhere: worth finishing while the walker moves.
    fn differs_by_camera_only(&self, other: &Self) -> bool {
        let what = |job: &Self| (job.width, job.height, job.aspect.map, job.aspect.is_exact);
        self.scene == other.scene
            && self.settings == other.settings
            && what(self) == what(other)
            && self.aspect.beside == other.aspect.beside
    }

    /// How long a frame of `running` may go on while this one waits; `None` for to its end.
    fn patience(&self, running: &Self) -> Option<Duration> {
        if self.differs_by_camera_only(running) {
            None
        } else if self.lowering.level > 0 && running.lowering.level == 0 {
            // Motion began, and asks for speed.
            Some(Duration::ZERO)
        } else {
            Some(PATIENCE)
        }
    }
}

/// A finished frame.
#[derive(Debug)]
pub struct TracedFrame {
    /// The picture.
    pub film: Film,
    /// What it cost.
    pub stats: FrameStats,
    /// When it was done.
    pub finished: Instant,
    /// What it shows.
    pub job: Job,
    /// Samples a pixel, where it was refined at rest.
    pub samples: Option<u32>,
    /// The same view by the settings beside, and how many milliseconds it took.
    pub beside: Option<(Film, f64)>,
    /// What its colours mean, where it is a map.
    pub legend: Option<Legend>,
}

impl TracedFrame {
    /// Its films.
    pub fn into_films(self) -> impl Iterator<Item = Film> {
        std::iter::once(self.film).chain(self.beside.map(|(film, _)| film))
    }
}

/// Renders a job into a film.
pub type Render<'a> = &'a mut dyn FnMut(&Job, &mut Film) -> FrameStats;

/// What the tracing thread sends word of. Called on that thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// A frame can be [taken](Tracer::take), or a [survey](Tracer::take_survey).
    Frame,
    /// The thread is gone: after a stop, or because the renderer panicked.
    Gone,
}

/// What both threads see.
#[derive(Debug, Default)]
pub(super) struct Exchange {
    pub job: Option<Job>,
    running: Option<(Job, Instant)>,
    /// The last view is being refined.
    refining: bool,
    /// A search that runs while there is nothing to trace.
    pub search: Search,
    done: Option<TracedFrame>,
    spare: Vec<Film>,
    stop: bool,
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
    fn spare_film(&mut self, job: &Job) -> Option<Film> {
        self.spare.retain(|film| job.fits(film));
        self.spare.pop()
    }

    /// Puts a frame into the box, in place of one that was not taken.
    fn put(&mut self, frame: TracedFrame) {
        let missed = self.done.replace(frame);
        self.spare.extend(missed.into_iter().flat_map(TracedFrame::into_films));
    }
}

#[derive(Debug, Default)]
pub(super) struct Shared {
    exchange: Mutex<Exchange>,
    wake: Condvar,
}

impl Shared {
    /// A panic in the renderer must not take the window down with it: poisoned data is as good as any.
    pub fn lock(&self) -> MutexGuard<'_, Exchange> {
        self.exchange.lock().unwrap_or_else(PoisonError::into_inner)
    }
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
        let mut exchange = self.shared.lock();
        exchange.job = Some(job);
        if exchange.refining || exchange.search.in_frame {
            self.cancel.cancel();
        }
        drop(exchange);
        self.shared.wake.notify_one();
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
        let mut exchange = self.shared.lock();
        exchange.search.asked = Some((scene, inquiry));
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

    /// The newest news of a search, once.
    pub fn take_survey(&self) -> Option<Survey> {
        self.shared.lock().search.survey.take()
    }

    /// The newest news of an exam, once.
    pub fn take_exam(&self) -> Option<Exam> {
        self.shared.lock().search.exam.take()
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

pub(super) struct Worker {
    pub shared: Arc<Shared>,
    pub cancel: CancelToken,
    pub interval: Duration,
}

impl Worker {
    fn run(&self, render: Render<'_>, word: &dyn Fn(Word)) {
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
        let stats = render(&job, &mut film);
        let completed = stats.completed;
        let mut frame =
            TracedFrame { film, stats, finished: Instant::now(), job, samples: None, beside: None, legend: None };
        let completed = completed && views.complete(&mut frame, &|job| self.film_for(job), render);
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
        let frame = TracedFrame { film, stats, finished, job, samples, beside: None, legend: None };
        self.shared.lock().put(frame);
        true
    }

    /// A film for the picture of `job`. Made without the lock: the event loop does not wait for memory.
    pub fn film_for(&self, job: &Job) -> Film {
        let spare = self.shared.lock().spare_film(job);
        spare.unwrap_or_else(|| Film::new(job.width, job.height, job.aspect.map.planes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::survey::End;
    use crate::render::Planes;
    use crate::scene::{LoadOptions, builtin, load_text};
    use crate::settings::Supersample;
    use std::sync::LazyLock;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::mpsc::{Receiver, channel};

    /// An empty scene.
    fn nowhere() -> Arc<Scene> {
        static NOWHERE: LazyLock<Arc<Scene>> = LazyLock::new(|| {
            Arc::new(load_text("nowhere.json", r#"{"version": 1}"#, &LoadOptions::default()).expect("right"))
        });
        NOWHERE.clone()
    }

    fn job(width: u32, x: f32) -> Job {
        let mut camera = Camera::default();
        camera.eye.x = x;
        Job {
            scene: nowhere(),
            camera,
            settings: Settings::default(),
            width,
            height: 4,
            lowering: Lowering::NONE,
            aspect: Aspect::default(),
        }
    }

    fn start(
        render: impl FnMut(&Job, &mut Film) -> FrameStats + Send + 'static,
        cancel: CancelToken,
    ) -> (Tracer, Receiver<Word>) {
        let (sender, receiver) = channel();
        let word = move |word| sender.send(word).unwrap_or(());
        (Tracer::start_with(render, cancel, Duration::ZERO, word).expect("a thread starts"), receiver)
    }

    const SOON: Duration = Duration::from_secs(20);

    #[test]
    fn a_job_becomes_a_frame_and_no_job_becomes_nothing() {
        let traced = Arc::new(AtomicUsize::new(0));
        let count = traced.clone();
        let render = move |_: &Job, _: &mut Film| {
            count.fetch_add(1, Ordering::SeqCst);
            FrameStats { completed: true, ..FrameStats::default() }
        };
        let (tracer, words) = start(render, CancelToken::default());
        for width in [4, 8, 8] {
            tracer.post(job(width, 0.0));
            assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
            let frame = tracer.take().expect("a frame");
            assert_eq!(frame.film.width(), width);
            tracer.recycle(frame.film);
        }
        assert!(tracer.take().is_none());
        assert!(!tracer.is_busy());
        drop(tracer);
        assert_eq!(traced.load(Ordering::SeqCst), 3, "asleep between jobs");
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone));
    }

    #[test]
    fn only_the_newest_job_waits() {
        let (gate, opened) = channel::<()>();
        let (began, begins) = channel();
        let render = move |job: &Job, _: &mut Film| {
            began.send(job.camera.eye.x).expect("the test listens");
            opened.recv().expect("the test opens");
            FrameStats { completed: true, ..FrameStats::default() }
        };
        let (tracer, words) = start(render, CancelToken::default());
        tracer.post(job(4, 0.0));
        assert_eq!(begins.recv_timeout(SOON), Ok(0.0));
        for x in [1.0, 2.0, 3.0] {
            tracer.post(job(4, x));
        }
        gate.send(()).expect("the tracer waits");
        assert_eq!(begins.recv_timeout(SOON), Ok(3.0));
        gate.send(()).expect("the tracer waits");
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
    }

    #[test]
    fn a_long_frame_of_old_settings_is_dropped_and_closing_does_not_wait() {
        let cancel = CancelToken::default();
        let asked = cancel.clone();
        let (began, begins) = channel();
        let render = move |job: &Job, _: &mut Film| {
            began.send(job.settings.stride).expect("the test listens");
            while !asked.is_cancelled() {
                std::thread::sleep(Duration::from_millis(1));
            }
            FrameStats { completed: false, ..FrameStats::default() }
        };
        let (tracer, words) = start(render, cancel);
        tracer.post(job(4, 0.0));
        assert_eq!(begins.recv_timeout(SOON), Ok(8));
        tracer.post(job(4, 1.0));
        assert_eq!(tracer.drop_outdated(), None, "another place is no reason to drop a frame");
        let mut other = job(4, 2.0);
        other.settings.stride = 4;
        tracer.post(other);
        while let Some(later) = tracer.drop_outdated() {
            std::thread::sleep(later.saturating_duration_since(Instant::now()));
        }
        assert_eq!(begins.recv_timeout(SOON), Ok(4));
        drop(tracer);
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone));
    }

    fn at_rest(width: u32, x: f32) -> Job {
        let mut job = job(width, x);
        job.settings.refine_at_rest = true;
        job
    }

    /// The frames that come until none comes for a while.
    fn frames(tracer: &Tracer, words: &Receiver<Word>) -> Vec<TracedFrame> {
        let mut frames = Vec::new();
        while words.recv_timeout(4 * at_rest::REST).is_ok() {
            frames.extend(tracer.take());
        }
        frames
    }

    #[test]
    fn a_view_at_rest_becomes_supersample_16_byte_for_byte_and_then_nothing_is_traced() {
        let scene = Arc::new(builtin(&LoadOptions::default()).expect("it loads"));
        let camera = scene.cameras[0].camera;
        for settings in [Settings::exact(), Settings { supersample: Supersample::Grid { side: 2 }, ..Settings::fast() }]
        {
            let (width, height) = (80, 45);
            let (sender, words) = channel();
            let word = move |word| sender.send(word).unwrap_or(());
            let tracer = Tracer::start(Duration::ZERO, word).expect("a thread starts");
            let at_rest = Settings { refine_at_rest: true, ..settings.clone() };
            tracer.post(Job {
                scene: Arc::clone(&scene),
                camera,
                settings: at_rest,
                width,
                height,
                lowering: Lowering::NONE,
                aspect: Aspect::default(),
            });
            let frames = frames(&tracer, &words);
            let picture = |supersample: Supersample| {
                let mut film = Film::new(width, height, Planes::default());
                // At rest nothing is enlarged.
                let render_scale = if supersample.rays() == 16 { 1.0 } else { settings.render_scale };
                let settings = Settings { supersample, render_scale, ..settings.clone() };
                render_frame(&scene, &camera, &settings, &mut Scratch::new(), &mut film);
                film
            };
            let (first, last) = (frames.first().expect("a frame"), frames.last().expect("a frame"));
            assert_eq!((first.samples, last.samples), (None, Some(16)));
            assert!(first.film.rgba() == picture(settings.supersample).rgba(), "the first as set");
            assert!(last.film.rgba() == picture(Supersample::Grid { side: 4 }).rgba(), "the last with 16 samples");
            assert!(first.film.rgba() != last.film.rgba(), "this scene is no test");
            let samples: Vec<_> = frames.iter().skip(1).filter_map(|frame| frame.samples).collect();
            assert!(samples.is_sorted() && samples[0] > settings.supersample.rays(), "{samples:?}");
            assert!(words.recv_timeout(2 * at_rest::REST).is_err(), "asleep");
        }
    }

    #[test]
    fn nothing_is_refined_where_that_is_not_wanted_or_not_needed() {
        let traced = Arc::new(AtomicUsize::new(0));
        let count = traced.clone();
        let render = move |_: &Job, _: &mut Film| {
            count.fetch_add(1, Ordering::SeqCst);
            FrameStats { completed: true, ..FrameStats::default() }
        };
        let (tracer, words) = start(render, CancelToken::default());
        let mut enough = at_rest(4, 0.0);
        enough.settings.supersample = Supersample::Grid { side: 5 };
        for job in [job(4, 0.0), enough] {
            tracer.post(job);
            assert_eq!(frames(&tracer, &words).len(), 1);
        }
        assert_eq!(traced.load(Ordering::SeqCst), 2);
    }

    #[test]
    fn motion_drops_a_pass_at_once() {
        let cancel = CancelToken::default();
        let asked = cancel.clone();
        let (began, begins) = channel();
        let render = move |job: &Job, film: &mut Film| {
            let pass = film.samples().is_some();
            began.send((job.camera.eye.x, pass)).expect("the test listens");
            // A pass that would take for ever.
            while pass && !asked.is_cancelled() {
                std::thread::sleep(Duration::from_millis(1));
            }
            FrameStats { completed: !pass, ..FrameStats::default() }
        };
        let (tracer, words) = start(render, cancel);
        for x in [0.0, 1.0, 2.0] {
            tracer.post(at_rest(4, x));
            assert_eq!(begins.recv_timeout(SOON), Ok((x, false)));
            assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
            assert_eq!(begins.recv_timeout(SOON), Ok((x, true)), "at rest");
        }
        assert!(!tracer.is_busy());
        drop(tracer);
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone), "no pass became a frame");
    }

    #[test]
    fn while_it_moves_nothing_is_refined() {
        let (began, begins) = channel();
        let render = move |_: &Job, film: &mut Film| {
            began.send(film.samples()).expect("the test listens");
            FrameStats { completed: true, ..FrameStats::default() }
        };
        let (tracer, _words) = start(render, CancelToken::default());
        for step in 0..30 {
            tracer.post(at_rest(4, step as f32));
            assert_eq!(begins.recv_timeout(SOON), Ok(None));
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    #[test]
    fn motion_that_asks_for_speed_does_not_wait_for_a_frame_at_rest() {
        let (full, mut fast) = (job(4, 0.0), job(4, 1.0));
        fast.settings.stride = 16;
        assert_eq!(fast.patience(&full), Some(PATIENCE));
        fast.lowering = Lowering { level: 1, scale: 0.7, ..Lowering::NONE };
        assert_eq!(fast.patience(&full), Some(Duration::ZERO));
        assert_eq!(full.patience(&fast), Some(PATIENCE));
        assert_eq!(job(4, 2.0).patience(&full), None);
    }

    #[test]
    fn a_panicking_renderer_is_reported() {
        let (tracer, words) = start(|_, _| std::panic::resume_unwind(Box::new("broken")), CancelToken::default());
        tracer.post(job(4, 0.0));
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone));
    }

    /// A search on a small picture.
    fn search() -> (Arc<Scene>, tune::Task, Survey) {
        let bound = tune::Bound::parse("flip=0.01").expect("right");
        let task = tune::Task {
            cameras: vec![Camera::default()],
            size: (16, 9),
            settings: Settings::exact(),
            fixed: Vec::new(),
            bounds: vec![bound],
            also: Vec::new(),
            budget: SOON,
        };
        (nowhere(), task, Survey::new(Camera::default(), bound))
    }

    /// Waits for the end of a search; the widths of the frames that came meanwhile.
    fn end_of(tracer: &Tracer, words: &Receiver<Word>) -> (End, Vec<u32>) {
        let mut widths = Vec::new();
        loop {
            assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
            widths.extend(tracer.take().map(|frame| frame.film.width()));
            if let Some(end) = tracer.take_survey().and_then(|survey| survey.end) {
                return (end, widths);
            }
        }
    }

    #[test]
    fn a_search_gives_way_to_frames_and_then_goes_on() {
        let (began, begins) = channel();
        let render = move |job: &Job, _: &mut Film| {
            began.send(job.width).unwrap_or(());
            std::thread::sleep(Duration::from_millis(1));
            FrameStats { completed: true, ..FrameStats::default() }
        };
        let (tracer, words) = start(render, CancelToken::default());
        let (scene, task, survey) = search();
        tracer.search(scene, task, survey);
        assert_eq!(begins.recv_timeout(SOON), Ok(16));
        tracer.post(job(4, 0.0));
        let (end, widths) = end_of(&tracer, &words);
        assert!(matches!(end, End::Found { .. }), "{end:?}");
        assert_eq!(widths, [4]);
        let measured = begins.try_iter().skip_while(|width| *width == 16).skip(1).collect::<Vec<_>>();
        assert!(measured.len() > 10 && measured.iter().all(|width| *width == 16), "{measured:?}");
    }

    #[test]
    fn a_search_is_stopped_in_the_middle_of_a_frame() {
        let cancel = CancelToken::default();
        let asked = cancel.clone();
        let (began, begins) = channel();
        let render = move |job: &Job, _: &mut Film| {
            began.send(job.width).unwrap_or(());
            while !asked.is_cancelled() {
                std::thread::sleep(Duration::from_millis(1));
            }
            FrameStats { completed: false, ..FrameStats::default() }
        };
        let (tracer, words) = start(render, cancel);
        let (scene, task, survey) = search();
        tracer.search(scene, task, survey);
        assert_eq!(begins.recv_timeout(SOON), Ok(16));
        tracer.stop_search();
        assert_eq!(end_of(&tracer, &words).0, End::Stopped);
    }
}
