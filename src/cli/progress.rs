//! A progress bar for long runs, on a terminal only.

use indicatif::{ProgressBar, ProgressStyle};
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
/// What it shows of any other steps.
const OF_STEPS: &str = "{spinner} {wide_bar} {percent}% {msg}, {elapsed}, {eta} to go";

/// Counts frames, or other steps, and shows how many are done; dropping it clears the bar.
#[derive(Debug)]
pub struct Progress {
    done: Arc<AtomicU64>,
    /// What is in work.
    what: Arc<Mutex<String>>,
    /// The thread that draws, and the channel whose end stops it. A thread of its own: one frame may take minutes.
    drawing: Option<(Sender<()>, JoinHandle<()>)>,
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
        let visible = !quiet && io::stderr().is_terminal();
        let drawing = visible.then(|| {
            let (stop, stopped) = mpsc::channel();
            let (count, what) = (Arc::clone(&done), Arc::clone(&what));
            (stop, thread::spawn(move || draw(steps, template, &count, &what, &stopped)))
        });
        Self { done, what, drawing }
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

fn draw(steps: u64, template: &str, done: &AtomicU64, what: &Mutex<String>, stopped: &mpsc::Receiver<()>) {
    if stopped.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
        return;
    }
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    while stopped.recv_timeout(REDRAW) == Err(RecvTimeoutError::Timeout) {
        bar.tick();
        bar.set_message(what.lock().unwrap_or_else(PoisonError::into_inner).clone());
        bar.set_position(done.load(Ordering::Relaxed));
    }
    bar.finish_and_clear();
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some((stop, thread)) = self.drawing.take() {
            drop(stop);
            // A bar that failed to draw is no reason to fail.
            let _ = thread.join();
        }
    }
}
