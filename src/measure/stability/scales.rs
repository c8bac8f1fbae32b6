//! One scene in ever larger and smaller units, which should change nothing in its picture.

use super::Difficulty;

pub const SCALES: Difficulty = Difficulty {
    name: "scales",
    axis: "scale of the scene [units a metre, logarithmic]; hard at both ends",
    unit: "units a metre",
    share_of: "all pixels, against the picture at scale 1",
    falls: false,
    values: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
    scene,
    subject: None,
    measure: Some(1.0),
};

fn scene(scale: f64, _: u32) -> String {
    let s = |x: f64| x * scale;
    let v = |x: f64, y: f64, z: f64| format!("[{}, {}, {}]", s(x), s(y), s(z));
    format!(
        r#"{{ "version": 1, "render": {{ "background": [0.3, 0.5, 0.8] }},
             "camera": {{ "position": {}, "look_at": {}, "fov": 45 }},
             "materials": {{ "red": {{ "color": [0.9, 0.25, 0.2], "specular": 0.3, "reflectivity": 0.3 }},
                             "floor": {{ "color": [0.7, 0.7, 0.7], "specular": 0 }},
                             "glass": {{ "transparency": 0.9, "ior": 1.5, "diffuse": 0.1, "specular": 0 }} }},
             "lights": [ {{ "type": "point", "position": {} }} ],
             "objects": [
               {{ "type": "rectangle", "corner": {}, "edge_u": {}, "edge_v": {}, "material": "floor" }},
               {{ "type": "sphere", "center": {}, "radius": {}, "material": "red" }},
               {{ "type": "sphere", "center": {}, "radius": {}, "material": "glass" }},
               {{ "type": "box", "min": {}, "max": {}, "material": "red" }},
               {{ "type": "cylinder", "base": {}, "top": {}, "radius": {}, "capped": true, "material": "floor" }} ] }}"#,
        v(0.3, 1.6, 5.0),
        v(0.1, 0.5, 0.0),
        v(3.0, 6.0, 4.0),
        v(-6.0, 0.0, -6.0),
        v(0.0, 0.0, 12.0),
        v(12.0, 0.0, 0.0),
        v(-0.9, 0.7, 0.0),
        s(0.7),
        v(0.8, 0.5, 0.9),
        s(0.5),
        v(0.6, 0.0, -1.2),
        v(1.8, 1.3, -0.3),
        v(-2.2, 0.0, -0.5),
        v(-2.0, 1.5, -0.5),
        s(0.15),
    )
}
