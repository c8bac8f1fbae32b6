//! Progress bars, drawn by a thread of their own, on a terminal only.

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use raywalk::render::TileCount;
use raywalk::scene;
use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
const REDRAW: Duration = Duration::from_millis(200);

/// What a bar shows of work whose end is known.
const OF_STEPS: &str = "{spinner} {wide_bar} {msg}";
/// What it shows of a load.
const OF_LOAD: &str = "{spinner} {msg}";

/// Counts steps and shows how many are done; dropping it clears the bar.
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

/// How far some work has come.
struct Standing {
    done: u64,
    what: String,
}

impl Progress {
    /// Progress over so many tiles, which `count` counts; shows nothing if `quiet` or stderr is no terminal.
    pub fn over_tiles(tiles: u64, count: TileCount, quiet: bool) -> Self {
        Self::over(tiles, quiet, move |_| count.finished())
    }

    /// Progress over steps that are told by [`set`](Self::set).
    pub fn over_steps(steps: u64, quiet: bool) -> Self {
        Self::over(steps, quiet, |done| done)
    }

    fn over(steps: u64, quiet: bool, position: impl Fn(u64) -> u64 + Send + 'static) -> Self {
        let (done, what) = (Arc::new(AtomicU64::new(0)), Arc::<Mutex<String>>::default());
        let (count, text) = (Arc::clone(&done), Arc::clone(&what));
        let drawing = Drawing::start(Some(steps), quiet, move || Standing {
            done: position(count.load(Ordering::Relaxed)),
            what: text.lock().unwrap_or_else(PoisonError::into_inner).clone(),
        });
        Self { done, what, _drawing: drawing }
    }

    /// This is in work.
    pub fn tell(&self, what: &str) {
        what.clone_into(&mut self.what.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// So many steps are done, and this is in work.
    pub fn set(&self, done: u64, what: &str) {
        self.done.store(done, Ordering::Relaxed);
        self.tell(what);
    }
}

impl Drawing {
    /// How far a load has come; nothing if `quiet` or stderr is no terminal.
    pub fn of_load(load: &scene::Progress, quiet: bool) -> Option<Self> {
        let load = load.clone();
        Self::start(None, quiet, move || Standing { done: 0, what: load.step().to_string() })
    }

    fn start(steps: Option<u64>, quiet: bool, standing: impl Fn() -> Standing + Send + 'static) -> Option<Self> {
        if quiet || !io::stderr().is_terminal() {
            return None;
        }
        let (stop, stopped) = mpsc::channel();
        let thread = thread::spawn(move || draw(steps, standing, &stopped));
        Some(Self { stop: Some(stop), thread: Some(thread) })
    }
}

fn draw(steps: Option<u64>, standing: impl Fn() -> Standing, stopped: &mpsc::Receiver<()>) {
    let began = Instant::now();
    if stopped.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
        return;
    }
    let bar = ProgressBar::new(steps.unwrap_or_default());
    if let Ok(style) = ProgressStyle::with_template(if steps.is_some() { OF_STEPS } else { OF_LOAD }) {
        bar.set_style(style);
    }
    while stopped.recv_timeout(REDRAW) == Err(RecvTimeoutError::Timeout) {
        let standing = standing();
        bar.tick();
        bar.set_message(text(&standing, steps, began.elapsed()));
        bar.set_position(standing.done);
    }
    bar.finish_and_clear();
}

/// What is said beside the bar: the share that is done, what is in work, the time it took so far, and the time that the rest
/// takes at the same pace. Before the first step is done there is no pace.
fn text(standing: &Standing, steps: Option<u64>, elapsed: Duration) -> String {
    let Standing { done, what } = standing;
    let mut parts = Vec::new();
    if let Some(steps) = steps.filter(|steps| *steps > 0) {
        parts.push(format!("{}%", (100 * done.min(&steps)) / steps));
    }
    if !what.is_empty() {
        parts.push(what.clone());
    }
    parts.push(format!("{:#}", HumanDuration(elapsed)));
    let left = steps.and_then(|steps| steps.checked_sub(*done)).filter(|left| *left > 0 && *done > 0);
    if let Some(left) = left {
        let seconds = elapsed.as_secs_f64() * left as f64 / *done as f64;
        // Of centuries nobody needs to know more.
        let rest = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        parts.push(format!("{:#} to go", HumanDuration(rest)));
    }
    parts.join(", ")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_follows_from_what_is_done_and_from_nothing_else() {
        let said = |done, what: &str, steps, seconds| {
            text(&Standing { done, what: what.to_owned() }, steps, Duration::from_secs(seconds))
        };
        assert_eq!(said(0, "", Some(200), 30), "0%, 30s");
        assert_eq!(said(50, "", Some(200), 30), "25%, 30s, 2m to go");
        assert_eq!(said(1, "frame 1 of 9", Some(100), 2), "1%, frame 1 of 9, 2s, 3m to go");
        assert_eq!(said(200, "", Some(200), 30), "100%, 30s", "it is being written");
        assert_eq!(said(300, "", Some(200), 30), "100%, 30s");
        assert_eq!(said(0, "reading a.glb", None, 3), "reading a.glb, 3s");
        assert!(said(1, "", Some(u64::MAX / 100), u64::MAX).contains("to go"));
    }
}
