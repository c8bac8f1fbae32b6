//! What the overlay knows of a search for cheap settings: how far it is, what was measured, what was found.

use crate::measure::front::front;
use crate::measure::tune::{Bound, Trial, Tuning, Verdict};
use crate::scene::Camera;
use crate::settings::{Present, Settings};

/// A search, under way or ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// From where it looks.
    pub camera: Camera,
    /// What pictures must keep; see [`Bound::none`] for a search that only measures.
    pub bound: Bound,
    /// How far it has come, 0 to 1.
    pub share: f64,
    /// What was measured so far.
    pub points: Vec<Point>,
    /// How it ended; `None` while it is under way.
    pub end: Option<End>,
}

/// Settings that were measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The settings; what only the window looks at is not theirs to say.
    pub settings: Settings,
    /// Least CPU time of a frame in milliseconds.
    pub cpu_ms: f64,
    /// What the bound's metric says.
    pub score: f64,
    /// The error that this stands for, 0 for equal pictures.
    pub error: f64,
}

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// The cheapest settings that keep the bound, and whether something less simple was faster, but only within noise.
    Found {
        /// The place in [`Survey::points`].
        place: usize,
        /// Simpler than what was fastest.
        simpler: bool,
    },
    /// Nothing keeps the bound.
    Nothing,
    /// It was stopped.
    Stopped,
}

impl Survey {
    /// A search that begins.
    pub fn new(camera: Camera, bound: Bound) -> Self {
        Self { camera, bound, share: 0.0, points: Vec::new(), end: None }
    }

    /// Takes what was measured so far.
    pub fn measured(&mut self, share: f64, trials: &[Trial]) {
        self.share = share;
        self.points = trials.iter().filter_map(|trial| self.point(trial)).collect();
    }

    /// Takes the end of the search.
    pub fn ended(&mut self, found: &Tuning) {
        self.measured(1.0, &found.trials);
        let chosen = found.chosen.map(|place| &found.trials[place].settings);
        let place = chosen.and_then(|chosen| self.points.iter().position(|point| point.settings == *chosen));
        let simpler = found.passed_over.is_some();
        self.end = Some(place.map_or(End::Nothing, |place| End::Found { place, simpler }));
    }

    /// A trial whose picture was judged.
    fn point(&self, trial: &Trial) -> Option<Point> {
        let score = *trial.scores.first()?;
        let is_judged = trial.verdict != Verdict::Slow && !score.is_nan();
        let error = self.bound.error(score);
        is_judged.then(|| Point { settings: trial.settings.clone(), cpu_ms: trial.cost(), score, error })
    }

    /// The place of what draws the same frames as `settings`.
    pub fn place_of(&self, settings: &Settings) -> Option<usize> {
        self.points.iter().position(|point| for_window(&point.settings, settings) == *settings)
    }

    /// The places of the points that no other is better than in both time and error, the fastest first.
    pub fn front(&self) -> Vec<usize> {
        front(&self.points.iter().map(|point| (point.cpu_ms, point.error)).collect::<Vec<_>>())
    }
}

/// What the frames of `chosen` depend on, without what only the window looks at.
pub fn of_frames(chosen: &Settings, scene_depth: u32) -> Settings {
    let depth = chosen.depth.filter(|depth| *depth != scene_depth);
    Settings { refine_at_rest: false, target_fps: None, present: Present::Auto, depth, ..chosen.clone() }
}

/// The settings that were measured, in a window that is set as in `current`.
pub fn for_window(measured: &Settings, current: &Settings) -> Settings {
    let Settings { refine_at_rest, target_fps, present, depth, .. } = *current;
    Settings { refine_at_rest, target_fps, present, depth, ..measured.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(settings: Settings, cpu_ms: f64, error: f64) -> Point {
        Point { settings, cpu_ms, score: error, error }
    }

    fn survey() -> Survey {
        let bound = Bound::parse("flip=0.01").expect("right");
        let mut survey = Survey::new(Camera::default(), bound);
        survey.points = vec![
            point(Settings::exact(), 80.0, 0.0),
            point(Settings::balanced(), 90.0, 0.001),
            point(Settings::fast(), 40.0, 0.04),
        ];
        survey
    }

    #[test]
    fn the_front_goes_from_fast_to_true() {
        assert_eq!(survey().front(), [2, 0]);
    }

    #[test]
    fn what_is_drawn_is_found_whatever_the_window_does_with_it() {
        let drawn = Settings { refine_at_rest: true, target_fps: Some(30), depth: Some(5), ..Settings::fast() };
        assert_eq!(survey().place_of(&drawn), Some(2));
        assert_eq!(survey().place_of(&Settings { stride: 2, ..drawn.clone() }), None);
        assert_eq!(of_frames(&drawn, 5), Settings::fast());
        assert_eq!(for_window(&Settings::fast(), &drawn), drawn);
    }
}
