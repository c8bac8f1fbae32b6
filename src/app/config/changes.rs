//! Two windows, one file: each lays over it what changed in itself, and leaves the rest as the other wrote it.

use super::Config;
use std::collections::BTreeMap;

impl Config {
    /// This configuration with what changed from `before` to `after`.
    #[must_use]
    pub fn with_changes(mut self, before: &Self, after: &Self) -> Self {
        fn take<T: Clone + PartialEq>(current: &mut T, before: &T, after: &T) {
            if before != after {
                current.clone_from(after);
            }
        }
        // All by name, so that none is forgotten.
        let Self {
            settings,
            window,
            ui_scale,
            sensitivity,
            invert_look,
            panel,
            screenshots,
            recent,
            bookmarks,
            others: _,
        } = &mut self;
        take_entries(settings, &before.settings, &after.settings);
        take(window, &before.window, &after.window);
        take(ui_scale, &before.ui_scale, &after.ui_scale);
        take(sensitivity, &before.sensitivity, &after.sensitivity);
        take(invert_look, &before.invert_look, &after.invert_look);
        take(panel, &before.panel, &after.panel);
        take(screenshots, &before.screenshots, &after.screenshots);
        recent.take_changes(&before.recent, &after.recent);
        bookmarks.take_changes(&before.bookmarks, &after.bookmarks);
        self
    }
}

/// Lays over `current` the entries that came, went or changed.
fn take_entries(
    current: &mut BTreeMap<String, String>,
    before: &BTreeMap<String, String>,
    after: &BTreeMap<String, String>,
) {
    current.retain(|name, _| after.contains_key(name) || !before.contains_key(name));
    let changed = after.iter().filter(|(name, value)| before.get(*name) != Some(*value));
    current.extend(changed.map(|(name, value)| (name.clone(), value.clone())));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, FileCamera};
    use std::path::Path;

    fn with_settings(settings: &[(&str, &str)]) -> Config {
        let settings = settings.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
        Config { settings, ..Config::default() }
    }

    #[test]
    fn settings_come_change_and_go_one_by_one() {
        let before = with_settings(&[("bvh", "off"), ("fill", "hit"), ("stride", "4")]);
        let after = with_settings(&[("fill", "color"), ("shadows", "off"), ("stride", "4")]);
        let theirs = with_settings(&[("bvh", "off"), ("fill", "hit"), ("stride", "8"), ("tone-map", "none")]);
        let expected = with_settings(&[("fill", "color"), ("shadows", "off"), ("stride", "8"), ("tone-map", "none")]);
        assert_eq!(theirs.with_changes(&before, &after), expected);
    }

    #[test]
    fn bookmarks_and_recent_files_of_both_windows_stay() {
        let file = Some(Path::new("/room.json"));
        let mut before = Config::default();
        before.bookmarks.of_mut(file).store(1, Camera::default().into());
        before.recent.opened(Path::new("/room.json"));
        let (mut ours, mut theirs) = (before.clone(), before.clone());
        let mine = FileCamera::from(Camera { fov: 20.0, ..Camera::default() });
        ours.bookmarks.of_mut(file).store(2, mine);
        ours.recent.opened(Path::new("/ours.json"));
        ours.panel = true;
        theirs.bookmarks.of_mut(file).store(3, mine);
        theirs.bookmarks.of_mut(None).store(1, mine);
        theirs.recent.opened(Path::new("/theirs.json"));
        theirs.ui_scale = 2.0;
        theirs.others.insert("later".to_owned(), true.into());
        let both = theirs.with_changes(&before, &ours);
        let room = both.bookmarks.of(file);
        assert_eq!([1, 2, 3, 4].map(|n| room.get(n)), [Some(Camera::default().into()), Some(mine), Some(mine), None]);
        assert_eq!(both.bookmarks.of(None).get(1), Some(mine));
        assert_eq!(both.recent.files(), ["/ours.json", "/theirs.json", "/room.json"].map(Path::new));
        assert_eq!((both.panel, both.ui_scale), (true, 2.0));
        assert!(both.others.contains_key("later"));
    }
}
