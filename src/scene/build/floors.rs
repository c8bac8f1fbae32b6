//! The floors of a scene, found by rays straight down, and the unit that their sizes tell.

use super::probe::{Probe, VIEWS, horizontal};
use crate::geometry::{Aabb, NO_PRIMITIVE};
use crate::scene::start::Unit;
use glam::Vec3;

/// Columns along the longer horizontal axis.
const COLUMNS: f32 = 32.0;
/// Most surfaces that are looked at in a column.
const LAYERS: usize = 10;
/// Least height of an upward unit normal of what can be walked on.
const LEVEL: f32 = 0.7;
/// The same of what is level enough to have been made for walking.
const EVEN: f32 = 0.93;
/// Least footprint, in square metres, and least height of what is worth looking at.
const FOOTPRINT: f32 = 3.0;
const HEIGHT: f32 = 1.7;
/// How far below the subject's bounds its floors may lie, as a share of its height: the ground may be no part of it.
const BELOW: f32 = 0.1;

/// Least share of columns with a roof whose heights tell the unit.
const ROOFED: f32 = 0.1;
/// Usual heights of rooms lie below the first, in metres, and none above the second.
const HIGH: f32 = 12.0;
const HIGHEST: f32 = 30.0;
/// Usual widths of streets lie below the first, in metres; what is wider and higher than the second is in centimetres.
const WIDE: f32 = 60.0;
const WIDEST: f32 = 100.0;
/// Height above the floor at which walls are looked for, as a share of the extent, and places where they are.
const KNEE: f32 = 0.02;
const PLACES: usize = 64;
/// One in so many of them must be between walls: the others may be roofs.
const FEW: usize = 5;
/// Greatest height of the unit normal of a wall.
const UPRIGHT: f32 = 0.3;

/// A place on a floor.
#[derive(Clone, Copy, Debug)]
pub struct Floor {
    /// On the surface.
    pub at: Vec3,
    /// How much room is above it; infinite under the sky.
    pub room: f32,
    /// Whether it is level, or nearly so.
    pub is_even: bool,
    /// The column that it lies in.
    pub column: usize,
}

/// What the sizes of rooms and streets tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The unit that they seem to be in.
    pub unit: Unit,
    /// Whether there are rooms or streets of usual sizes in that unit.
    pub is_certain: bool,
    /// Least area of the floor of a level, in square metres. In units that are but guessed, shelves would be halls.
    pub least_area: f32,
}

impl Scale {
    /// Where nothing tells.
    pub const UNKNOWN: Self = Self { unit: Unit::Metre, is_certain: false, least_area: 10.0 };
}

/// The floors in a grid of columns.
#[derive(Debug)]
pub struct Floors {
    /// How many columns there are along x and z.
    pub columns: [usize; 2],
    /// Width of a column.
    pub cell: f32,
    /// By column, from the highest down.
    pub floors: Vec<Floor>,
}

impl Floors {
    /// The floors within and right below `bounds`; `None` where those are too small for anybody to walk in, or where looking
    /// takes more than the probe may.
    pub fn of(probe: &mut Probe, bounds: Aabb) -> Option<Self> {
        let size = bounds.size();
        if bounds.is_empty() || !size.is_finite() || size.x * size.z < FOOTPRINT || size.y < HEIGHT {
            return None;
        }
        let cell = size.x.max(size.z) / COLUMNS;
        let columns = [size.x, size.z].map(|length| ((length / cell).ceil() as usize).max(1));
        let step = size.y * 1e-4;
        let (top, bottom) = (bounds.max.y + step, bounds.min.y - size.y * BELOW);
        let mut floors = Vec::new();
        for column in 0..columns[0] * columns[1] {
            let share = |place: usize, count: usize| (place as f32 + 0.5) / count as f32;
            let [x, z] = [share(column % columns[0], columns[0]), share(column / columns[0], columns[1])];
            let above = Vec3::new(bounds.min.x + size.x * x, top, bounds.min.z + size.z * z);
            let (mut start, mut room, mut is_inside) = (0.0, f32::INFINITY, false);
            for _ in 0..LAYERS {
                let (distance, primitive) = probe.closest(above, Vec3::NEG_Y, start);
                let at = above - Vec3::Y * distance;
                if primitive == NO_PRIMITIVE || at.y < bottom {
                    break;
                }
                if start > 0.0 {
                    room = distance - (start - step);
                }
                let up = probe.normal_at(primitive, at).map_or(0.0, |normal| normal.y);
                // What lies right below the top of something is inside of it: a solid thing has no rooms.
                if up >= LEVEL && !is_inside {
                    floors.push(Floor { at, room, is_even: up >= EVEN, column });
                }
                is_inside = up > 0.0;
                start = distance + step;
            }
        }
        (!probe.is_spent()).then_some(Self { columns, cell, floors })
    }

    /// The unit that rooms and streets seem to be measured in: metres unless the sizes say otherwise clearly.
    pub fn scale(&self, probe: &mut Probe, bounds: Aabb) -> Scale {
        let mut rooms: Vec<f32> = Vec::new();
        let mut columns = 0_u32;
        // The highest room of each column: what lies under tables is none.
        for column in self.floors.chunk_by(|a, b| a.column == b.column) {
            columns += 1;
            rooms.extend(column.iter().map(|floor| floor.room).filter(|room| room.is_finite()).max_by(f32::total_cmp));
        }
        let is_roofed = rooms.len() as f32 > ROOFED * columns as f32;
        let room = median(&mut rooms).filter(|_| is_roofed);
        // Rooms are 4 to 15 m high in eighths, 1.2 to 18 m in centimetres, and 1.8 m or more in millimetres.
        match room {
            Some(HIGHEST..120.0) => return Scale { unit: Unit::Eighth, is_certain: true, least_area: 500.0 },
            Some(120.0..1800.0) => return Scale { unit: Unit::Centimetre, is_certain: true, least_area: 40.0 },
            Some(1800.0..) => return Scale { unit: Unit::Millimetre, is_certain: true, least_area: 40.0 },
            Some(..HIGH) => return Scale { is_certain: true, ..Scale::UNKNOWN },
            _ => {}
        }
        match self.street_width(probe, bounds) {
            Some(..WIDE) => Scale { is_certain: true, ..Scale::UNKNOWN },
            Some(WIDEST..) if room.is_none() && bounds.size().y > WIDEST => {
                Scale { unit: Unit::Centimetre, is_certain: true, least_area: 300.0 }
            }
            _ => Scale::UNKNOWN,
        }
    }

    /// The usual distance between walls; `None` where there are few.
    fn street_width(&self, probe: &mut Probe, bounds: Aabb) -> Option<f32> {
        let views = horizontal();
        let knee = Vec3::Y * bounds.size().max_element() * KNEE;
        let open: Vec<&Floor> = self.floors.iter().filter(|floor| floor.room > knee.y && floor.is_even).collect();
        let looked: Vec<&Floor> = open.iter().step_by(open.len().div_ceil(PLACES).max(1)).copied().collect();
        let mut widths = Vec::new();
        for floor in &looked {
            let met = probe.see(floor.at + knee, &views, 0.0);
            let wall = |i: usize| met[i].filter(|met| met.normal.y.abs() < UPRIGHT).map(|met| met.distance);
            let across = (0..VIEWS / 2).filter_map(|i| Some(wall(i)? + wall(i + VIEWS / 2)?));
            widths.extend(across.min_by(f32::total_cmp));
        }
        if widths.len() * FEW < looked.len() { None } else { median(&mut widths) }
    }
}

fn median(values: &mut [f32]) -> Option<f32> {
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}
