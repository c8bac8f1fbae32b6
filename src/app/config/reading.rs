//! A configuration out of its file's text: entry by entry, so that a bad one costs nothing but itself.

use super::{Config, UI_SCALES, WindowState};
use crate::app::bookmarks::BookmarkShelf;
use crate::app::scenes::RecentFiles;
use crate::settings::{ROWS, Settings};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Most entries that are named in one line, and so much of a name.
const MOST_NAMED: usize = 4;
const MOST_CHARACTERS: usize = 80;
/// Degrees a count of the mouse that can be lived with.
const SENSITIVITIES: std::ops::RangeInclusive<f64> = 1e-3..=10.0;

/// What could not be used.
#[derive(Debug, Default)]
pub struct Faults {
    /// The first of them.
    named: Vec<String>,
    more: usize,
}

impl Faults {
    /// Passes over an entry.
    pub fn note(&mut self, name: impl std::fmt::Display) {
        if self.named.len() == MOST_NAMED {
            self.more += 1;
            return;
        }
        let name: String = name.to_string().chars().take(MOST_CHARACTERS).collect();
        self.named.push(name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect());
    }

    /// All in one line: `panel, recent[0], window.size`. `None` where there are none.
    pub fn line(&self) -> Option<String> {
        let more = if self.more == 0 { String::new() } else { format!(" and {} more", self.more) };
        (!self.named.is_empty()).then(|| self.named.join(", ") + &more)
    }
}

impl Config {
    /// Reads a configuration; `faults` are the entries that are not as they should be: those have their defaults.
    ///
    /// # Errors
    /// Why `text` is no configuration at all.
    pub fn read(text: &str, faults: &mut Faults) -> Result<Self, serde_json::Error> {
        let mut map: Map<String, Value> = serde_json::from_str(text)?;
        let usual = Self::default();
        let mut entries = Entries { map: &mut map, within: "", faults };
        let settings = entries.take("settings").unwrap_or_default();
        let window = entries.take("window").unwrap_or_default();
        let ui_scale = entries.take("ui_scale").unwrap_or(usual.ui_scale);
        let sensitivity: Option<f64> = entries.take("sensitivity").unwrap_or_default();
        let invert_look = entries.take("invert_look").unwrap_or(usual.invert_look);
        let panel = entries.take("panel").unwrap_or(usual.panel);
        let screenshots = entries.take("screenshots").unwrap_or_default();
        let recent: Value = entries.take("recent").unwrap_or_default();
        let bookmarks: Value = entries.take("bookmarks").unwrap_or_default();
        Ok(Self {
            settings: read_settings(settings, faults),
            window: read_window(window, faults),
            ui_scale: f32::clamp(ui_scale, *UI_SCALES.start(), *UI_SCALES.end()),
            sensitivity: sensitivity.filter(|degrees| {
                let is_usable = SENSITIVITIES.contains(degrees);
                if !is_usable {
                    faults.note("sensitivity");
                }
                is_usable
            }),
            invert_look,
            panel,
            screenshots,
            recent: RecentFiles::read(recent, faults),
            bookmarks: BookmarkShelf::read(bookmarks, faults),
            others: map,
        })
    }
}

/// The entries of an object, taken out one by one.
struct Entries<'a> {
    map: &'a mut Map<String, Value>,
    /// What it is the object of.
    within: &'static str,
    faults: &'a mut Faults,
}

impl Entries<'_> {
    /// The entry of a name, if there is one of that type.
    fn take<T: DeserializeOwned>(&mut self, name: &str) -> Option<T> {
        let value = serde_json::from_value(self.map.remove(name)?);
        value.map_err(|_| self.faults.note(format_args!("{}{name}", self.within))).ok()
    }
}

/// Settings by their names, without values that those do not take. Names may be those of a later version.
fn read_settings(map: Map<String, Value>, faults: &mut Faults) -> BTreeMap<String, String> {
    let takes = |name: &str, text: &str| {
        let row = ROWS.iter().find(|row| row.name == name);
        row.is_none_or(|row| (row.set)(&mut Settings::default(), text).is_ok())
    };
    let setting = |(name, value): (String, Value)| match value {
        Value::String(text) if takes(&name, &text) => Some((name, text)),
        _ => {
            faults.note(format_args!("settings.{name}"));
            None
        }
    };
    map.into_iter().filter_map(setting).collect()
}

/// A window; `None` where there is none of a size that can be opened.
fn read_window(map: Option<Map<String, Value>>, faults: &mut Faults) -> Option<WindowState> {
    let mut map = map?;
    let mut entries = Entries { map: &mut map, within: "window.", faults };
    let position = entries.take("position").unwrap_or_default();
    let maximized = entries.take("maximized").unwrap_or_default();
    let fullscreen = entries.take("fullscreen").unwrap_or_default();
    let size: Option<(u32, u32)> = entries.take("size");
    if size.is_some_and(|size| !WindowState::can_be(size)) {
        faults.note("window.size");
    }
    let size = size.filter(|size| WindowState::can_be(*size))?;
    Some(WindowState { position, size, maximized, fullscreen })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, FileCamera};
    use std::path::Path;

    fn read(text: &str) -> (Config, Option<String>) {
        let mut faults = Faults::default();
        let config = Config::read(text, &mut faults).expect("an object");
        (config, faults.line())
    }

    #[test]
    fn one_bad_entry_costs_nothing_but_itself() {
        let usual = FileCamera::from(Camera::default());
        let camera = usual.to_json();
        let text = format!(
            r#"{{ "ui_scale": 2, "panel": 7, "settings": {{ "stride": "4", "fill": 3 }},
            "window": {{ "position": [1, "x"], "size": [900, 500], "maximized": true }},
            "recent": [1, "/a.json"], "later": [1],
            "bookmarks": {{ "/short.json": [{camera}, null], "/odd.json": [{{}}, {camera}, 3], "/none.json": 5,
                "/long.json": [null,null,null,null,null,null,null,null,null,{camera}] }} }}"#
        );
        let (config, faults) = read(&text);
        assert_eq!((config.ui_scale, config.panel), (2.0, false));
        assert_eq!(config.settings.iter().collect::<Vec<_>>(), [(&"stride".to_owned(), &"4".to_owned())]);
        let window = WindowState { position: None, size: (900, 500), maximized: true, fullscreen: false };
        assert_eq!(config.window, Some(window));
        assert_eq!(config.recent.files(), [Path::new("/a.json")]);
        assert!(config.others.contains_key("later"));
        assert_eq!(config.bookmarks.of(Some(Path::new("/short.json"))).get(1), Some(usual));
        let odd = config.bookmarks.of(Some(Path::new("/odd.json")));
        assert_eq!((odd.get(1), odd.get(2), odd.get(3)), (None, Some(usual), None));
        let faults = faults.expect("there are some");
        assert!(faults.contains("panel") && faults.ends_with("more") && !faults.contains('\n'), "{faults}");
    }

    #[test]
    fn settings_without_a_value_that_they_take_are_faults() {
        let (config, faults) = read(
            r#"{ "settings": { "shadows": "maybe", "stride": "7", "fill": "color", "of-a-later-version": "7" } }"#,
        );
        assert_eq!(config.settings.keys().collect::<Vec<_>>(), ["fill", "of-a-later-version"]);
        assert_eq!(faults.as_deref(), Some("settings.shadows, settings.stride"));
    }

    #[test]
    fn windows_that_cannot_be_are_not_opened() {
        for size in ["[100000, 100000]", "[40000, 20000]", "[16384, 16384]", "[-5, 100]", "[0, 4]", "[1]", "\"x\""] {
            let (config, faults) = read(&format!(r#"{{ "ui_scale": 2, "window": {{ "size": {size} }} }}"#));
            assert_eq!((config.window, config.ui_scale), (None, 2.0), "{size}");
            assert_eq!(faults.as_deref(), Some("window.size"), "{size}");
        }
        let (config, faults) = read(r#"{ "window": { "size": [7680, 4320] } }"#);
        assert_eq!((config.window.map(|window| window.size), faults), (Some((7680, 4320)), None));
    }

    #[test]
    fn what_was_written_is_read_without_a_fault() {
        assert_eq!(read("{}"), (Config::default(), None));
        let mut config = Config { ui_scale: 1.5, sensitivity: Some(0.2), ..Config::default() };
        config.recent.opened(Path::new("/scenes/my room.json"));
        let far = Camera { eye: glam::Vec3::new(0.1, 1.6, -1e-7), ..Camera::default() };
        config.bookmarks.of_mut(Some(Path::new("/a.json"))).store(3, far.into());
        for config in [config, Config::default()] {
            let text = serde_json::to_string_pretty(&config).expect("plain data");
            assert_eq!(read(&text), (config, None));
        }
        // Numbers out of range are brought within, quietly where that is what was meant.
        let (config, faults) = read(r#"{ "ui_scale": 1e300, "sensitivity": -3 }"#);
        assert_eq!((config.ui_scale, config.sensitivity, faults.as_deref()), (3.0, None, Some("sensitivity")));
    }

    #[test]
    fn what_is_no_configuration_says_so() {
        for text in ["", "[]", "{ \"ui_scale\": ", "\u{0}", &"[".repeat(100_000)] {
            assert!(Config::read(text, &mut Faults::default()).is_err());
        }
    }
}
