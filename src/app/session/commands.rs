//! What keys ask for once.

use super::events::WindowHost;
use super::{NO_ROOM, STEP, Session};
use crate::app::input::Command;
use crate::app::journey::Start;
use crate::app::overlay::Change;
use crate::app::scenes::Wish;
use crate::app::{desktop, methods};
use crate::scene::{self, Camera, FileCamera};
use std::time::Instant;

/// A step of the size of panel and text.
const UI_STEP: f32 = 1.1;

impl Session {
    /// Does what a key asks for; [`Command::Quit`] is up to the caller.
    pub(super) fn obey(&mut self, now: Instant, command: Command) {
        match command {
            Command::StoreBookmark(_) | Command::GoToBookmark(_) | Command::Screenshot if !self.scenes.has_scene() => {
                self.notices.warn(now, "Not before the scene is loaded");
            }
            Command::ReleasePointer if self.capture.is_active() => {
                self.journey.stop_replay();
                self.capture.release(&WindowHost(&self.window));
            }
            Command::ReleasePointer if self.journey.stop_replay() => {}
            Command::ReleasePointer if self.shown.help => self.shown.help = false,
            Command::ReleasePointer => self.wish(Wish::Cancel),
            Command::ToggleHelp => {
                // It is read with a free pointer.
                self.capture.release(&WindowHost(&self.window));
                self.shown = self.shown.with_help_toggled();
            }
            Command::Open => self.wish(Wish::Open),
            Command::Reload => self.wish(Wish::Reload),
            Command::ToggleWarnings if self.scene.warnings.is_empty() => {
                self.notices.tell(now, "The scene has no warnings");
            }
            Command::ToggleWarnings => self.wish(Wish::ToggleWarnings),
            Command::Inspect => self.inspect(),
            Command::TogglePanel => self.apply(Change::TogglePanel),
            Command::ToggleOverlay => self.shown.overlay = !self.shown.overlay,
            Command::Home => self.apply(Change::Home),
            Command::ToggleWalking => self.toggle_walking(now),
            Command::Screenshot => self.take_screenshot(now),
            Command::ToggleFullscreen => desktop::toggle_fullscreen(&self.window),
            Command::EnlargeUi => self.scale_ui(self.ui_scale * UI_STEP),
            Command::ReduceUi => self.scale_ui(self.ui_scale / UI_STEP),
            Command::ResetUi => self.scale_ui(1.0),
            Command::StoreBookmark(number) => {
                let camera = self.file_camera();
                self.keeper.config.bookmarks.of_mut(self.scenes.place()).store(number, camera);
                self.notices.tell(now, format!("Bookmark {number} set: key {number} comes back here"));
            }
            Command::GoToBookmark(number) => match self.keeper.config.bookmarks.of(self.scenes.place()).get(number) {
                Some(camera) => match camera.camera(self.scene.origin) {
                    Some(camera) => self.go_to(camera),
                    None => self.notices.warn(now, format!("Bookmark {number} is too far away to be seen from")),
                },
                None => self.notices.warn(now, format!("There is no bookmark {number}: Ctrl+{number} sets it")),
            },
            Command::CopyCamera => {
                self.layer.copy(self.file_camera().to_json());
                self.notices.tell(now, "Camera copied as JSON");
            }
            Command::PasteCamera => self.paste(now),
            Command::ToggleRecording => self.toggle_recording(now),
            Command::ToggleReplay => self.toggle_replay(now),
            Command::NextMap => self.change_methods(&methods::Change::Map(self.methods.map.next())),
            Command::ToggleSplit => self.change_methods(&methods::Change::Split(!self.methods.split.is_on)),
            Command::Quit => {}
        }
        self.keeper.touch(now);
        self.repaint(now);
    }

    /// The camera of this moment in the coordinates of the scene's file.
    fn file_camera(&self) -> FileCamera {
        self.scene.file_camera(&self.walker.camera())
    }

    pub(super) fn go_to(&mut self, camera: Camera) {
        self.journey.stop_replay();
        self.walker.go_to(camera);
    }

    /// Goes to the camera on the clipboard.
    pub(super) fn paste(&mut self, now: Instant) {
        let text = self.layer.pasted().filter(|text| !text.trim().is_empty());
        match text.as_deref().map(|text| scene::read_camera("clipboard", text, self.scene.origin)) {
            None => self.notices.warn(now, "The clipboard holds no text"),
            Some(Err(error)) => self.notices.warn(now, format!("The clipboard holds no camera: {error}")),
            Some(Ok(camera)) => {
                self.go_to(camera);
                self.notices.tell(now, "Camera pasted");
            }
        }
    }

    pub(super) fn toggle_recording(&mut self, now: Instant) {
        if !self.finish_recording(now) {
            self.journey.record(now, self.walker.camera());
            self.notices.tell(now, self.labels.of("Recording where you go: R stops"));
        }
    }

    /// Ends the recording and has it written, if there is one.
    pub(super) fn finish_recording(&mut self, now: Instant) -> bool {
        self.end_recording(now, format!(": {}", self.labels.of("P replays it")))
    }

    /// The same; `how_to` is what to say of a replay.
    pub(super) fn end_recording(&mut self, now: Instant, how_to: String) -> bool {
        let (camera, place) = (self.walker.camera(), (self.walker.surroundings(), self.scene.origin));
        let errand = self.journey.finish(now, camera, self.path_folders(), place, how_to);
        let was_recording = errand.is_some();
        errand.into_iter().for_each(|errand| self.errands.run(errand));
        was_recording
    }

    pub(super) fn toggle_replay(&mut self, now: Instant) {
        if self.journey.is_recording() {
            self.notices.warn(now, self.labels.of("Still recording: R stops"));
        } else if !self.journey.stop_replay() {
            match self.journey.replay(now) {
                Start::Begun => {}
                Start::TooSoon => self.notices.warn(now, "The recording is still being made into a path"),
                Start::Nothing => self.notices.warn(now, self.labels.of("Nothing is recorded yet: R starts")),
            }
        }
    }

    /// Follows a recording and a replay; says when to be called again.
    pub(super) fn travel(&mut self, now: Instant) -> Option<Instant> {
        let base = self.walker.camera();
        if let Some(camera) = self.journey.camera(now, &base, self.scene.origin) {
            self.walker.go_to(camera);
        }
        if self.journey.see(now, self.walker.camera()) {
            self.finish_recording(now);
            self.notices.warn(now, "Recording stopped: length limit reached");
            self.repaint(now);
        }
        self.journey.is_replaying().then_some(now + STEP)
    }

    /// Fly or walk. The speed that held keys had so far was that of the other.
    pub(super) fn toggle_walking(&mut self, now: Instant) {
        if !self.walker.toggle_walking(&self.scene.geometry) {
            self.notices.warn(now, NO_ROOM);
        } else if self.walker.is_walking() {
            self.notices.tell(now, self.labels.of("Walking: Space jumps, G flies"));
        } else {
            self.notices.tell(now, self.labels.of("Flying: G walks"));
        }
        self.step(now);
    }
}
