//! What the window remembers from one run to the next: a small JSON file in the user's configuration folder.
//!
//! [`Config`] is the file as plain data; to remember something more, add a field with a default, and fill it in where
//! the session gathers what it keeps. [`reading`] makes one of the file's text, [`changes`] knows what one window changed
//! of it, [`Store`] reads and writes the file, [`Keeper`] knows when.
//! Flags beat it, the contract's order of settings before it stays, and nothing but the window looks at it.

mod changes;
mod keeper;
pub mod reading;
mod store;

pub use keeper::Keeper;
pub use store::Store;

use crate::app::bookmarks::BookmarkShelf;
use crate::app::scenes::RecentFiles;
use crate::math::simd;
use crate::settings::{ROWS, Row, Settings};
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Most pixels of a window along a side and in all (two of 8K): systems and adapters give out beyond.
const MAX_SIDE: u32 = 16384;
const MAX_AREA: u64 = 1 << 26;
/// Sizes of panel and text, against the usual one.
pub const UI_SCALES: RangeInclusive<f32> = 0.5..=3.0;

/// The file, as plain data. What it lacks has its default; keys of a later version are kept as they are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Config {
    /// Settings that differ from those the window usually starts with: values as they are typed, by the names of rows.
    pub settings: BTreeMap<String, String>,
    /// Where and how large the window was.
    pub window: Option<WindowState>,
    /// How many times as large as usual panel and text are, within [`UI_SCALES`].
    pub ui_scale: f32,
    /// Degrees of turn per count of the mouse; `None` for the usual.
    pub sensitivity: Option<f64>,
    /// Mouse forward looks down.
    pub invert_look: bool,
    /// The panel is open.
    pub panel: bool,
    /// Name of screenshots, with `%04d` for their number; `None` for the usual.
    pub screenshots: Option<String>,
    /// Files that were opened, the newest first.
    pub recent: RecentFiles,
    /// Views to come back to, by scene.
    pub bookmarks: BookmarkShelf,
    /// What another version of the program remembers.
    #[serde(flatten)]
    pub others: serde_json::Map<String, serde_json::Value>,
}

/// A window on the desktop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct WindowState {
    /// Left and upper edge of its frame in physical pixels, where the desktop tells.
    pub position: Option<(i32, i32)>,
    /// Width and height of its inside in logical pixels, when it neither is maximised nor fills the screen.
    pub size: (u32, u32),
    /// It is maximised.
    pub maximized: bool,
    /// It fills the screen.
    pub fullscreen: bool,
}

impl WindowState {
    /// Whether a window can be of this size.
    pub fn can_be((width, height): (u32, u32)) -> bool {
        width.min(height) > 0 && width.max(height) <= MAX_SIDE && u64::from(width) * u64::from(height) <= MAX_AREA
    }

    /// The size of a window for a picture of this size: the same, or of about the same shape where no window can be that
    /// large.
    pub fn nearest_size((width, height): (u32, u32)) -> (u32, u32) {
        let (across, down) = (f64::from(width.max(1)), f64::from(height.max(1)));
        let side = f64::from(MAX_SIDE) / across.max(down);
        let scale = side.min((MAX_AREA as f64 / (across * down)).sqrt()).min(1.0);
        // Rounded down: the product is not above the area.
        let scaled = |side: f64| ((side * scale) as u32).max(1);
        (scaled(across), scaled(down))
    }
}

impl Default for Config {
    fn default() -> Self {
        Self {
            settings: BTreeMap::new(),
            window: None,
            ui_scale: 1.0,
            sensitivity: None,
            invert_look: false,
            panel: false,
            screenshots: None,
            recent: RecentFiles::default(),
            bookmarks: BookmarkShelf::default(),
            others: serde_json::Map::new(),
        }
    }
}

/// What the window starts with where nothing else is asked for.
pub fn usual_settings() -> Settings {
    Settings { refine_at_rest: true, ..Settings::balanced() }
}

/// Whether a row is left to the scene unless it is set: what suits one scene is not carried to the next.
fn is_of_the_scene(row: &Row) -> bool {
    (row.get)(&Settings::exact()) == "scene"
}

impl Config {
    /// The settings to start with. What no row takes, or the machine lacks, is passed over.
    pub fn start_settings(&self) -> Settings {
        let mut settings = usual_settings();
        for row in ROWS.iter().filter(|row| !is_of_the_scene(row)) {
            let mut changed = settings.clone();
            if let Some(value) = self.settings.get(row.name)
                && (row.set)(&mut changed, value).is_ok()
                && simd::is_available(changed.simd)
            {
                settings = changed;
            }
        }
        settings
    }

    /// Takes over the settings that are not as the window `opened` with them: those were changed by hand, and flags are
    /// for one run.
    pub fn keep_settings(&mut self, opened: &Settings, current: &Settings) {
        let usual = usual_settings();
        for row in ROWS.iter().filter(|row| !is_of_the_scene(row)) {
            let value = (row.get)(current);
            if value == (row.get)(opened) {
                continue;
            }
            if value == (row.get)(&usual) {
                self.settings.remove(row.name);
            } else {
                self.settings.insert(row.name.to_owned(), value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{Exposure, Fill};

    fn read(text: &str) -> Config {
        Config::read(text, &mut reading::Faults::default()).expect("an object")
    }

    #[test]
    fn a_config_survives_the_round_trip_through_its_file() {
        let mut config = Config { ui_scale: 1.5, sensitivity: Some(0.2), invert_look: true, ..Config::default() };
        config.window = Some(WindowState { position: Some((-5, 40)), size: (900, 500), ..WindowState::default() });
        config.settings.insert("fill".to_owned(), "hit".to_owned());
        let text = serde_json::to_string_pretty(&config).expect("plain data");
        assert_eq!(read(&text), config);
    }

    #[test]
    fn missing_keys_have_defaults_and_unknown_ones_are_kept() {
        assert_eq!(read("{}"), Config::default());
        let config = read(r#"{ "panel": true, "later": [1, 2] }"#);
        assert!(config.panel && config.others.contains_key("later"));
        let text = serde_json::to_string(&config).expect("plain data");
        assert!(text.contains(r#""later":[1,2]"#), "{text}");
    }

    #[test]
    fn a_window_for_a_huge_picture_is_one_that_can_be() {
        assert_eq!(WindowState::nearest_size((1280, 720)), (1280, 720));
        for size in [(u32::MAX, u32::MAX), (u32::MAX, 1), (1, u32::MAX), (40000, 20000), (16384, 16384), (0, 5)] {
            let nearest = WindowState::nearest_size(size);
            assert!(WindowState::can_be(nearest), "{nearest:?} for {size:?}");
        }
        assert_eq!(WindowState::nearest_size((40000, 20000)), (11585, 5792));
    }

    #[test]
    fn what_was_changed_by_hand_is_kept_and_flags_are_not() {
        let mut config = Config::default();
        config.settings.insert("stride".to_owned(), "4".to_owned());
        config.settings.insert("fill".to_owned(), "hit".to_owned());
        let opened = Settings { supersample: crate::settings::Supersample::Adaptive, ..config.start_settings() };
        assert_eq!((opened.stride, opened.fill), (4, Fill::Hit));
        config.keep_settings(&opened, &opened);
        assert_eq!(config.settings.len(), 2, "a flag is for one run");
        let fill = Fill::Color;
        let changed = Settings { fill, shadows: false, exposure: Exposure::Stops(2.0), ..opened.clone() };
        config.keep_settings(&opened, &changed);
        let kept: Vec<_> = config.settings.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
        // The usual value needs no entry, and exposure is the scene's.
        assert_eq!(kept, [("shadows", "off"), ("stride", "4")]);
        let expected = Settings { stride: 4, shadows: false, ..usual_settings() };
        assert_eq!(config.start_settings(), expected);
    }

    #[test]
    fn nonsense_is_passed_over() {
        let config = read(r#"{ "settings": { "stride": "7", "colour": "red", "bvh": "off" } }"#);
        assert_eq!(config.start_settings(), Settings { bvh: false, ..usual_settings() });
    }
}
