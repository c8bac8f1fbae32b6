//! The fly camera: where the walker stands, where they look, how fast they go.

use super::input::Motion;
use super::look::SpikeFilter;
use crate::geometry::Aabb;
use crate::scene::Camera;
use glam::{DQuat, DVec2, DVec3, Vec3};

/// Speed is multiplied by this for each notch of the wheel.
const NOTCH: f64 = 1.1;
/// Most notches away from the scene's own speed, either way: hundreds of millions of times, yet never zero.
const MAX_NOTCHES: f64 = 200.0;
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

/// A walker who starts at one of the scene's cameras and flies from there.
#[derive(Debug)]
pub struct Walker {
    /// Degrees of turn per count of the mouse.
    pub sensitivity: f64,
    /// Mouse forward looks down.
    pub invert_look: bool,
    home: Camera,
    /// The camera last gone to. Until the walker moves from it, it stays what it is, bit for bit.
    stance: Camera,
    moved: bool,
    /// Turns +Y to the scene's up.
    upright: DQuat,
    pose: Pose,
    fov: f32,
    base_speed: f64,
    notches: f64,
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
            stance: home,
            moved: false,
            upright,
            pose,
            fov: home.fov,
            base_speed: surroundings / CROSSING_SECONDS,
            notches: 0.0,
            spikes: SpikeFilter::default(),
        }
    }

    /// Goes to `camera` and takes its field of view. Speed stays.
    pub fn go_to(&mut self, camera: Camera) {
        (self.upright, self.pose) = stand(&camera);
        self.fov = camera.fov;
        self.stance = camera;
        self.moved = false;
    }

    /// Back to where the walk started.
    pub fn go_home(&mut self) {
        self.go_to(self.home);
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
            up: (self.upright * DVec3::Y).as_vec3(),
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

    /// Walks for `seconds`. Diagonals are as fast as straight lines.
    pub fn walk(&mut self, motion: Motion, seconds: f64) {
        if !motion.is_moving() {
            return;
        }
        let forward = self.direction();
        let up = self.upright * DVec3::Y;
        let right = self.upright * DQuat::from_rotation_y(self.pose.yaw.to_radians()) * DVec3::X;
        let wish = right * motion.right + up * motion.up + forward * motion.forward;
        let pace = match (motion.fast, motion.slow) {
            (true, false) => FAST_FACTOR,
            (false, true) => 1.0 / FAST_FACTOR,
            _ => 1.0,
        };
        let step = self.speed() * pace * seconds.clamp(0.0, MAX_STEP_SECONDS);
        let eye = self.pose.eye + wish.normalize_or_zero() * step;
        // Beyond what f32 can hold there is nothing to see: stay.
        if eye.as_vec3().is_finite() {
            self.pose.eye = eye;
            self.moved = true;
        }
    }

    /// Metres a second.
    pub fn speed(&self) -> f64 {
        self.base_speed * NOTCH.powf(self.notches)
    }

    /// Sets the speed in metres a second, within the range the wheel covers.
    pub fn set_speed(&mut self, speed: f64) {
        self.notches = 0.0;
        self.scroll((speed / self.base_speed).ln() / NOTCH.ln());
    }

    /// Changes the speed by notches of the wheel.
    pub fn scroll(&mut self, notches: f64) {
        if notches.is_finite() {
            self.notches = (self.notches + notches).clamp(-MAX_NOTCHES, MAX_NOTCHES);
        }
    }

    /// Vertical field of view in degrees.
    pub fn fov(&self) -> f32 {
        self.fov
    }

    /// Sets the vertical field of view in degrees, within [`FOV_RANGE`].
    pub fn set_fov(&mut self, fov: f32) {
        self.fov = fov.clamp(*FOV_RANGE.start(), *FOV_RANGE.end());
    }

    fn direction(&self) -> DVec3 {
        let (yaw, pitch) = (self.pose.yaw.to_radians(), self.pose.pitch.to_radians());
        self.upright * DVec3::new(-yaw.sin() * pitch.cos(), pitch.sin(), -yaw.cos() * pitch.cos())
    }
}

/// What is up for a walker at `camera`, and their pose in that frame.
fn stand(camera: &Camera) -> (DQuat, Pose) {
    let forward = (camera.look_at.as_dvec3() - camera.eye.as_dvec3()).normalize_or(DVec3::NEG_Z);
    let camera_up = camera.up.as_dvec3().normalize_or(DVec3::Y);
    // A plan view looks along Y with a horizontal `up`: that one gives the heading, while up remains +Y.
    let plan_view = forward.y.abs() > 0.999 && camera_up.y.abs() < 0.1;
    let upright = if plan_view { DQuat::IDENTITY } else { DQuat::from_rotation_arc(DVec3::Y, camera_up) };
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
            walker.walk(motion, 1.0 / f64::from(fps));
        }
        walker.pose.eye.distance(walker.home.eye.as_dvec3())
    }

    #[test]
    fn the_camera_is_the_given_one_until_the_walker_moves() {
        let mut walker = walker();
        let home = walker.home;
        assert_eq!(walker.camera(), home);
        walker.look(DVec2::new(30.0, 10.0));
        walker.walk(Motion { forward: 1.0, ..Motion::default() }, 0.1);
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
            walker.walk(Motion { right: 1.0, ..Motion::default() }, 1e-3);
            let (before, after) = (home.frame(64, 64), walker.camera().frame(64, 64));
            assert!(after.forward.abs_diff_eq(before.forward, 1e-5), "{up}: {} {}", before.forward, after.forward);
            assert!(after.right.abs_diff_eq(before.right, 1e-5), "{up}: {} {}", before.right, after.right);
        }
    }

    #[test]
    fn a_plan_view_keeps_its_heading() {
        let home = Camera { eye: Vec3::new(0.0, 9.0, 0.0), look_at: Vec3::ZERO, up: Vec3::NEG_X, ..Camera::default() };
        let mut walker = Walker::new(home, 1.0);
        walker.walk(Motion { right: 1.0, ..Motion::default() }, 0.1);
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
                walker.walk(Motion::default(), 1.0 / fps as f64);
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
    fn the_wheel_multiplies_and_comes_back() {
        let mut walker = walker();
        let start = walker.speed();
        walker.scroll(1.0);
        assert!((walker.speed() / start - 1.1).abs() < 1e-12);
        walker.scroll(-1.0);
        (0..200).for_each(|_| walker.scroll(-1.0));
        assert!(walker.speed() > 0.0);
        (0..200).for_each(|_| walker.scroll(1.0));
        assert!((walker.speed() / start - 1.0).abs() < 1e-9);
        (0..1000).for_each(|_| walker.scroll(5.0));
        assert!(walker.speed().is_finite());
        walker.set_speed(3.5);
        assert!((walker.speed() - 3.5).abs() < 1e-9);
        walker.scroll(f64::NAN);
        walker.set_speed(f64::NAN);
        assert!(walker.speed() > 0.0);
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
