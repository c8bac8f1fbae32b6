//! A place to stand in an interior: on the floor, looking into the longest free direction.

use super::probe::{Met, Probe, VIEWS, around, horizontal};
use super::stand::{EYE_HEIGHT, Stand};
use crate::geometry::Aabb;
use crate::scene::start::Unit;
use glam::Vec3;

/// Places tried along each horizontal axis.
const PLACES: usize = 7;
/// Shares of the height from which floors are looked for.
const STOREYS: [f32; 3] = [0.9, 0.6, 0.3];
/// Greatest share of a room's height at which the eye stands.
const EYE_SHARE: f32 = 0.7;
/// Least height of a room, in metres, where the whole scene is higher: else one would stand under tables. Lower scenes are
/// doll's houses.
const ROOM: f32 = 1.9;
/// Directions that tell whether a place is enclosed.
const LOOKS: usize = 96;
/// Least share of them that see the front of something, of a place inside.
const ENCLOSED: f32 = 0.8;
/// Least share of the places with a floor that must be inside, and least part of the scene's horizontal extent that the view
/// must be free for: nooks between things are no rooms. Measured on 12 scenes: rooms have shares from 0.23 and views from
/// 0.23, of things one or the other is at most 0.18 or 0.13.
const INSIDE: f32 = 0.2;
const OPEN: f64 = 0.16;
/// What lies farther outside of the bounds than this share of their extent is not looked at.
const BEYOND: f32 = 0.05;
/// Least share of them that see the front of something: a table has no walls.
const WALLED: f32 = 0.9;
/// How many of them to either side of a view are in the picture.
const SIDES: usize = 3;
/// Points of the floor around the eye, as every so many of the horizontal directions, and the share of the way to the
/// walls at which they lie.
const FLOOR_STEP: usize = 4;
const FLOOR_REACH: f32 = 0.25;
/// Least share of them that are level with the eye's own floor, and what of the eye's height they may be off.
const LEVEL: f32 = 0.75;
const LEVEL_TOLERANCE: f32 = 0.25;

/// A place to stand, and what can be seen from there.
struct Place {
    eye: Vec3,
    /// How high above the floor.
    height: f32,
    view: Vec3,
    /// How far it is free.
    free: f32,
    /// Logarithm of that, and its mean over all of the picture, added up.
    score: f64,
    /// The greatest mean of any view from here.
    openness: f64,
}

/// A place inside to stand, or `None` where nearly nothing is enclosed, or finding out takes more than the probe may.
///
/// Only what faces the eye counts: the inside of a solid thing shows nothing but backs.
pub fn stand(probe: &mut Probe, bounds: Aabb, unit: Unit) -> Option<Stand> {
    if bounds.is_empty() || bounds.size().min_element() <= 0.0 {
        return None;
    }
    let directions = Directions { looks: around(LOOKS), views: horizontal() };
    let mut best: Option<Place> = None;
    let (mut with_floor, mut inside, mut openness) = (0, 0, f64::NEG_INFINITY);
    for place in 0..PLACES * PLACES {
        let share = |i: usize| (i as f32 + 0.5) / PLACES as f32;
        let [x, z] = [share(place % PLACES), share(place / PLACES)];
        let mut last = None;
        let mut is_inside = false;
        for storey in STOREYS {
            if probe.is_spent() {
                return None;
            }
            let above = bounds.min + bounds.size() * Vec3::new(x, storey, z);
            let floor = eye_above_floor(probe, above, bounds, unit).filter(|(eye, _)| last.replace(*eye) != Some(*eye));
            let Some((eye, height)) = floor else { continue };
            let Some(place) = directions.place(probe, eye, height, bounds) else { continue };
            is_inside = true;
            openness = openness.max(place.openness);
            if best.as_ref().is_none_or(|best| place.score > best.score) {
                best = Some(place);
            }
        }
        with_floor += u32::from(last.is_some());
        inside += u32::from(is_inside);
    }
    if probe.is_spent() {
        return None;
    }
    let size = bounds.size().as_dvec3();
    let open = libm::log(OPEN * libm::hypot(size.x, size.z));
    let is_interior = inside as f32 >= INSIDE * with_floor as f32 && openness >= open;
    let Place { eye, height, view, free, .. } = best.filter(|_| is_interior)?;
    Stand::looking(eye, view, free, height)
}

/// Where it is looked from a place.
struct Directions {
    /// All around.
    looks: Vec<Vec3>,
    /// Horizontally, in order.
    views: Vec<Vec3>,
}

impl Directions {
    /// What there is to see at `eye`, so high above the floor; `None` where that is not inside of a room. Skies and strays
    /// beyond `bounds` are no walls.
    fn place(&self, probe: &mut Probe, eye: Vec3, height: f32, bounds: Aabb) -> Option<Place> {
        let around = bounds.padded(bounds.size().max_element() * BEYOND);
        let mut look = |looks: &[Vec3]| {
            let met = probe.look(eye, looks, 0.0).into_iter().zip(looks);
            let is_part = |met: &Met, look: &Vec3| look.y < 0.0 || around.holds(eye + *look * met.distance);
            met.map(|(met, look)| met.filter(|met| is_part(met, look))).collect::<Vec<_>>()
        };
        let walls = look(&self.views);
        if !mostly_fronts(&walls, &self.views, WALLED) || !mostly_fronts(&look(&self.looks), &self.looks, ENCLOSED) {
            return None;
        }
        // What leads out of the scene is no view.
        let free: Vec<f32> = walls.iter().map(|met| met.map_or(0.0, |met| met.distance)).collect();
        self.is_floor_level(probe, eye, height, &free).then(|| self.widest(eye, height, &free))?
    }

    fn is_floor_level(&self, probe: &mut Probe, eye: Vec3, height: f32, free: &[f32]) -> bool {
        let around = self.views.iter().zip(free).step_by(FLOOR_STEP);
        let points: Vec<Vec3> = around.map(|(view, free)| eye + *view * (free * FLOOR_REACH)).collect();
        let is_level = |point: &&Vec3| {
            let below = probe.look_along(**point, Vec3::NEG_Y, 0.0);
            below.is_some_and(|met| (met.distance - height).abs() <= LEVEL_TOLERANCE * height)
        };
        let level = points.iter().filter(is_level).count();
        level as f32 >= LEVEL * points.len() as f32
    }

    /// The view that is free the farthest, ahead and over all of the picture: a gap between two pillars is none.
    fn widest(&self, eye: Vec3, height: f32, free: &[f32]) -> Option<Place> {
        let far = |i: usize| libm::log(f64::from(free[i].max(f32::MIN_POSITIVE)));
        let mean = |middle: usize| {
            let picture = (0..=2 * SIDES).map(|side| far((middle + VIEWS + side - SIDES) % VIEWS));
            picture.sum::<f64>() / (2 * SIDES + 1) as f64
        };
        let openness = (0..VIEWS).map(mean).max_by(f64::total_cmp)?;
        let place = |i: usize| {
            let (view, free, score) = (self.views[i], free[i], far(i) + mean(i));
            Place { eye, height, view, free, score, openness }
        };
        (0..VIEWS).map(place).max_by(|a, b| a.score.total_cmp(&b.score))
    }
}

/// Whether at least so great a share of looks met the front of something.
fn mostly_fronts(met: &[Option<Met>], looks: &[Vec3], share: f32) -> bool {
    let fronts = met.iter().zip(looks).filter(|(met, look)| met.is_some_and(|met| met.normal.dot(**look) < 0.0));
    fronts.count() as f32 >= share * looks.len() as f32
}

/// The eye of somebody who stands on the floor below a point, and how high above it.
fn eye_above_floor(probe: &mut Probe, above: Vec3, bounds: Aabb, unit: Unit) -> Option<(Vec3, f32)> {
    let floor = probe.look_along(above, Vec3::NEG_Y, 0.0).filter(|met| met.normal.y > 0.5)?;
    let step = bounds.size().y * 1e-4;
    let ground = above - Vec3::Y * (floor.distance - step);
    let room = probe.look_along(ground, Vec3::Y, 0.0).map_or(bounds.max.y - ground.y, |met| met.distance);
    let metre = unit.per_metre();
    let least = if bounds.size().y >= ROOM * metre { ROOM * metre } else { step };
    let height = (EYE_HEIGHT * metre).min(EYE_SHARE * room);
    (room > least).then_some((ground + Vec3::Y * height, height))
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
                parts.push(Part::new(shape, id));
            }
        }
        (Geometry::build(parts), Aabb { min, max })
    }

    #[test]
    fn a_room_is_entered_at_eye_height_and_seen_along_its_length() {
        let (geometry, bounds) = room(Vec3::new(-1.0, 0.0, -6.0), Vec3::new(1.0, 3.0, 6.0), true);
        let Stand { camera, eye_height } = stand(&mut Probe::new(&geometry), bounds, Unit::Metre).unwrap();
        assert!((camera.eye.y - 1.6).abs() < 0.01, "{}", camera.eye);
        assert!((eye_height - 1.6).abs() < 0.01, "{eye_height}");
        let view = camera.look_at - camera.eye;
        assert!(view.z.abs() > 6.0 && view.x.abs() < 0.3 * view.z.abs() && view.y == 0.0, "{view}");
    }

    #[test]
    fn a_solid_box_is_not_entered() {
        let (geometry, bounds) = room(Vec3::splat(-1.0), Vec3::ONE, false);
        assert_eq!(stand(&mut Probe::new(&geometry), bounds, Unit::Metre), None);
        assert_eq!(stand(&mut Probe::new(&Geometry::default()), Aabb::EMPTY, Unit::Metre), None);
    }
}
