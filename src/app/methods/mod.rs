//! Seeing what the methods do: maps, the exact picture while a key is held, two settings side by side, errors and costs.
//!
//! State and rules alone: what a job is to show, what becomes of its films, what is known of the settings. No window.

mod kept;
mod split;

use kept::{Kept, Shown};
pub use split::{Side, Split};

use super::exam::{Exam, RowCost};
use super::maps::{Legend, Map};
use super::survey::of_frames;
use super::tracer::TracedFrame;
use crate::render::{Film, FrameStats};
use crate::scene::Camera;
use crate::settings::Settings;

/// What of a view a job shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Aspect {
    /// The exact picture in place of that of the settings, for as long as a key is held.
    pub is_exact: bool,
    /// As what it is painted.
    pub map: Map,
    /// Settings whose picture is shown beside.
    pub beside: Option<Settings>,
}

impl Aspect {
    /// Whether it is the settings' own picture alone.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }
}

/// What is to be seen of the methods, and what is known of them.
#[derive(Debug)]
pub struct Methods {
    /// As what frames are painted.
    pub map: Map,
    /// The key for the exact picture is down.
    pub wants_exact: bool,
    /// Two settings side by side.
    pub split: Split,
    /// What the colours on display mean.
    pub legend: Option<Legend>,
    /// What was measured last.
    pub exam: Option<Exam>,
    /// That was measured from elsewhere.
    pub is_elsewhere: bool,
    /// What was on display before the exact picture.
    kept: Kept,
}

/// What the user asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Paint frames so.
    Map(Map),
    /// Show two settings side by side, or no longer.
    Split(bool),
    /// Put the divider at this share of the width.
    Divider(f32),
    /// Edit the settings of this side.
    Edit(Side),
    /// Make the right side's settings those of the left.
    CopyLeft,
    /// Measure the errors of the settings.
    MeasureErrors,
    /// Measure what each setting costs.
    MeasureCosts,
    /// End what is measured.
    Stop,
}

impl Methods {
    /// The picture alone. `settings` are what the right side starts from.
    pub fn new(settings: &Settings) -> Self {
        Self {
            map: Map::Picture,
            wants_exact: false,
            split: Split::new(settings.without_approximations()),
            legend: None,
            exam: None,
            is_elsewhere: false,
            kept: Kept::default(),
        }
    }

    /// Takes over what needs no one else.
    pub fn apply(&mut self, change: &Change, settings: &Settings) {
        match change {
            Change::Map(map) => self.map = *map,
            Change::Split(is_on) => self.split.switch(*is_on),
            Change::Divider(share) => self.split.move_to(*share),
            Change::Edit(side) => self.split.edited = *side,
            Change::CopyLeft => self.split.right = settings.clone(),
            Change::Stop => self.end_exam(),
            Change::MeasureErrors | Change::MeasureCosts => {}
        }
    }

    /// What a job for `settings` shows, and by which settings it is traced.
    pub fn ask(&self, settings: &Settings) -> (Settings, Aspect) {
        if self.wants_exact {
            let aspect = Aspect { is_exact: true, ..Aspect::default() };
            return (Settings { refine_at_rest: settings.refine_at_rest, ..settings.reference() }, aspect);
        }
        let beside = self.split.is_on.then(|| Settings { refine_at_rest: false, ..self.split.right.clone() });
        let aspect = Aspect { is_exact: false, map: self.map, beside };
        // What is refined is one picture, and no map of it.
        let refine_at_rest = settings.refine_at_rest && aspect.is_plain();
        (Settings { refine_at_rest, ..settings.clone() }, aspect)
    }

    /// Whether a frame is what is asked for now: one of the exact picture may come late.
    pub fn shows(&self, frame: &TracedFrame) -> bool {
        frame.job.aspect.is_exact == self.wants_exact
    }

    /// The settings that the panel edits.
    pub fn edited<'a>(&'a self, settings: &'a Settings) -> &'a Settings {
        if self.edits_right() { &self.split.right } else { settings }
    }

    /// Whether these are the right side's.
    pub fn edits_right(&self) -> bool {
        self.split.is_on && self.split.edited == Side::Right
    }

    /// Makes a frame's film ready for display, by `present`, which returns the film that was there before. The films that are
    /// not needed any more go to `recycle`.
    pub fn display(
        &mut self,
        frame: TracedFrame,
        present: &mut dyn FnMut(Film) -> Option<Film>,
        recycle: &mut dyn FnMut(Film),
    ) {
        if frame.job.aspect.is_exact {
            let old = present(frame.film);
            self.kept.keep(old, recycle);
            return;
        }
        self.kept.clear(recycle);
        self.legend = frame.legend;
        match frame.beside {
            Some((right, milliseconds)) => {
                self.split.milliseconds = [frame.stats.frame_ms, milliseconds];
                self.split.take([frame.film, right], recycle);
                self.split.present(present, recycle);
            }
            None => {
                self.split.clear(recycle);
                present(frame.film).into_iter().for_each(recycle);
            }
        }
    }

    /// An exact picture comes after what was `shown` and cost `stats`.
    pub fn leave(&mut self, shown: Option<Shown>, stats: &FrameStats) {
        self.kept.leave(shown, stats);
    }

    /// What was on display before the exact picture: its film, if it shows what is seen from `camera`, what it was, and what
    /// it cost.
    pub fn go_back(&mut self, camera: &Camera) -> (Option<Film>, Option<Shown>, Option<FrameStats>) {
        self.kept.take(camera)
    }

    /// What a row was measured to cost, as it is in `settings`; nothing once those have changed.
    pub fn cost(&self, row: &str, settings: &Settings) -> Option<&RowCost> {
        let exam = self.exam.as_ref()?;
        let is_same = of_frames(settings, 0) == of_frames(&exam.settings, 0);
        exam.costs.iter().find(|cost| is_same && cost.row == row)
    }

    /// No more is to be heard of the exam under way.
    pub fn end_exam(&mut self) {
        if let Some(exam) = &mut self.exam {
            exam.has_ended = true;
        }
    }

    /// Whether an exam is under way.
    pub fn is_measuring(&self) -> bool {
        self.exam.as_ref().is_some_and(|exam| !exam.has_ended)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Visibility;

    fn window() -> Settings {
        Settings { refine_at_rest: true, ..Settings::balanced() }
    }

    #[test]
    fn a_plain_picture_is_traced_as_set() {
        let methods = Methods::new(&window());
        assert_eq!(methods.ask(&window()), (window(), Aspect::default()));
    }

    #[test]
    fn while_a_key_is_held_the_exact_picture_is_traced_and_refined_as_the_other_would_be() {
        let mut methods = Methods::new(&window());
        (methods.map, methods.wants_exact) = (Map::Cost, true);
        methods.split.is_on = true;
        let (settings, aspect) = methods.ask(&window());
        assert_eq!(settings, Settings { refine_at_rest: true, ..window().reference() });
        assert_eq!(settings.visibility, Visibility::Full);
        assert_eq!(aspect, Aspect { is_exact: true, ..Aspect::default() });
    }

    #[test]
    fn maps_and_two_sides_are_not_refined() {
        let mut methods = Methods::new(&window());
        methods.map = Map::Depth;
        assert!(!methods.ask(&window()).0.refine_at_rest);
        methods.map = Map::Picture;
        methods.apply(&Change::Split(true), &window());
        let (settings, aspect) = methods.ask(&window());
        let beside = aspect.beside.expect("two sides");
        assert!(!settings.refine_at_rest && !beside.refine_at_rest);
        assert_eq!(Settings { refine_at_rest: false, ..window().without_approximations() }, beside, "exact at first");
    }

    #[test]
    fn the_panel_edits_either_side() {
        let mut methods = Methods::new(&window());
        methods.apply(&Change::Edit(Side::Right), &window());
        assert_eq!(methods.edited(&window()), &window(), "there is one side only");
        methods.apply(&Change::Split(true), &window());
        assert!(!methods.edits_right(), "the left one at first");
        methods.apply(&Change::Edit(Side::Right), &window());
        assert!(methods.edits_right() && methods.edited(&window()) == &methods.split.right);
        methods.apply(&Change::CopyLeft, &window());
        assert_eq!(methods.split.right, window());
    }
}
