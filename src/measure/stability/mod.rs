//! Scenes that get harder step by step, each made in memory: where does each method begin to fail?

mod scales;
mod spheres;
mod wires;

use super::records::Part;
use super::sweep::{Comparison, Effort, Job, Judge, Reference, View, stability_methods};
use crate::scene::{LoadOptions, Scene, SceneError, load_text};
use crate::settings::Settings;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// One way in which scenes get harder.
pub struct Difficulty {
    /// Its name in records.
    pub name: &'static str,
    /// What its numbers are, with their unit.
    pub axis: &'static str,
    /// The unit alone.
    pub unit: &'static str,
    /// Of which pixels the wrong ones are a share.
    pub share_of: &'static str,
    /// Whether small numbers are the hard ones.
    pub falls: bool,
    /// The numbers.
    values: &'static [f64],
    /// The scene at a number, as JSON, for pictures of this height.
    scene: fn(f64, u32) -> String,
    /// The objects whose pixels count; `None` for all.
    subject: Option<fn() -> Range<u32>>,
    /// The number whose picture is the reference for all; `None` where each has its own.
    measure: Option<f64>,
}

/// Every difficulty.
pub const DIFFICULTIES: &[Difficulty] = &[wires::WIRES, spheres::SPHERES, scales::SCALES];

const SIZE: (u32, u32) = (480, 270);

/// The jobs that draw each method's error against every difficulty.
///
/// # Errors
/// None that the scenes above could cause.
pub fn jobs(base: &Settings, effort: &Effort) -> Result<Vec<Job>, SceneError> {
    let size = effort.size(SIZE);
    let full = base.reference();
    let mut jobs = Vec::new();
    for difficulty in DIFFICULTIES {
        let made = |value| difficulty.scene(value, size.1);
        let measure = difficulty.measure.map(made).transpose()?;
        for &value in difficulty.values {
            let scene = made(value)?;
            let against = measure.as_ref().unwrap_or(&scene).clone();
            let camera = scene.cameras[0].camera;
            jobs.push(Job::Compare(Comparison {
                part: Part::Stability,
                view: View {
                    name: difficulty.name.to_owned(),
                    scene,
                    camera_name: "default".to_owned(),
                    camera,
                    path: Vec::new(),
                    size,
                },
                at: Some(value),
                reference: Reference { camera: against.cameras[0].camera, scene: against, settings: full.clone() },
                judge: Judge::Wrong(difficulty.subject.map(|subject| subject())),
                keeps_pictures: false,
                methods: stability_methods(base, effort.quick),
                rounds: 0,
                budget: Duration::ZERO,
                longest_frame: Duration::from_secs(10),
            }));
        }
    }
    Ok(jobs)
}

impl Difficulty {
    fn scene(&self, value: f64, height: u32) -> Result<Arc<Scene>, SceneError> {
        let text = (self.scene)(value, height);
        Ok(Arc::new(load_text(&format!("{}.json", self.name), &text, &LoadOptions::default())?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_valid_and_shows_its_subject() {
        for difficulty in DIFFICULTIES {
            for &value in difficulty.values {
                let text = (difficulty.scene)(value, 90);
                let strict = LoadOptions { strict: true, ..LoadOptions::default() };
                let scene = load_text("made.json", &text, &strict).unwrap_or_else(|error| panic!("{error}"));
                assert!(scene.cameras[0].camera.is_valid(), "{} {value}", difficulty.name);
                let subject = difficulty.subject.map_or(0..1, |subject| subject());
                assert!(scene.objects.len() >= subject.end as usize, "{} {value}", difficulty.name);
            }
        }
    }
}
