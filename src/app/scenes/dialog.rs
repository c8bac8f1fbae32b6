//! The desktop's file dialog, asked on a thread of its own.

use crate::scene::FORMATS;
use crate::scene::environment::SKY_EXTENSIONS;
use log::{LevelFilter, Log, Metadata, Record};
use rfd::AsyncFileDialog;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};

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

/// Asks for a scene file or a picture of the sky, at first in `folder`, and gives the answer to `then`, on another thread.
pub fn ask<W: HasWindowHandle + HasDisplayHandle>(
    window: &W,
    folder: Option<&Path>,
    then: impl FnOnce(Answer) + Send + 'static,
) {
    let extensions: Vec<&str> = FORMATS.iter().flat_map(|format| format.extensions).copied().collect();
    let mut dialog = AsyncFileDialog::new().set_title("Open a scene").set_parent(window);
    dialog =
        dialog.add_filter("Scenes", &extensions).add_filter("Skies", &SKY_EXTENSIONS).add_filter("All files", &["*"]);
    if let Some(folder) = folder {
        dialog = dialog.set_directory(folder);
    }
    EAR.listen();
    let chosen = dialog.pick_file();
    let wait = move || {
        let chosen = pollster::block_on(chosen).map(|file| file.path().to_owned());
        then(chosen.map_or_else(|| EAR.nothing(), Answer::Chosen));
    };
    // Without a thread there is no dialog either, and whoever asked sees that none comes.
    let _ = std::thread::Builder::new().name("dialog".to_owned()).spawn(wait);
}

/// Hears the library say that it found no dialog to open: it says so in its log alone.
struct Ear {
    heard: AtomicBool,
}

static EAR: Ear = Ear { heard: AtomicBool::new(false) };

impl Ear {
    fn listen(&'static self) {
        self.heard.store(false, Ordering::Relaxed);
        // Refused from the second time on, and where the program has another log.
        if log::set_logger(self).is_ok() {
            log::set_max_level(LevelFilter::Error);
        }
    }

    /// What it means that nothing was chosen.
    fn nothing(&self) -> Answer {
        if self.heard.load(Ordering::Relaxed) { Answer::NoDialog } else { Answer::Closed }
    }
}

impl Log for Ear {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("rfd")
    }

    fn log(&self, record: &Record<'_>) {
        // Its last resort, where there is no portal, is the program zenity.
        if self.enabled(record.metadata()) && record.args().to_string().contains("with zenity") {
            self.heard.store(true, Ordering::Relaxed);
        }
    }

    fn flush(&self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use log::Level;

    #[test]
    fn only_a_failing_last_resort_means_that_there_is_no_dialog() {
        let ear = Ear { heard: AtomicBool::new(false) };
        let say = |target: &str, text: &str| {
            ear.log(&Record::builder().target(target).level(Level::Error).args(format_args!("{text}")).build());
        };
        say("rfd::backend", "Can't connect to a portal: libdbus-1.so not found");
        say("wgpu", "Failed to start with zenity");
        assert_eq!(ear.nothing(), Answer::Closed);
        say("rfd::backend", "Failed to pick file with zenity: No such file or directory");
        assert_eq!(ear.nothing(), Answer::NoDialog);
    }
}
