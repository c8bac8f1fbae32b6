//! Ten thousand balls of about a pixel each, spread evenly over a large sphere by a golden-section spiral.

use std::f64::consts::PI;
use std::fmt::Write;

/// How many balls.
const COUNT: u32 = 10_000;
/// Radius of the sphere they lie on, in radii of one of them.
const SPREAD: f64 = 250.0;

/// The scene file, one ball a line at whole coordinates.
pub fn scene() -> String {
    let mut text = String::from(HEAD);
    let turn = PI * (3.0 - 5_f64.sqrt());
    for i in 0..COUNT {
        let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(COUNT);
        let (across, angle) = ((1.0 - y * y).sqrt(), turn * f64::from(i));
        let [x, y, z] = [across * libm::cos(angle), y, across * libm::sin(angle)].map(|c| (c * SPREAD).round() as i32);
        let comma = if i == 0 { "" } else { "," };
        // Writing to a String cannot fail.
        let _ = write!(text, "{comma}\n{{\"type\":\"sphere\",\"center\":[{x},{y},{z}],\"radius\":1}}");
    }
    text.push_str("\n    ] }\n  ]\n}\n");
    text
}

/// Everything but the balls.
const HEAD: &str = r#"{
  "version": 1,
  "comment": "10,000 balls of 1.2 pixels each at 640x360, spread over a large sphere: no block of pixels is one thing, all is edge. Subsampling must split nearly everything and still loses balls between its corners; a beam meets hundreds. Written by examples/make_scenes.",
  "render": { "width": 640, "height": 360, "max_depth": 5, "background": [0.08, 0.1, 0.16], "ambient": [1, 1, 1] },
  "camera": { "position": [0, 1, 10], "look_at": [0, -0.1, 0], "fov": 39.598 },
  "cameras": { "within": { "position": [0.3, 0.2, 0.5], "look_at": [-2, 0.5, -2], "fov": 70 } },
  "materials": { "floor": { "color": [0.3, 0.36, 0.5], "ambient": 0.2, "diffuse": 0.8, "specular": 0, "reflectivity": 0.15 } },
  "lights": [
    { "type": "directional", "direction": [-0.5, -1, -0.6], "color": [1, 0.85, 0.6], "intensity": 0.6 },
    { "type": "point", "position": [0, 0, 0], "color": [0.5, 0.8, 1], "intensity": 0.5 }
  ],
  "objects": [
    { "type": "plane", "name": "floor", "point": [0, -3.2, 0], "normal": [0, 1, 0], "material": "floor" },
    { "type": "group", "transform": { "scale": 0.012 }, "children": ["#;
