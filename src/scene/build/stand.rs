//! Somebody who stands on a floor, as the searches for a place to start find them.

use crate::scene::Camera;
use glam::Vec3;

/// Eye height of a person, in metres.
pub const EYE_HEIGHT: f32 = 1.6;

/// Somebody who stands on a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// What they see.
    pub camera: Camera,
    /// How high their eye is above the floor.
    pub eye_height: f32,
}

impl Stand {
    /// At `eye`, looking in the unit direction `view`, in which it is free so far; `None` where that is no view.
    pub fn looking(eye: Vec3, view: Vec3, free: f32, eye_height: f32) -> Option<Self> {
        // Far from the origin, a shorter step would be lost.
        let reach = free.max(eye.abs().max_element() * 1e-3);
        let camera = Camera { eye, look_at: eye + view * reach, ..Camera::default() };
        camera.is_valid().then_some(Self { camera, eye_height })
    }
}
