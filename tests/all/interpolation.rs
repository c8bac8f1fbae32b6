//! `--visibility certified --fill color`: what is seen is proven, and the light in between is good enough.

use crate::picture_bits::{PictureBits, render};
use crate::random::Random;
use crate::stress;
use crate::temporary::load_text;
use raywalk::math::simd::is_available;
use raywalk::render::Film;
use raywalk::scene::{LoadOptions, Scene, load};
use raywalk::settings::{Fill, Settings, SimdLevel, ToneMap};
use std::path::Path;

/// Pixels that are interpolated lie closer together the larger the picture.
const SIZE: (u32, u32) = (320, 184);

/// Channel values farther off than this, of 255, are counted.
const NEAR: u8 = 2;

/// The share of channel values that may be.
const MOST: f64 = 1e-3;

fn interpolated() -> Settings {
    Settings { fill: Fill::Color, ..Settings::exact() }
}

fn our_scenes() -> Vec<Scene> {
    let names = ["base", "cornell", "gallery", "mirrors", "sphereflake"];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    names.map(|name| load(&folder.join(name).with_extension("json"), &LoadOptions::default()).unwrap()).into()
}

/// The share of channel values of the 8-bit pictures that are not near.
fn share_off(a: &Film, b: &Film) -> f64 {
    let off = a.rgba().iter().zip(b.rgba()).filter(|&(&a, &b)| a.abs_diff(b) > NEAR).count();
    off as f64 / (f64::from(a.width() * a.height()) * 3.0)
}

#[test]
fn nearly_all_values_are_near_the_exact_ones() {
    let mut random = Random::new(31);
    for scene in our_scenes() {
        let cameras = stress::cameras(&scene, 3, &mut random);
        for (number, camera) in cameras.iter().enumerate() {
            let exact = render(&scene, camera, &Settings::exact(), SIZE);
            let share = share_off(&exact, &render(&scene, camera, &interpolated(), SIZE));
            assert!(share <= MOST, "{}, camera {number}: {:.3} % are off", scene.name, share * 100.0);
        }
    }
}

/// Light far above 1, which a dark texture or a tone curve brings back into sight.
fn dazzling() -> Scene {
    load_text(
        r##"{ "version": 1, "camera": { "position": [0, 1.5, 5], "look_at": [0, 0.5, 0], "fov": 50 },
              "textures": { "coal": { "checker": [[0.02, 0.02, 0.02], [0.05, 0.04, 0.03]], "size": 0.7 } },
              "materials": {
                "coal": { "color": { "texture": "coal" }, "specular": 0.5, "shininess": 80 },
                "brass": { "color": [0.8, 0.6, 0.2], "specular": 1, "shininess": 200 } },
              "lights": [ { "type": "point", "position": [1, 2, 2], "intensity": 30, "falloff": "inverse_square" },
                          { "type": "directional", "direction": [-1, -1, -1], "intensity": 3 } ],
              "objects": [ { "type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "coal" },
                           { "type": "sphere", "center": [0, 1, 0], "radius": 1, "material": "brass" } ] }"##,
    )
    .unwrap()
}

#[test]
fn bright_light_is_near_the_exact_one_too() {
    let scene = dazzling();
    let camera = &scene.cameras[0].camera;
    for tone_map in [Some(ToneMap::None), Some(ToneMap::Neutral)] {
        let exact = render(&scene, camera, &Settings { tone_map, ..Settings::exact() }, SIZE);
        let share = share_off(&exact, &render(&scene, camera, &Settings { tone_map, ..interpolated() }, SIZE));
        assert!(share <= MOST, "{tone_map:?}: {:.3} % are off", share * 100.0);
    }
}

#[test]
fn cells_are_interpolated_and_see_what_is_there() {
    let scene = &our_scenes()[0];
    let camera = &scene.cameras[0].camera;
    let mut film = crate::picture_bits::film(SIZE);
    let stats =
        raywalk::render::render_frame(scene, camera, &interpolated(), &mut raywalk::render::Scratch::new(), &mut film);
    let pixels = stats.pixels;
    assert!(pixels.interpolated > u64::from(SIZE.0 * SIZE.1) / 4, "{pixels:?}");
    let sum = pixels.interpolated + pixels.certified + pixels.resolved + pixels.traced;
    assert_eq!(sum, u64::from(SIZE.0 * SIZE.1));
    // The planes are those of every pixel's own ray.
    let exact = render(scene, camera, &Settings::exact(), SIZE);
    for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
        assert_eq!(film.depth(x, y), exact.depth(x, y));
        assert_eq!(film.normal(x, y), exact.normal(x, y));
        assert_eq!(film.primitive(x, y), exact.primitive(x, y));
    }
}

#[test]
fn threads_and_instructions_keep_its_bits() {
    for scene in our_scenes() {
        let camera = &scene.cameras[0].camera;
        let expected = PictureBits::of(&render(&scene, camera, &interpolated(), (200, 113)));
        for (threads, simd) in [(3, SimdLevel::Auto), (1, SimdLevel::Off), (1, SimdLevel::Sse4), (1, SimdLevel::Avx2)] {
            if is_available(simd) {
                let settings = Settings { threads, simd, ..interpolated() };
                let found = PictureBits::of(&render(&scene, camera, &settings, (200, 113)));
                if let Some(difference) = expected.difference(&found) {
                    panic!("{}, {threads} threads, {simd:?}: {difference}", scene.name);
                }
            }
        }
    }
}
