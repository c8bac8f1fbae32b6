//! When the configuration is written: some seconds after a change and at the end, and only when something changed.

use super::{Config, Store, WindowState};
use crate::app::errands::{Errand, News};
use crate::settings::Settings;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// From a change to the file: a slider that is dragged is one change.
const DELAY: Duration = Duration::from_secs(3);
/// A window is put in its place by the desktop within this time of its opening.
const SETTLING: Duration = Duration::from_millis(1500);

/// The configuration while the window is open.
#[derive(Debug)]
pub struct Keeper {
    /// What will be written. To be brought up to date before [`save`](Self::save).
    pub config: Config,
    store: Option<Store>,
    /// As it was read, and as it was last to be written.
    read: Config,
    asked: Config,
    /// As it was when the file last had all of it: what changed since is laid over whatever another window wrote. Only
    /// errands look at it, one after the other.
    filed: Arc<Mutex<Config>>,
    /// The settings and the window as they were opened.
    settings: Settings,
    window: Option<WindowState>,
    opened: Instant,
    due: Option<Instant>,
    /// A failure was told of.
    told: Arc<AtomicBool>,
}

impl Keeper {
    /// Keeps `config`, which was read from `store`, for a window opened with `settings`. Without a store nothing is kept.
    pub fn new(store: Option<Store>, config: Config, settings: &Settings) -> Self {
        Self {
            store,
            read: config.clone(),
            asked: config.clone(),
            filed: Arc::new(Mutex::new(config.clone())),
            config,
            settings: settings.clone(),
            window: None,
            opened: Instant::now(),
            due: None,
            told: Arc::default(),
        }
    }

    /// Something that is kept may have changed.
    pub fn touch(&mut self, now: Instant) {
        if self.store.is_some() {
            self.due.get_or_insert(now + DELAY);
        }
    }

    /// When to [`save`](Self::save), if ever.
    pub fn due(&self) -> Option<Instant> {
        self.due
    }

    /// Takes over what of the settings was changed since the window opened.
    pub fn keep_settings(&mut self, current: &Settings) {
        self.config.settings.clone_from(&self.read.settings);
        self.config.keep_settings(&self.settings, current);
    }

    /// The window is at `position` now: where the desktop put it, or a moment later where the user did.
    pub fn window_moved(&mut self, now: Instant, position: (i32, i32)) {
        match &mut self.window {
            Some(opened) if now.saturating_duration_since(self.opened) < SETTLING => opened.position = Some(position),
            _ => self.touch(now),
        }
    }

    /// Takes over where the window is, once that is not where it opened.
    pub fn keep_window(&mut self, current: WindowState) {
        let opened = self.window.get_or_insert(current);
        opened.position = opened.position.or(current.position);
        if *opened == current {
            return;
        }
        // A window that fills the screen goes back to the size it had.
        let before = self.config.window.unwrap_or(*opened);
        let is_whole = current.maximized || current.fullscreen;
        let (position, size) = if is_whole { (before.position, before.size) } else { (current.position, current.size) };
        self.config.window = Some(WindowState { position, size, ..current });
    }

    /// The window opens like this.
    pub fn open_window(&mut self, state: WindowState) {
        self.window = Some(state);
        self.opened = Instant::now();
    }

    /// What writes the file, if there is anything new to write.
    pub fn save(&mut self) -> Option<Errand> {
        self.due = None;
        let store = self.store.as_ref().filter(|_| self.config != self.asked)?.clone();
        self.asked = self.config.clone();
        let (after, filed, told) = (self.config.clone(), Arc::clone(&self.filed), Arc::clone(&self.told));
        Some(Box::new(move || {
            let mut before = filed.lock().unwrap_or_else(PoisonError::into_inner);
            let written = store.update(|current| match current {
                Some(current) => current.with_changes(&before, &after),
                None => after.clone(),
            });
            let Err(error) = written else {
                *before = after;
                return None;
            };
            let is_first = !told.swap(true, Ordering::Relaxed);
            is_first.then(|| News::Problem(format!("settings are not kept: {error}")))
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;
    use crate::temporary::Folder;

    fn keeper() -> Keeper {
        let store = Store::open(std::env::temp_dir().join("raywalk-never-written/config.json")).0;
        Keeper::new(Some(store), Config::default(), &Settings::balanced())
    }

    #[test]
    fn nothing_new_is_not_written() {
        let now = Instant::now();
        let mut keeper = keeper();
        assert_eq!(keeper.due(), None);
        assert!(keeper.save().is_none());
        keeper.touch(now);
        keeper.touch(now + Duration::from_secs(2));
        assert_eq!(keeper.due(), Some(now + DELAY));
        keeper.config.panel = true;
        assert!(keeper.save().is_some());
        assert_eq!(keeper.due(), None);
        assert!(keeper.save().is_none(), "it is written");
    }

    #[test]
    fn two_windows_keep_what_each_of_them_changed() {
        let folder = Folder::new();
        let path = folder.path().join("config.json");
        let open = || {
            let (store, config, _) = Store::open(path.clone());
            Keeper::new(Some(store), config, &Settings::balanced())
        };
        let save = |keeper: &mut Keeper| {
            assert!(keeper.save().is_some_and(|errand| errand().is_none()));
            Store::open(path.clone()).1
        };
        let (mut one, mut other) = (open(), open());
        one.config.bookmarks.of_mut(None).store(1, Camera::default().into());
        save(&mut one);
        other.config.bookmarks.of_mut(None).store(2, Camera::default().into());
        other.config.ui_scale = 2.0;
        save(&mut other);
        one.config.panel = true;
        let kept = save(&mut one);
        assert!([1, 2].iter().all(|&number| kept.bookmarks.of(None).get(number).is_some()), "{kept:?}");
        assert_eq!((kept.ui_scale, kept.panel), (2.0, true));
        assert_eq!(folder.names(), ["config.json"]);
    }

    #[test]
    fn what_could_not_be_written_is_written_with_the_next_change() {
        let folder = Folder::new();
        let path = folder.path().join("raywalk/config.json");
        let (store, config, _) = Store::open(path.clone());
        let mut keeper = Keeper::new(Some(store), config, &Settings::balanced());
        let in_the_way = folder.write("raywalk", b"");
        keeper.config.panel = true;
        assert!(keeper.save().is_some_and(|errand| errand().is_some()));
        std::fs::remove_file(in_the_way).expect("it is there");
        // Another window came first.
        Store::open(path.clone()).0.update(|_| Config { ui_scale: 2.0, ..Config::default() }).expect("writable");
        keeper.config.invert_look = true;
        assert!(keeper.save().is_some_and(|errand| errand().is_none()));
        let kept = Store::open(path).1;
        assert_eq!((kept.panel, kept.invert_look, kept.ui_scale), (true, true, 2.0));
    }

    #[test]
    fn without_a_store_nothing_is_due() {
        let mut keeper = Keeper::new(None, Config::default(), &Settings::balanced());
        keeper.touch(Instant::now());
        keeper.config.panel = true;
        assert!(keeper.due().is_none() && keeper.save().is_none());
    }

    #[test]
    fn a_setting_that_was_changed_back_is_as_it_was_read() {
        let mut keeper = keeper();
        let opened = Settings::balanced();
        keeper.keep_settings(&Settings { shadows: false, ..opened.clone() });
        assert_eq!(keeper.config.settings.len(), 1);
        keeper.keep_settings(&opened);
        assert!(keeper.config.settings.is_empty());
    }

    #[test]
    fn a_window_is_kept_once_the_user_moves_it_and_keeps_its_size_while_it_fills_the_screen() {
        let mut keeper = keeper();
        let at = |position, size| WindowState { position: Some(position), size, ..WindowState::default() };
        let first = WindowState { position: None, ..at((0, 0), (1280, 720)) };
        keeper.open_window(first);
        let (soon, later) = (keeper.opened, keeper.opened + 2 * SETTLING);
        keeper.window_moved(soon, (30, 40));
        assert_eq!(keeper.due(), None, "the desktop put it there");
        keeper.keep_window(at((30, 40), (1280, 720)));
        assert_eq!(keeper.config.window, None);
        keeper.window_moved(later, (31, 40));
        assert!(keeper.due().is_some(), "the user did");
        keeper.keep_window(at((31, 40), (900, 500)));
        assert_eq!(keeper.config.window, Some(at((31, 40), (900, 500))));
        keeper.keep_window(WindowState { fullscreen: true, ..at((0, 0), (1920, 1080)) });
        let whole = WindowState { fullscreen: true, ..at((31, 40), (900, 500)) };
        assert_eq!(keeper.config.window, Some(whole));
    }
}
