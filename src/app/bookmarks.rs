//! Numbered views to come back to.

use crate::scene::Camera;
use serde::{Deserialize, Serialize};

/// Views by number, 1 to 9. Plain data, so that it can be kept with a scene.
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
