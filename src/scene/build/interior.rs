//! A place to stand in an interior: on the floor, looking into the longest free direction.

use super::probe::{Probe, around};
use crate::geometry::Aabb;
use crate::scene::Camera;
use glam::Vec3;
use std::f64::consts::TAU;

/// Places tried along each horizontal axis.
const PLACES: usize = 7;
/// Shares of the height from which floors are looked for.
const STOREYS: [f32; 3] = [0.9, 0.6, 0.3];
/// Eye height of a person, in metres.
const EYE_HEIGHT: f32 = 1.6;
/// Least and greatest share of a room's height at which the eye stands: the file may not be in metres.
const EYE_SHARE: [f32; 2] = [0.15, 0.55];
/// Directions that tell whether a place is enclosed.
const LOOKS: usize = 96;
/// Least share of directions that see the front of something, of a place inside.
const ENCLOSED: f32 = 0.8;
/// Directions tried for the view.
const VIEWS: usize = 32;

/// A camera inside, or `None` where nearly nothing is enclosed.
///
/// Only what faces the eye counts: the inside of a solid thing shows nothing but backs.
pub fn stand(probe: &mut Probe, bounds: Aabb) -> Option<Camera> {
    if bounds.is_empty() || bounds.size().min_element() <= 0.0 {
        return None;
    }
    let looks = around(LOOKS);
    let views = horizontal();
    let mut best: Option<(f32, Vec3, Vec3)> = None;
    for place in 0..PLACES * PLACES {
        let share = |i: usize| (i as f32 + 0.5) / PLACES as f32;
        let [x, z] = [share(place % PLACES), share(place / PLACES)];
        let mut last = None;
        for storey in STOREYS {
            let above = bounds.min + bounds.size() * Vec3::new(x, storey, z);
            let Some(eye) = eye_above_floor(probe, above, bounds).filter(|eye| last.replace(*eye) != Some(*eye)) else {
                continue;
            };
            let met = probe.look(eye, &looks, 0.0);
            let facing = met.iter().zip(&looks).filter(|(met, look)| met.is_some_and(|met| met.normal.dot(**look) < 0.0));
            if (facing.count() as f32) < ENCLOSED * LOOKS as f32 {
                continue;
            }
            let (free, view) = longest(probe, eye, &views);
            if best.is_none_or(|(longest, _, _)| free > longest) {
                best = Some((free, eye, view));
            }
        }
    }
    let (free, eye, view) = best?;
    let camera = Camera { eye, look_at: eye + view * free.max(eye.abs().max_element() * 1e-3), ..Camera::default() };
    camera.is_valid().then_some(camera)
}

/// The eye of somebody who stands on the floor below a point.
fn eye_above_floor(probe: &mut Probe, above: Vec3, bounds: Aabb) -> Option<Vec3> {
    let floor = probe.look_along(above, Vec3::NEG_Y, 0.0).filter(|met| met.normal.y > 0.5)?;
    let step = bounds.size().y * 1e-4;
    let ground = above - Vec3::Y * (floor.distance - step);
    let room = probe.look_along(ground, Vec3::Y, 0.0).map_or(bounds.max.y - ground.y, |met| met.distance);
    let [least, greatest] = EYE_SHARE.map(|share| share * room);
    (room > step).then(|| ground + Vec3::Y * EYE_HEIGHT.clamp(least, greatest))
}

fn horizontal() -> Vec<Vec3> {
    let direction = |i: usize| {
        let angle = TAU * i as f64 / VIEWS as f64;
        Vec3::new(libm::cos(angle) as f32, 0.0, libm::sin(angle) as f32).normalize()
    };
    (0..VIEWS).map(direction).collect()
}

/// The view that is free the farthest, and how far. A gap that only one direction looks through does not count, nor one
/// that leads out of the scene.
fn longest(probe: &mut Probe, eye: Vec3, views: &[Vec3]) -> (f32, Vec3) {
    let free: Vec<f32> = probe.look(eye, views, 0.0).iter().map(|met| met.map_or(0.0, |met| met.distance)).collect();
    let mut best = (0.0, views[0]);
    for (i, &view) in views.iter().enumerate() {
        let sides = [(i + VIEWS - 1) % VIEWS, (i + 1) % VIEWS].map(|side| free[side]);
        let own = free[i].min(sides[0].max(sides[1]));
        if own > best.0 {
            best = (own, view);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Part, PrimitiveId, Shape};

    /// A box of triangles that face inwards or outwards.
    fn room(min: Vec3, max: Vec3, inwards: bool) -> (Geometry, Aabb) {
        let corner = |i: usize| Vec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), max, min);
        // Faces that wind outwards.
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let mut parts = Vec::new();
        for [a, b, c, d] in faces.map(|face| face.map(corner)) {
            for [a, b, c] in [[a, b, c], [a, c, d]] {
                let vertices = if inwards { [a, c, b] } else { [a, b, c] };
                let id = PrimitiveId { object: 0, primitive: parts.len() as u32 };
                let shape = Shape::Triangle { vertices };
                parts.push(Part { shape, id, attributes: None, extras: None, holes: None });
            }
        }
        (Geometry::build(parts), Aabb { min, max })
    }

    #[test]
    fn a_room_is_entered_at_eye_height_and_seen_along_its_length() {
        let (geometry, bounds) = room(Vec3::new(-1.0, 0.0, -6.0), Vec3::new(1.0, 3.0, 6.0), true);
        let camera = stand(&mut Probe::new(&geometry), bounds).unwrap();
        assert!((camera.eye.y - 1.6).abs() < 0.01, "{}", camera.eye);
        let view = camera.look_at - camera.eye;
        assert!(view.z.abs() > 6.0 && view.x.abs() < 0.3 * view.z.abs() && view.y == 0.0, "{view}");
    }

    #[test]
    fn a_solid_box_is_not_entered() {
        let (geometry, bounds) = room(Vec3::splat(-1.0), Vec3::ONE, false);
        assert_eq!(stand(&mut Probe::new(&geometry), bounds), None);
        assert_eq!(stand(&mut Probe::new(&Geometry::default()), Aabb::EMPTY), None);
    }
}
