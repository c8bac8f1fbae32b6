//! What the overlay asks for.

use super::Session;
use crate::app::exam::{Exam, Subject};
use crate::app::input::Hold;
use crate::app::lowering::presets_below;
use crate::app::methods;
use crate::app::overlay::Change;
use crate::app::steering::Steering;
use crate::app::surroundings;
use crate::app::survey::{self, End, Survey};
use crate::measure::tune::{Bound, Task};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A search tries no new settings after this time.
const SEARCH_BUDGET: Duration = Duration::from_secs(30);

impl Session {
    pub(super) fn apply(&mut self, change: Change) {
        match change {
            Change::Settings(settings) if self.methods.edits_right() => self.methods.split.right = settings,
            Change::Settings(settings) => {
                let shown_otherwise = settings.present != self.settings.present;
                self.steering = Steering::new(presets_below(&settings));
                self.settings = settings;
                if shown_otherwise {
                    self.replace_presenter(Instant::now());
                }
            }
            Change::Camera(index) => {
                if let Some(camera) = self.scene.cameras.get(index).map(|named| named.camera) {
                    self.go_to(camera);
                }
            }
            Change::Home => {
                self.journey.stop_replay();
                self.walker.go_home();
            }
            Change::Speed(speed) => self.walker.set_speed(speed),
            Change::Walking(_) => self.toggle_walking(Instant::now()),
            Change::EyeHeight(height) => {
                if !self.walker.set_eye_height(&self.scene.geometry, height) {
                    self.notices.warn(Instant::now(), "Not enough room for that eye height here");
                }
            }
            Change::Fov(fov) => self.walker.set_fov(fov),
            Change::Sensitivity(sensitivity) => self.walker.sensitivity = sensitivity,
            Change::InvertLook(invert) => self.walker.invert_look = invert,
            Change::Bound(bound) => self.bound = bound,
            Change::Search(bound) => self.search(bound),
            Change::StopSearch => {
                self.tracer.stop_search();
                if let Some(survey) = &mut self.survey {
                    survey.end.get_or_insert(End::Stopped);
                }
            }
            Change::UiScale(scale) => self.scale_ui(scale),
            Change::Methods(change) => self.change_methods(&change),
            Change::TogglePanel => self.shown = self.shown.with_panel_toggled(self.panel_fits()),
            Change::Scenes(wish) => self.wish(wish),
            Change::Light(light, dial) => {
                self.lighting.turn(light, dial);
                self.relight();
            }
            Change::ResetLights => {
                self.lighting.reset();
                self.relight();
            }
            Change::Environment(change) => {
                if !matches!(change, surroundings::Change::Turn { .. }) {
                    self.scenes.forget_sky();
                }
                self.surroundings.apply(change);
                self.relight();
            }
            Change::CloseInspection => self.inspection = None,
            Change::ToggleHelp => self.shown = self.shown.with_help_toggled(),
        }
    }

    /// Notes whether the key for the exact picture is down; once it is up, goes back to what was there before.
    pub(super) fn hold_exact(&mut self, now: Instant) {
        let wants = self.keys.is_held(Hold::Exact);
        if self.methods.wants_exact == wants {
            return;
        }
        self.methods.wants_exact = wants;
        self.repaint(now);
        if wants {
            return;
        }
        if let Some(late) = self.fresh.take_if(|frame| frame.job.aspect.is_exact) {
            late.into_films().for_each(|film| self.tracer.recycle(film));
        }
        let (film, what, stats) = self.methods.go_back(&self.walker.camera());
        if let Some(exact) = film.and_then(|film| self.presenter.set_frame(&self.gpu, film)) {
            self.tracer.recycle(exact);
        }
        self.traced = what.or(self.traced.take());
        self.stats = stats.unwrap_or_else(|| std::mem::take(&mut self.stats));
        self.picture.demand(now, self.rates.display);
    }

    pub(super) fn change_methods(&mut self, change: &methods::Change) {
        self.methods.apply(change, &self.settings);
        match change {
            methods::Change::MeasureErrors => self.examine(Subject::Errors),
            methods::Change::MeasureCosts => self.examine(Subject::Costs),
            methods::Change::Stop => self.tracer.stop_search(),
            _ => self.picture.demand(Instant::now(), self.rates.display),
        }
    }

    /// Starts an exam of the settings on what is seen from here.
    pub(super) fn examine(&mut self, subject: Subject) {
        let size = self.picture_size();
        if size.0 == 0 || size.1 == 0 {
            return;
        }
        let settings = self.methods.edited(&self.settings).clone();
        let exam = Exam::new(subject, self.walker.camera(), settings, size).with_answers_of(self.methods.exam.as_ref());
        self.methods.exam = Some(exam.clone());
        self.tracer.examine(Arc::clone(&self.lit), exam);
        if let Some(survey) = &mut self.survey {
            survey.end.get_or_insert(End::Stopped);
        }
    }

    /// Starts a search on what is seen from here.
    pub(super) fn search(&mut self, bound: Bound) {
        let size = self.picture_size();
        if size.0 == 0 || size.1 == 0 {
            return;
        }
        let camera = self.walker.camera();
        let settings = survey::of_frames(&self.settings, self.scene.render.max_depth);
        let task = Task {
            cameras: vec![camera],
            size,
            settings: settings.clone(),
            fixed: Vec::new(),
            bounds: vec![bound],
            also: vec![settings],
            budget: SEARCH_BUDGET,
        };
        let survey = Survey::new(camera, bound);
        self.survey = Some(survey.clone());
        self.tracer.search(Arc::clone(&self.lit), task, survey);
        self.methods.end_exam();
    }
}
