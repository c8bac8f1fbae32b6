//! Cameras whose pixels are known before anything stands in front of them, so that things can be put on their borders.

use crate::random::Random;
use crate::stress::triple;
use glam::{DVec2, DVec3, Vec3, swizzles::Vec3Swizzles};
use raywalk::scene::Camera;
use raywalk::scene::camera::CameraFrame;
use serde_json::{Value, json};

/// A half-line in double precision.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: DVec3,
    /// Of any length.
    pub direction: DVec3,
}

impl Ray {
    pub fn at(self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A camera, the picture it makes, and the unit in which the scene around it is measured.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub camera: Camera,
    pub size: (u32, u32),
    /// How large the scene is altogether.
    pub unit: f64,
}

/// Around tiles of 64, 32, 16 and 8 pixels, and nothing that they divide.
const SIZES: [(u32, u32); 10] =
    [(67, 35), (130, 97), (64, 64), (65, 33), (33, 66), (96, 40), (17, 9), (128, 64), (40, 72), (1, 1)];

/// Common fields of view and the ends of what there is. That of 90 degrees has exact picture coordinates; in the
/// narrowest, pixels are no farther apart than directions can be told from each other.
const FIELDS: [f32; 12] = [90.0, 90.0, 60.0, 45.0, 20.0, 120.0, 170.0, 1.0, 0.1, 0.01, 0.001, 1e-4];

/// Blocks of which pixels may be the border.
const BLOCKS: [u32; 5] = [64, 32, 16, 8, 4];

impl View {
    /// A view that makes rays. Scenes are `unit` large, their eye up to a million times that from the origin.
    pub fn new(random: &mut Random) -> Self {
        loop {
            let unit = if random.chance(0.6) { random.pick(&[1.0, 1e-4, 1e5]) } else { random.magnitude(-4.0, 5.0) };
            let away = match random.below(4) {
                0 => unit * random.magnitude(0.0, 6.0),
                1 => unit * random.within(0.0, 3.0),
                _ => 0.0,
            };
            let eye = (random.direction() * away).as_vec3();
            let (forward, up) = match random.below(3) {
                0 => (random.direction(), random.direction()),
                1 => (DVec3::new(random.sign(), 0.0, random.sign()), DVec3::Y),
                _ => {
                    let axis = random.pick(&[DVec3::X, DVec3::Y, DVec3::Z]) * random.sign();
                    (axis, random.pick(&[axis.yzx(), axis.zxy()]))
                }
            };
            // Far from the origin a point nearby would round to another direction.
            let ahead = unit.max(away);
            let look_at = (eye.as_dvec3() + forward * ahead).as_vec3();
            let fov = if random.chance(0.8) { random.pick(&FIELDS) } else { random.within(0.01, 179.0) as f32 };
            let camera = Camera { eye, look_at, up: up.as_vec3(), fov, ..Camera::default() };
            if camera.is_valid() {
                return Self { camera, size: random.pick(&SIZES), unit };
            }
        }
    }

    pub fn eye(&self) -> DVec3 {
        self.camera.eye.as_dvec3()
    }

    pub fn frame(&self) -> CameraFrame {
        self.camera.frame(self.size.0, self.size.1)
    }

    /// The ray through a place of the picture in pixels, (0, 0) the left upper corner. One unit of t is one unit
    /// straight ahead.
    pub fn ray(&self, place: DVec2) -> Ray {
        let frame = self.frame();
        let [forward, right, up] = [frame.forward, frame.right, frame.up].map(Vec3::as_dvec3);
        let across = place.x * 2.0 / f64::from(self.size.0) - 1.0;
        let down = 1.0 - place.y * 2.0 / f64::from(self.size.1);
        Ray { origin: self.eye(), direction: forward + right * across + up * down }
    }

    /// Edge of a pixel at distance 1.
    pub fn pixel(&self) -> f64 {
        self.frame().up.as_dvec3().length() * 2.0 / f64::from(self.size.1)
    }

    /// A column or row where blocks of pixels meet: the centre of the last pixel of one or the first of the next,
    /// or, not `centred`, also their border, or all but that.
    fn border(random: &mut Random, extent: u32, centred: bool) -> f64 {
        let block = random.pick(&BLOCKS);
        let at = match random.below(8) {
            0 => f64::from(extent / 2),
            1 => f64::from(extent),
            2 => random.below(extent as usize) as f64,
            _ => f64::from(random.below((extent / block) as usize + 1) as u32 * block),
        };
        if centred {
            return at + random.pick(&[0.5, -0.5]);
        }
        let nudge = if random.chance(0.3) { 0.0 } else { random.sign() * random.magnitude(-7.0, -1.0) };
        at + random.pick(&[0.5, -0.5, 0.0]) + nudge
    }

    /// A place where a column and a row of borders meet; most often a pixel's centre.
    pub fn corner(&self, random: &mut Random) -> DVec2 {
        let centred = random.chance(0.7);
        DVec2::new(Self::border(random, self.size.0, centred), Self::border(random, self.size.1, centred))
    }

    /// Two places of the picture: on a column or a row of borders, or between two corners of blocks.
    pub fn line(&self, random: &mut Random) -> [DVec2; 2] {
        let [a, mut b] = [self.corner(random), self.corner(random)];
        match random.below(5) {
            0 | 1 => b.x = a.x,
            2 | 3 => b.y = a.y,
            _ => {}
        }
        if a.distance(b) < 0.25 {
            let size = DVec2::new(self.size.0.into(), self.size.1.into());
            b = if a.x == b.x { DVec2::new(a.x, a.y + size.y * 0.6) } else { DVec2::new(a.x + size.x * 0.6, a.y) };
        }
        [a, b]
    }

    /// The camera as a scene file says it.
    pub fn to_json(self) -> Value {
        let Camera { eye, look_at, up, fov, near, far } = self.camera;
        let [position, look_at, up] = [eye, look_at, up].map(|v| triple(v.as_dvec3()));
        let mut camera = json!({ "position": position, "look_at": look_at, "up": up, "fov": fov });
        if near > 0.0 {
            camera["near"] = json!(near);
        }
        if far.is_finite() {
            camera["far"] = json!(far);
        }
        camera
    }
}
