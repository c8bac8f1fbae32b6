//! The tracing thread: the newest job in, the newest frame out, nothing in between ever waits.
//!
//! The event loop posts what to trace and goes on; a job that was not begun is replaced by the next. Finished frames
//! wait in a box of one, and their films travel back to be used again. Without a new job the thread sleeps.

use crate::render::{CancelToken, Film, FrameStats, Planes, Scratch, render_frame};
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
    /// From where.
    pub camera: Camera,
    /// How.
    pub settings: Settings,
    /// Picture width in pixels, at least 1.
    pub width: u32,
    /// Picture height in pixels, at least 1.
    pub height: u32,
}

impl Job {
    /// Whether a frame of `other` shows this one from elsewhere: worth finishing while the walker moves.
    fn differs_by_camera_only(&self, other: &Self) -> bool {
        self.settings == other.settings && (self.width, self.height) == (other.width, other.height)
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
}

/// What the tracing thread sends word of. Called on that thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// A frame can be [taken](Tracer::take).
    Frame,
    /// The thread is gone: after a stop, or because the renderer panicked.
    Gone,
}

/// What both threads see.
#[derive(Debug, Default)]
struct Exchange {
    job: Option<Job>,
    running: Option<(Job, Instant)>,
    done: Option<TracedFrame>,
    spare: Vec<Film>,
    stop: bool,
}

#[derive(Debug, Default)]
struct Shared {
    exchange: Mutex<Exchange>,
    wake: Condvar,
}

impl Shared {
    /// A panic in the renderer must not take the window down with it: poisoned data is as good as any.
    fn lock(&self) -> MutexGuard<'_, Exchange> {
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
    /// Starts a thread that traces `scene`, at most one frame per `interval`, and sends `word`.
    ///
    /// # Errors
    /// The system's reason when no thread can be started.
    pub fn start(scene: Arc<Scene>, interval: Duration, word: impl Fn(Word) + Send + 'static) -> std::io::Result<Self> {
        let mut scratch = Scratch::new();
        let cancel = scratch.cancel.clone();
        let render =
            move |job: &Job, film: &mut Film| render_frame(&scene, &job.camera, &job.settings, &mut scratch, film);
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

    /// Asks for a frame, in place of one that was asked for and not begun.
    pub fn post(&self, job: Job) {
        self.shared.lock().job = Some(job);
        self.shared.wake.notify_one();
    }

    /// Drops the running frame if newer settings have waited for long enough; else says when to ask again, if ever.
    pub fn drop_outdated(&self) -> Option<Instant> {
        let exchange = self.shared.lock();
        let (running, began) = exchange.running.as_ref()?;
        let waiting = exchange.job.as_ref()?;
        if waiting.differs_by_camera_only(running) || self.cancel.is_cancelled() {
            return None;
        }
        if began.elapsed() >= PATIENCE {
            self.cancel.cancel();
            return None;
        }
        Some(*began + PATIENCE)
    }

    /// The newest finished frame, once.
    pub fn take(&self) -> Option<TracedFrame> {
        self.shared.lock().done.take()
    }

    /// Gives a film back to be traced into again.
    pub fn recycle(&self, film: Film) {
        self.shared.lock().spare.push(film);
    }

    /// Whether a frame is being traced or waits to be.
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

struct Worker {
    shared: Arc<Shared>,
    cancel: CancelToken,
    interval: Duration,
}

impl Worker {
    fn run(&self, render: &mut dyn FnMut(&Job, &mut Film) -> FrameStats, word: &dyn Fn(Word)) {
        let mut next_start = Instant::now();
        while let Some((job, film)) = self.begin(next_start) {
            next_start = Instant::now() + self.interval;
            let mut film = film.unwrap_or_else(|| Film::new(job.width, job.height, Planes::default()));
            let stats = render(&job, &mut film);
            if self.finish(film, stats) {
                word(Word::Frame);
            }
        }
    }

    /// Sleeps until there is a job and it is time, then takes the newest; `None` to stop.
    fn begin(&self, not_before: Instant) -> Option<(Job, Option<Film>)> {
        let mut exchange = self.shared.lock();
        loop {
            if exchange.stop {
                return None;
            }
            let wait = not_before.saturating_duration_since(Instant::now());
            exchange = if exchange.job.is_none() {
                self.shared.wake.wait(exchange).unwrap_or_else(PoisonError::into_inner)
            } else if !wait.is_zero() {
                self.shared.wake.wait_timeout(exchange, wait).unwrap_or_else(PoisonError::into_inner).0
            } else {
                break;
            };
        }
        let job = exchange.job.take()?;
        // Under the same lock as `post` and `drop`, so that no request to stop is lost.
        self.cancel.reset();
        exchange.running = Some((job.clone(), Instant::now()));
        exchange.spare.retain(|film| (film.width(), film.height()) == (job.width, job.height));
        let film = exchange.spare.pop();
        Some((job, film))
    }

    /// Puts a completed frame into the box; false for one that was dropped on the way.
    fn finish(&self, film: Film, stats: FrameStats) -> bool {
        let mut exchange = self.shared.lock();
        exchange.running = None;
        if !stats.completed {
            exchange.spare.push(film);
            return false;
        }
        let missed = exchange.done.replace(TracedFrame { film, stats, finished: Instant::now() });
        exchange.spare.extend(missed.map(|frame| frame.film));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::mpsc::{Receiver, channel};

    fn job(width: u32, x: f32) -> Job {
        let mut camera = Camera::default();
        camera.eye.x = x;
        Job { camera, settings: Settings::default(), width, height: 4 }
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

    #[test]
    fn a_panicking_renderer_is_reported() {
        let (tracer, words) = start(|_, _| std::panic::resume_unwind(Box::new("broken")), CancelToken::default());
        tracer.post(job(4, 0.0));
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone));
    }
}
