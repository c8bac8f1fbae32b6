//! The pinhole camera: position, direction and field of view, and the rays it makes.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// A pinhole camera in a right-handed world; angles in degrees, the field of view vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye.
    pub eye: Vec3,
    /// A point on the optical axis.
    pub look_at: Vec3,
    /// Roughly up; must not be parallel to the view.
    pub up: Vec3,
    /// Vertical field of view in degrees, in (0, 180).
    pub fov: f32,
    /// Least distance of primary hits, at least 0.
    pub near: f32,
    /// Greatest distance of primary hits; infinity for none.
    pub far: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: Vec3::new(0.0, 0.0, 5.0),
            look_at: Vec3::ZERO,
            up: Vec3::Y,
            fov: 60.0,
            near: 0.0,
            far: f32::INFINITY,
        }
    }
}

/// A camera in the coordinates of its file, as scene files write it. A scene may be moved before it is traced: see
/// [`Scene::origin`](super::Scene::origin).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileCamera {
    position: [f64; 3],
    look_at: [f64; 3],
    up: [f32; 3],
    fov: f32,
    #[serde(default, skip_serializing_if = "is_zero")]
    near: f32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    far: Option<f32>,
}

fn is_zero(near: &f32) -> bool {
    *near == 0.0
}

impl FileCamera {
    /// A camera of a scene that was moved so that `origin` is at its origin.
    pub fn of(camera: &Camera, origin: DVec3) -> Self {
        let Camera { eye, look_at, up, fov, near, far } = *camera;
        let [position, look_at] = [eye, look_at].map(|point| in_file(point, origin).to_array());
        Self { position, look_at, up: up.to_array(), fov, near, far: far.is_finite().then_some(far) }
    }

    /// The camera in a scene that was moved so; `None` where it cannot make rays there.
    pub fn camera(&self, origin: DVec3) -> Option<Camera> {
        let [eye, look_at] = [self.position, self.look_at].map(|point| (DVec3::from(point) - origin).as_vec3());
        let far = self.far.unwrap_or(f32::INFINITY);
        let camera = Camera { eye, look_at, up: self.up.into(), fov: self.fov, near: self.near, far };
        camera.is_valid().then_some(camera)
    }

    /// Whether it can make rays in some scene.
    pub fn is_valid(&self) -> bool {
        self.camera(self.position.into()).is_some() && DVec3::from(self.position).as_vec3().is_finite()
    }

    /// The camera as JSON, as in a scene file. Read again for a scene that was not moved it is the same, bit for bit.
    pub fn to_json(&self) -> String {
        // Numbers and lists can always be written.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// A camera of a scene that was not moved.
impl From<Camera> for FileCamera {
    fn from(camera: Camera) -> Self {
        Self::of(&camera, DVec3::ZERO)
    }
}

/// A point of a scene that was moved so that `origin` is at its origin, in the coordinates of its file.
pub fn in_file(point: Vec3, origin: DVec3) -> DVec3 {
    DVec3::from(point.to_array().map(shortest)) + origin
}

/// The number that is written with the fewest digits of all that round to this one.
pub fn shortest(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

/// The camera's basis for one picture size: pixel (x, y), row 0 on top, looks along
/// `forward + (2(x + .5)/W - 1) right + (1 - 2(y + .5)/H) up`, where `right` and `up` are already
/// scaled by the field of view and the picture's aspect.
#[derive(Clone, Copy, Debug)]
pub struct CameraFrame {
    /// Position of the eye.
    pub eye: Vec3,
    /// Unit vector along the optical axis.
    pub forward: Vec3,
    /// Half of the picture's width at unit distance.
    pub right: Vec3,
    /// Half of the picture's height at unit distance.
    pub up: Vec3,
    /// Picture width in pixels.
    pub width: u32,
    /// Picture height in pixels.
    pub height: u32,
    /// Least distance of primary hits.
    pub near: f32,
    /// Greatest distance of primary hits.
    pub far: f32,
}

impl Camera {
    /// A camera at `eye` with `yaw` 0 looking along -Z, positive turning left, and positive `pitch` looking up (degrees).
    pub fn from_yaw_pitch(eye: Vec3, yaw: f32, pitch: f32, fov: f32) -> Self {
        let (yaw, pitch) = (f64::from(yaw).to_radians(), f64::from(pitch).to_radians());
        let (sin_yaw, cos_yaw) = (libm::sin(yaw), libm::cos(yaw));
        let (sin_pitch, cos_pitch) = (libm::sin(pitch), libm::cos(pitch));
        let direction = DVec3::new(-sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch);
        // Straight up or down, +Y is no longer across the view: the horizontal heading is.
        let up = if cos_pitch.abs() > 1e-6 {
            Vec3::Y
        } else {
            (DVec3::new(-sin_yaw, 0.0, -cos_yaw) * -sin_pitch.signum()).as_vec3()
        };
        // Far from the origin a point one metre away would round to a coarse direction.
        let distance = f64::from(eye.abs().max_element().max(1.0));
        Self { eye, look_at: (eye.as_dvec3() + direction * distance).as_vec3(), up, fov, ..Self::default() }
    }

    /// Whether the camera can make rays: all finite, the view neither zero nor parallel to `up`, `fov` in (0, 180).
    pub fn is_valid(&self) -> bool {
        let forward = self.look_at.as_dvec3() - self.eye.as_dvec3();
        let across = forward.cross(self.up.as_dvec3()).length();
        let scale = forward.length() * self.up.as_dvec3().length();
        scale.is_finite()
            && scale > 0.0
            && across > 1e-9 * scale
            && self.fov > 0.0
            && self.fov < 180.0
            && self.near >= 0.0
            && self.near < self.far
    }

    /// The basis for a picture of `width` x `height` pixels. Computed in f64 and rounded once.
    pub fn frame(&self, width: u32, height: u32) -> CameraFrame {
        let forward = (self.look_at.as_dvec3() - self.eye.as_dvec3()).normalize();
        let right = forward.cross(self.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let half_height = libm::tan(f64::from(self.fov).to_radians() / 2.0);
        let half_width = half_height * f64::from(width) / f64::from(height);
        CameraFrame {
            eye: self.eye,
            forward: forward.as_vec3(),
            right: (right * half_width).as_vec3(),
            up: (up * half_height).as_vec3(),
            width,
            height,
            near: self.near,
            far: self.far,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaw_turns_left_and_pitch_looks_up() {
        let forward = |yaw, pitch| Camera::from_yaw_pitch(Vec3::ZERO, yaw, pitch, 60.0).frame(4, 4).forward;
        assert!(forward(0.0, 0.0).abs_diff_eq(Vec3::NEG_Z, 1e-6));
        assert!(forward(90.0, 0.0).abs_diff_eq(Vec3::NEG_X, 1e-6));
        assert!(forward(0.0, 90.0).abs_diff_eq(Vec3::Y, 1e-6));
        for pitch in [-90.0, 90.0] {
            assert!(Camera::from_yaw_pitch(Vec3::ONE, 30.0, pitch, 60.0).is_valid());
        }
    }

    #[test]
    fn yaw_keeps_its_direction_far_from_the_origin() {
        let camera = Camera::from_yaw_pitch(Vec3::splat(1e7), 30.0, 10.0, 60.0);
        let near = Camera::from_yaw_pitch(Vec3::ZERO, 30.0, 10.0, 60.0);
        assert!(camera.frame(4, 4).forward.abs_diff_eq(near.frame(4, 4).forward, 1e-6));
    }

    #[test]
    fn a_camera_is_written_in_the_coordinates_of_its_file() {
        let camera =
            Camera { eye: Vec3::new(0.35, 1.6, -2.25), look_at: Vec3::new(-1.0, 0.1, 7.0), ..Camera::default() };
        let origin = DVec3::new(582_143.0, 0.0, 5_340_122.0);
        let text = FileCamera::of(&camera, origin).to_json();
        assert!(text.starts_with(r#"{"position":[582143.35,1.6,5340119.75]"#), "{text}");
        let read: FileCamera = serde_json::from_str(&text).unwrap();
        let back = read.camera(origin).unwrap();
        assert!(back.eye.abs_diff_eq(camera.eye, 1e-6) && back.look_at.abs_diff_eq(camera.look_at, 1e-6), "{back:?}");
        let near: FileCamera = serde_json::from_str(&FileCamera::of(&camera, DVec3::ZERO).to_json()).unwrap();
        assert_eq!(near.camera(DVec3::ZERO), Some(camera));
        assert!(read.is_valid());
        assert!(!FileCamera::of(&Camera { look_at: camera.eye, ..camera }, origin).is_valid());
    }

    #[test]
    fn a_camera_that_cannot_make_rays_says_so() {
        let good = Camera::default();
        assert!(good.is_valid());
        for bad in [
            Camera { look_at: good.eye, ..good },
            Camera { up: Vec3::Z, ..good },
            Camera { fov: 180.0, ..good },
            Camera { fov: f32::NAN, ..good },
            Camera { near: 2.0, far: 1.0, ..good },
        ] {
            assert!(!bad.is_valid(), "{bad:?}");
        }
    }
}
