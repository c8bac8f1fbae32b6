//! A place to stand in a level: on connected floor that things rise around, with the longest view.

use super::brightness;
use super::floors::{Floor, Floors, Scale};
use super::probe::{Met, Probe, VIEWS, horizontal};
use super::stand::{EYE_HEIGHT, Stand};
use crate::geometry::Aabb;
use crate::scene::start::Unit;
use glam::Vec3;

/// Least room above a floor for somebody to walk on it.
const HEAD_ROOM: f32 = 2.0;
/// What is passed at this height is passable, and steps up to this height are climbed, in metres; so are slopes of 45°.
const WAIST: f32 = 1.0;
const STEP: f32 = 0.5;
/// Least area of a floor in square metres, if it is so large a share of all floors: a shelf has many compartments. Of any
/// floor, least area.
const AREA: f32 = 10.0;
const MOST_OF_ALL: f32 = 0.4;
const SPACIOUS: f32 = 25.0;
/// Greatest extent, in metres, of a level without rooms or streets of usual sizes.
const UNCERTAIN: f32 = 60.0;
/// Least share of a floor that is even: backs of animals are not.
const EVEN: f32 = 0.5;
/// Least share of the largest floor's area: what is smaller is a corner of a large thing.
const LARGE: f32 = 0.25;
/// Greatest height of the unit normal of what counts as a wall.
const STEEP: f32 = 0.6;
/// Most connected floors that are looked at, and places on each.
const REGIONS: usize = 4;
const PLACES: usize = 72;
/// Least mean share of horizontal directions in which something rises above the eye: nothing rises around a table top, and
/// little around a thing on its ground.
const SURROUNDED: f32 = 0.3;
/// The same of pairs of opposite directions: one is between walls in a level, and beside a house that stands alone.
const BETWEEN: f32 = 0.12;
/// How many horizontal directions to either side of a view are in the picture.
const SIDES: usize = 4;
/// Least distances from the eye to what it looks at and to what is beside it, in metres.
const AHEAD: f32 = 1.5;
const BESIDE: f32 = 0.5;
/// Radius of the floor around the eye, at least, and how far it may rise or fall there, in metres.
const FREE_FLOOR: f32 = 0.4;
const UNEVEN: f32 = 0.4;
/// How much a picture full of surfaces, and one taken in the middle of everything, are worth: logarithms of a distance.
const FULL: f32 = 1.5;
const CENTRAL: f32 = 1.5;
/// Least share of the picture that shows a surface.
const SHOWN: f32 = 0.35;
/// Best places that are looked at closely.
const TRIES: usize = 24;

/// A place on a floor and the best view from there.
struct Place {
    eye: Vec3,
    view: Vec3,
    free: f32,
    score: f32,
}

/// A place to stand on connected floors within `bounds`, or `None` where they are no level, or finding out takes more than
/// the probe may. `regions` come from [`regions`].
pub fn stand(probe: &mut Probe, regions: &[Region], bounds: Aabb, scale: Scale) -> Option<Stand> {
    let metre = scale.unit.per_metre();
    // Tops of things in centimetres would be plateaus in metres.
    if !scale.is_certain && bounds.size().with_y(0.0).max_element() > UNCERTAIN * metre {
        return None;
    }
    let all: f32 = regions.iter().map(|region| region.area).sum();
    let largest = regions.first()?.area;
    let look = Looking { bounds, metre, views: horizontal() };
    let mut best: Option<(f32, Vec<Place>)> = None;
    for Region { floors, area } in regions.iter().take(REGIONS) {
        let even = floors.iter().filter(|floor| floor.is_even).count() as f32 / floors.len() as f32;
        let is_spacious = *area >= SPACIOUS || (*area >= AREA && *area >= MOST_OF_ALL * all);
        if !is_spacious || *area < scale.least_area || even < EVEN || *area < LARGE * largest {
            continue;
        }
        let (mut risen, mut between) = (0.0, 0.0);
        let mut places = Vec::new();
        let looked = floors.iter().step_by(floors.len().div_ceil(PLACES).max(1));
        let count = looked.len() as f32;
        for floor in looked {
            let (walls, pairs, place) = look.around(probe, floor.at + Vec3::Y * EYE_HEIGHT * metre);
            risen += walls / count;
            between += pairs / count;
            places.extend(place);
        }
        let worth = risen * area;
        if risen >= SURROUNDED && between >= BETWEEN && best.as_ref().is_none_or(|(best, _)| worth > *best) {
            best = Some((worth, places));
        }
    }
    let (_, mut places) = best?;
    places.sort_by(|a, b| b.score.total_cmp(&a.score));
    let stand = places.into_iter().take(TRIES).find_map(|place| look.stand(probe, &place))?;
    (!probe.is_spent()).then_some(stand)
}

/// Floors between which one can walk.
#[derive(Debug)]
pub struct Region {
    /// The places, in order of their columns.
    pub floors: Vec<Floor>,
    /// In square metres.
    pub area: f32,
}

/// Floors that one can walk on, by connected region, the largest first.
pub fn regions(probe: &mut Probe, floors: &Floors, unit: Unit) -> Vec<Region> {
    let metre = unit.per_metre();
    let walkable: Vec<Floor> = floors.floors.iter().copied().filter(|floor| floor.room >= HEAD_ROOM * metre).collect();
    let mut first = vec![walkable.len(); floors.columns[0] * floors.columns[1] + 1];
    for (i, floor) in walkable.iter().enumerate().rev() {
        first[floor.column] = i;
    }
    for column in (0..first.len() - 1).rev() {
        first[column] = first[column].min(first[column + 1]);
    }
    let mut union = Union((0..walkable.len()).collect());
    for (i, floor) in walkable.iter().enumerate() {
        let mut neighbours = Vec::with_capacity(2);
        if (floor.column + 1) % floors.columns[0] != 0 {
            neighbours.push(floor.column + 1);
        }
        if floor.column + floors.columns[0] < first.len() - 1 {
            neighbours.push(floor.column + floors.columns[0]);
        }
        for column in neighbours {
            let beside = first[column]..first[column + 1];
            for (j, other) in beside.clone().zip(&walkable[beside]) {
                if is_passable(probe, floor.at, other.at, metre) {
                    union.join(i, j);
                }
            }
        }
    }
    let mut regions: Vec<Vec<Floor>> = vec![Vec::new(); walkable.len()];
    for (i, floor) in walkable.iter().enumerate() {
        regions[union.root(i)].push(*floor);
    }
    regions.retain(|region| !region.is_empty());
    regions.sort_by_key(|region| std::cmp::Reverse(region.len()));
    let cell = (floors.cell / metre).powi(2);
    let area = |floors: Vec<Floor>| Region { area: floors.len() as f32 * cell, floors };
    regions.into_iter().map(area).collect()
}

/// Whether one can walk from one place to one in the next column.
fn is_passable(probe: &mut Probe, a: Vec3, b: Vec3, metre: f32) -> bool {
    let way = b - a;
    let run = way.with_y(0.0).length();
    if way.y.abs() > run.max(STEP * metre) {
        return false;
    }
    let waist = Vec3::Y * WAIST * metre;
    let length = way.length();
    let is_free = |met: Option<Met>| met.is_none_or(|met| met.distance >= length);
    if length <= 0.0 || !is_free(probe.look_along(a + waist, way / length, 0.0)) {
        return false;
    }
    let fall = WAIST * metre + way.y.abs() / 2.0 + STEP * metre;
    probe.look_along(a + way / 2.0 + waist, Vec3::NEG_Y, 0.0).is_some_and(|met| met.distance <= fall)
}

/// Sets that are joined.
struct Union(Vec<usize>);

impl Union {
    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}

/// How places are looked at.
struct Looking {
    bounds: Aabb,
    metre: f32,
    views: Vec<Vec3>,
}

impl Looking {
    /// The share of horizontal directions in which walls are seen, that of pairs of opposite ones, and the best view from
    /// `eye`, if one is any good.
    fn around(&self, probe: &mut Probe, eye: Vec3) -> (f32, f32, Option<Place>) {
        let met = probe.see(eye, &self.views, 0.0);
        // What is beyond the bounds is sky: a dome, or something far off.
        let ends: Vec<f32> = self.views.iter().map(|view| self.end(eye, *view)).collect();
        let free: Vec<Option<f32>> =
            met.iter().zip(&ends).map(|(met, end)| met.map(|met| met.distance).filter(|free| free <= end)).collect();
        let is_wall = |met: &Option<Met>| met.is_some_and(|met| met.normal.y.abs() < STEEP);
        let walls: Vec<bool> = met.iter().zip(&free).map(|(met, free)| is_wall(met) && free.is_some()).collect();
        let share = walls.iter().filter(|is_wall| **is_wall).count() as f32 / VIEWS as f32;
        let pairs = (0..VIEWS / 2).filter(|i| walls[*i] && walls[i + VIEWS / 2]).count() as f32 / (VIEWS / 2) as f32;
        let nearest = free.iter().flatten().copied().fold(f32::INFINITY, f32::min);
        if nearest < BESIDE * self.metre {
            return (share, pairs, None);
        }
        let far = |i: usize| (free[i].unwrap_or(ends[i]) / self.metre).max(0.1);
        let picture = |middle: usize| (0..=2 * SIDES).map(move |side| (middle + VIEWS + side - SIDES) % VIEWS);
        let score = |middle: usize| {
            let count = (2 * SIDES + 1) as f32;
            let mean = picture(middle).map(|i| libm::logf(far(i))).sum::<f32>() / count;
            let full = picture(middle).filter(|i| free[*i].is_some()).count() as f32 / count;
            // Nothing near stands in the middle of the picture.
            let ahead = picture(middle).skip(SIDES - 1).take(3).map(far).fold(f32::INFINITY, f32::min);
            mean + libm::logf(ahead) / 2.0 + FULL * full
        };
        let ahead = (0..VIEWS).filter(|&i| far(i) >= AHEAD && picture(i).any(|i| free[i].is_some()));
        let best = ahead.map(|i| (i, score(i))).max_by(|a, b| a.1.total_cmp(&b.1));
        let place = best.map(|(i, score)| {
            let off = (eye - self.bounds.center()).with_y(0.0).length();
            let half = self.bounds.size().with_y(0.0).length() / 2.0;
            let free = free[i].unwrap_or(ends[i]).max(self.metre);
            Place { eye, view: self.views[i], free, score: score - CENTRAL * off / half }
        });
        (share, pairs, place)
    }

    /// How far it is to the end of the bounds, a little widened.
    fn end(&self, eye: Vec3, view: Vec3) -> f32 {
        let around = self.bounds.padded(self.bounds.size().max_element() * 0.02);
        let to = Vec3::select(view.cmpgt(Vec3::ZERO), around.max - eye, around.min - eye) / view;
        to.x.abs().min(to.z.abs())
    }

    /// Somebody who stands at a place, if there is floor all around and something to see.
    fn stand(&self, probe: &mut Probe, place: &Place) -> Option<Stand> {
        let Place { eye, view, free, .. } = *place;
        let eye_height = EYE_HEIGHT * self.metre;
        for side in self.views.iter().step_by(VIEWS / 8) {
            let knee = eye - Vec3::Y * (eye_height - STEP * self.metre);
            let is_blocked =
                probe.look_along(knee, *side, 0.0).is_some_and(|met| met.distance < FREE_FLOOR * self.metre);
            let below = probe.look_along(eye + *side * FREE_FLOOR * self.metre, Vec3::NEG_Y, 0.0);
            let is_floor = below.is_some_and(|met| (met.distance - eye_height).abs() <= UNEVEN * self.metre);
            if is_blocked || !is_floor {
                return None;
            }
        }
        let stand = Stand::looking(eye, view, free, eye_height)?;
        let picture = probe.see(eye, &brightness::view(&stand.camera), 0.0);
        let shown = picture.iter().flatten().count() as f32;
        (shown >= SHOWN * picture.len() as f32).then_some(stand)
    }
}
