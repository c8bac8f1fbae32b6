//! The scenes of `scenes/stress/`, and the cameras that look at them.

use crate::random::Random;
use raywalk::scene::{Camera, LoadOptions, Scene, load};
use std::path::Path;

/// A scene that breaks something.
pub struct Stress {
    /// The file's name, without its extension.
    pub name: String,
    pub scene: Scene,
    /// The file's own cameras, then as many near them, and one more near the first.
    pub cameras: Vec<Camera>,
}

impl Stress {
    /// The file's own cameras.
    pub fn own_cameras(&self) -> &[Camera] {
        &self.cameras[..self.scene.cameras.len()]
    }
}

/// Every scene, by name. A warning is an error.
pub fn all() -> Vec<Stress> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/stress");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut all: Vec<Stress> = files.filter(|file| file.extension().is_some_and(|e| e == "json")).map(stress).collect();
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}

fn stress(file: impl AsRef<Path>) -> Stress {
    let file = file.as_ref();
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let scene = load(file, &strict).unwrap_or_else(|error| panic!("{error}"));
    let mut random = Random::new(1);
    let own: Vec<Camera> = scene.cameras.iter().map(|view| view.camera).collect();
    let nearby: Vec<Camera> = own.iter().chain([&own[0]]).map(|camera| near(camera, &mut random)).collect();
    let name = file.file_stem().unwrap().to_string_lossy().into_owned();
    Stress { name, scene, cameras: [own, nearby].concat() }
}

/// A camera that shows about the same: a step aside, another direction, another field of view.
pub fn near(camera: &Camera, random: &mut Random) -> Camera {
    let distance = f64::from(camera.eye.distance(camera.look_at));
    let half_height = (f64::from(camera.fov).to_radians() / 2.0).tan() * distance;
    let camera = Camera {
        eye: camera.eye + (random.direction() * distance * 0.05).as_vec3(),
        look_at: camera.look_at + (random.direction() * half_height * 0.3).as_vec3(),
        fov: camera.fov * random.within(0.8, 1.25) as f32,
        ..*camera
    };
    assert!(camera.is_valid(), "{camera:?}");
    camera
}

#[test]
fn every_file_opens_with_what_it_breaks() {
    for Stress { name, .. } in all() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/stress").join(&name).with_extension("json");
        let text = std::fs::read_to_string(file).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert!(
            lines[2].starts_with("  \"comment\": \"") && lines[2].len() > 100,
            "{name} says too little: {}",
            lines[2]
        );
    }
}
