//! The window: input in, traced frames and the overlay out; or the same walk in a [`terminal`].
//!
//! The main thread runs the event loop: it gathers input, moves the walker, uploads, draws and presents, each a
//! matter of milliseconds. Frames are traced on a thread of their own ([`tracer`]), so that neither input nor the
//! overlay ever waits for one; a search for cheap settings shares that thread and gives way to every frame
//! ([`measuring`]). Scenes are loaded on another ([`scenes`]); the one shown stays until the next stands.
//!
//! Architecture invariant: with nothing moved and nothing changed, nothing is traced, drawn or woken up for.

pub mod bookmarks;
pub mod config;
pub mod error;
pub mod exam;
pub mod history;
pub mod input;
pub mod inspection;
pub mod labels;
pub mod lighting;
pub mod maps;
pub mod methods;
pub mod overlay;
pub mod present;
pub mod scenes;
pub mod screenshot;
pub mod surroundings;
pub mod survey;
pub mod terminal;
pub mod walker;

mod at_rest;
mod capture;
mod desktop;
mod display;
mod errands;
mod gpu;
mod hint;
mod journey;
mod layer;
mod look;
mod lowering;
mod measuring;
mod outside;
mod pacing;
mod session;
mod steering;
mod tally;
mod tracer;
mod viewer;
mod views;

pub use config::UI_SCALES;
pub use error::AppError;

use crate::measure::Record;
use crate::picture::NumberedName;
use crate::scene::{Camera, LoadOptions};
use crate::settings::Settings;
use config::{Config, Store};
use scenes::{Arrival, Load};
use std::path::PathBuf;

/// What to open the window on.
#[derive(Clone, Debug)]
pub struct AppOptions {
    /// What to walk through.
    pub opening: Opening,
    /// How the user's scenes are loaded.
    pub load: LoadOptions,
    /// How frames are traced at first.
    pub settings: Settings,
    /// Size of the window's inside in logical pixels: physical ones where the display's scale is 1.
    pub size: (u32, u32),
    /// What the user's last window left, and where to keep what this one leaves; without a store, nothing is kept.
    pub config: Config,
    /// See `config`.
    pub store: Option<Store>,
    /// The window opens as the last one was, whatever `size` says.
    pub as_before: bool,
    /// Where screenshots go.
    pub screenshots: NumberedName,
    /// Whether a record of the walk is wanted at the end.
    pub tells: bool,
}

/// The scene that a window opens on.
#[derive(Clone, Debug)]
pub enum Opening {
    /// It is there.
    Scene(Arrival),
    /// It is being loaded from this file. The window shows how far that has come, and closes with
    /// [`AppError::NoScene`] should it fail.
    Loading(Load, PathBuf),
}

/// Where things stood when the user closed the window.
#[derive(Debug)]
pub struct AppExit {
    /// The last view.
    pub camera: Camera,
    /// The last settings.
    pub settings: Settings,
    /// What was done at the end, such as a file that was written, one line each.
    pub notes: Vec<String>,
    /// What could not be done at the end, one line each.
    pub warnings: Vec<String>,
    /// What frames cost since scene, settings or size changed last, where that was asked for and there was one.
    pub record: Option<Record>,
}

/// Closes the window from any thread; false once it is gone.
pub type Closer = Box<dyn Fn() -> bool + Send>;

/// Opens the window and runs until it is closed, also by what is given to `closer`. To be called on the main thread, once in
/// a process.
///
/// # Errors
/// [`AppError::NoDisplay`] when no window can be had, before anything was shown; the others when it had to close.
pub fn run(options: AppOptions, closer: impl FnOnce(Closer)) -> Result<AppExit, AppError> {
    viewer::run(options, closer)
}
