//! What to trace, and what was traced.

use crate::app::lowering::Lowering;
use crate::app::maps::Legend;
use crate::app::methods::Aspect;
use crate::render::{Film, FrameStats};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A frame of other settings is given this long before it is dropped for the new ones: dragging a slider
/// still shows frames, and a mode that takes minutes can be left at once.
pub(super) const PATIENCE: Duration = Duration::from_millis(300);

/// What to trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// What is seen.
    pub scene: Arc<Scene>,
    /// From where.
    pub camera: Camera,
    /// How.
    pub settings: Settings,
    /// Picture width in pixels, at least 1.
    pub width: u32,
    /// Picture height in pixels, at least 1.
    pub height: u32,
    /// What of it was given up for speed.
    pub lowering: Lowering,
    /// What of the view is to be shown.
    pub aspect: Aspect,
}

impl Job {
    /// The same view by other settings, and nothing but its picture.
    pub fn with_settings(&self, settings: Settings) -> Self {
        Self { settings, aspect: Aspect::default(), ..self.clone() }
    }

    /// Whether a film has the size and the planes of its picture.
    pub(super) fn fits(&self, film: &Film) -> bool {
        (film.width(), film.height(), film.planes()) == (self.width, self.height, self.aspect.map.planes())
    }

    /// Whether a frame of `other` shows this one from elsewhere: worth finishing while the walker moves.
    pub fn differs_by_camera_only(&self, other: &Self) -> bool {
        let what = |job: &Self| (job.width, job.height, job.aspect.map, job.aspect.is_exact);
        self.scene == other.scene
            && self.settings == other.settings
            && what(self) == what(other)
            && self.aspect.beside == other.aspect.beside
    }

    /// How long a frame of `running` may go on while this one waits; `None` for to its end.
    pub(super) fn patience(&self, running: &Self) -> Option<Duration> {
        if self.differs_by_camera_only(running) {
            None
        } else if self.lowering.level > 0 && running.lowering.level == 0 {
            // Motion began, and asks for speed.
            Some(Duration::ZERO)
        } else {
            Some(PATIENCE)
        }
    }
}

/// A finished frame.
#[derive(Debug)]
pub struct TracedFrame {
    /// The picture.
    pub film: Film,
    /// What it cost.
    pub stats: FrameStats,
    /// CPU time of the process while it was traced, in milliseconds.
    pub cpu_ms: f64,
    /// Wall time of all that was traced for it, other pictures of the view included, in milliseconds.
    pub whole_ms: f64,
    /// When it was done.
    pub finished: Instant,
    /// What it shows.
    pub job: Job,
    /// Samples a pixel, where it was refined at rest.
    pub samples: Option<u32>,
    /// The same view by the settings beside, and how many milliseconds it took.
    pub beside: Option<(Film, f64)>,
    /// What its colours mean, where it is a map.
    pub legend: Option<Legend>,
}

impl TracedFrame {
    /// Its films.
    pub fn into_films(self) -> impl Iterator<Item = Film> {
        std::iter::once(self.film).chain(self.beside.map(|(film, _)| film))
    }
}

/// Renders a job into a film.
pub type Render<'a> = &'a mut dyn FnMut(&Job, &mut Film) -> FrameStats;
