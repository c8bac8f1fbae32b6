//! Ctrl-C: a frame is stopped between tiles, a file is finished or removed, a window closes, anything else ends at once.

use super::Failure;
use raywalk::app::Closer;
use raywalk::render::CancelToken;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Listens for Ctrl-C.
#[derive(Clone)]
pub struct Interrupt {
    /// Stops the frame in work.
    pub token: CancelToken,
    /// Files may be open that have to be removed on the way out.
    careful: Arc<AtomicBool>,
    /// A window may be open that has things to keep.
    window: Arc<Mutex<Option<Closer>>>,
}

impl Interrupt {
    /// Starts to listen. Until [`careful`](Self::careful) is called, Ctrl-C ends the process at once.
    pub fn listen() -> Result<Self, Failure> {
        let interrupt = Self { token: CancelToken::default(), careful: Arc::default(), window: Arc::default() };
        let Self { token, careful, window } = interrupt.clone();
        let handler = move || {
            let again = token.is_cancelled();
            token.cancel();
            let window = window.lock().unwrap_or_else(PoisonError::into_inner);
            let closes = window.as_ref().is_some_and(|close| close());
            if again || !(careful.load(Ordering::SeqCst) || closes) {
                std::process::exit(Failure::INTERRUPTED.into());
            }
        };
        ctrlc::set_handler(handler).map_err(|error| Failure::Run(format!("cannot listen for Ctrl-C: {error}")))?;
        Ok(interrupt)
    }

    /// From now on Ctrl-C only asks: [`check`](Self::check) tells. A second one still ends the process.
    pub fn careful(&self) {
        self.careful.store(true, Ordering::SeqCst);
    }

    /// From now on Ctrl-C closes the window, for as long as there is one; a second one still ends the process.
    pub fn closes(&self, window: Closer) {
        *self.window.lock().unwrap_or_else(PoisonError::into_inner) = Some(window);
    }

    /// Ends the command if Ctrl-C was pressed.
    pub fn check(&self) -> Result<(), Failure> {
        if self.token.is_cancelled() { Err(Failure::Interrupted) } else { Ok(()) }
    }
}
