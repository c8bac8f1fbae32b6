//! Stops a frame that takes too long, or when measuring is asked to stop.

use crate::render::CancelToken;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// How often it looks: seldom enough to cost a frame nothing.
const PERIOD: Duration = Duration::from_millis(10);

/// A thread that watches the frame in work.
pub struct Watch {
    /// Asks measuring to stop.
    pub stop: CancelToken,
    frame: CancelToken,
    deadline: Arc<Mutex<Option<Instant>>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Watches frames until `stop` is cancelled.
    pub fn new(stop: CancelToken) -> Self {
        Self::over(stop, CancelToken::default())
    }

    /// The same, where `frame` is what stops a frame.
    pub fn over(stop: CancelToken, frame: CancelToken) -> Self {
        let (deadline, ended) = (Arc::<Mutex<Option<Instant>>>::default(), Arc::default());
        let thread = {
            let (stop, frame, deadline) = (stop.clone(), frame.clone(), Arc::clone(&deadline));
            let ended: Arc<AtomicBool> = Arc::clone(&ended);
            thread::spawn(move || {
                while !ended.load(Ordering::Relaxed) {
                    thread::sleep(PERIOD);
                    let deadline = deadline.lock().unwrap_or_else(PoisonError::into_inner);
                    if stop.is_cancelled() || deadline.is_some_and(|deadline| Instant::now() > deadline) {
                        frame.cancel();
                    }
                }
            })
        };
        Self { stop, frame, deadline, ended, thread: Some(thread) }
    }

    /// What stops the frame in work.
    pub fn token(&self) -> CancelToken {
        self.frame.clone()
    }

    /// A frame starts that may last until `deadline`.
    pub fn start(&self, deadline: Option<Instant>) {
        let mut held = self.deadline.lock().unwrap_or_else(PoisonError::into_inner);
        *held = deadline;
        self.frame.reset();
        if self.stop.is_cancelled() {
            self.frame.cancel();
        }
    }

    /// The frame has ended.
    pub fn end(&self) {
        *self.deadline.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // It has nothing left to say.
            let _ = thread.join();
        }
    }
}
