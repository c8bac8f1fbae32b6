//! Numbered views to come back to.

use crate::scene::Camera;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The bookmarks of scenes by the one path of their files; those of the built-in scene have no name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
}

fn name(place: Option<&Path>) -> String {
    place.map(Path::to_string_lossy).unwrap_or_default().into_owned()
}

/// Views by number, 1 to 9.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bookmarks([Option<Camera>; 9]);

impl Bookmarks {
    /// Keeps a view under a number from 1 to 9; others are no numbers of bookmarks.
    pub fn store(&mut self, number: u8, camera: Camera) {
        if let Some(place) = self.0.get_mut(usize::from(number.wrapping_sub(1))) {
            *place = Some(camera);
        }
    }

    /// The view of a number, if one was kept.
    pub fn get(&self, number: u8) -> Option<Camera> {
        *self.0.get(usize::from(number.wrapping_sub(1)))?
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn each_scene_has_its_own() {
        let mut shelf = BookmarkShelf::default();
        shelf.of_mut(Some(Path::new("/room.json"))).store(1, Camera::default());
        assert_eq!(shelf.of(Some(Path::new("/room.json"))).get(1), Some(Camera::default()));
        assert_eq!(shelf.of(Some(Path::new("/hall.json"))).get(1), None);
        assert_eq!(shelf.of(None).get(1), None);
        let text = serde_json::to_string(&shelf).expect("plain data");
        assert_eq!(serde_json::from_str::<BookmarkShelf>(&text).expect("what was written"), shelf);
    }

    #[test]
    fn a_view_is_kept_bit_for_bit_also_in_a_file() {
        let camera = Camera::from_yaw_pitch(Vec3::new(0.1, 1.6, -1e-7), 33.3, -7.1, 61.7);
        let mut bookmarks = Bookmarks::default();
        bookmarks.store(3, camera);
        bookmarks.store(0, camera);
        bookmarks.store(10, camera);
        let text = serde_json::to_string(&bookmarks).expect("plain data");
        let read: Bookmarks = serde_json::from_str(&text).expect("what was written");
        assert_eq!(read, bookmarks);
        assert_eq!(read.get(3), Some(camera));
        assert!([0, 1, 9, 10, 255].iter().all(|&number| read.get(number).is_none()));
    }
}
