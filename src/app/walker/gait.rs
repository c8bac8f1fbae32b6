//! Walking: gravity, floors, stairs and jumps, in steps of fixed length, so that it is the same at any frame rate.
//!
//! A floor up to a step higher than the ground is stepped on. What is higher is a wall, and what is steeper than 50 degrees
//! is no ground: on a ramp, a cone or a ball of such a slope, one gets a step above the ground that it rises from.

use super::body::{Body, Sole, World};
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
/// Pieces of one movement at most, and attempts to find a way along walls in each.
const PIECES: f64 = 16.0;
const ATTEMPTS: u32 = 3;
/// How far from a wall one is led while sliding along it, in radii: else rounding would put one into it.
const CLEARANCE: f64 = 1e-3;
/// How much higher than a step a floor may be, as a share of the eye height: rounding.
const SLACK: f64 = 1e-3;
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
    /// Height along up that steps are counted from: of the last floor that was not steep, or of what was lower since.
    /// Infinite before the first.
    ground: f64,
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
            let mut room = bent.filter_map(|feet| body.clear(world, feet, feet, f64::INFINITY));
            let feet = room.find(|feet| world.is_free(eye, *feet + world.up * body.eye_height))?;
            Some(Self::at(body, world, feet))
        })
    }

    fn at(body: Body, world: World, feet: DVec3) -> Self {
        let last_floor = feet.dot(world.up);
        Self {
            body,
            feet,
            before: feet,
            fall: 0.0,
            stands: false,
            last_floor,
            ground: f64::INFINITY,
            rest: 0.0,
            jump: 0.0,
            still: false,
        }
    }

    /// The same feet, the eye at another height; `None` where that does not fit.
    pub fn with_eye_height(&self, world: World, eye_height: f64) -> Option<Self> {
        let body = Body { eye_height };
        let feet = body.clear(world, self.feet, self.feet, f64::INFINITY)?;
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
            self.stride(world, velocity * TICK);
        }
        let size = self.body.eye_height / PERSON;
        if self.jump > 0.0 && self.stands {
            self.fall = -(2.0 * GRAVITY * JUMP).sqrt() * size;
            (self.jump, self.stands) = (0.0, false);
        }
        self.jump = (self.jump - TICK).max(0.0);
        let (floor, ground) = self.floor(world);
        if self.fall >= 0.0 && floor >= -self.reach() {
            self.last_floor = self.feet.dot(world.up) + floor;
            self.climb(world, floor);
            (self.fall, self.stands, self.ground) = (0.0, true, ground);
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

    /// Moves by a level `way`, along walls where there are any.
    fn stride(&mut self, world: World, way: DVec3) {
        let count = (way.length() / self.body.sole()).ceil().clamp(1.0, PIECES);
        for _ in 0..count as u32 {
            if !self.advance(world, way / count) {
                break;
            }
        }
    }

    /// Moves by a piece of a way; false where it is barred.
    fn advance(&mut self, world: World, mut way: DVec3) -> bool {
        let from = self.feet;
        let mut before = None;
        for _ in 0..ATTEMPTS {
            let reached = self.body.moved(world, from, way, self.highest(world, false));
            let Some(wall) = self.wall(world, reached) else {
                self.feet = reached;
                return true;
            };
            // Whoever is in a wall, such as after a jump onto a slope, may leave it.
            let before = *before.get_or_insert_with(|| self.wall(world, from).map(|wall| wall.height));
            if before.is_some_and(|before| wall.height <= before) {
                self.feet = reached;
                return true;
            }
            let nearest = self.body.away_from_wall(world, reached, self.highest(world, wall.is_steep));
            let mut ways_out = nearest.into_iter().chain((-wall.aside).try_normalize());
            let Some(away) = ways_out.find(|away| way.dot(*away) < 0.0) else { return false };
            let clearance = CLEARANCE * self.body.radius();
            way -= away * way.dot(away);
            // Straight into a wall there is no way along it, and nothing to keep clear for.
            if way.length() < clearance {
                return false;
            }
            way += away * clearance;
        }
        false
    }

    /// The highest floor that is stepped on, as a height along up.
    fn highest(&self, world: World, is_steep: bool) -> f64 {
        // From the air one may also land on what is higher.
        let from = if self.stands || is_steep { self.ground } else { self.ground.max(self.feet.dot(world.up)) };
        from + self.body.step() + SLACK * self.body.eye_height
    }

    /// The highest of what is too high to step on from here, with the feet at `feet`.
    fn wall(&self, world: World, feet: DVec3) -> Option<Sole> {
        let is_wall = |sole: &Sole| sole.height > self.highest(world, sole.is_steep).max(feet.dot(world.up));
        self.body.soles(world, feet).filter(is_wall).max_by(|a, b| a.height.total_cmp(&b.height))
    }

    /// Height of the floor above the feet. Where there is none, that of the last one, or the feet's own below it. Second
    /// the [ground](Self::ground) on it.
    fn floor(&self, world: World) -> (f64, f64) {
        let feet = self.feet.dot(world.up);
        let deepest = feet - DEEPEST * self.body.eye_height;
        let [mut floor, mut ground] = [f64::NEG_INFINITY; 2];
        let mut is_in_wall = false;
        for sole in self.body.soles(world, self.feet) {
            if sole.height > self.highest(world, sole.is_steep) {
                is_in_wall = true;
                continue;
            }
            if sole.height < deepest {
                continue;
            }
            floor = floor.max(sole.height);
            if !sole.is_steep {
                ground = ground.max(sole.height);
            }
        }
        let height = if is_in_wall && !ground.is_finite() {
            // Legs in what is too steep to stand on: one slides down along it until it is low enough. The body stays outside.
            deepest
        } else if floor.is_finite() {
            floor
        } else {
            self.last_floor.min(feet)
        };
        (height - feet, if ground.is_finite() { ground } else { self.ground.min(height) })
    }

    /// How deep a floor may lie to be stood on at once: a step down, or as far as one falls anyway.
    fn reach(&self) -> f64 {
        if self.stands { self.body.step() } else { self.fall * TICK }
    }

    /// Evens out the height above the floor.
    fn climb(&mut self, world: World, floor: f64) {
        let share = 1.0 - (-TICK / EASE).exp();
        self.feet = self.body.moved(world, self.feet, world.up * (floor * share), f64::INFINITY);
    }

    /// Rises or falls for a tick.
    fn fly(&mut self, world: World, floor: f64, size: f64) {
        self.fall = (self.fall + GRAVITY * size * TICK).min(FASTEST_FALL * size);
        let drop = (self.fall * TICK).min((-floor).max(0.0));
        let from = self.feet;
        self.feet = self.body.moved(world, from, -world.up * drop, f64::INFINITY);
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
