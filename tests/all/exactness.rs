//! "Same pixels": every value of a setting that promises it gives every bit of every plane.

use crate::flips::flipped;
use crate::picture_bits::{PictureBits, render};
use crate::random::Random;
use crate::stress;
use raywalk::scene::{Camera, LoadOptions, Scene, load};
use raywalk::settings::Settings;
use std::path::Path;

/// Neither a multiple of a tile nor of a packet.
const SIZE: (u32, u32) = (97, 66);

/// What differs between the ways that promise the same pixels.
pub fn wrong_pixels(name: &str, scene: &Scene, cameras: &[Camera]) -> Vec<String> {
    let mut wrong = Vec::new();
    for (number, camera) in cameras.iter().enumerate() {
        let expected = PictureBits::of(&render(scene, camera, &Settings::exact(), SIZE));
        if expected.not_a_number() > 0 {
            wrong.push(format!("{name}, camera {number}: {} pixels are not numbers", expected.not_a_number()));
        }
        for (flip, settings) in flipped() {
            let picture = PictureBits::of(&render(scene, camera, &settings, SIZE));
            if let Some(difference) = expected.difference(&picture) {
                wrong.push(format!("{name}, camera {number}, {flip}: {difference}"));
            }
        }
    }
    wrong
}

fn extra_cameras() -> usize {
    if std::env::var_os("RAYWALK_LONG").is_some() { 20 } else { 1 }
}

#[test]
fn every_kind_of_switch_is_among_the_flips() {
    let flips: Vec<String> = flipped().into_iter().map(|(name, _)| name).collect();
    for expected in ["shadow-cache off", "bvh off", "sphere-cache off", "simd off", "threads 1", "threads 5"] {
        assert!(flips.iter().any(|flip| flip == expected), "{expected} is not in {flips:?}");
    }
}

#[test]
fn stress_scenes_keep_every_bit() {
    let mut random = Random::new(1);
    let mut wrong = Vec::new();
    for (name, scene) in stress::scenes() {
        let cameras = stress::cameras(&scene, extra_cameras(), &mut random);
        wrong.extend(wrong_pixels(&name, &scene, &cameras));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn our_own_scenes_keep_every_bit() {
    let mut random = Random::new(2);
    let mut wrong = Vec::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut found = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        // Camera paths lie among the scenes.
        if std::fs::read_to_string(&path).unwrap().contains("\"keys\"") {
            continue;
        }
        let scene = load(&path, &LoadOptions::default()).unwrap();
        found += 1;
        let cameras = stress::cameras(&scene, extra_cameras(), &mut random);
        wrong.extend(wrong_pixels(&scene.name, &scene, &cameras[..cameras.len().min(2 + extra_cameras())]));
    }
    assert!(found >= 5, "only {found} scenes were found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
