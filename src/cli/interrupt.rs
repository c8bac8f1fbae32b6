//! Ctrl-C: a frame is stopped between tiles, a file is finished or removed, anything else ends at once.

use super::Failure;
use raywalk::render::CancelToken;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Listens for Ctrl-C.
#[derive(Clone, Debug)]
pub struct Interrupt {
    /// Stops the frame in work.
    pub token: CancelToken,
    /// Files may be open that have to be removed on the way out.
    careful: Arc<AtomicBool>,
}

impl Interrupt {
    /// Starts to listen. Until [`careful`](Self::careful) is called, Ctrl-C ends the process at once.
    pub fn listen() -> Result<Self, Failure> {
        let interrupt = Self { token: CancelToken::default(), careful: Arc::default() };
        let Self { token, careful } = interrupt.clone();
        let handler = move || {
            let again = token.is_cancelled();
            token.cancel();
            if again || !careful.load(Ordering::SeqCst) {
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

    /// Ends the command if Ctrl-C was pressed.
    pub fn check(&self) -> Result<(), Failure> {
        if self.token.is_cancelled() { Err(Failure::Interrupted) } else { Ok(()) }
    }
}
