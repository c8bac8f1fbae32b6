//! What outlasts the window: settings, pictures, and news of how writing them went.

use super::Session;
use crate::app::lighting::Dial;
use crate::app::overlay::Panel;
use crate::app::screenshot::{self, Place, Shot};
use crate::app::{desktop, errands, walker};
use directories::BaseDirs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

impl Session {
    /// Brings what is remembered up to date and has it written, if there is anything new.
    pub(super) fn save_config(&mut self) {
        if let Some(state) = desktop::state_of(&self.window) {
            self.keeper.keep_window(state);
        }
        self.keeper.keep_settings(&self.settings);
        let config = &mut self.keeper.config;
        config.ui_scale = self.ui_scale;
        config.invert_look = self.walker.invert_look;
        config.sensitivity = (self.walker.sensitivity != walker::SENSITIVITY).then_some(self.walker.sensitivity);
        config.panel = self.shown.panel != Panel::Closed;
        config.recent.clone_from(self.scenes.recent());
        if let Some(errand) = self.keeper.save() {
            self.errands.run(errand);
        }
    }

    /// Keeps the picture on display as a file, or what it is about to become.
    pub(super) fn take_screenshot(&mut self, now: Instant) {
        // Of two sides only both films together are what is seen.
        self.show_frame();
        let Some((film, (job, samples))) = self.presenter.frame().zip(self.traced.as_ref()) else {
            self.notices.warn(now, "No picture yet");
            return;
        };
        if !Arc::ptr_eq(&job.scene, &self.lit) {
            // What there is to say of the scene and its light is not of this picture.
            self.camerawork.postpone();
            self.notices.tell(now, "Screenshot follows when the changed scene is shown");
            return;
        }
        let place = Place {
            file: self.scenes.file().map(Path::to_owned),
            cameras: self.scene.cameras.clone(),
            turned: self.lighting.dials().iter().filter_map(Dial::turned).collect(),
            limits: self.scenes.limits().clone(),
            environment: self.surroundings.choice(self.scenes.environment()),
            environment_turned: self.surroundings.turned(),
        };
        let is_kept = self.posted.as_ref() == Some(job);
        let shot = Shot::new(film, job, *samples, place);
        match self.camerawork.ask(shot, is_kept) {
            None => self.notices.tell(now, "Screenshot follows when refining ends"),
            Some(shot) => self.write(shot),
        }
    }

    /// Where the file of a recorded path goes: the folders that are tried, one after the other.
    pub(super) fn path_folders(&self) -> Vec<PathBuf> {
        let of_screenshots = self.screenshots.of(1).parent().map(Path::to_owned);
        let home = BaseDirs::new().map(|folders| folders.home_dir().to_owned());
        [Some(PathBuf::new()), of_screenshots, home].into_iter().flatten().collect()
    }

    pub(super) fn write(&self, shot: Shot) {
        self.errands.run(screenshot::errand(shot, self.screenshots.clone()));
    }

    /// Tells what came of errands.
    pub fn tell_news(&mut self, now: Instant) {
        for news in self.errands.news().collect::<Vec<_>>() {
            match news {
                errands::News::Done(text) => self.notices.tell(now, text),
                errands::News::Problem(text) => self.notices.warn(now, text),
            }
            self.repaint(now);
        }
    }
}
