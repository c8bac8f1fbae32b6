//! How much time a sweep may take.

use std::time::Duration;

/// How thorough a sweep is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// What it is called in records.
    pub name: &'static str,
    /// Fewer methods, smaller pictures.
    pub quick: bool,
    /// Visits of each method, at most; a visit is an untimed frame and some timed ones.
    pub rounds: u32,
    /// Cameras of a path that settings are compared from.
    pub cameras: usize,
    /// Time for all of one view's jobs.
    pub scene: Duration,
}

impl Effort {
    /// Under three minutes a scene on two cores.
    pub const DEFAULT: Self =
        Self { name: "default", quick: false, rounds: 6, cameras: 6, scene: Duration::from_secs(110) };
    /// Under thirty seconds a scene.
    pub const QUICK: Self = Self { name: "quick", quick: true, rounds: 3, cameras: 3, scene: Duration::from_secs(18) };

    /// A part of a scene's time, in per cent.
    pub(super) fn share(&self, percent: u32) -> Duration {
        self.scene * percent / 100
    }

    /// Sides divided by two where it has to be quick.
    pub fn size(&self, (width, height): (u32, u32)) -> (u32, u32) {
        if self.quick { ((width / 2).max(1), (height / 2).max(1)) } else { (width, height) }
    }
}
