//! Skies that are brought to the scene that is shown: read on a thread of their own, and again when their file changes.

use super::watch::{Sight, Watch};
use super::{Inbox, Note};
use crate::scene::environment::SkyImage;
use crate::scene::guard::guarded;
use crate::scene::{Limits, Progress, Warning, read_sky};
use std::path::{Path, PathBuf};

/// A picture of the sky that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyArrival {
    /// Its file.
    pub file: PathBuf,
    /// The picture.
    pub image: SkyImage,
    /// What was odd about it.
    pub warnings: Vec<Warning>,
}

/// The sky that was brought last.
#[derive(Debug, Default)]
pub struct SkyFile {
    file: Option<PathBuf>,
    reading: Option<Progress>,
    watch: Option<Watch>,
}

/// What came of reading a sky: the picture, or why there is none, in one line.
#[derive(Debug)]
pub struct SkyNote {
    outcome: Result<SkyArrival, String>,
    /// Of the reading that ended.
    progress: Progress,
}

impl SkyFile {
    /// Reads `file` in place of the one before.
    pub fn bring(&mut self, file: &Path, limits: &Limits, inbox: &Inbox) {
        if let Some(before) = self.reading.take() {
            before.cancel();
        }
        self.file = Some(file.to_owned());
        let progress = Progress::default();
        self.reading = Some(progress.clone());
        let (file, limits, inbox) = (file.to_owned(), limits.clone(), inbox.clone());
        let read = move || {
            let read = || read_sky(&file, &limits, limits.texture_bytes, &progress);
            let outcome = match guarded(read) {
                Ok(Ok((image, warnings))) => Ok(SkyArrival { file: file.clone(), image, warnings }),
                Ok(Err(error)) => Err(error.to_string()),
                Err(fault) => Err(format!("{}: the program has a fault: {fault}", file.display())),
            };
            inbox.put(Note::Sky(Box::new(SkyNote { outcome, progress })));
        };
        // Without a thread nothing comes of it, as of scenes.
        let _ = std::thread::Builder::new().name("sky".to_owned()).spawn(read);
    }

    /// Reads once more what was brought.
    pub fn again(&mut self, limits: &Limits, inbox: &Inbox) {
        if let Some(file) = self.file.clone() {
            self.bring(&file, limits, inbox);
        }
    }

    /// Another scene is shown: the sky that was brought is not of it.
    pub fn forget(&mut self) {
        if let Some(reading) = self.reading.take() {
            reading.cancel();
        }
        *self = Self::default();
    }

    /// A reading has ended. What came of it; `None` if it was given up. From then on the file is watched.
    pub fn ended(&mut self, note: SkyNote, inbox: &Inbox) -> Option<Result<SkyArrival, String>> {
        let SkyNote { outcome, progress } = note;
        if progress.is_cancelled() {
            return None;
        }
        self.reading = None;
        let eye = inbox.clone();
        let watch = self.watch.get_or_insert_with(|| {
            Watch::start(move |sight| {
                if sight == Sight::Changed {
                    eye.put(Note::SkyChanged);
                }
            })
        });
        watch.files(progress.files());
        Some(outcome)
    }
}

impl Drop for SkyFile {
    fn drop(&mut self) {
        if let Some(reading) = &self.reading {
            reading.cancel();
        }
    }
}
