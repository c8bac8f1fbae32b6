//! A progress bar for long runs and loads, on a terminal only.

use indicatif::{ProgressBar, ProgressStyle};
use raywalk::scene;
use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
const REDRAW: Duration = Duration::from_millis(200);

/// What a bar shows of frames.
const OF_FRAMES: &str = "{spinner} {wide_bar} frame {pos}/{len}, {elapsed}, {eta} to go";
/// What it shows of a load.
const OF_LOAD: &str = "{spinner} {msg}, {elapsed}";
/// What it shows of any other steps.
const OF_STEPS: &str = "{spinner} {wide_bar} {percent}% {msg}, {elapsed}, {eta} to go";

/// Counts frames, or other steps, and shows how many are done; dropping it clears the bar.
#[derive(Debug)]
pub struct Progress {
    done: Arc<AtomicU64>,
    /// What is in work.
    what: Arc<Mutex<String>>,
    /// Clears the bar when it is dropped.
    _drawing: Option<Drawing>,
}

/// A bar on the terminal; dropping it clears it.
#[derive(Debug)]
pub struct Drawing {
    /// Its end stops the thread.
    stop: Option<Sender<()>>,
    /// A thread of its own: one frame may take minutes.
    thread: Option<JoinHandle<()>>,
}

impl Progress {
    /// Progress over `frames` frames; shows nothing if `quiet` or stderr is no terminal.
    pub fn new(frames: u64, quiet: bool) -> Self {
        Self::over(frames, OF_FRAMES, quiet)
    }

    /// Progress over steps that are told by [`set`](Self::set).
    pub fn over_steps(steps: u64, quiet: bool) -> Self {
        Self::over(steps, OF_STEPS, quiet)
    }

    fn over(steps: u64, template: &'static str, quiet: bool) -> Self {
        let (done, what) = (Arc::new(AtomicU64::new(0)), Arc::<Mutex<String>>::default());
        let (count, text) = (Arc::clone(&done), Arc::clone(&what));
        let drawing = Drawing::start(steps, template, quiet, move |bar| {
            bar.set_message(text.lock().unwrap_or_else(PoisonError::into_inner).clone());
            bar.set_position(count.load(Ordering::Relaxed));
        });
        Self { done, what, _drawing: drawing }
    }

    /// One more frame is done.
    pub fn advance(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// So many steps are done, and this is in work.
    pub fn set(&self, done: u64, what: &str) {
        self.done.store(done, Ordering::Relaxed);
        what.clone_into(&mut self.what.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Drawing {
    /// How far a load has come; nothing if `quiet` or stderr is no terminal.
    pub fn of_load(load: &scene::Progress, quiet: bool) -> Option<Self> {
        let load = load.clone();
        Self::start(0, OF_LOAD, quiet, move |bar| bar.set_message(load.step().to_string()))
    }

    fn start(
        steps: u64,
        template: &'static str,
        quiet: bool,
        tell: impl Fn(&ProgressBar) + Send + 'static,
    ) -> Option<Self> {
        if quiet || !io::stderr().is_terminal() {
            return None;
        }
        let (stop, stopped) = mpsc::channel();
        let thread = thread::spawn(move || draw(steps, template, tell, &stopped));
        Some(Self { stop: Some(stop), thread: Some(thread) })
    }
}

fn draw(steps: u64, template: &str, tell: impl Fn(&ProgressBar), stopped: &mpsc::Receiver<()>) {
    if stopped.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
        return;
    }
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    while stopped.recv_timeout(REDRAW) == Err(RecvTimeoutError::Timeout) {
        bar.tick();
        tell(&bar);
    }
    bar.finish_and_clear();
}

impl Drop for Drawing {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A bar that failed to draw is no reason to fail.
            let _ = thread.join();
        }
    }
}
