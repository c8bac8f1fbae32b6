//! Walking: gravity, floors, stairs and jumps, in steps of fixed length, so that it is the same at any frame rate.

use super::body::{Body, World};
use glam::DVec3;

/// Length of a step of time, in seconds.
const TICK: f64 = 1.0 / 240.0;
/// Eye height of a person in metres: other heights feel gravity in proportion.
pub const PERSON: f64 = 1.6;
/// Metres a second, each second.
const GRAVITY: f64 = 9.81;
/// Fastest fall, metres a second.
const FASTEST_FALL: f64 = 60.0;
/// How high a jump is, in metres.
const JUMP: f64 = 0.5;
/// Seconds within which a jump that was asked for in the air is still made.
const JUMP_PATIENCE: f64 = 0.1;
/// Seconds in which the height above a floor evens out but for 1/e: stairs are a ramp to the eye.
const EASE: f64 = 0.05;
/// Floors deeper than so many eye heights are none: nobody wants to fall for that long.
const DEEPEST: f64 = 200.0;
/// Whoever moves less than this share of the eye height in a step stands still.
const STILL: f64 = 1e-6;
/// Distances in radii at which a place is looked for where the body fits.
const ASIDE: [f64; 3] = [1.0, 2.0, 4.0];
/// How far the knees bend at once where the ceiling is low, in steps.
const BENDS: [f64; 4] = [0.0, 0.3, 0.6, 0.9];

/// Someone who walks.
#[derive(Clone, Debug)]
pub struct Gait {
    body: Body,
    feet: DVec3,
    /// Where the feet were a tick before.
    before: DVec3,
    /// Metres a second downward; below 0 while rising.
    fall: f64,
    /// There is something to stand on.
    stands: bool,
    /// Height of the last floor, along up: what one walks on where there is none.
    last_floor: f64,
    /// Seconds that are not yet a whole tick.
    rest: f64,
    /// Seconds for which a jump is still wanted.
    jump: f64,
    still: bool,
}

impl Gait {
    /// Stands or begins to fall at `eye`, or as near to it as there is room in sight of it. `None` where there is none.
    pub fn begin(body: Body, world: World, eye: DVec3) -> Option<Self> {
        let rings = ASIDE.into_iter().flat_map(|radii| world.ring(radii * body.radius()));
        let places = [DVec3::ZERO].into_iter().chain(rings);
        places.map(|aside| eye + aside).find_map(|place| {
            // In sight, before what is on the other side of a wall is asked for its floor.
            if !world.is_free(eye, place) {
                return None;
            }
            let height = world.distance(place, -world.up).unwrap_or(f64::INFINITY).min(body.eye_height);
            let bent = BENDS.into_iter().map(|bend| place - world.up * (height + bend * body.step()));
            let mut room = bent.filter_map(|feet| body.clear(world, feet, feet));
            let feet = room.find(|feet| world.is_free(eye, *feet + world.up * body.eye_height))?;
            Some(Self::at(body, world, feet))
        })
    }

    fn at(body: Body, world: World, feet: DVec3) -> Self {
        let last_floor = feet.dot(world.up);
        Self { body, feet, before: feet, fall: 0.0, stands: false, last_floor, rest: 0.0, jump: 0.0, still: false }
    }

    /// The same feet, the eye at another height; `None` where that does not fit.
    pub fn with_eye_height(&self, world: World, eye_height: f64) -> Option<Self> {
        let body = Body { eye_height };
        let feet = body.clear(world, self.feet, self.feet)?;
        let [old, new] = [self.body.eye_height, eye_height].map(|height| feet + world.up * height);
        world.is_free(old, new).then(|| Self::at(body, world, feet))
    }

    /// Where the eye is, between the last two ticks.
    pub fn eye(&self, up: DVec3) -> DVec3 {
        self.before.lerp(self.feet, self.rest / TICK) + up * self.body.eye_height
    }

    /// Whether anything changes without being asked for: one falls, climbs or jumps.
    pub fn is_under_way(&self) -> bool {
        !self.still
    }

    /// Has the next tick jump, if there is something to jump from by then.
    pub fn jump(&mut self) {
        self.jump = JUMP_PATIENCE;
        self.still = false;
    }

    /// Walks on for `seconds` with a horizontal velocity in metres a second.
    pub fn walk(&mut self, world: World, velocity: DVec3, seconds: f64) {
        if velocity == DVec3::ZERO && self.still {
            return;
        }
        self.rest += seconds;
        while self.rest >= TICK {
            self.rest -= TICK;
            self.before = self.feet;
            self.tick(world, velocity);
        }
    }

    fn tick(&mut self, world: World, velocity: DVec3) {
        if velocity != DVec3::ZERO {
            self.feet = self.body.moved(world, self.feet, velocity * TICK);
        }
        let size = self.body.eye_height / PERSON;
        if self.jump > 0.0 && self.stands {
            self.fall = -(2.0 * GRAVITY * JUMP).sqrt() * size;
            (self.jump, self.stands) = (0.0, false);
        }
        self.jump = (self.jump - TICK).max(0.0);
        let floor = self.floor(world);
        if self.fall >= 0.0 && floor >= -self.reach() {
            self.last_floor = self.feet.dot(world.up) + floor;
            self.climb(world, floor);
            (self.fall, self.stands) = (0.0, true);
        } else {
            self.fly(world, floor, size);
        }
        let moved = self.feet.distance(self.before);
        self.still = self.stands && moved < STILL * self.body.eye_height && self.jump == 0.0;
        if self.still {
            self.feet = self.before;
            self.rest = 0.0;
        }
    }

    /// Height of the floor above the feet. Where there is none, that of the last one, or the feet's own below it.
    fn floor(&self, world: World) -> f64 {
        let floor = self.body.floor(world, self.feet, -DEEPEST * self.body.eye_height);
        floor.unwrap_or_else(|| (self.last_floor - self.feet.dot(world.up)).min(0.0))
    }

    /// How deep a floor may lie to be stood on at once: a step down, or as far as one falls anyway.
    fn reach(&self) -> f64 {
        if self.stands { self.body.step() } else { self.fall * TICK }
    }

    /// Evens out the height above the floor.
    fn climb(&mut self, world: World, floor: f64) {
        let share = 1.0 - (-TICK / EASE).exp();
        self.feet = self.body.moved(world, self.feet, world.up * (floor * share));
    }

    /// Rises or falls for a tick.
    fn fly(&mut self, world: World, floor: f64, size: f64) {
        self.fall = (self.fall + GRAVITY * size * TICK).min(FASTEST_FALL * size);
        let drop = (self.fall * TICK).min((-floor).max(0.0));
        let from = self.feet;
        self.feet = self.body.moved(world, from, -world.up * drop);
        let dropped = (from - self.feet).dot(world.up);
        self.stands = false;
        if drop > 0.0 && dropped < 0.5 * drop {
            // Held by something narrower than a foot: that is stood on, too.
            self.feet += world.up * dropped;
            (self.fall, self.stands) = (0.0, true);
        } else if drop < 0.0 && dropped > 0.5 * drop {
            // Against a ceiling.
            self.fall = 0.0;
        }
    }
}
