//! A load on a thread of its own.

use crate::scene::guard::guarded;
use crate::scene::progress::SeenFile;
use crate::scene::{Camera, Progress, Scene};
use std::error::Error;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Stack of the loading thread: readers go as deep as the limits on nesting allow, whatever the system's default.
const STACK: usize = 16 << 20;

/// A scene that was loaded, and where a walk through it starts.
#[derive(Clone, Debug)]
pub struct Arrival {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Where the walk starts.
    pub camera: Camera,
    /// Its file; `None` for a scene that is not a file.
    pub file: Option<PathBuf>,
    /// The one path of its file, however that was spelled or linked to.
    pub place: Option<PathBuf>,
    /// The files that the load looked at.
    pub files: Vec<SeenFile>,
    /// Milliseconds it took to read and build.
    pub load_ms: f64,
    /// Size of the window's inside that it asks for, in physical pixels.
    pub size: Option<(u32, u32)>,
}

/// The one path of a file, as [`Arrival::place`] has it. It asks the disk, which may take long.
pub fn place_of(file: &Path) -> PathBuf {
    file.canonicalize().or_else(|_| std::path::absolute(file)).unwrap_or_else(|_| file.to_owned())
}

/// Why there is no scene; its text is one line.
pub type Failed = Box<dyn Error + Send + Sync>;

/// What a load comes to.
pub type Outcome = Result<Arrival, Failed>;

/// A load under way, or one whose outcome waits to be taken. Clones speak of the same one.
#[derive(Clone)]
pub struct Load {
    progress: Progress,
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    ended: Condvar,
}

#[derive(Default)]
struct State {
    outcome: Option<Outcome>,
    has_ended: bool,
    then: Option<Box<dyn FnOnce() + Send>>,
}

impl Load {
    /// Starts to load by `work`, which tells `progress` how far it has come and ends when that is cancelled.
    pub fn start(progress: Progress, work: impl FnOnce() -> Outcome + Send + 'static) -> Self {
        let load = Self { progress, shared: Arc::default() };
        let shared = Arc::clone(&load.shared);
        let work = move || {
            let outcome = guarded(work);
            shared.end(outcome.unwrap_or_else(|fault| Err(format!("loading stopped by a fault: {fault}").into())));
        };
        let thread = std::thread::Builder::new().name("loader".to_owned()).stack_size(STACK).spawn(work);
        if let Err(error) = thread {
            load.shared.end(Err(format!("cannot start a thread to load on: {error}").into()));
        }
        load
    }

    /// How far it has come; also the way to cancel it.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The outcome, once, if it has ended.
    pub fn take(&self) -> Option<Outcome> {
        self.shared.lock().outcome.take()
    }

    /// Waits for the end and takes the outcome.
    pub fn wait_to_the_end(&self) -> Outcome {
        let waited = self.shared.ended.wait_while(self.shared.lock(), |state| !state.has_ended);
        let outcome = waited.unwrap_or_else(PoisonError::into_inner).outcome.take();
        outcome.unwrap_or_else(|| Err("the scene was taken before".into()))
    }

    /// Waits for the end, for so long at most, and takes the outcome.
    pub fn wait(&self, at_most: Duration) -> Option<Outcome> {
        let state = self.shared.lock();
        let waited = self.shared.ended.wait_timeout_while(state, at_most, |state| !state.has_ended);
        waited.unwrap_or_else(PoisonError::into_inner).0.outcome.take()
    }

    /// Has `then` called once it has ended: on the thread of the load, or at once.
    pub fn when_ended(&self, then: impl FnOnce() + Send + 'static) {
        let mut state = self.shared.lock();
        if state.has_ended {
            drop(state);
            then();
        } else {
            state.then = Some(Box::new(then));
        }
    }
}

impl Shared {
    fn end(&self, outcome: Outcome) {
        let mut state = self.lock();
        state.outcome = Some(outcome);
        state.has_ended = true;
        let then = state.then.take();
        drop(state);
        self.ended.notify_all();
        if let Some(then) = then {
            then();
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for Load {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Load").field("progress", &self.progress).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LoadOptions, load_text};
    use std::sync::mpsc::channel;

    const SOON: Duration = Duration::from_secs(20);

    fn arrival() -> Arrival {
        let scene = load_text("a.json", r#"{"version": 1}"#, &LoadOptions::default()).expect("right");
        Arrival {
            camera: scene.cameras[0].camera,
            scene: Arc::new(scene),
            file: None,
            place: None,
            files: Vec::new(),
            load_ms: 0.0,
            size: None,
        }
    }

    #[test]
    fn whoever_waits_gets_the_outcome_once() {
        let load = Load::start(Progress::default(), || Ok(arrival()));
        let (ended, ends) = channel();
        load.when_ended(move || ended.send(()).unwrap_or(()));
        assert_eq!(ends.recv_timeout(SOON), Ok(()));
        assert!(load.wait(SOON).is_some_and(|outcome| outcome.is_ok()));
        assert!(load.take().is_none() && load.wait(Duration::ZERO).is_none());
        let (ended, ends) = channel();
        load.when_ended(move || ended.send(()).unwrap_or(()));
        assert_eq!(ends.try_recv(), Ok(()), "at once, where it has ended");
    }

    #[test]
    fn a_cancelled_load_ends_and_leaves_nothing_behind() {
        let kept = Arc::new(());
        let held = Arc::clone(&kept);
        let progress = Progress::default();
        let seen = progress.clone();
        let load = Load::start(progress, move || {
            while !seen.is_cancelled() {
                std::thread::sleep(Duration::from_millis(1));
            }
            drop(held);
            Err("cancelled".into())
        });
        assert!(load.wait(Duration::from_millis(20)).is_none(), "it goes on");
        load.progress().cancel();
        assert!(load.wait(SOON).is_some_and(|outcome| outcome.is_err()));
        assert_eq!(Arc::strong_count(&kept), 1);
    }

    #[test]
    fn a_panic_is_an_outcome() {
        let load = Load::start(Progress::default(), || std::panic::resume_unwind(Box::new("broken")));
        let outcome = load.wait(SOON).expect("it has ended");
        assert!(outcome.expect_err("no scene").to_string().contains("fault"));
    }
}
