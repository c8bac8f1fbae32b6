//! The floors of a scene, found by rays straight down, and the unit that their sizes tell.

use super::interior::{VIEWS, horizontal};
use super::probe::Probe;
use crate::geometry::Aabb;
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
const ROOFED: f32 = 0.25;
/// Widest streets and greatest heights, in metres, that are usual: what is larger both ways is in centimetres.
const WIDEST: f32 = 100.0;
/// Height above the floor at which walls are looked for, as a share of the extent, and places where they are.
const KNEE: f32 = 0.02;
const PLACES: usize = 64;
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
        if bounds.is_empty() || !bounds.is_finite() || size.x * size.z < FOOTPRINT || size.y < HEIGHT {
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
            let (mut start, mut room) = (0.0, f32::INFINITY);
            for _ in 0..LAYERS {
                let Some(met) = probe.look_along(above, Vec3::NEG_Y, start) else { break };
                if above.y - met.distance < bottom {
                    break;
                }
                if start > 0.0 {
                    room = met.distance - (start - step);
                }
                if met.normal.y >= LEVEL {
                    let is_even = met.normal.y >= EVEN;
                    floors.push(Floor { at: above - Vec3::Y * met.distance, room, is_even, column });
                }
                start = met.distance + step;
            }
        }
        (!probe.is_spent()).then_some(Self { columns, cell, floors })
    }

    /// The unit that rooms and streets seem to be measured in: metres unless the sizes say otherwise clearly.
    pub fn unit(&self, probe: &mut Probe, bounds: Aabb) -> Unit {
        let mut rooms: Vec<f32> = Vec::new();
        let mut columns = 0;
        // The highest room of each column: what lies under tables is none.
        for column in self.floors.chunk_by(|a, b| a.column == b.column) {
            columns += 1;
            rooms.extend(column.iter().map(|floor| floor.room).filter(|room| room.is_finite()).max_by(f32::total_cmp));
        }
        let roofed = rooms.len() as f32 / (columns as f32).max(1.0);
        if std::env::var_os("DBG").is_some() {
            eprintln!("roofed {roofed} room {:?} width {:?}", median(&mut rooms), self.street_width(probe, bounds));
        }
        if roofed >= ROOFED {
            return median(&mut rooms).map_or(Unit::Metre, of_room);
        }
        let is_wide = self.street_width(probe, bounds).is_some_and(|width| width > WIDEST);
        if is_wide && bounds.size().y > WIDEST { Unit::Centimetre } else { Unit::Metre }
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
        if widths.len() * 2 < looked.len() { None } else { median(&mut widths) }
    }
}

/// The unit in which a room of this height is one for people: from 2 m up to a hall of 30.
fn of_room(height: f32) -> Unit {
    match height {
        ..30.0 => Unit::Metre,
        30.0..120.0 => Unit::Eighth,
        120.0..1800.0 => Unit::Centimetre,
        _ => Unit::Millimetre,
    }
}

fn median(values: &mut [f32]) -> Option<f32> {
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}
