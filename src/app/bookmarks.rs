//! Numbered views to come back to.

use super::config::reading::Faults;
use crate::scene::FileCamera;
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// The bookmarks of scenes by the one path of their files; those of the built-in scene have no name.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct BookmarkShelf(BTreeMap<String, Bookmarks>);

impl BookmarkShelf {
    /// Those of the scene at `place`; `None` is the built-in one.
    pub fn of(&self, place: Option<&Path>) -> Bookmarks {
        self.0.get(&name(place)).cloned().unwrap_or_default()
    }

    /// Those of the scene at `place`, to be added to.
    pub fn of_mut(&mut self, place: Option<&Path>) -> &mut Bookmarks {
        self.0.entry(name(place)).or_default()
    }

    /// Out of a configuration: whatever of it are bookmarks.
    pub fn read(value: Value, faults: &mut Faults) -> Self {
        let scenes = match value {
            Value::Object(scenes) => scenes,
            Value::Null => Map::new(),
            _ => {
                faults.note("bookmarks");
                Map::new()
            }
        };
        let read = |(name, value): (String, Value)| {
            let bookmarks = Bookmarks::read(&name, value, faults);
            (name, bookmarks)
        };
        Self(scenes.into_iter().map(read).collect())
    }

    /// Takes over the views that changed from `before` to `after`.
    pub fn take_changes(&mut self, before: &Self, after: &Self) {
        let none = Bookmarks::default();
        for (name, after) in &after.0 {
            let before = before.0.get(name).unwrap_or(&none);
            if before != after {
                self.0.entry(name.clone()).or_default().take_changes(before, after);
            }
        }
    }
}

fn name(place: Option<&Path>) -> String {
    place.map(Path::to_string_lossy).unwrap_or_default().into_owned()
}

/// Views by number, 1 to 9.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Bookmarks([Option<FileCamera>; 9]);

impl Bookmarks {
    /// Keeps a view under a number from 1 to 9; others are no numbers of bookmarks.
    pub fn store(&mut self, number: u8, camera: FileCamera) {
        if let Some(place) = self.0.get_mut(usize::from(number.wrapping_sub(1))) {
            *place = Some(camera);
        }
    }

    /// The view of a number, if one was kept.
    pub fn get(&self, number: u8) -> Option<FileCamera> {
        *self.0.get(usize::from(number.wrapping_sub(1)))?
    }

    /// The bookmarks of the scene of a name: a list of views, `null` where there is none.
    fn read(name: &str, value: Value, faults: &mut Faults) -> Self {
        let mut bookmarks = Self::default();
        let Value::Array(views) = value else {
            faults.note(format_args!("bookmarks of \"{name}\""));
            return bookmarks;
        };
        if views.len() > bookmarks.0.len() {
            faults.note(format_args!("more than {} bookmarks of \"{name}\"", bookmarks.0.len()));
        }
        let places = bookmarks.0.iter_mut().zip(views).enumerate();
        for (i, (place, view)) in places.filter(|(_, (_, view))| !view.is_null()) {
            match serde_json::from_value(view).ok().filter(FileCamera::is_valid) {
                Some(view) => *place = Some(view),
                None => faults.note(format_args!("bookmark {} of \"{name}\"", i + 1)),
            }
        }
        bookmarks
    }

    fn take_changes(&mut self, before: &Self, after: &Self) {
        for (place, (before, after)) in self.0.iter_mut().zip(before.0.iter().zip(&after.0)) {
            if before != after {
                *place = *after;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;
    use glam::{DVec3, Vec3};

    fn usual() -> FileCamera {
        FileCamera::of(&Camera::default(), DVec3::ZERO)
    }

    #[test]
    fn each_scene_has_its_own() {
        let mut shelf = BookmarkShelf::default();
        shelf.of_mut(Some(Path::new("/room.json"))).store(1, usual());
        assert_eq!(shelf.of(Some(Path::new("/room.json"))).get(1), Some(usual()));
        assert_eq!(shelf.of(Some(Path::new("/hall.json"))).get(1), None);
        assert_eq!(shelf.of(None).get(1), None);
        let text = serde_json::to_string(&shelf).expect("plain data");
        let value = serde_json::from_str(&text).expect("what was written");
        assert_eq!(BookmarkShelf::read(value, &mut Faults::default()), shelf);
    }

    #[test]
    fn a_view_is_kept_bit_for_bit_also_in_a_file() {
        let exact = Camera::from_yaw_pitch(Vec3::new(0.1, 1.6, -1e-7), 33.3, -7.1, 61.7);
        let camera = FileCamera::of(&exact, DVec3::ZERO);
        let mut bookmarks = Bookmarks::default();
        bookmarks.store(3, camera);
        bookmarks.store(0, camera);
        bookmarks.store(10, camera);
        let text = serde_json::to_string(&bookmarks).expect("plain data");
        let read = Bookmarks::read("", serde_json::from_str(&text).expect("what was written"), &mut Faults::default());
        assert_eq!(read, bookmarks);
        assert_eq!(read.get(3).and_then(|camera| camera.camera(DVec3::ZERO)), Some(exact));
        assert!([0, 1, 9, 10, 255].iter().all(|&number| read.get(number).is_none()));
    }
}
