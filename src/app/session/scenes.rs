//! Scenes that come and change while the window is open.

use super::{OUTSIDE, Session, title, whereabouts};
use crate::app::error::AppError;
use crate::app::journey::Journey;
use crate::app::lighting::Lighting;
use crate::app::lowering::presets_below;
use crate::app::scenes::{Arrival, News, SkyArrival, Wish};
use crate::app::steering::Steering;
use crate::app::surroundings::Surroundings;
use crate::app::tracer::Job;
use crate::app::{desktop, inspection};
use crate::scene::Scene;
use glam::DVec2;
use std::sync::Arc;
use std::time::Instant;
use winit::dpi::LogicalSize;

impl Session {
    /// Takes up what has become of scenes.
    ///
    /// # Errors
    /// The first scene of all could not be loaded.
    pub fn on_news(&mut self) -> Result<(), AppError> {
        while let Some(news) = self.scenes.news() {
            match news {
                News::Opened(arrival) => self.enter(arrival),
                News::Reloaded(arrival) => self.replace_scene(arrival.scene),
                News::Sky(outcome) => self.bring_sky(outcome),
                News::Nothing(failed) => return Err(AppError::NoScene(failed)),
            }
        }
        self.repaint(Instant::now());
        Ok(())
    }

    /// Goes to another scene.
    pub(super) fn enter(&mut self, Arrival { scene, camera, size, .. }: Arrival) {
        // Ways lead through the scene that they were gone in.
        let now = Instant::now();
        if self.end_recording(now, String::new()) {
            self.notices.tell(now, "The recording has ended: this is another scene");
        }
        self.journey = Journey::default();
        self.walker.enter(&scene, camera);
        self.lighting = Lighting::of(&scene);
        self.surroundings = Surroundings::of(&scene);
        if let Some(size) = size.filter(|_| !self.is_placed) {
            let (width, height) = desktop::possible_size(size, self.window.scale_factor());
            // The window stays as it is where the system does not let it be resized.
            let _ = self.window.request_inner_size(LogicalSize::new(width, height));
        }
        self.show_scene(scene);
    }

    /// Shows what the scene has become, from where the walker stands.
    pub(super) fn replace_scene(&mut self, scene: Arc<Scene>) {
        let home = self.walker.home();
        let named = self.scene.cameras.iter().position(|named| named.camera == home);
        if scene.origin != self.scene.origin {
            // What moved is the place of the numbers, not the walker.
            if self.end_recording(Instant::now(), String::new()) {
                self.notices.tell(Instant::now(), "The recording has ended: the scene has moved");
            }
            self.walker.shift(self.scene.origin - scene.origin);
        }
        if let Some(moved) = named.and_then(|index| scene.cameras.get(index)) {
            self.walker.set_home(moved.camera);
        }
        self.lighting.keep_for(&scene);
        self.surroundings.keep_for(&scene);
        self.show_scene(scene);
    }

    pub(super) fn show_scene(&mut self, scene: Arc<Scene>) {
        self.steering = Steering::new(presets_below(&self.settings));
        self.window.set_title(&title(&scene));
        self.inspection = None;
        self.light(self.surroundings.around(self.lighting.lit(&scene)));
        self.walker.lose_footing();
        self.notices.take_back(OUTSIDE);
        self.outside = whereabouts(&scene, self.walker.home());
        self.scene = scene;
    }

    /// Shows a sky that was brought, or tells why there is none.
    fn bring_sky(&mut self, outcome: Result<SkyArrival, String>) {
        let now = Instant::now();
        match outcome {
            Err(problem) => self.notices.warn(now, format!("No sky: {problem}")),
            Ok(_) if !self.scenes.has_scene() => self.notices.warn(now, "No sky before the scene is loaded"),
            Ok(SkyArrival { file, image, warnings }) => {
                self.notices.tell(now, format!("Sky: {} {}x{}", image.name, image.width, image.height));
                warnings.into_iter().for_each(|warning| self.notices.warn(now, warning.to_string()));
                self.surroundings.bring(file, image);
                self.relight();
            }
        }
    }

    /// Shows the scene in the light and the surroundings that the user chose.
    pub(super) fn relight(&mut self) {
        self.light(self.surroundings.around(self.lighting.lit(&self.scene)));
    }

    /// Traces `lit` from now on. What was measured of the scene before, or of other lights, says nothing of it.
    pub(super) fn light(&mut self, lit: Arc<Scene>) {
        if *lit != *self.lit {
            self.tracer.stop_search();
            (self.survey, self.methods.exam) = (None, None);
        }
        self.lit = lit;
    }

    /// Inspects what the picture shows under the pointer, or in its middle while the pointer is captured.
    pub(super) fn inspect(&mut self) {
        let Some((Job { scene, camera, width, height, .. }, _)) = &self.traced else { return };
        let [left, top, across, down] = self.presenter.place().map(f64::from);
        let place = (self.pointer - DVec2::new(left, top)) / DVec2::new(across.max(1.0), down.max(1.0));
        let place = if self.capture.is_active() { DVec2::splat(0.5) } else { place };
        self.inspection = inspection::inspect(scene, camera, (*width, *height), place);
    }

    /// Does what the user asks of scenes.
    pub(super) fn wish(&mut self, wish: Wish) {
        self.scenes.grant(wish, &*self.window);
    }
}
