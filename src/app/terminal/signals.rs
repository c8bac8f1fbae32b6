//! Requests to end from outside: SIGINT, SIGTERM, SIGHUP and SIGQUIT become words to the walk, so that the terminal is given back.

use std::io;

#[cfg(unix)]
mod unix {
    use super::io;
    use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    use signal_hook::iterator::{Handle, Signals};
    use std::time::Duration;

    /// How long the walk may take to end. It waits for a terminal that takes nothing, as after Ctrl-S.
    const PATIENCE: Duration = Duration::from_secs(5);

    /// Listens until dropped.
    #[derive(Debug)]
    pub struct Watch(Handle);

    impl Watch {
        /// Sends `word` of each signal from now on. To be called while the terminal is still as it was.
        pub fn start(word: impl Fn(i32) + Send + 'static) -> io::Result<Self> {
            let before = tcgetattr(io::stdin()).ok();
            let mut signals = Signals::new([SIGHUP, SIGINT, SIGQUIT, SIGTERM])?;
            let handle = signals.handle();
            let listen = move || {
                if let Some(signal) = signals.forever().next() {
                    word(signal);
                    std::thread::sleep(PATIENCE);
                    if let Some(before) = before.filter(|_| !signals.handle().is_closed()) {
                        // As much as can be done without its help.
                        let _ = tcsetattr(io::stdin(), OptionalActions::Now, &before);
                        crate::picture::exit(128 + signal);
                    }
                }
            };
            std::thread::Builder::new().name("signals".to_owned()).spawn(listen)?;
            Ok(Self(handle))
        }
    }

    impl Drop for Watch {
        fn drop(&mut self) {
            self.0.close();
        }
    }

    /// Stops the process as Ctrl-Z does, until the shell has it go on.
    pub fn suspend() -> io::Result<()> {
        signal_hook::low_level::emulate_default_handler(signal_hook::consts::SIGTSTP)
    }
}

#[cfg(unix)]
pub use unix::{Watch, suspend};

#[cfg(not(unix))]
mod other {
    use super::io;

    /// Without signals there is nothing to listen for.
    #[derive(Debug)]
    pub struct Watch;

    impl Watch {
        /// Does nothing.
        pub fn start(_word: impl Fn(i32) + Send + 'static) -> io::Result<Self> {
            Ok(Self)
        }
    }

    /// Does nothing.
    pub fn suspend() -> io::Result<()> {
        Ok(())
    }
}

#[cfg(not(unix))]
pub use other::{Watch, suspend};
