//! Finds the cheapest settings whose pictures are good enough.
//!
//! `axes` says what may be varied, from the list of settings and its promises; `search` walks it; each `trial` is timed and
//! judged; `report` tells what came of it. Frames are made by a [`Studio`]: on the command line a [`Machine`], in the window
//! the thread that traces anyway.

mod axes;
mod bound;
mod machine;
mod report;
mod search;
mod trial;

pub use bound::Bound;
pub use machine::Machine;
pub use report::{json, table};
pub use trial::{Trial, Verdict};

use crate::render::Film;
use crate::scene::Camera;
use crate::settings::Settings;
use std::time::Duration;

/// What is looked for.
#[derive(Clone, Debug)]
pub struct Task {
    /// The views, at least one; the worst of them decides.
    pub cameras: Vec<Camera>,
    /// Width and height of the picture in pixels, each at least 1.
    pub size: (u32, u32),
    /// Where the search starts from. Of rows that are not fixed it keeps only what is another picture by intent.
    pub settings: Settings,
    /// Names of the rows that keep their values, whatever they promise.
    pub fixed: Vec<&'static str>,
    /// What all pictures must keep.
    pub bounds: Vec<Bound>,
    /// Settings that are tried in any case.
    pub also: Vec<Settings>,
    /// No new settings are tried after this time.
    pub budget: Duration,
}

/// A search was asked to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Stopped;

/// Where frames are made.
pub trait Studio {
    /// Renders one frame into `film`. CPU milliseconds that it took; `None` for one that was dropped because it took longer
    /// than `longest`.
    ///
    /// # Errors
    /// [`Stopped`].
    fn frame(
        &mut self,
        camera: &Camera,
        settings: &Settings,
        film: &mut Film,
        longest: Option<Duration>,
    ) -> Result<Option<f64>, Stopped>;

    /// How far the search has come, 0 to 1, and what it has tried so far.
    fn told(&mut self, share: f64, trials: &[Trial]);
}

/// What a search found.
#[derive(Clone, Debug)]
pub struct Tuning {
    /// What all pictures had to keep.
    pub bounds: Vec<Bound>,
    /// All settings that were tried, in order.
    pub trials: Vec<Trial>,
    /// Of these, the ones that were judged and that no other beats in both time and error, the slowest first.
    pub front: Vec<usize>,
    /// The cheapest that keeps all bounds.
    pub chosen: Option<usize>,
    /// What was faster than the chosen, but only within noise, and less simple.
    pub passed_over: Option<usize>,
    /// Times of the chosen and of what was passed over are the same, as far as was measured, if they differ by less than this
    /// share.
    pub noise: f64,
    /// The rows that were varied, each with its values.
    pub varied: Vec<(&'static str, Vec<String>)>,
    /// How many views there are.
    pub frames: usize,
    /// Width and height of the pictures.
    pub size: (u32, u32),
    /// The time was up before all candidates were tried.
    pub cut_short: bool,
}

/// Searches for the cheapest settings within the bounds of `task`; see [`search`].
///
/// # Errors
/// [`Stopped`].
pub fn tune(task: &Task, studio: &mut dyn Studio) -> Result<Tuning, Stopped> {
    search::run(task, studio)
}
