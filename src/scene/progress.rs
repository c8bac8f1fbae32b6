//! A load as other threads see it: how far it has come, which files it looked at, and the way to end it early.

use std::collections::BTreeMap;
use std::fs::Metadata;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// What a load is busy with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// In words, such as `decoding textures`; empty before it begins.
    pub what: String,
    /// How many of these are done.
    pub done: u64,
    /// How many there are; 0 where that is not known.
    pub of: u64,
}

impl std::fmt::Display for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.of {
            0 => write!(f, "{}", self.what),
            of => write!(f, "{}: {} of {of}", self.what, self.done),
        }
    }
}

/// Tells two versions of a file apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    modified: Option<SystemTime>,
    bytes: u64,
}

impl Stamp {
    /// The stamp of what is at `path` now; `None` where nothing is.
    pub fn of(path: &Path) -> Option<Self> {
        path.metadata().ok().as_ref().map(Self::of_metadata)
    }

    /// The stamp of a file that was asked already.
    pub fn of_metadata(metadata: &Metadata) -> Self {
        Self { modified: metadata.modified().ok(), bytes: metadata.len() }
    }
}

/// A file that a load looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeenFile {
    /// Where it is, or was looked for.
    pub path: PathBuf,
    /// Its version; `None` where there was none.
    pub stamp: Option<Stamp>,
}

/// The handle on a load; clones speak of the same one.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    cancelled: AtomicBool,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    step: Step,
    /// By where they are: many things may name one.
    files: BTreeMap<PathBuf, Option<Stamp>>,
}

impl Progress {
    /// Asks the load to end. It does so between files, textures, meshes and the stages of building the tree.
    pub fn cancel(&self) {
        self.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to end.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }

    /// What it is busy with.
    pub fn step(&self) -> Step {
        self.state().step.clone()
    }

    /// The files it looked at so far, those that it did not find among them.
    pub fn files(&self) -> Vec<SeenFile> {
        let files = self.state().files.clone();
        files.into_iter().map(|(path, stamp)| SeenFile { path, stamp }).collect()
    }

    /// Begins something that has `of` parts, 0 where that is not known.
    pub(super) fn begin(&self, what: impl Into<String>, of: usize) {
        self.state().step = Step { what: what.into(), done: 0, of: of as u64 };
    }

    /// One part more is done.
    pub(super) fn advance(&self) {
        self.state().step.done += 1;
    }

    /// Notes that it looked at a file. The version that was seen last counts.
    pub(super) fn saw(&self, path: &Path, stamp: Option<Stamp>) {
        let files = &mut self.state().files;
        match files.get_mut(path) {
            Some(known) => *known = stamp,
            None => drop(files.insert(path.to_owned(), stamp)),
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_told_in_words() {
        let progress = Progress::default();
        progress.begin("reading room.glb", 0);
        assert_eq!(progress.step().to_string(), "reading room.glb");
        progress.begin("decoding textures", 15);
        for _ in 0..3 {
            progress.clone().advance();
        }
        assert_eq!(progress.step().to_string(), "decoding textures: 3 of 15");
    }

    #[test]
    fn a_file_is_noted_once_however_often_it_is_looked_for() {
        let progress = Progress::default();
        let seen = Some(Stamp { modified: None, bytes: 1 });
        for _ in 0..3 {
            progress.saw(Path::new("wood.png"), None);
        }
        progress.saw(Path::new("room.gltf"), seen);
        progress.saw(Path::new("wood.png"), seen);
        let files = progress.files();
        assert_eq!(
            files.iter().map(|file| (file.path.to_str(), file.stamp)).collect::<Vec<_>>(),
            [(Some("room.gltf"), seen), (Some("wood.png"), seen)]
        );
    }
}
