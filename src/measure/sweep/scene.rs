//! The jobs of one scene.

use super::method::{optimisations, sweep_methods, walk_methods};
use super::{Comparison, Effort, Job, Judge, Method, Reference, View, Walk};
use crate::measure::records::Part;
use crate::scene::Camera;
use crate::settings::{Settings, Visibility};

/// Frames of a walk that no path was given for.
const STEPS: u32 = 36;
/// How far such a walk moves from frame to frame, in pixels of what is looked at.
const STEP_PIXELS: f32 = 0.7;

/// Settings against error, optimisations one by one, errors along a walk, and time against the number of pixels.
/// `path` holds the cameras of a path; without one the camera takes some steps aside.
pub fn of_scene(view: &View, base: &Settings, path: Option<Vec<Camera>>, effort: &Effort) -> Vec<Job> {
    let full = Settings { visibility: Visibility::Full, ..base.clone() };
    let reference = Reference { scene: view.scene.clone(), camera: view.camera, settings: full.clone() };
    let comparison = |part, (width, height): (u32, u32), at, judge, methods: Vec<Method>, percent| {
        let budget = effort.share(percent);
        Job::Compare(Comparison {
            part,
            view: View { size: (width.max(1), height.max(1)), ..view.clone() },
            at,
            reference: reference.clone(),
            judge,
            keeps_pictures: part == Part::Settings,
            longest_frame: budget / (2 * methods.len() as u32),
            methods,
            rounds: effort.rounds,
            budget,
        })
    };
    let size = effort.size(view.size);
    let half = (size.0 / 2, size.1 / 2);
    // Without its optimisations the tracer is slow, so these are compared on smaller pictures.
    let quarter = if effort.quick { half } else { (size.0 / 4, size.1 / 4) };
    let mut jobs = vec![
        comparison(Part::Settings, size, None, Judge::Metrics, sweep_methods(base, effort.quick), 60),
        comparison(Part::Optimisations, quarter, None, Judge::Time, optimisations(base), 16),
    ];
    let small = View { size: (half.0.max(1), half.1.max(1)), ..view.clone() };
    jobs.push(Job::Walk(Walk {
        cameras: path.unwrap_or_else(|| steps_aside(&view.camera, small.size.1)),
        view: small,
        reference: full.clone(),
        methods: walk_methods(base),
        budget: effort.share(12),
    }));
    for sides in [8, 4, 2, 1] {
        let scaled = (size.0 * 3 / (2 * sides), size.1 * 3 / (2 * sides));
        let pixels = f64::from(scaled.0.max(1)) * f64::from(scaled.1.max(1));
        let methods = sweep_methods(base, true).into_iter().filter(|m| GROWING.contains(&m.name.as_str())).collect();
        jobs.push(comparison(Part::Pixels, scaled, Some(pixels), Judge::Time, methods, 3));
    }
    jobs
}

/// The methods whose growth is drawn.
const GROWING: [&str; 4] = ["full", "exact", "balanced", "fast"];

/// A walk to the right that moves what is looked at by a fraction of a pixel each frame: edges cross pixels one by one.
fn steps_aside(camera: &Camera, height: u32) -> Vec<Camera> {
    let frame = camera.frame(1, 1);
    let pixel = 2.0 * frame.up * camera.eye.distance(camera.look_at) / height as f32;
    let right = frame.right.normalize_or_zero() * pixel.length() * STEP_PIXELS;
    let at = |step: u32| right * step as f32;
    (0..STEPS)
        .map(|step| Camera { eye: camera.eye + at(step), look_at: camera.look_at + at(step), ..*camera })
        .collect()
}
