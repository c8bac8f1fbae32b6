//! A film that gathers samples ends with the picture of `--supersample 16`, bit for bit.

use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::{Camera, LoadOptions, Scene, load};
use raywalk::settings::{PRESETS, Settings, Supersample, ToneMap, Visibility};
use std::path::Path;

/// Neither a multiple of a tile nor of a packet.
const SIZE: (u32, u32) = (97, 66);

fn scene(name: &str) -> (Scene, Camera) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("json");
    let scene = load(&file, &LoadOptions::default()).unwrap();
    let camera = scene.cameras[0].camera;
    (scene, camera)
}

fn sixteen(scene: &Scene, camera: &Camera, settings: &Settings) -> Film {
    let settings = Settings { supersample: Supersample::Grid { side: 4 }, render_scale: 1.0, ..settings.clone() };
    let mut film = Film::new(SIZE.0, SIZE.1, Planes::default());
    render_frame(scene, camera, &settings, &mut Scratch::new(), &mut film);
    film
}

fn colors(film: &Film) -> Vec<[u32; 3]> {
    let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
    pixels.map(|(x, y)| film.color(x, y).map(f32::to_bits)).collect()
}

/// Mean difference of all bytes.
fn distance(a: &Film, b: &Film) -> f64 {
    let sum: u32 = a.rgba().iter().zip(b.rgba()).map(|(&a, &b)| u32::from(a.abs_diff(b))).sum();
    f64::from(sum) / a.rgba().len() as f64
}

fn all_settings() -> Vec<Settings> {
    let mut all: Vec<Settings> = PRESETS.iter().map(|preset| (preset.settings)()).collect();
    all.push(Settings { visibility: Visibility::Full, ..Settings::exact() });
    all.push(Settings { visibility: Visibility::Subsample, tone_map: Some(ToneMap::Neutral), ..Settings::exact() });
    all
}

#[test]
fn sixteen_frames_make_the_picture_of_supersample_16() {
    let mut scratch = Scratch::new();
    let mut film = Film::accumulating(SIZE.0, SIZE.1);
    // Glass and mirrors; textures and glass; a far pattern.
    for name in ["cornell", "gallery", "mirrors"] {
        let (scene, camera) = scene(name);
        for settings in all_settings() {
            let expected = sixteen(&scene, &camera, &settings);
            let mut plain = Film::new(SIZE.0, SIZE.1, Planes::default());
            render_frame(&scene, &camera, &settings, &mut scratch, &mut plain);
            let mut distances = vec![distance(&plain, &expected)];
            // Twice: after the last sample it begins anew.
            for samples in (1..=16).chain(1..=16) {
                assert!(render_frame(&scene, &camera, &settings, &mut scratch, &mut film).completed);
                assert_eq!(film.samples(), Some(samples));
                distances.push(distance(&film, &expected));
            }
            assert!(film.rgba() == expected.rgba() && distances[16] == 0.0, "{name}: {settings:?}");
            assert_eq!(colors(&film), colors(&expected), "{name}: {settings:?}");
            assert!(distances[2] < distances[0], "{name}: two samples are worth showing: {distances:?}");
            assert!(distances[4..16].iter().all(|d| *d < 0.7 * distances[0]), "{name}: four or more: {distances:?}");
        }
    }
}

#[test]
fn what_was_cancelled_or_left_begins_anew() {
    let (scene, camera) = scene("cornell");
    let mut scratch = Scratch::new();
    let mut film = Film::accumulating(SIZE.0, SIZE.1);
    let settings = Settings::exact();
    let mut elsewhere = camera;
    elsewhere.eye.x += 0.2;
    for _ in 0..5 {
        render_frame(&scene, &elsewhere, &settings, &mut scratch, &mut film);
    }
    scratch.cancel.cancel();
    assert!(!render_frame(&scene, &elsewhere, &settings, &mut scratch, &mut film).completed);
    assert_eq!(film.samples(), Some(0));
    scratch.cancel.reset();
    for _ in 0..9 {
        render_frame(&scene, &elsewhere, &settings, &mut scratch, &mut film);
    }
    film.start_over();
    for _ in 0..16 {
        render_frame(&scene, &camera, &settings, &mut scratch, &mut film);
    }
    assert_eq!(colors(&film), colors(&sixteen(&scene, &camera, &settings)));
    let mut plain = Film::new(4, 4, Planes::default());
    plain.start_over();
    assert_eq!(plain.samples(), None, "other films gather nothing");
}
