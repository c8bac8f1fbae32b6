//! What flat mirrors show, block by block: the bits of every ray traced on its own.

use crate::picture_bits::{PictureBits, film};
use crate::random::Random;
use crate::stress::{materials, textures, triple};
use crate::temporary::load_text;
use glam::DVec3;
use raywalk::render::{Scratch, render_frame};
use raywalk::scene::{Camera, Scene};
use raywalk::settings::{Settings, Visibility};
use serde_json::{Value, json};

/// Small, but enough for several runs of mirrored rays.
const SIZE: (u32, u32) = (67, 41);

/// A flat mirror: a point in its middle, its unit normal, and how large it is.
struct Mirror {
    middle: DVec3,
    normal: DVec3,
    size: f64,
}

/// Tilted, parallel and lying mirrors of every flat type, the last one a plane.
fn mirrors() -> Vec<Mirror> {
    let of = |middle: [f64; 3], normal: [f64; 3], size| Mirror {
        middle: middle.into(),
        normal: DVec3::from(normal).normalize(),
        size,
    };
    vec![
        of([0.0, 1.0, 4.0], [0.0, 0.0, -1.0], 2.0),
        of([0.0, 1.0, -4.0], [0.0, 0.0, 1.0], 2.0),
        of([3.0, 1.0, 0.0], [-1.0, 0.3, 0.2], 1.5),
        of([-3.0, 0.8, 0.5], [1.0, 0.01, -0.003], 1.5),
        of([0.3, 3.0, 0.2], [0.1, -1.0, 0.1], 1.5),
        of([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 6.0),
    ]
}

impl Mirror {
    /// Two directions across its normal.
    fn axes(&self) -> [DVec3; 2] {
        let across = self.normal.any_orthonormal_vector();
        [across, self.normal.cross(across)]
    }

    fn to_json(&self, number: usize) -> Value {
        let [a, b] = self.axes().map(|axis| axis * self.size);
        let (middle, normal) = (triple(self.middle), triple(self.normal));
        let corners = [self.middle - a - b, self.middle + a - b, self.middle + b].map(triple);
        match number % 6 {
            0 | 1 => json!({ "type": "rectangle", "corner": triple(self.middle - a - b), "edge_u": triple(a * 2.0),
                             "edge_v": triple(b * 2.0), "material": "mirror" }),
            2 => {
                json!({ "type": "disk", "center": middle, "normal": normal, "radius": self.size, "material": "steel" })
            }
            3 => json!({ "type": "triangle", "vertices": corners, "material": "mirror" }),
            4 => json!({ "type": "rectangle", "corner": corners[0], "edge_u": triple(a * 2.0), "edge_v": triple(b),
                         "material": "pane" }),
            _ => json!({ "type": "plane", "point": middle, "normal": normal, "material": "tiles" }),
        }
    }

    /// What stands on it, pokes through it, lies behind it, and covers a part of it.
    fn company(&self, random: &mut Random) -> Vec<Value> {
        let [a, b] = self.axes();
        let mut place = |off: f64| {
            let spread = self.size.min(1.5);
            let [x, y] = [(); 2].map(|()| random.within(-spread, spread));
            self.middle + a * x + b * y + self.normal * off
        };
        let [on, through, behind, before, foot] = [0.2, 0.05, -0.4, 0.6, 0.0].map(&mut place);
        let edge = place(0.0);
        vec![
            json!({ "type": "sphere", "center": triple(on), "radius": 0.2, "material": "matte" }),
            json!({ "type": "sphere", "center": triple(through), "radius": 0.15, "material": "shiny" }),
            json!({ "type": "sphere", "center": triple(behind), "radius": 0.2, "material": "clay" }),
            json!({ "type": "disk", "center": triple(before), "normal": triple(self.normal), "radius": 0.25 }),
            json!({ "type": "cylinder", "base": triple(foot), "top": triple(foot + self.normal * 0.5), "radius": 0.1,
                    "material": "clay" }),
            json!({ "type": "triangle", "vertices": [triple(edge), triple(edge + a * 0.3), triple(edge + self.normal)],
                    "material": "matte" }),
        ]
    }
}

fn scene(unit: f64) -> Scene {
    let mut random = Random::new(7);
    let mut objects = Vec::new();
    for (number, mirror) in mirrors().iter().enumerate() {
        objects.push(mirror.to_json(number));
        objects.extend(mirror.company(&mut random));
    }
    for _ in 0..60 {
        let center = random.point(2.5) + DVec3::Y * 2.0;
        let (min, max) = (center - DVec3::splat(0.1), center + random.point(0.1).abs());
        objects.push(json!({ "type": "box", "min": triple(min), "max": triple(max), "material": "matte" }));
    }
    let text = json!({
        "version": 1, "camera": { "position": [0, 1, 0], "look_at": [0, 1, 1] }, "render": { "max_depth": 3 },
        "textures": textures(), "materials": materials(),
        "lights": [{ "type": "directional", "direction": [0.3, -1, 0.2] }],
        "objects": [{ "type": "group", "transform": { "scale": unit }, "children": objects }]
    });
    load_text(text.to_string()).unwrap()
}

/// A look at a mirror: from anywhere in front, from close above its surface, or along it.
fn look(random: &mut Random, unit: f64) -> Camera {
    let all = mirrors();
    let mirror = &all[random.below(all.len())];
    let [a, b] = mirror.axes();
    let mut point = |off: f64| {
        let [x, y] = [(); 2].map(|()| random.within(-1.0, 1.0) * mirror.size.min(2.0));
        mirror.middle + a * x + b * y + mirror.normal * off
    };
    let [from, to] = [point(0.0), point(0.0)];
    let eye = match random.below(3) {
        0 => from + (mirror.normal + random.direction() * 0.7) * random.within(0.5, 3.0),
        1 => from + mirror.normal * random.magnitude(-4.0, -0.5),
        _ => from + (from - to) * 2.0 + mirror.normal * random.magnitude(-5.0, -0.5),
    };
    let fov = random.within(5.0, 100.0) as f32;
    Camera { eye: (eye * unit).as_vec3(), look_at: (to * unit).as_vec3(), fov, ..Camera::default() }
}

/// A picture, and how many mirrored rays beams told of.
fn picture(scene: &Scene, camera: &Camera, settings: &Settings, scratch: &mut Scratch) -> (PictureBits, u64) {
    let mut film = film(SIZE);
    let stats = render_frame(scene, camera, settings, scratch, &mut film);
    assert!(stats.completed);
    (PictureBits::of(&film), stats.certificates.mirrored)
}

fn full(settings: &Settings) -> Settings {
    Settings { visibility: Visibility::Full, ..settings.clone() }
}

#[test]
fn mirrored_things_keep_every_bit() {
    let settings = Settings { threads: 1, ..Settings::exact() };
    let mut wrong = Vec::new();
    let mut scratch = Scratch::new();
    for unit in [1.0, 1e-3, 1e4] {
        let scene = scene(unit);
        let mut certified = 0;
        let mut random = Random::new(8);
        for number in 0..200 {
            let camera = look(&mut random, unit);
            let [(expected, none), (found, some)] =
                [full(&settings), settings.clone()].map(|settings| picture(&scene, &camera, &settings, &mut scratch));
            assert_eq!(none, 0);
            certified += some;
            if let Some(difference) = expected.difference(&found) {
                wrong.push(format!("scale {unit}, camera {number} {camera:?}: {difference}"));
            }
        }
        let all = 200 * u64::from(SIZE.0 * SIZE.1);
        assert!(certified > all / 10, "scale {unit}: beams told of {certified} of {all} pixels only");
    }
    assert!(wrong.is_empty(), "{} are wrong:\n{}", wrong.len(), wrong.join("\n"));
}
