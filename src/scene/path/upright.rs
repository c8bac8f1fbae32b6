//! Which way is up where a path looks along its own up: as just before, or else as just after.

use super::CameraPath;
use crate::scene::Camera;
use glam::{DQuat, DVec3, Vec3};

/// The least sine of the angle between the view and up, beyond what rounding of the positions makes of it.
const LEAST_SINE: f64 = 1e-6;

impl CameraPath {
    /// `camera`, which is that of time `t`, with an up across its view: if its own is not, that of the nearest frame before
    /// which has one, turned with the view. Where none has, of the nearest frame after; where none has either, its own.
    pub(super) fn upright(&self, t: f64, camera: Camera, base: &Camera, origin: DVec3) -> Camera {
        if !looks_along_up(&camera) {
            return camera;
        }
        let now = ((t - self.keys[0].t) * self.fps).ceil().max(0.0) as u64;
        let last = self.frame_count() - 1;
        let at = |frame: u64| self.by_keys(self.keys[0].t + frame as f64 / self.fps, base, origin);
        let before = |steps: u64| now.min(last + 1).checked_sub(steps).map(at);
        let after = |steps: u64| now.checked_add(steps).filter(|frame| *frame <= last).map(at);
        let other = nearest(before).or_else(|| nearest(after));
        other.map_or(camera, |other| Camera { up: carried(&other, &camera), ..camera })
    }
}

/// The nearest of cameras in a row that does not look along its up, found by doubling steps and then halving: there may be
/// very many.
fn nearest(camera: impl Fn(u64) -> Option<Camera>) -> Option<Camera> {
    let usable = |steps: u64| camera(steps).filter(|camera| !looks_along_up(camera));
    let mut far: u64 = 1;
    let mut near = 0;
    let mut found = loop {
        if let Some(found) = usable(far) {
            break found;
        }
        // Beyond the end the last one is tried, once.
        if camera(far).is_none() {
            let mut end = far;
            while end - near > 1 {
                let middle = near + (end - near) / 2;
                if camera(middle).is_some() { near = middle } else { end = middle }
            }
            far = near;
            near = 0;
            break usable(far)?;
        }
        near = far;
        far = far.checked_mul(2)?;
    };
    while far - near > 1 {
        let middle = near + (far - near) / 2;
        match usable(middle) {
            Some(nearer) => (far, found) = (middle, nearer),
            None => near = middle,
        }
    }
    Some(found)
}

/// Whether the camera looks along its up, as far as the numbers tell. Not of one that looks nowhere.
fn looks_along_up(camera: &Camera) -> bool {
    let (view, up) = (camera.look_at.as_dvec3() - camera.eye.as_dvec3(), camera.up.as_dvec3());
    let largest = camera.eye.abs().max(camera.look_at.abs()).max_element();
    let rounding = f64::from(largest) * f64::from(f32::EPSILON) / view.length();
    let sine = view.cross(up).length() / (view.length() * up.length());
    sine <= LEAST_SINE.max(rounding)
}

/// The up of `other`'s picture, turned as its view is turned to that of `camera`.
fn carried(other: &Camera, camera: &Camera) -> Vec3 {
    let view = |camera: &Camera| (camera.look_at.as_dvec3() - camera.eye.as_dvec3()).normalize();
    let (from, to) = (view(other), view(camera));
    let right = from.cross(other.up.as_dvec3());
    let turned: DVec3 = DQuat::from_rotation_arc(from, to) * right.cross(from).normalize();
    turned.as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn path(text: &str) -> CameraPath {
        CameraPath::parse(text, Path::new("walk.json")).expect("it is right")
    }

    /// The up of a frame's picture, and whether it has one.
    fn up(path: &CameraPath, frame: u64) -> (bool, Vec3) {
        let camera = path.camera(frame, &Camera::default(), DVec3::ZERO);
        (camera.is_valid(), camera.frame(8, 8).up.normalize())
    }

    #[test]
    fn up_is_carried_over_where_a_path_looks_straight_down() {
        let path = path(
            r#"{ "version": 1, "fps": 10, "keys": [ { "t": 0, "position": [0, 1, 5], "look_at": [0, 0.5, 0] },
                 { "t": 1, "position": [0, 1, -5], "look_at": [0, 0.5, 0] } ] }"#,
        );
        for frame in 0..=10 {
            assert!(up(&path, frame).0, "frame {frame}");
        }
        let (before, carried) = (up(&path, 4).1, up(&path, 5).1);
        assert!(carried.abs_diff_eq(Vec3::NEG_Z, 1e-5) && before.z < -0.1, "{before} {carried}");
        // The same at any time between two frames.
        assert!(path.camera_after(0.5, &Camera::default(), DVec3::ZERO).is_valid());
    }

    #[test]
    fn a_long_look_along_up_keeps_what_was_up_before_or_comes_after() {
        // Ahead, then down for a hundred seconds, then ahead to another side.
        let key = |t: u32, look_at: &str| format!(r#"{{ "t": {t}, "position": [0, 9, 0], "look_at": {look_at} }}"#);
        let write = |keys: &[String]| path(&format!(r#"{{ "version": 1, "fps": 10, "keys": [{}] }}"#, keys.join(",")));
        let (down, ahead, right) = ("[0, 0, 0]", "[0, 8, -5]", "[5, 8, 0]");
        let whole = write(&[key(0, ahead), key(1, down), key(2, down), key(99, down), key(100, down), key(101, right)]);
        let before = up(&whole, 19).1;
        for frame in [20, 21, 500, 989, 990] {
            let (is_valid, up) = up(&whole, frame);
            assert!(is_valid && up.abs_diff_eq(before, 1e-2), "frame {frame}: {up}, not {before}");
        }
        let begins = write(&[key(0, down), key(1, down), key(2, down), key(3, right)]);
        let after = up(&begins, 11).1;
        for frame in [0, 7, 10] {
            let (is_valid, up) = up(&begins, frame);
            assert!(is_valid && up.abs_diff_eq(after, 1e-2), "frame {frame}: {up}, not {after}");
        }
        let ends = write(&[key(0, ahead), key(1, down)]);
        for frame in [10, 11, 1_000_000_000_000] {
            let (is_valid, up) = up(&ends, frame);
            assert!(is_valid && up.abs_diff_eq(Vec3::NEG_Z, 1e-3), "frame {frame}: {up}");
        }
        let never = write(&[key(0, down), key(1, down)]);
        assert!(!up(&never, 5).0, "nothing says what is up");
    }

    #[test]
    fn up_turns_with_a_view_that_turns_quickly() {
        let path = path(
            r#"{ "version": 1, "fps": 1, "keys": [ { "t": 0, "position": [0, 1, 0], "look_at": [0, 1, -1] },
                 { "t": 1, "position": [0, 1, 0], "look_at": [0, 0, 0] } ] }"#,
        );
        let (is_valid, up) = up(&path, 1);
        assert!(is_valid && up.abs_diff_eq(Vec3::NEG_Z, 1e-5), "{up}");
    }

    #[test]
    fn what_is_only_nearly_along_up_is_left_alone() {
        let text = |x: f64| {
            format!(
                r#"{{ "version": 1, "keys": [ {{ "t": 0, "position": [{x}, 1, 0], "look_at": [0, 0, 0] }},
                     {{ "t": 1, "position": [1, 1, 0], "look_at": [0, 0, 0] }} ] }}"#
            )
        };
        assert_eq!(path(&text(1e-4)).camera(0, &Camera::default(), DVec3::ZERO).up, Vec3::Y);
        assert_ne!(path(&text(1e-8)).camera(0, &Camera::default(), DVec3::ZERO).up, Vec3::Y, "that is rounding");
    }
}
