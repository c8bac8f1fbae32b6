//! What ends a command early, and the exit code it means.

use raywalk::app::AppError;
use raywalk::app::scenes::NoScene;
use raywalk::measure::bench::BenchError;
use raywalk::measure::metric::SizesDiffer;
use raywalk::measure::records::RecordsError;
use raywalk::picture::PictureError;
use raywalk::scene::SceneError;

/// Why a command was not done. The text is one line: what, where, what to do.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The command line asks for something that makes no sense.
    #[error("{0}")]
    Usage(String),
    /// A scene or camera path could not be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A folder holds no scene, or several.
    #[error(transparent)]
    Folder(#[from] NoScene),
    /// A picture or record could not be written or read.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Pictures that cannot be compared.
    #[error("{0}; compare pictures of equal size")]
    Sizes(#[from] SizesDiffer),
    /// A bench ended early.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// Records of a bench could not be read.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// The scene asks for something that cannot be rendered.
    #[error("{0}")]
    Run(String),
    /// The window had to close.
    #[error(transparent)]
    Window(#[from] AppError),
    /// Standard output refused.
    #[error("cannot write to standard output: {0}")]
    Stdout(std::io::Error),
    /// Ctrl-C.
    #[error("interrupted")]
    Interrupted,
    /// A signal that asks to end, by its number.
    #[error("stopped by signal {0}")]
    Signal(i32),
}

impl Failure {
    /// Exit code of wrong usage.
    pub const WRONG_USAGE: u8 = 2;
    /// Exit code after Ctrl-C: 128 and the signal's number, as shells have it.
    pub const INTERRUPTED: u8 = 130;

    /// The exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Picture(PictureError::UnknownExtension { .. }) => Self::WRONG_USAGE,
            Self::Interrupted | Self::Bench(BenchError::Interrupted) => Self::INTERRUPTED,
            Self::Signal(number) => u8::try_from(128 + number).unwrap_or(1),
            _ => 1,
        }
    }
}
