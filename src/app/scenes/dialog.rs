//! The desktop's file dialog, asked on a thread of its own.

use crate::scene::FORMATS;
use rfd::AsyncFileDialog;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};

/// A dialog that is over sooner was never there: nobody is that quick.
const LEAST: Duration = Duration::from_millis(400);

/// What came of asking.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// A file was chosen.
    Chosen(PathBuf),
    /// The dialog was closed.
    Closed,
    /// There is no dialog on this desktop.
    NoDialog,
}

/// Asks for a scene file, at first in `folder`, and gives the answer to `then`, on another thread.
pub fn ask<W: HasWindowHandle + HasDisplayHandle>(
    window: &W,
    folder: Option<&Path>,
    then: impl FnOnce(Answer) + Send + 'static,
) {
    let extensions: Vec<&str> = FORMATS.iter().flat_map(|format| format.extensions).copied().collect();
    let mut dialog = AsyncFileDialog::new().set_title("Open a scene").set_parent(window);
    dialog = dialog.add_filter("Scenes", &extensions).add_filter("All files", &["*"]);
    if let Some(folder) = folder {
        dialog = dialog.set_directory(folder);
    }
    let asked = Instant::now();
    let chosen = dialog.pick_file();
    let wait = move || {
        let chosen = pollster::block_on(chosen).map(|file| file.path().to_owned());
        then(chosen.map_or_else(|| nothing(asked.elapsed()), Answer::Chosen));
    };
    // Without a thread there is no dialog either, and whoever asked sees that none comes.
    let _ = std::thread::Builder::new().name("dialog".to_owned()).spawn(wait);
}

/// What it means that nothing was chosen after this time. The library does not tell.
fn nothing(after: Duration) -> Answer {
    if after < LEAST { Answer::NoDialog } else { Answer::Closed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dialog_that_nobody_can_have_closed_was_not_there() {
        assert_eq!(nothing(Duration::from_millis(30)), Answer::NoDialog);
        assert_eq!(nothing(Duration::from_secs(2)), Answer::Closed);
    }
}
