//! What there is to say of scenes, as the overlay shows it.

use super::load::Failed;
use crate::scene::Scene;
use crate::scene::progress::Step;
use std::path::{Path, PathBuf};

/// A load that came to nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What could not be done.
    pub title: String,
    /// Why: file and place, problem, remedy.
    pub message: String,
    /// What to open to try it again.
    pub file: Option<PathBuf>,
}

impl Failure {
    /// For the reason that the load gave.
    pub(super) fn new(title: String, failed: &Failed, file: PathBuf) -> Self {
        Self { title, message: failed.to_string(), file: Some(file) }
    }

    /// Where no file can be chosen.
    pub(super) fn of_no_dialog() -> Self {
        let message = "This desktop has neither a portal for file dialogs (xdg-desktop-portal) nor zenity. Drop a scene \
                       file or its folder on this window, or name it on the command line.";
        Self { title: "There is no file dialog here".to_owned(), message: message.to_owned(), file: None }
    }
}

/// A load as the overlay shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loading {
    /// What is loaded.
    pub name: String,
    /// What the load is busy with.
    pub step: Step,
    /// How long it has taken.
    pub seconds: f64,
}

/// Warnings that are told of.
#[derive(Clone, Copy, Debug)]
pub struct Oddities<'a> {
    /// Whose they are.
    pub scene: &'a Scene,
    /// All of them are listed, not summed up in a line.
    pub is_list: bool,
}

/// What there is to say of scenes.
#[derive(Clone, Debug, Default)]
pub struct Report<'a> {
    /// The load under way, if it takes long.
    pub loading: Option<Loading>,
    /// The load that came to nothing, until it is dismissed or another begins.
    pub failure: Option<&'a Failure>,
    /// The warnings of the scene, as long as there is to tell of them.
    pub odd: Option<Oddities<'a>>,
    /// The folder of the scene that is shown.
    pub folder: Option<&'a Path>,
    /// What may be done now.
    pub hint: Option<&'static str>,
    /// The files that were opened last.
    pub recent: &'a [PathBuf],
    /// Which files are not watched and why, in words, if some are not.
    pub blind: Option<&'a str>,
}
