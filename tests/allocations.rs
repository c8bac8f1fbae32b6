//! A frame allocates nothing, on any thread, once its scratch and film have seen such frames.
//!
//! A binary of its own: it counts every allocation of the process, and other tests beside it would be counted too.

use raywalk::math::simd::is_available;
use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::{Camera, LoadOptions, Scene, load, load_embedded};
use raywalk::settings::{Kind, PRESETS, ROWS, Settings};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::path::Path;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Four tiles.
const SIZE: (u32, u32) = (90, 70);
/// Steps of a walk.
const STEPS: usize = 3;
/// Walks until one of them must be quiet. Queues change places as they fill, and which thread gets which tile differs
/// from walk to walk: each may meet its heaviest tile late.
const WALKS: usize = 20;

/// No light: one at the eye. Nested glass, for the bodies around the eye.
const HEADLIGHT: &[u8] = br#"{ "version": 1, "camera": { "position": [0, 0, 0.5], "look_at": [0, 0, -4], "fov": 70 },
    "materials": { "glass": { "transparency": 0.9, "ior": 1.5 }, "mirror": { "reflectivity": 0.5 } },
    "objects": [ { "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "glass" },
        { "type": "box", "min": [-2, -2, -2], "max": [2, 2, 2], "material": "glass" },
        { "type": "cylinder", "base": [3, -2, -5], "top": [3, 2, -5], "radius": 1, "material": "mirror" },
        { "type": "plane", "point": [0, -3, 0], "normal": [0, 1, 0], "material": "mirror" } ] }"#;

fn scenes() -> Vec<Scene> {
    let options = LoadOptions::default();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut scenes: Vec<Scene> = ["base", "mirrors", "cornell", "gallery"]
        .map(|name| load(&folder.join(name).with_extension("json"), &options).expect("the scene loads"))
        .into();
    scenes.push(load_embedded("headlight.json", &[("headlight.json", HEADLIGHT)], &options).expect("the scene loads"));
    scenes
}

/// The presets, and the default with every choice of every row, each in turn.
fn all_settings() -> Vec<(String, Settings)> {
    let mut all: Vec<_> = PRESETS.iter().map(|preset| (preset.name.to_owned(), (preset.settings)())).collect();
    for row in ROWS {
        let Kind::Choice(choices) = &row.kind else { continue };
        for choice in *choices {
            let mut settings = Settings::exact();
            (row.set)(&mut settings, choice.value).expect("a row takes its own choices");
            if is_available(settings.simd) {
                all.push((format!("{} {}", row.name, choice.value), settings));
            }
        }
    }
    all
}

/// Walks a few steps from `camera` and says how many allocations that took.
fn walk(scene: &Scene, camera: &Camera, settings: &Settings, scratch: &mut Scratch, film: &mut Film) -> usize {
    let region = Region::new(ALLOCATOR);
    for step in 0..STEPS {
        let mut camera = *camera;
        camera.eye.x += step as f32 * 0.07;
        render_frame(scene, &camera, settings, scratch, film);
    }
    let change = region.change();
    change.allocations + change.reallocations
}

#[test]
fn a_frame_allocates_nothing_once_warm() {
    let (options, no_planes) = (all_settings(), Planes::default());
    let all_planes = Planes { depth: true, normal: true, object: true, primitive: true, decision: true, cost: true };
    let mut wrong = Vec::new();
    for scene in scenes() {
        let camera = scene.cameras[0].camera;
        let films = [
            (1, Film::new(SIZE.0, SIZE.1, all_planes)),
            (2, Film::new(SIZE.0, SIZE.1, no_planes)),
            (2, Film::accumulating(SIZE.0, SIZE.1)),
        ];
        for (threads, mut film) in films {
            let mut scratch = Scratch::new();
            for (name, settings) in &options {
                let settings = Settings { threads, ..*settings };
                let mut quiet = || walk(&scene, &camera, &settings, &mut scratch, &mut film) == 0;
                if !(0..WALKS).any(|_| quiet()) {
                    wrong.push(format!("{}, {name}, {threads} thread(s)", scene.name));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "allocations in each of {WALKS} walks of {STEPS} frames:\n{}", wrong.join("\n"));
}
