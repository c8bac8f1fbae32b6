//! What a single ray sees first: for questions about a scene, not for pictures of it.

use super::Scene;
use super::build::Probe;
use crate::geometry::PrimitiveId;
use glam::Vec3;

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// How far away, in metres.
    pub distance: f32,
    /// The object, and the primitive within it.
    pub id: PrimitiveId,
}

impl Scene {
    /// What the ray from `origin` along the unit vector `direction` sees first, farther away than `near`.
    pub fn pick(&self, origin: Vec3, direction: Vec3, near: f32) -> Option<Pick> {
        let (distance, primitive) = Probe::new(&self.geometry).seen(origin, direction, near);
        self.geometry.id(primitive).map(|id| Pick { distance, id })
    }

    /// How many primitives an object has, as far as they have an extent.
    pub fn primitives_of(&self, object: u32) -> usize {
        self.geometry.count_of(object)
    }
}
