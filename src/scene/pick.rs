//! What a single ray meets first: for questions about a scene, not for pictures of it.

use super::Scene;
use super::build::Probe;
use crate::geometry::{NO_PRIMITIVE, PrimitiveId};
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
    /// What the ray from `origin` along the unit vector `direction` meets first, farther away than `near`.
    pub fn pick(&self, origin: Vec3, direction: Vec3, near: f32) -> Option<Pick> {
        let (distance, primitive) = Probe::new(&self.geometry).closest(origin, direction, near);
        (primitive != NO_PRIMITIVE).then(|| Pick { distance, id: self.geometry.ids[primitive as usize] })
    }

    /// How many primitives an object has, as far as they have an extent.
    pub fn primitives_of(&self, object: u32) -> usize {
        // Identities are ascending.
        let before = |object: u32| self.geometry.ids.partition_point(|id| id.object < object);
        before(object + 1) - before(object)
    }
}
