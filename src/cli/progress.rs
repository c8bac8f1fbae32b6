//! A progress bar for long runs, on a terminal only.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, IsTerminal};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
const REDRAW: Duration = Duration::from_millis(200);

/// Counts frames and shows how many are done; dropping it clears the bar.
#[derive(Debug)]
pub struct Progress {
    done: Arc<AtomicU64>,
    /// The thread that draws, and the channel whose end stops it. A thread of its own: one frame may take minutes.
    drawing: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Progress over `frames` frames; shows nothing if `quiet` or stderr is no terminal.
    pub fn new(frames: u64, quiet: bool) -> Self {
        let done = Arc::new(AtomicU64::new(0));
        let visible = !quiet && io::stderr().is_terminal();
        let drawing = visible.then(|| {
            let (stop, stopped) = mpsc::channel();
            let count = Arc::clone(&done);
            (stop, thread::spawn(move || draw(frames, &count, &stopped)))
        });
        Self { done, drawing }
    }

    /// One more frame is done.
    pub fn advance(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }
}

fn draw(frames: u64, done: &AtomicU64, stopped: &mpsc::Receiver<()>) {
    if stopped.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
        return;
    }
    let bar = ProgressBar::new(frames);
    if let Ok(style) = ProgressStyle::with_template("{spinner} {wide_bar} frame {pos}/{len}, {elapsed}, {eta} to go") {
        bar.set_style(style);
    }
    while stopped.recv_timeout(REDRAW) == Err(RecvTimeoutError::Timeout) {
        bar.tick();
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
