//! Whether the eye has left the scene: a void to all sides does not say where to go.

use crate::geometry::Aabb;
use glam::{DVec3, Vec3};

/// Distance outside the bounds that is still inside, as a share of their diagonal.
const MARGIN: f64 = 0.05;
/// Times as far away as the scene's own cameras that is still inside: objects are looked at from around them.
const AROUND: f64 = 2.0;

/// What the last step of the eye came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// The eye left the scene.
    Left,
    /// The eye is back inside.
    Returned,
}

/// Watches the eye leave the scene's bounds and come back.
#[derive(Clone, Copy, Debug)]
pub struct Outside {
    bounds: Aabb,
    margin: f64,
    is_outside: bool,
}

impl Outside {
    /// Nothing is outside a scene without bounds. `eyes` are places that belong to the scene wherever they are, such as
    /// those of its cameras.
    pub fn new(bounds: Aabb, eyes: impl IntoIterator<Item = Vec3>) -> Self {
        let farthest = eyes.into_iter().map(|eye| distance(bounds, eye)).fold(0.0, f64::max);
        let margin = MARGIN * bounds.size().as_dvec3().length() + AROUND * farthest;
        Self { bounds, margin, is_outside: false }
    }

    /// Takes note of where the eye is; tells when that is news.
    pub fn see(&mut self, eye: Vec3) -> Option<Crossing> {
        let is_outside = !self.bounds.is_empty() && self.bounds.is_finite() && distance(self.bounds, eye) > self.margin;
        if is_outside == std::mem::replace(&mut self.is_outside, is_outside) {
            return None;
        }
        Some(if is_outside { Crossing::Left } else { Crossing::Returned })
    }
}

/// Distance of a point from a box, 0 within it.
fn distance(bounds: Aabb, point: Vec3) -> f64 {
    let (min, max, point) = (bounds.min.as_dvec3(), bounds.max.as_dvec3(), point.as_dvec3());
    if bounds.is_empty() { 0.0 } else { (min - point).max(point - max).max(DVec3::ZERO).length() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOM: Aabb = Aabb { min: Vec3::new(-3.0, 0.0, -2.0), max: Vec3::new(3.0, 2.5, 2.0) };

    #[test]
    fn leaving_is_told_once_until_the_eye_is_back() {
        let mut outside = Outside::new(ROOM, [Vec3::new(0.0, 1.6, 0.0)]);
        let along = |z: f32| Vec3::new(0.0, 1.6, z);
        for (z, crossing) in [
            (1.9, None),
            (2.2, None),
            (3.0, Some(Crossing::Left)),
            (50.0, None),
            (2.9, None),
            (1.0, Some(Crossing::Returned)),
            (0.0, None),
            (-9.0, Some(Crossing::Left)),
        ] {
            assert_eq!(outside.see(along(z)), crossing, "{z}");
        }
    }

    #[test]
    fn objects_may_be_walked_around_at_the_distance_of_their_camera() {
        let mut outside = Outside::new(ROOM, [Vec3::new(0.0, 1.0, 12.0)]);
        for angle in 0..64 {
            let (sin, cos) = (angle as f32 * 0.1).sin_cos();
            assert_eq!(outside.see(Vec3::new(20.0 * sin, 1.0, 20.0 * cos)), None, "{angle}");
        }
        assert_eq!(outside.see(Vec3::new(0.0, 1.0, 40.0)), Some(Crossing::Left));
    }

    #[test]
    fn nothing_is_outside_of_scenes_without_bounds() {
        for bounds in [Aabb::EMPTY, Aabb::INFINITE] {
            let mut outside = Outside::new(bounds, [Vec3::ZERO]);
            assert_eq!(outside.see(Vec3::splat(1e9)), None, "{bounds:?}");
        }
    }
}
