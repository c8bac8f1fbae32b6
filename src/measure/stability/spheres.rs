//! A sphere that gets farther away, the field of view narrowed so that it keeps its size in the picture.

use super::Difficulty;

pub const SPHERES: Difficulty = Difficulty {
    name: "spheres",
    axis: "distance of the eye [radii of the sphere, logarithmic]; harder to the right",
    unit: "radii away",
    share_of: "all pixels",
    falls: false,
    values: &[10.0, 30.0, 1e2, 3e2, 1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6],
    scene,
    subject: None,
    measure: None,
};

fn scene(distance: f64, _: u32) -> String {
    // The sphere fills half of the height.
    let fov = 2.0 * libm::atan(2.0 / distance).to_degrees();
    let eye = [0.36, 0.48, 0.8].map(|part| part * distance);
    format!(
        r#"{{ "version": 1, "render": {{ "background": [0.3, 0.5, 0.8] }},
             "camera": {{ "position": {eye:?}, "look_at": [0, 0, 0], "fov": {fov} }},
             "materials": {{ "ball": {{ "color": [0.9, 0.5, 0.2], "specular": 0.2 }} }},
             "lights": [ {{ "type": "directional", "direction": [-1, -0.5, -0.3] }} ],
             "objects": [ {{ "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "ball" }} ] }}"#
    )
}
