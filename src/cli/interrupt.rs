//! Requests to end, by Ctrl-C or a signal: a frame is stopped between tiles, a file is finished or removed, a window closes,
//! anything else ends at once, without leaving a temporary file.

use super::Failure;
use raywalk::app::Closer;
use raywalk::picture;
use raywalk::render::CancelToken;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The numbers that every system has for these signals.
const HANG_UP: i32 = 1;
const CTRL_C: i32 = 2;

/// Listens for requests to end.
#[derive(Clone)]
pub struct Interrupt {
    /// Stops the frame in work.
    pub token: CancelToken,
    /// The first signal that came; 0 before.
    signal: Arc<AtomicI32>,
    /// Files may be open that have to be removed on the way out.
    careful: Arc<AtomicBool>,
    /// A window may be open that has things to keep.
    window: Arc<Mutex<Option<Closer>>>,
}

impl Interrupt {
    /// Starts to listen. Until [`careful`](Self::careful) is called, a request ends the process at once.
    pub fn listen() -> Result<Self, Failure> {
        let interrupt = Self {
            token: CancelToken::default(),
            signal: Arc::default(),
            careful: Arc::default(),
            window: Arc::default(),
        };
        let listener = interrupt.clone();
        signals::listen(move |signal| listener.obey(signal))
            .map_err(|error| Failure::Run(format!("cannot listen for signals: {error}")))?;
        Ok(interrupt)
    }

    fn obey(&self, signal: i32) {
        let again = self.token.is_cancelled();
        let _ = self.signal.compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst);
        self.token.cancel();
        let window = self.window.lock().unwrap_or_else(PoisonError::into_inner);
        let closes = window.as_ref().is_some_and(|close| close());
        // A terminal that closes says so twice: itself, and through the shell in it. That is no impatience.
        let hurries = again && signal != HANG_UP;
        if hurries || !(self.careful.load(Ordering::SeqCst) || closes) {
            picture::exit(128 + signal);
        }
    }

    /// From now on a request only asks: [`check`](Self::check) tells. A second one still ends the process.
    pub fn careful(&self) {
        self.careful.store(true, Ordering::SeqCst);
    }

    /// From now on a request closes the window, for as long as there is one; a second one still ends the process.
    pub fn closes(&self, window: Closer) {
        *self.window.lock().unwrap_or_else(PoisonError::into_inner) = Some(window);
    }

    /// Ends the command if that was asked for.
    pub fn check(&self) -> Result<(), Failure> {
        match self.signal.load(Ordering::SeqCst) {
            0 => Ok(()),
            CTRL_C => Err(Failure::Interrupted),
            signal => Err(Failure::Signal(signal)),
        }
    }

    /// How a command ended, an interruption named after the signal that caused it.
    pub fn name(&self, ended: Result<(), Failure>) -> Result<(), Failure> {
        match ended {
            Err(failure) if failure.exit_code() == Failure::INTERRUPTED => self.check().and(Err(failure)),
            ended => ended,
        }
    }
}

#[cfg(unix)]
mod signals {
    use super::HANG_UP;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    use signal_hook::iterator::Signals;
    use std::io;

    /// Calls `obey` with the number of each signal that asks to end, on a thread of its own.
    pub fn listen(obey: impl Fn(i32) + Send + 'static) -> io::Result<()> {
        let mut wanted = vec![SIGINT, SIGQUIT, SIGTERM];
        if !ignores_hang_up() {
            wanted.push(SIGHUP);
        }
        let mut signals = Signals::new(wanted)?;
        std::thread::Builder::new().name("signals".to_owned()).spawn(move || signals.forever().for_each(obey))?;
        Ok(())
    }

    /// Whether the process was started by `nohup`, which listening would undo. Known on Linux only.
    fn ignores_hang_up() -> bool {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        mask.is_some_and(|mask| mask >> (HANG_UP - 1) & 1 == 1)
    }
}

#[cfg(not(unix))]
mod signals {
    use super::CTRL_C;
    use std::io;

    /// Calls `obey` at each Ctrl-C, on a thread of its own.
    pub fn listen(obey: impl Fn(i32) + Send + 'static) -> io::Result<()> {
        ctrlc::set_handler(move || obey(CTRL_C)).map_err(io::Error::other)
    }
}
