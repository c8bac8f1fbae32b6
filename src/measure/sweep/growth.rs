//! Time against the number of primitives: a cloud of spheres, its volume and their share of it the same for any number.

use super::{Comparison, Effort, Job, Judge, Method, Reference, View};
use crate::measure::records::Part;
use crate::scene::{LoadOptions, SceneError, load_text};
use crate::settings::Settings;
use std::fmt::Write;
use std::sync::Arc;
use std::time::Duration;

const SIZE: (u32, u32) = (640, 360);
const COUNTS: [u32; 9] = [10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000];

/// Time against primitives for `base`, for a ray a pixel, and for that without a tree.
///
/// # Errors
/// None that `COUNTS` could cause.
pub fn by_primitives(base: &Settings, effort: &Effort) -> Result<Vec<Job>, SceneError> {
    let full = base.reference();
    let method =
        |family, name: &str, settings: &Settings| Method { family, name: name.to_owned(), settings: settings.clone() };
    let methods = vec![
        method("full", "full", &full),
        method("exact", "exact", &base.without_approximations()),
        method("hit", "no tree", &Settings { bvh: false, ..full.clone() }),
    ];
    let size = effort.size(SIZE);
    let counts = COUNTS.iter().filter(|count| **count <= 10_000 || !effort.quick);
    let job = |&count: &u32| {
        let scene = Arc::new(load_text("cloud.json", &cloud(count), &LoadOptions::default())?);
        let camera = scene.cameras[0].camera;
        Ok(Job::Compare(Comparison {
            part: Part::Primitives,
            view: View {
                name: "cloud of spheres".to_owned(),
                camera_name: "default".to_owned(),
                camera,
                path: Vec::new(),
                size,
                scene: scene.clone(),
            },
            at: Some(f64::from(count)),
            reference: Reference { scene, camera, settings: full.clone() },
            judge: Judge::Time,
            keeps_pictures: false,
            methods: methods.clone(),
            rounds: effort.rounds.min(3),
            budget: effort.scene / 100,
            longest_frame: Duration::from_millis(500),
        }))
    };
    counts.map(job).collect()
}

/// `count` spheres in a cube of edge 2 over a floor, placed by a sequence that fills it evenly (the plastic number's
/// powers, after Roberts).
fn cloud(count: u32) -> String {
    let radius = 0.35 / f64::from(count).cbrt();
    let mut spheres = String::new();
    for i in 1..=count {
        let place = |root: f64| 2.0 * (f64::from(i) * root).fract() - 1.0;
        let (x, y, z) =
            (place(0.819_172_513_396_164_4), place(0.671_043_606_703_789_3), place(0.549_700_477_901_970_3));
        // Writing to a string cannot fail.
        let _ = write!(spheres, r#",{{"type":"sphere","center":[{x},{y},{z}],"radius":{radius},"material":"ball"}}"#);
    }
    format!(
        r#"{{ "version": 1, "render": {{ "background": [0.3, 0.5, 0.8], "max_depth": 2 }},
             "camera": {{ "position": [1.6, 1.2, 3.6], "look_at": [0, -0.1, 0], "fov": 40 }},
             "materials": {{ "ball": {{ "color": [0.8, 0.5, 0.2], "reflectivity": 0.2, "specular": 0.3 }},
                             "floor": {{ "color": [0.7, 0.7, 0.7], "specular": 0 }} }},
             "lights": [ {{ "type": "point", "position": [4, 6, 5] }} ],
             "objects": [ {{ "type": "plane", "point": [0, -1.2, 0], "normal": [0, 1, 0], "material": "floor" }}{spheres} ] }}"#
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clouds_have_the_spheres_they_say() {
        let scene = load_text("cloud.json", &cloud(30), &LoadOptions { strict: true, ..LoadOptions::default() });
        assert_eq!(scene.expect("a valid scene").geometry.len(), 31);
    }
}
