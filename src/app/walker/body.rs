//! The walker's body: a round column that floats at the height of a step above its feet, and never touches anything.
//!
//! The column is a row of balls that overlap. Each ball's middle is kept a radius away from every surface, meshes
//! and round things alike, by the geometry's nearest points; and in one go it moves by less than that radius. So no middle,
//! the eye's first of all, ever gets to the other side of anything, however thin it is, at any speed and any frame rate.
//! Below the column are legs, which touch nothing: stairs are met by the floor under them, not by their risers. How high a
//! floor may be to be stepped on is for the [gait](super::gait) to say.

use crate::geometry::{Geometry, NO_PRIMITIVE};
use crate::scene::build::probe::Probe;
use glam::DVec3;
use std::f64::consts::TAU;

/// What of the eye height the body's radius is, and the highest step: of 1.6 m, 25 and 40 cm.
const RADIUS: f64 = 0.25 / 1.6;
const STEP: f64 = 0.4 / 1.6;
/// Balls of the column. Less than a radius from one to the next, so that nothing fits between them.
const BALLS: u32 = 5;
/// How deep a surface may be within a ball at last, and what is pushed away at first, as shares of its radius.
const TOLERANCE: f64 = 0.02;
const NOTHING: f64 = 1e-7;
/// One go: how far it may be meant to lead, and how far it may lead with what pushes back, in radii. Together with the
/// tolerance less than a radius.
const PIECE: f64 = 0.4;
const LEASH: f64 = 0.8;
/// Goes of one movement at most. Beyond, it is cut short.
const PIECES: u32 = 16;
/// Surfaces that push back, one after the other, in one go.
const PUSHES: u32 = 12;
/// Surfaces less steep than this are stood on or hung against: their normal's share along up.
const LEVEL: f64 = 0.7;
/// How far from the middle a floor is looked for, in radii.
const SOLE: f64 = 0.6;
/// The least share of a floor's normal along up: that of a slope of 50 degrees, with a little to spare for rounding.
const STEEPEST: f64 = 0.642_7;
/// The least level share of the way to a wall that tells in which direction it is.
const LEAST_LEVEL: f64 = 0.1;
/// Places on a ring around a middle.
const SIDES: u32 = 8;

/// The surroundings, and which way is up there.
#[derive(Clone, Copy)]
pub struct World<'a> {
    /// What is there.
    pub geometry: &'a Geometry,
    /// Unit vector.
    pub up: DVec3,
}

impl World<'_> {
    /// Whether a straight line is free of everything.
    pub fn is_free(&self, from: DVec3, to: DVec3) -> bool {
        let way = to - from;
        self.distance(from, way.normalize_or(self.up)).is_none_or(|distance| distance > way.length())
    }

    /// How far it is from `origin` to what lies in a direction.
    pub fn distance(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let met = Probe::new(self.geometry).look_along(origin.as_vec3(), direction.as_vec3(), 0.0);
        met.map(|met| f64::from(met.distance))
    }

    /// Ways from a middle to places all around it, level and this long.
    pub fn ring(&self, distance: f64) -> impl Iterator<Item = DVec3> + use<> {
        let (right, ahead) = self.up.any_orthonormal_pair();
        (0..SIDES).map(move |i| {
            let angle = TAU * f64::from(i) / f64::from(SIDES);
            (right * angle.cos() + ahead * angle.sin()) * distance
        })
    }
}

/// The body's measures, all in proportion to its eye height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Height of the eye above the feet, above 0.
    pub eye_height: f64,
}

/// A floor under a part of the body.
#[derive(Clone, Copy, Debug)]
pub struct Sole {
    /// From the middle of the feet to this part, level.
    pub aside: DVec3,
    /// The floor's height along up.
    pub height: f64,
    /// It rises or falls by more than 50 degrees.
    pub is_steep: bool,
}

/// What touches a ball.
struct Contact {
    depth: f64,
    /// Unit vector away from it.
    away: DVec3,
    /// Its height along up, where it touches.
    height: f64,
}

impl Body {
    /// The column's radius.
    pub fn radius(self) -> f64 {
        RADIUS * self.eye_height
    }

    /// The highest step.
    pub fn step(self) -> f64 {
        STEP * self.eye_height
    }

    /// How far from the middle a floor is looked for.
    pub fn sole(self) -> f64 {
        SOLE * self.radius()
    }

    /// Moves by `way`, pushed aside by what is in it; returns where that leads. What lies higher than `highest`, along up,
    /// never lifts the body: it is a wall.
    pub fn moved(self, world: World, feet: DVec3, way: DVec3, highest: f64) -> DVec3 {
        let piece = PIECE * self.radius();
        let count = (way.length() / piece).ceil().max(1.0);
        let part = way / count;
        let mut feet = feet;
        for _ in 0..(count as u32).min(PIECES) {
            let halves = [part, part * 0.5, part * 0.25];
            match halves.into_iter().find_map(|part| self.clear(world, feet + part, feet, highest)) {
                Some(reached) => feet = reached,
                None => break,
            }
        }
        feet
    }

    /// The place near `feet` where the body touches nothing; `None` where it does not fit, or only farther away from
    /// `from` than a safe go. What lies higher than `highest` is a wall.
    pub fn clear(self, world: World, feet: DVec3, from: DVec3, highest: f64) -> Option<DVec3> {
        let mut feet = feet;
        for _ in 0..PUSHES {
            let Some(contact) = self.deepest_contact(world, feet, NOTHING) else { return Some(feet) };
            let Contact { depth, away, height } = contact;
            let upward = away.dot(world.up);
            let level = away - world.up * upward;
            // Walls push sideways only, else one would climb whatever leans back.
            let is_wall = upward > 0.0 && height > highest && level.length_squared() > 0.0;
            feet += if upward.abs() >= LEVEL && !is_wall {
                world.up * (depth / upward)
            } else {
                level * (depth / level.length_squared())
            };
            if feet.distance(from) > LEASH * self.radius() {
                return None;
            }
        }
        // Between two walls that meet in a wedge, one push undoes some of the other.
        self.deepest_contact(world, feet, TOLERANCE).is_none().then_some(feet)
    }

    /// The deepest contact of more than a share of the radius.
    fn deepest_contact(self, world: World, feet: DVec3, tolerance: f64) -> Option<Contact> {
        let radius = self.radius();
        let lowest = self.step() + radius;
        let contact = |ball: u32| {
            let height = lowest + (self.eye_height - lowest) * f64::from(ball) / f64::from(BALLS - 1);
            let middle = feet + world.up * height;
            let nearest = world.geometry.nearest(middle, radius * (1.0 - tolerance))?;
            let from_surface = middle - nearest;
            let away = from_surface.normalize_or(world.up);
            Some(Contact { depth: radius - from_surface.length(), away, height: nearest.dot(world.up) })
        };
        (0..BALLS).filter_map(contact).max_by(|a, b| a.depth.total_cmp(&b.depth))
    }

    /// The floors under the body: at most a step and a radius above the feet.
    pub fn soles(self, world: World, feet: DVec3) -> impl Iterator<Item = Sole> {
        let knee = self.step() + self.radius();
        let mut probe = Probe::new(world.geometry);
        let asides = world.ring(self.sole()).chain([DVec3::ZERO]);
        asides.filter_map(move |aside| {
            let origin = (feet + world.up * knee + aside).as_vec3();
            let (distance, primitive) = probe.closest(origin, (-world.up).as_vec3(), 0.0);
            if primitive == NO_PRIMITIVE {
                return None;
            }
            let point = origin.as_dvec3() - world.up * f64::from(distance);
            let normal = world.geometry.normal_at(primitive, point.as_vec3());
            let is_steep = normal.is_some_and(|normal| normal.as_dvec3().dot(world.up).abs() < STEEPEST);
            Some(Sole { aside, height: point.dot(world.up), is_steep })
        })
    }

    /// The level direction away from what is nearest to the body at a height along up; `None` where that is nothing near, or
    /// lies above or below.
    pub fn away_from_wall(self, world: World, feet: DVec3, height: f64) -> Option<DVec3> {
        let middle = feet + world.up * (height - feet.dot(world.up));
        let away = (middle - world.geometry.nearest(middle, 2.0 * self.radius())?).try_normalize()?;
        let level = away - world.up * away.dot(world.up);
        (level.length() > LEAST_LEVEL).then(|| level.normalize())
    }
}
