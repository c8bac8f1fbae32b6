//! The jobs of one scene.

use super::method::{optimisations_alone, optimisations_taken_away, sweep_methods, walk_methods};
use super::{Comparison, Effort, Job, Judge, Method, Reference, View, Walk};
use crate::measure::records::Part;
use crate::render::{Film, Planes, Scratch, render_frame};
use crate::scene::Camera;
use crate::settings::Settings;
use std::time::{Duration, Instant};

/// Frames of a walk that no path was given for.
const STEPS: u32 = 36;
/// How far such a walk moves from frame to frame, in pixels of what is looked at.
const STEP_PIXELS: f32 = 0.7;

/// Settings against error, optimisations one by one, errors along a walk, and time against the number of pixels.
/// Without a path the camera takes some steps aside for the walk; with one, settings are compared from several places
/// along it, and all but these two begin where it does.
pub fn of_scene(view: &View, base: &Settings, effort: &Effort) -> Vec<Job> {
    let (full, swept) = (base.reference(), sweep_methods(base, effort.quick));
    let reference = Reference { scene: view.scene.clone(), camera: view.camera, settings: full.clone() };
    let comparison = |part, (width, height): (u32, u32), at, judge, methods: Vec<Method>, percent| {
        let budget = effort.share(percent);
        Job::Compare(Comparison {
            part,
            view: match part {
                Part::Settings => View { size: (width.max(1), height.max(1)), ..view.clone() }.sampled(effort.cameras),
                _ => View { size: (width.max(1), height.max(1)), ..view.clone() }.still(),
            },
            at,
            reference: reference.clone(),
            judge,
            keeps_pictures: part == Part::Settings,
            // Slow methods must not eat the time of all; but of optimisations the slowest is what others are held against.
            longest_frame: match part {
                Part::Optimisations => budget / SLOWEST,
                Part::Pixels => budget / 2,
                _ => longest_frame(effort, methods.len()),
            },
            methods,
            rounds: effort.rounds,
            budget,
        })
    };
    let size = effort.size(view.size);
    let half = (size.0 / 2, size.1 / 2);
    let mut jobs = vec![
        comparison(Part::Settings, size, None, Judge::Metrics, swept, SETTINGS_SHARE),
        comparison(
            Part::Optimisations,
            bare_size(view, half, effort.share(OPTIMISATIONS_SHARE) / (2 * SLOWEST)),
            None,
            Judge::Time,
            optimisations_alone(base),
            OPTIMISATIONS_SHARE,
        ),
        // What is worth little in a tiny picture, such as beams, must not be judged by one.
        comparison(Part::Optimisations, half, None, Judge::Time, optimisations_taken_away(base), OPTIMISATIONS_SHARE),
    ];
    let mut small = View { size: (half.0.max(1), half.1.max(1)), ..view.clone() };
    if small.path.is_empty() {
        small.path = steps_aside(&view.camera, small.size.1);
    }
    jobs.push(Job::Walk(Walk {
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

/// The part of a scene's time that the comparison of settings is given, in per cent.
const SETTINGS_SHARE: u32 = 58;

/// What a frame of that comparison may take.
fn longest_frame(effort: &Effort, methods: usize) -> Duration {
    effort.share(SETTINGS_SHARE) / (2 * methods as u32)
}

/// A size at which the reference's frame fits into a sweep from all that settings are compared from, as measured on small
/// pictures: that of `view`, or a smaller one of its shape, halved as often as needed.
pub fn affordable_size(view: &View, base: &Settings, effort: &Effort) -> (u32, u32) {
    /// The small picture's edge is this many times smaller.
    const SMALLER: u32 = 8;
    let longest = longest_frame(effort, sweep_methods(base, effort.quick).len());
    let (settings, mut scratch) = (base.reference(), Scratch::default());
    let (width, height) = effort.size(view.size);
    let mut film = Film::new((width / SMALLER).max(1), (height / SMALLER).max(1), Planes::default());
    let mut time = |camera| {
        let start = Instant::now();
        render_frame(&view.scene, camera, &settings, &mut scratch, &mut film);
        start.elapsed()
    };
    let sampled = view.clone().sampled(effort.cameras);
    // The first frame of all starts threads and touches memory.
    time(&view.camera);
    let slowest = sampled.cameras().iter().map(time).max().unwrap_or_default();
    let (mut frame, mut size) = (slowest * SMALLER * SMALLER, view.size);
    while frame > longest && size.0.min(size.1) > 2 * LEAST_EDGE {
        (frame, size) = (frame / 4, (size.0 / 2, size.1 / 2));
    }
    size
}

/// Pictures with a smaller edge say little.
const LEAST_EDGE: u32 = 36;

/// The part of a scene's time that optimisations are given, in per cent, once for each alone and once for all but each;
/// and the part of that which the slowest frame may take.
const OPTIMISATIONS_SHARE: u32 = 9;
const SLOWEST: u32 = 5;

/// A size at which a frame without any optimisation should end within `longest`: `size`, or a smaller one of its shape.
fn bare_size(view: &View, size: (u32, u32), longest: Duration) -> (u32, u32) {
    /// Seconds to test one primitive in scalar code, on the slow side, and rays a pixel.
    const TEST: f64 = 4e-9;
    const RAYS: f64 = 6.0;
    /// Fewer pixels say nothing about pictures.
    const LEAST: f64 = 64.0 * 36.0;
    let pixels = f64::from(size.0) * f64::from(size.1);
    let affordable = longest.as_secs_f64() / (view.scene.geometry.len().max(1) as f64 * RAYS * TEST);
    let scale = (affordable.max(LEAST) / pixels.max(1.0)).sqrt().min(1.0);
    let scaled = |side: u32| ((f64::from(side) * scale).round() as u32).max(1);
    (scaled(size.0), scaled(size.1))
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
