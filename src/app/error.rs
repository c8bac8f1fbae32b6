//! Why the window could not be opened or had to close.

/// What ends [`run`](super::run) other than the user.
#[derive(Debug, thiserror::Error)]
pub enum AppError {
    /// The scene that was to be shown first could not be loaded.
    #[error("{0}")]
    NoScene(super::scenes::Failed),
    /// There is nothing to show a window on: no display server, or no way to draw on it. Rendering without
    /// a window still works.
    #[error("no display to open a window on: {0}")]
    NoDisplay(String),
    /// The graphics device was lost and could not be had again.
    #[error("the graphics device was lost: {0}; restart, or render without a window: raywalk render")]
    GraphicsLost(String),
    /// The tracing thread ended by itself; its panic message was printed before.
    #[error("the tracing thread stopped; please report the message above")]
    TracerGone,
    /// No thread to trace on.
    #[error("cannot start the tracing thread: {0}")]
    NoThread(#[from] std::io::Error),
    /// The terminal refused, or went away during a walk in it.
    #[error("the terminal failed: {0}")]
    Terminal(std::io::Error),
    /// The window system ended the event loop.
    #[error("the window system failed: {0}")]
    EventLoop(#[from] winit::error::EventLoopError),
}
