//! `--visibility subsample` and cached differences of spheres: approximations, and how good they have to be.

use crate::picture_bits::{film, render};
use crate::temporary::load_text;
use raywalk::render::{Film, Scratch, render_frame};
use raywalk::scene::Scene;
use raywalk::settings::{Fill, Settings, SphereCache, Supersample, Visibility};

/// What is counted as wrong: any channel farther off than this.
const OFF: f32 = 0.01;

fn ball_on_floor() -> Scene {
    load_text(
        r#"{ "version": 1, "camera": { "position": [0, 0.6, -4.6], "look_at": [0, -0.1, 0], "fov": 45 },
             "render": { "background": [0.3, 0.4, 0.5] },
             "materials": { "green": { "color": [0.1, 0.65, 0.2], "reflectivity": 0.3 } },
             "lights": [ { "type": "point", "position": [-7, 10, -10] } ],
             "objects": [ { "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "green" },
                          { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0] } ] }"#,
    )
    .unwrap()
}

fn subsample(stride: u32, fill: Fill) -> Settings {
    Settings { visibility: Visibility::Subsample, stride, fill, ..Settings::exact() }
}

fn both_fills() -> impl Iterator<Item = Settings> {
    [2, 4, 8, 16].into_iter().flat_map(|stride| [Fill::Hit, Fill::Color].map(|fill| subsample(stride, fill)))
}

/// The share of pixels that are wrong.
fn wrong(a: &Film, b: &Film) -> f64 {
    let pixels = || (0..a.height()).flat_map(|y| (0..a.width()).map(move |x| (x, y)));
    let differs = |&(x, y): &(u32, u32)| (0..3).any(|c| (a.color(x, y)[c] - b.color(x, y)[c]).abs() > OFF);
    pixels().filter(differs).count() as f64 / pixels().count() as f64
}

#[test]
fn few_pixels_of_a_large_ball_are_wrong() {
    let scene = ball_on_floor();
    let camera = scene.cameras[0].camera;
    let size = (200, 150);
    let full = render(&scene, &camera, &Settings::exact(), size);
    for settings in both_fills() {
        let rate = wrong(&full, &render(&scene, &camera, &settings, size));
        // Re-used hits are shaded on their own: only what no corner saw is missed. Colours in between are guesses.
        let bound = if settings.fill == Fill::Hit { 0.004 } else { 0.05 };
        println!("stride {} {:?}: {:.3} % wrong", settings.stride, settings.fill, rate * 100.0);
        assert!(rate <= bound, "stride {} {:?}: {:.2} % wrong", settings.stride, settings.fill, rate * 100.0);
    }
}

#[test]
fn what_no_corner_sees_is_all_that_is_missed() {
    // With corners on every other pixel, a ball this large has none of its parts between them.
    let scene = ball_on_floor();
    let camera = scene.cameras[0].camera;
    let full = render(&scene, &camera, &Settings::exact(), (128, 96));
    let fine = render(&scene, &camera, &subsample(2, Fill::Hit), (128, 96));
    assert!(wrong(&full, &fine) < 0.001);
}

#[test]
fn every_pixel_is_counted_once_and_drawn_whatever_the_size() {
    let scene = ball_on_floor();
    let camera = scene.cameras[0].camera;
    let mut scratch = Scratch::new();
    for size in
        [(1, 1), (2, 3), (3, 2), (65, 64), (64, 65), (63, 129), (64, 64), (1, 200), (200, 1), (66, 17), (129, 67)]
    {
        let full = render(&scene, &camera, &Settings::exact(), size);
        for settings in both_fills().chain([Settings::exact()]) {
            let mut film = film(size);
            let pixels = render_frame(&scene, &camera, &settings, &mut scratch, &mut film).pixels;
            let sum = pixels.traced + pixels.resolved + pixels.certified + pixels.interpolated;
            let name = format!("{size:?} {:?} {:?} {}", settings.visibility, settings.fill, settings.stride);
            assert_eq!(sum, u64::from(size.0) * u64::from(size.1), "{name}: {pixels:?}");
            for y in 0..size.1 {
                for x in 0..size.0 {
                    // Everything in this scene is brighter than this.
                    let brightness: f32 = film.color(x, y).iter().sum();
                    let expected: f32 = full.color(x, y).iter().sum();
                    assert!(brightness > 0.5 * expected.min(0.1), "{name}: a hole at ({x}, {y})");
                }
            }
        }
    }
}

#[test]
fn supersampling_counts_each_pixel_once() {
    let scene = ball_on_floor();
    let camera = scene.cameras[0].camera;
    for settings in both_fills().chain([Settings::exact()]) {
        let settings = Settings { supersample: Supersample::Grid { side: 2 }, ..settings };
        let mut film = film((70, 50));
        let stats = render_frame(&scene, &camera, &settings, &mut Scratch::new(), &mut film);
        let pixels = stats.pixels;
        assert_eq!(pixels.traced + pixels.resolved + pixels.certified + pixels.interpolated, 3500, "{settings:?}");
        assert_eq!(stats.supersampled, 3500);
    }
}

#[test]
fn supersampling_is_the_mean_of_shifted_pictures() {
    // A picture of twice the size has its rays where the four samples of each pixel are.
    let scene = ball_on_floor();
    let camera = scene.cameras[0].camera;
    let settings = Settings { supersample: Supersample::Grid { side: 2 }, ..Settings::exact() };
    let four = render(&scene, &camera, &settings, (60, 40));
    let large = render(&scene, &camera, &Settings::exact(), (120, 80));
    for y in 0..40 {
        for x in 0..60 {
            for c in 0..3 {
                let samples = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| large.color(2 * x + i, 2 * y + j)[c]);
                let mean = samples.iter().sum::<f32>() / 4.0;
                assert!((four.color(x, y)[c] - mean).abs() < 2e-4, "({x}, {y}): {} for {mean}", four.color(x, y)[c]);
            }
        }
    }
}

/// A ball seen from afar, and the share of pixels that the cached difference changes.
fn difference_terms_change(distance: f32) -> f64 {
    let text = format!(
        r#"{{ "version": 1, "camera": {{ "position": [0, 0, {distance}], "look_at": [0, 0, 0], "fov": {} }},
              "lights": [ {{ "type": "directional", "direction": [1, -1, -1] }} ],
              "objects": [ {{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }} ] }}"#,
        2.4 / distance * 57.3
    );
    let scene = load_text(text).unwrap();
    let camera = scene.cameras[0].camera;
    let [exact, difference] = [SphereCache::On, SphereCache::Difference]
        .map(|sphere_cache| render(&scene, &camera, &Settings { sphere_cache, ..Settings::exact() }, (64, 64)));
    wrong(&exact, &difference)
}

#[test]
fn the_difference_terms_agree_nearby_and_cancel_far_away() {
    assert!(difference_terms_change(4.0) < 0.001);
    assert!(difference_terms_change(20_000.0) > 0.05);
}
