//! The walker: where they stand, where they look, how fast they go; flying through everything, or on their feet.

mod body;
mod gait;
mod pace;
#[cfg(test)]
mod slopes;
#[cfg(test)]
mod trials;

use super::input::Motion;
use super::look::SpikeFilter;
use crate::geometry::{Aabb, Geometry};
use crate::scene::{Camera, Scene};
use body::{Body, World};
use gait::{Gait, PERSON};
use glam::{DQuat, DVec2, DVec3, Vec3};
use pace::Pace;
pub use pace::in_words as speed_in_words;

/// Metres a second that a person walks.
const WALKING_SPEED: f64 = 2.5;
/// Sizes of surroundings in metres that people walk in: others are in other units.
const METRES: std::ops::RangeInclusive<f64> = 3.0..=1000.0;
/// Elsewhere, what of the surroundings the first camera's height above its floor may be to be an eye height, and what
/// is one if it is not.
const EYE_SHARES: std::ops::RangeInclusive<f64> = 0.005..=0.3;
const USUAL_EYE_SHARE: f64 = 0.06;
/// Eye heights that can be set, in metres.
pub const EYE_HEIGHT_RANGE: std::ops::RangeInclusive<f64> = 1e-6..=1e6;
/// Seconds to cross the surroundings.
const CROSSING_SECONDS: f64 = 6.0;
/// Size in metres of surroundings that have none, such as a lone plane.
const NO_SURROUNDINGS: f64 = 10.0;
/// Longest step in seconds: whoever comes back from a stall should not find themselves elsewhere.
const MAX_STEP_SECONDS: f64 = 0.25;
/// Speed factor of the fast key, and of the slow one inverted.
const FAST_FACTOR: f64 = 4.0;
/// Steepest view in degrees: straight up, left and right would flip.
const MAX_PITCH: f64 = 89.0;
/// A camera's `up` that leans no farther to a side than this, in radians, leans by rounding only.
const NO_ROLL: f64 = 1e-4;
/// The least share of +Y in an `up` that may stand for it: less is a scene whose up is another axis.
const LEAST_UPWARD: f64 = 1e-3;
/// Vertical fields of view that can be set, in degrees.
pub const FOV_RANGE: std::ops::RangeInclusive<f32> = 20.0..=120.0;
/// Degrees of turn per count of the mouse, as it starts.
pub const SENSITIVITY: f64 = 0.12;

/// Degrees and a place: what movement changes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    eye: DVec3,
    yaw: f64,
    pitch: f64,
}

/// How the walker gets on.
#[derive(Debug)]
enum Way {
    /// Wherever they want.
    Fly,
    /// On their feet; `None` where they were put somewhere and have not moved since.
    Walk(Option<Gait>),
}

/// A walker who starts at one of the scene's cameras.
#[derive(Debug)]
pub struct Walker {
    /// Degrees of turn per count of the mouse.
    pub sensitivity: f64,
    /// Mouse forward looks down.
    pub invert_look: bool,
    home: Camera,
    surroundings: f64,
    /// The camera last gone to. Until the walker moves from it, it stays what it is, bit for bit.
    stance: Camera,
    moved: bool,
    /// Turns +Y to the scene's up.
    upright: DQuat,
    pose: Pose,
    fov: f32,
    way: Way,
    /// What the user chose: to walk, or to fly. Until then it is up to each scene.
    chosen: Option<bool>,
    eye_height: f64,
    /// Of flying, and of walking.
    flight: Pace,
    stroll: Pace,
    /// The jump key was up since the last jump.
    may_jump: bool,
    spikes: SpikeFilter,
}

impl Walker {
    /// Stands at `home`. `surroundings` is the size of what is there in metres: it sets the speed.
    pub fn new(home: Camera, surroundings: f64) -> Self {
        let (upright, pose) = stand(&home);
        Self {
            sensitivity: SENSITIVITY,
            invert_look: false,
            home,
            surroundings,
            stance: home,
            moved: false,
            upright,
            pose,
            fov: home.fov,
            way: Way::Fly,
            chosen: None,
            eye_height: PERSON,
            flight: Pace::new(surroundings / CROSSING_SECONDS),
            stroll: Pace::new(WALKING_SPEED),
            may_jump: true,
            spikes: SpikeFilter::default(),
        }
    }

    /// Stands at `home` in `scene`, with a speed and an eye height that fit what is there. Where the scene's first camera
    /// stands on a floor, a walk that starts there is on foot.
    pub fn in_scene(scene: &Scene, home: Camera) -> Self {
        let surroundings = surroundings(scene.objects.iter().map(|object| object.bounds), home.eye);
        let mut walker = Self::new(home, surroundings);
        let world = World { geometry: &scene.geometry, up: walker.up() };
        walker.take_eye_height(usual_eye_height(surroundings, world.distance(walker.pose.eye, -world.up)));
        if scene.on_foot() && scene.cameras.first().is_some_and(|first| first.camera == home) {
            walker.way = Way::Walk(None);
        }
        walker
    }

    /// Comes to another scene and stands at `home` there. Habits stay: of looking, and of walking or flying once the user
    /// has chosen.
    pub fn enter(&mut self, scene: &Scene, home: Camera) {
        let (sensitivity, invert_look, chosen) = (self.sensitivity, self.invert_look, self.chosen);
        *self = Self { sensitivity, invert_look, chosen, ..Self::in_scene(scene, home) };
        match chosen {
            Some(true) => self.way = Way::Walk(None),
            Some(false) => self.way = Way::Fly,
            None => {}
        }
    }

    /// Where the walk started.
    pub fn home(&self) -> Camera {
        self.home
    }

    /// Has another place be where the walk started; the walker stays where they are.
    pub fn set_home(&mut self, home: Camera) {
        self.home = home;
    }

    /// Stays where they are in a scene whose numbers have moved `by` so much.
    pub fn shift(&mut self, by: DVec3) {
        let shifted = |camera: Camera| {
            let [eye, look_at] = [camera.eye, camera.look_at].map(|point| (point.as_dvec3() + by).as_vec3());
            Camera { eye, look_at, ..camera }
        };
        (self.home, self.stance) = (shifted(self.home), shifted(self.stance));
        self.pose.eye += by;
        self.lose_footing();
    }

    /// Goes to `camera` and takes its field of view. Speed stays. On foot, one falls from there at the next step only.
    pub fn go_to(&mut self, camera: Camera) {
        self.lose_footing();
        (self.upright, self.pose) = stand(&camera);
        self.fov = camera.fov;
        self.stance = camera;
        self.moved = false;
    }

    /// Back to where the walk started, and to the speed it started with.
    pub fn go_home(&mut self) {
        self.go_to(self.home);
        self.flight.reset();
        self.stroll.reset();
    }

    /// The camera of this moment.
    pub fn camera(&self) -> Camera {
        if !self.moved {
            return Camera { fov: self.fov, ..self.stance };
        }
        let Pose { eye, .. } = self.pose;
        // Far from the origin, a unit step would drown in the rounding of f32 and the view would shake.
        let distance = eye.abs().max_element().max(1.0);
        Camera {
            eye: eye.as_vec3(),
            look_at: (eye + self.direction() * distance).as_vec3(),
            up: self.up().as_vec3(),
            fov: self.fov,
            ..self.stance
        }
    }

    /// Turns by mouse counts; never multiplied by time, so that a hand movement is the same turn at any frame rate.
    pub fn look(&mut self, counts: DVec2) {
        let turn = self.spikes.pass(counts) * self.sensitivity;
        if turn == DVec2::ZERO {
            return;
        }
        let down = if self.invert_look { -turn.y } else { turn.y };
        self.pose.yaw = (self.pose.yaw - turn.x).rem_euclid(360.0);
        self.pose.pitch = (self.pose.pitch - down).clamp(-MAX_PITCH, MAX_PITCH);
        self.moved = true;
    }

    /// Moves on for `seconds`. Diagonals are as fast as straight lines. False where walking found no room and became flying.
    pub fn advance(&mut self, geometry: &Geometry, motion: Motion, seconds: f64) -> bool {
        let seconds = seconds.clamp(0.0, MAX_STEP_SECONDS);
        match self.way {
            Way::Fly => self.fly(motion, seconds),
            Way::Walk(None) if !motion.is_moving() => {}
            Way::Walk(None) => return self.land(geometry),
            Way::Walk(Some(_)) => self.walk(geometry, motion, seconds),
        }
        true
    }

    fn fly(&mut self, motion: Motion, seconds: f64) {
        if !motion.is_moving() {
            return;
        }
        let wish = self.rightward() * motion.right + self.up() * motion.up + self.direction() * motion.forward;
        let step = self.speed() * haste(motion) * seconds;
        self.move_to(self.pose.eye + wish.normalize_or_zero() * step);
    }

    fn walk(&mut self, geometry: &Geometry, motion: Motion, seconds: f64) {
        let (up, right) = (self.up(), self.rightward());
        let wish = right * motion.right + up.cross(right) * motion.forward;
        let velocity = wish.normalize_or_zero() * (self.speed() * haste(motion));
        let Way::Walk(Some(gait)) = &mut self.way else { return };
        if motion.up > 0.0 && std::mem::take(&mut self.may_jump) {
            gait.jump();
        }
        self.may_jump |= motion.up <= 0.0;
        gait.walk(World { geometry, up }, velocity, seconds);
        let eye = gait.eye(up);
        if eye != self.pose.eye {
            self.move_to(eye);
        }
    }

    /// Beyond what f32 can hold there is nothing to see: stay.
    fn move_to(&mut self, eye: DVec3) {
        if eye.as_vec3().is_finite() {
            self.pose.eye = eye;
            self.moved = true;
        }
    }

    /// Size of what is around the start, in metres.
    pub fn surroundings(&self) -> f64 {
        self.surroundings
    }

    /// Whether the walker is on their feet.
    pub fn is_walking(&self) -> bool {
        matches!(self.way, Way::Walk(_))
    }

    /// Whether the view changes although no key is held: one falls.
    pub fn is_under_way(&self) -> bool {
        matches!(&self.way, Way::Walk(Some(gait)) if gait.is_under_way())
    }

    /// Walks instead of flying, or the reverse. False where there is no room to walk.
    pub fn toggle_walking(&mut self, geometry: &Geometry) -> bool {
        if self.is_walking() {
            self.way = Way::Fly;
            self.chosen = Some(false);
            return true;
        }
        let found = self.land(geometry);
        if found {
            self.chosen = Some(true);
        }
        found
    }

    /// What surrounds the walker has changed: on foot, they look for the floor anew when they next move.
    pub fn lose_footing(&mut self) {
        if let Way::Walk(gait) = &mut self.way {
            *gait = None;
        }
    }

    fn land(&mut self, geometry: &Geometry) -> bool {
        let world = World { geometry, up: self.up() };
        let gait = Gait::begin(Body { eye_height: self.eye_height }, world, self.pose.eye);
        let found = gait.is_some();
        self.way = gait.map_or(Way::Fly, |gait| Way::Walk(Some(gait)));
        found
    }

    /// Height of a walker's eye above the floor, in metres.
    pub fn eye_height(&self) -> f64 {
        self.eye_height
    }

    /// Sets the eye height in metres, within [`EYE_HEIGHT_RANGE`]. False where there is no room for it.
    pub fn set_eye_height(&mut self, geometry: &Geometry, eye_height: f64) -> bool {
        if !eye_height.is_finite() {
            return false;
        }
        let eye_height = eye_height.clamp(*EYE_HEIGHT_RANGE.start(), *EYE_HEIGHT_RANGE.end());
        let up = self.up();
        if let Way::Walk(Some(gait)) = &mut self.way {
            let Some(other) = gait.with_eye_height(World { geometry, up }, eye_height) else { return false };
            let eye = other.eye(up);
            *gait = other;
            self.move_to(eye);
        }
        self.take_eye_height(eye_height);
        true
    }

    fn take_eye_height(&mut self, eye_height: f64) {
        self.eye_height = eye_height;
        self.stroll.set_usual(WALKING_SPEED * eye_height / PERSON);
    }

    /// Metres a second.
    pub fn speed(&self) -> f64 {
        if self.is_walking() { self.stroll.speed() } else { self.flight.speed() }
    }

    /// Sets the speed in metres a second, within the range the wheel covers. Walking and flying have one each.
    pub fn set_speed(&mut self, speed: f64) {
        self.pace_mut().set_speed(speed);
    }

    /// Changes the speed by notches of the wheel.
    pub fn scroll(&mut self, notches: f64) {
        self.pace_mut().scroll(notches);
    }

    fn pace_mut(&mut self) -> &mut Pace {
        if self.is_walking() { &mut self.stroll } else { &mut self.flight }
    }

    /// Vertical field of view in degrees.
    pub fn fov(&self) -> f32 {
        self.fov
    }

    /// Sets the vertical field of view in degrees, within [`FOV_RANGE`].
    pub fn set_fov(&mut self, fov: f32) {
        self.fov = fov.clamp(*FOV_RANGE.start(), *FOV_RANGE.end());
    }

    /// The scene's up, of length 1.
    fn up(&self) -> DVec3 {
        self.upright * DVec3::Y
    }

    /// To the right of the view, of length 1 and level.
    fn rightward(&self) -> DVec3 {
        self.upright * DQuat::from_rotation_y(self.pose.yaw.to_radians()) * DVec3::X
    }

    fn direction(&self) -> DVec3 {
        let (yaw, pitch) = (self.pose.yaw.to_radians(), self.pose.pitch.to_radians());
        self.upright * DVec3::new(-yaw.sin() * pitch.cos(), pitch.sin(), -yaw.cos() * pitch.cos())
    }
}

/// What the held keys make of the speed.
fn haste(motion: Motion) -> f64 {
    match (motion.fast, motion.slow) {
        (true, false) => FAST_FACTOR,
        (false, true) => 1.0 / FAST_FACTOR,
        _ => 1.0,
    }
}

/// The eye height that fits surroundings of a size: a person's, unless they are too small or too large to be in metres.
/// There, that of the first camera above its floor, if it could be one.
fn usual_eye_height(surroundings: f64, above_floor: Option<f64>) -> f64 {
    if METRES.contains(&surroundings) {
        return PERSON;
    }
    let of_camera = above_floor.filter(|height| EYE_SHARES.contains(&(height / surroundings)));
    of_camera.unwrap_or(USUAL_EYE_SHARE * surroundings).clamp(*EYE_HEIGHT_RANGE.start(), *EYE_HEIGHT_RANGE.end())
}

/// What is up for a walker at `camera`, and their pose in that frame.
fn stand(camera: &Camera) -> (DQuat, Pose) {
    let forward = (camera.look_at.as_dvec3() - camera.eye.as_dvec3()).normalize_or(DVec3::NEG_Z);
    let camera_up = camera.up.as_dvec3().normalize_or(DVec3::Y);
    // A plan view looks along Y with a horizontal `up`: that one gives the heading, while up remains +Y.
    let plan_view = forward.y.abs() > 0.999 && camera_up.y.abs() < 0.1;
    // A camera that is pitched as a whole has an `up` that leans along its view. That is no other up of the scene: the
    // picture is the one that +Y makes.
    let rightward = forward.cross(camera_up).normalize_or_zero();
    let is_level = rightward.y.abs() <= NO_ROLL && camera_up.y > LEAST_UPWARD;
    let upright = if plan_view || is_level { DQuat::IDENTITY } else { DQuat::from_rotation_arc(DVec3::Y, camera_up) };
    let local = upright.inverse() * forward;
    let heading = if plan_view { camera_up * -forward.y.signum() } else { local };
    let pose = Pose {
        eye: camera.eye.as_dvec3(),
        yaw: f64::atan2(-heading.x, -heading.z).to_degrees(),
        pitch: local.y.clamp(-1.0, 1.0).asin().to_degrees().clamp(-MAX_PITCH, MAX_PITCH),
    };
    (upright, pose)
}

/// The size in metres of what surrounds a walker at `eye`, by the bounds of all objects: twice as far as the far side
/// of half of them is.
/// The median, so that neither a landscape around a house nor a sky sphere counts; planes have no size.
pub fn surroundings(bounds: impl Iterator<Item = Aabb>, eye: Vec3) -> f64 {
    let reach =
        |bounds: Aabb| bounds.center().as_dvec3().distance(eye.as_dvec3()) + bounds.size().as_dvec3().length() / 2.0;
    let mut reaches: Vec<f64> = bounds.filter(|b| b.is_finite() && !b.is_empty()).map(reach).collect();
    reaches.sort_by(f64::total_cmp);
    reaches.get(reaches.len() / 2).map(|median| 2.0 * median).filter(|size| *size > 0.0).unwrap_or(NO_SURROUNDINGS)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walker() -> Walker {
        let home = Camera { eye: Vec3::new(1.0, 2.0, 3.0), look_at: Vec3::new(0.0, 1.0, -4.0), ..Camera::default() };
        Walker::new(home, 12.0)
    }

    fn walked(fps: u32, motion: Motion) -> f64 {
        let mut walker = walker();
        for _ in 0..fps {
            walker.fly(motion, 1.0 / f64::from(fps));
        }
        walker.pose.eye.distance(walker.home.eye.as_dvec3())
    }

    #[test]
    fn the_camera_is_the_given_one_until_the_walker_moves() {
        let mut walker = walker();
        let home = walker.home;
        assert_eq!(walker.camera(), home);
        walker.look(DVec2::new(30.0, 10.0));
        walker.fly(Motion { forward: 1.0, ..Motion::default() }, 0.1);
        walker.set_fov(90.0);
        assert_ne!(walker.camera(), home);
        assert!(walker.camera().is_valid());
        walker.go_to(Camera::default());
        assert_eq!(walker.camera(), Camera::default());
        walker.go_home();
        assert_eq!(walker.camera(), home);
    }

    #[test]
    fn a_step_does_not_turn_the_view() {
        for up in [Vec3::Y, Vec3::Z, Vec3::NEG_Y, Vec3::new(0.3, 1.0, 0.1)] {
            let home = Camera {
                eye: Vec3::new(900.0, 2.0, 3.0),
                look_at: Vec3::new(896.0, 3.0, -4.0),
                up,
                ..Camera::default()
            };
            let mut walker = Walker::new(home, 1.0);
            walker.fly(Motion { right: 1.0, ..Motion::default() }, 1e-3);
            let (before, after) = (home.frame(64, 64), walker.camera().frame(64, 64));
            assert!(after.forward.abs_diff_eq(before.forward, 1e-5), "{up}: {} {}", before.forward, after.forward);
            assert!(after.right.abs_diff_eq(before.right, 1e-5), "{up}: {} {}", before.right, after.right);
        }
    }

    #[test]
    fn a_plan_view_keeps_its_heading() {
        let home = Camera { eye: Vec3::new(0.0, 9.0, 0.0), look_at: Vec3::ZERO, up: Vec3::NEG_X, ..Camera::default() };
        let mut walker = Walker::new(home, 1.0);
        walker.fly(Motion { right: 1.0, ..Motion::default() }, 0.1);
        let (before, after) = (home.frame(8, 8), walker.camera().frame(8, 8));
        assert!(after.right.abs_diff_eq(before.right, 1e-3), "{} {}", before.right, after.right);
        assert!(after.forward.abs_diff_eq(before.forward, 0.02), "{}", after.forward);
    }

    #[test]
    fn the_same_hand_movement_is_the_same_turn_at_any_frame_rate() {
        let deltas: Vec<DVec2> =
            (0..240).map(|i| DVec2::new(f64::from(i % 17) - 5.0, f64::from(i % 7) - 3.0)).collect();
        let turned = |fps: usize| {
            let mut walker = walker();
            for frame in deltas.chunks(240 / fps) {
                frame.iter().for_each(|&delta| walker.look(delta));
                walker.fly(Motion::default(), 1.0 / fps as f64);
            }
            (walker.pose.yaw, walker.pose.pitch)
        };
        assert_eq!(turned(15), turned(60));
        assert_eq!(turned(15), turned(240));
    }

    #[test]
    fn a_second_of_walking_is_as_far_at_any_frame_rate_and_in_any_direction() {
        let straight = walked(60, Motion { forward: 1.0, ..Motion::default() });
        assert!((straight - 2.0).abs() < 1e-6, "12 m in 6 s: {straight}");
        for fps in [15, 60, 240] {
            for motion in [
                Motion { forward: 1.0, right: 1.0, ..Motion::default() },
                Motion { forward: -1.0, up: 1.0, ..Motion::default() },
            ] {
                assert!((walked(fps, motion) / straight - 1.0).abs() < 0.01, "{motion:?} at {fps}");
            }
        }
        assert!(walked(60, Motion { forward: 1.0, fast: true, ..Motion::default() }) > 3.9 * straight);
    }

    #[test]
    fn a_landscape_around_a_house_does_not_speed_the_walker_up() {
        let bounds = |center: Vec3, half: f32| Aabb { min: center - half, max: center + half };
        let eye = Vec3::new(0.0, 1.6, 4.0);
        let mut all: Vec<Aabb> = (0..9).map(|i| bounds(Vec3::new(i as f32 - 4.0, 1.0, 0.0), 0.5)).collect();
        let room = surroundings(all.iter().copied(), eye);
        assert!((8.0..16.0).contains(&room), "{room}");
        all.extend([Aabb::INFINITE, Aabb::EMPTY, bounds(Vec3::ZERO, 5000.0)]);
        assert!((surroundings(all.into_iter(), eye) / room - 1.0).abs() < 0.3);
        assert_eq!(surroundings([Aabb::INFINITE].into_iter(), eye), NO_SURROUNDINGS);
    }

    #[test]
    fn the_view_stops_short_of_straight_up() {
        let mut walker = walker();
        (0..100).for_each(|_| walker.look(DVec2::new(0.0, -200.0)));
        assert_eq!(walker.pose.pitch, MAX_PITCH);
        assert!(walker.camera().is_valid());
        walker.invert_look = true;
        walker.look(DVec2::new(0.0, -10.0));
        assert!(walker.pose.pitch < MAX_PITCH);
    }
}
