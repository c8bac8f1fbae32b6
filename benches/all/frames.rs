//! Whole frames at 640 x 360, one thread, the default settings.

use crate::shapes;
use crate::sphereflake::{self, GENERATIONS};
use divan::Bencher;
use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::{LoadOptions, Scene, builtin, load, load_embedded};
use raywalk::settings::Settings;
use serde_json::json;
use std::path::Path;

const SIZE: (u32, u32) = (640, 360);

fn bench(bencher: Bencher, scene: &Scene) {
    let camera = scene.cameras[0].camera;
    let settings = Settings { threads: 1, ..Settings::exact() };
    let (mut scratch, mut film) = (Scratch::new(), Film::new(SIZE.0, SIZE.1, Planes::default()));
    bencher.bench_local(|| render_frame(scene, &camera, &settings, &mut scratch, &mut film));
}

/// A scene from text. It is kept until the program ends, as embedded files are.
fn scene_of(text: String) -> Scene {
    let files: &[(&str, &[u8])] = vec![("scene.json", &*text.into_bytes().leak())].leak();
    load_embedded("scene.json", files, &LoadOptions::default()).expect("the generated scene is valid")
}

#[divan::bench]
fn gallery(bencher: Bencher) {
    bench(bencher, &builtin(&LoadOptions::default()).expect("the built-in scene is valid"));
}

#[divan::bench]
fn cornell(bencher: Bencher) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.json");
    bench(bencher, &load(&path, &LoadOptions::default()).expect("the scene is valid"));
}

/// 820, 7,381 and 66,430 spheres: the cost should grow far more slowly.
#[divan::bench(args = [GENERATIONS - 1, GENERATIONS, GENERATIONS + 1])]
fn sphereflake_of_generations(bencher: Bencher, generations: u32) {
    bench(bencher, &scene_of(sphereflake::scene(generations)));
}

#[divan::bench]
fn grass(bencher: Bencher) {
    let corners: Vec<[f32; 3]> = shapes::grass(40_000).flatten().map(|p| p.to_array()).collect();
    let triangles: Vec<[usize; 3]> = (0..corners.len()).step_by(3).map(|i| [i, i + 1, i + 2]).collect();
    let scene = json!({
        "version": 1,
        "camera": { "position": [0, 0.8, 2.8], "look_at": [0, 0, 0], "fov": 50 },
        "materials": { "grass": { "color": [0.4, 0.7, 0.3] } },
        "lights": [{ "type": "point", "position": [4, 6, 4] }],
        "objects": [
            { "type": "mesh", "vertices": corners, "triangles": triangles, "material": "grass" },
            { "type": "rectangle", "corner": [-3, 0, -3], "edge_u": [0, 0, 6], "edge_v": [6, 0, 0] },
        ],
    });
    bench(bencher, &scene_of(scene.to_string()));
}
