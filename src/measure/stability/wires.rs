//! Wires that get thinner than a pixel.

use super::Difficulty;
use std::fmt::Write;
use std::ops::Range;

/// Wires before a wall.
const COUNT: u32 = 24;
/// The wall is the first object.
const SUBJECT: Range<u32> = 1..COUNT + 1;

pub const WIRES: Difficulty = Difficulty {
    name: "wires",
    axis: "width of the wires [pixels, logarithmic]; harder to the right",
    unit: "pixels",
    share_of: "pixels that show a wire",
    falls: true,
    values: &[8.0, 6.0, 4.0, 3.0, 2.0, 1.5, 1.0, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1, 0.07, 0.05],
    scene,
    subject: Some(|| SUBJECT),
    measure: None,
};

/// Upright wires, each leaning a little differently and at its own place between the pixels' columns, seen from so far
/// away that all are equally wide.
fn scene(width: f64, height: u32) -> String {
    const DISTANCE: f64 = 20.0;
    // The picture shows 2 units of height at the wires.
    let pixel = 2.0 / f64::from(height);
    let fov = 2.0 * libm::atan(1.0 / DISTANCE).to_degrees();
    let mut wires = String::new();
    for i in 0..COUNT {
        let share = (f64::from(i) + 0.5) / f64::from(COUNT);
        let x = 3.4 * (share - 0.5) + pixel * (f64::from(i) * 0.618_034).fract();
        let lean = 0.06 * (2.0 * (f64::from(i) * 0.754_878).fract() - 1.0);
        // Writing to a string cannot fail.
        let _ = write!(
            wires,
            r#",{{"type":"cylinder","base":[{},-0.9,0],"top":[{},0.9,0],"radius":{},"material":"wire"}}"#,
            x - lean,
            x + lean,
            0.5 * width * pixel
        );
    }
    format!(
        r#"{{ "version": 1, "camera": {{ "position": [0, 0, {DISTANCE}], "look_at": [0, 0, 0], "fov": {fov} }},
             "materials": {{ "wire": {{ "color": [0.1, 0.1, 0.1], "specular": 0 }}, "wall": {{ "color": [0.9, 0.9, 0.9], "specular": 0 }} }},
             "lights": [ {{ "type": "directional", "direction": [0, 0, -1] }} ],
             "objects": [ {{ "type": "rectangle", "corner": [-4, -3, -0.5], "edge_u": [8, 0, 0], "edge_v": [0, 6, 0], "material": "wall" }}{wires} ] }}"#
    )
}
