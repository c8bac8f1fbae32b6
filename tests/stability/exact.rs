//! What promises the same pixels: not one value of one plane may differ, on any scene, for any camera.

use super::scenes::{self, Stress, near};
use crate::flips::flipped;
use crate::picture_bits::{PictureBits, render};
use crate::random::Random;
use raywalk::scene::Camera;
use raywalk::settings::{Settings, Visibility};

const SIZE: (u32, u32) = (160, 90);

/// A ray for every pixel.
fn full() -> Settings {
    Settings { visibility: Visibility::Full, ..Settings::exact() }
}

/// What differs from `full`, seen by some cameras of a scene.
fn differences(stress: &Stress, cameras: &[Camera], methods: &[(String, Settings)]) -> Vec<String> {
    let mut found = Vec::new();
    for (number, camera) in cameras.iter().enumerate() {
        let place = format!("{}, camera {number}", stress.name);
        let expected = PictureBits::of(&render(&stress.scene, camera, &full(), SIZE));
        if expected.not_a_number() > 0 {
            found.push(format!("{place}: {} pixels are not numbers", expected.not_a_number()));
        }
        for (name, settings) in methods {
            let picture = PictureBits::of(&render(&stress.scene, camera, settings, SIZE));
            if let Some(difference) = expected.difference(&picture) {
                found.push(format!("{place}, {name}: {difference}; {camera:?}"));
            }
        }
    }
    found
}

/// All of a scene's cameras, and with `RAYWALK_LONG` set a hundred more.
fn cameras(stress: &Stress) -> Vec<Camera> {
    let more = if std::env::var_os("RAYWALK_LONG").is_some() { 100 } else { 0 };
    let mut random = Random::new(2);
    let own = stress.own_cameras().iter().cycle();
    stress.cameras.iter().copied().chain(own.take(more).map(|camera| near(camera, &mut random))).collect()
}

#[test]
fn full_differs_from_brute_force_in_no_value() {
    let method = [("brute force".to_owned(), Settings { bvh: false, ..full() })];
    let found: Vec<String> = scenes::all().iter().flat_map(|s| differences(s, &s.cameras, &method)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn certified_differs_from_full_in_no_value() {
    let method = [("certified".to_owned(), Settings::exact())];
    let found: Vec<String> = scenes::all().iter().flat_map(|s| differences(s, &cameras(s), &method)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn no_switch_that_promises_the_same_pixels_changes_a_value() {
    let mut methods = flipped();
    // Nothing between tracing and the picture looks at these.
    methods.retain(|(name, _)| !name.starts_with("present"));
    let found: Vec<String> = scenes::all().iter().flat_map(|s| differences(s, &s.cameras[..1], &methods)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}
