//! `--supersample adaptive`: each pixel is that of one ray or that of `--supersample 16`, chosen the same way by every
//! path to the same picture.

use crate::picture_bits::{PictureBits, film, render};
use crate::temporary::load_text;
use raywalk::render::{Film, Scratch, render_frame};
use raywalk::scene::{LoadOptions, Scene, load};
use raywalk::settings::{Fill, Settings, Supersample, Visibility};
use std::path::Path;

/// Several tiles, the last ones cut off.
const SIZE: (u32, u32) = (150, 83);

fn adaptive() -> Settings {
    Settings { supersample: Supersample::Adaptive, ..Settings::exact() }
}

fn sixteen() -> Settings {
    Settings { supersample: Supersample::Grid { side: 4 }, ..Settings::exact() }
}

fn scenes() -> impl Iterator<Item = Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let names = ["base", "cornell", "gallery", "mirrors", "sphereflake"];
    names.into_iter().map(move |name| load(&folder.join(name).with_extension("json"), &LoadOptions::default()).unwrap())
}

fn colors(film: &Film) -> Vec<[u32; 3]> {
    let pixels = (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    pixels.map(|(x, y)| film.color(x, y).map(f32::to_bits)).collect()
}

/// Root mean square error of pictures as shown, of 255.
fn rmse(a: &Film, b: &Film) -> f64 {
    let squares = a.rgba().iter().zip(b.rgba()).map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2));
    // The fourth byte is always the same.
    (squares.sum::<f64>() / (a.rgba().len() / 4 * 3) as f64).sqrt()
}

#[test]
fn pixels_are_those_of_one_ray_or_of_sixteen() {
    for scene in scenes() {
        for view in &scene.cameras {
            let mut film = film(SIZE);
            let stats = render_frame(&scene, &view.camera, &adaptive(), &mut Scratch::new(), &mut film);
            let one = render(&scene, &view.camera, &Settings::exact(), SIZE);
            let sixteen = render(&scene, &view.camera, &sixteen(), SIZE);
            let all = colors(&film).into_iter().zip(colors(&one)).zip(colors(&sixteen));
            let (mut neither, mut refined) = (0, 0);
            for ((color, one), sixteen) in all {
                neither += u32::from(color != one && color != sixteen);
                refined += u64::from(color != one);
            }
            let name = format!("{}, camera {}", scene.name, view.name);
            assert_eq!(neither, 0, "{name}");
            // Samples may add up to the centre's colour.
            assert!(refined > 0 && refined <= stats.supersampled, "{name}: {refined} of {}", stats.supersampled);
            assert!(stats.supersampled < u64::from(SIZE.0 * SIZE.1), "{name}");
            let pixels = stats.pixels;
            assert_eq!(pixels.traced + pixels.resolved + pixels.certified, u64::from(SIZE.0 * SIZE.1), "{name}");
            let error = rmse(&film, &sixteen);
            assert!(error < 1.5, "{name}: {error}");
        }
    }
}

#[test]
fn every_path_refines_the_same_pixels() {
    let more_threads = Settings { threads: 3, ..adaptive() };
    let one_thread = Settings { threads: 1, ..adaptive() };
    let full = Settings { visibility: Visibility::Full, ..adaptive() };
    let brute_force = Settings { bvh: false, ..full.clone() };
    for scene in scenes() {
        let camera = scene.cameras[0].camera;
        let expected = PictureBits::of(&render(&scene, &camera, &one_thread, SIZE));
        for settings in [&more_threads, &full, &brute_force] {
            let picture = PictureBits::of(&render(&scene, &camera, settings, SIZE));
            assert_eq!(expected.difference(&picture), None, "{}, {settings:?}", scene.name);
        }
    }
}

#[test]
fn planes_are_those_of_the_centres() {
    let scene = scenes().next().unwrap();
    let camera = scene.cameras[0].camera;
    let (fine, plain) = (render(&scene, &camera, &adaptive(), SIZE), render(&scene, &camera, &Settings::exact(), SIZE));
    for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
        assert_eq!(fine.depth(x, y).map(f32::to_bits), plain.depth(x, y).map(f32::to_bits));
        assert_eq!(fine.normal(x, y), plain.normal(x, y));
        assert_eq!(fine.object(x, y), plain.object(x, y));
        assert_eq!(fine.primitive(x, y), plain.primitive(x, y));
    }
}

#[test]
fn approximate_visibility_is_refined_too() {
    for scene in scenes() {
        let camera = scene.cameras[0].camera;
        let sixteen = render(&scene, &camera, &sixteen(), SIZE);
        for fill in [Fill::Hit, Fill::Color] {
            let one = Settings { visibility: Visibility::Subsample, fill, ..Settings::exact() };
            let fine = Settings { supersample: Supersample::Adaptive, ..one.clone() };
            let errors = [one, fine].map(|settings| rmse(&render(&scene, &camera, &settings, SIZE), &sixteen));
            assert!(errors[1] < errors[0], "{}, {fill:?}: {errors:?}", scene.name);
        }
    }
}

/// A wire a third of a pixel thick, all across the picture; it lies on a pixel's centre here and there.
fn wire() -> Scene {
    let text = r#"{ "version": 1, "camera": { "position": [0, 0, 10], "look_at": [0, 0, 0], "fov": 45 },
        "materials": { "white": { "ambient": 1, "diffuse": 0, "specular": 0 } },
        "objects": [ { "type": "cylinder", "base": [-9, -1.03, 0], "top": [9, 1.08, 0], "radius": 0.016,
                       "material": "white" } ] }"#;
    load_text(text).unwrap()
}

#[test]
fn a_thin_wire_is_followed_across_tiles() {
    let scene = wire();
    let camera = scene.cameras[0].camera;
    let one = render(&scene, &camera, &Settings::exact(), SIZE);
    let (fine, all) = (render(&scene, &camera, &adaptive(), SIZE), render(&scene, &camera, &sixteen(), SIZE));
    let columns_lit =
        |film: &Film| (0..SIZE.0).filter(|&x| (0..SIZE.1).any(|y| film.color(x, y) != [0.0; 3])).count() as u32;
    assert!(columns_lit(&one) < SIZE.0 / 2, "{} columns: the wire is no test", columns_lit(&one));
    assert_eq!(columns_lit(&fine), columns_lit(&all));
    assert!(colors(&fine) == colors(&all));
}

#[test]
fn a_cancelled_frame_says_so_and_leaves_nothing_behind() {
    let scene = wire();
    let camera = scene.cameras[0].camera;
    let (mut scratch, mut film) = (Scratch::new(), film(SIZE));
    scratch.cancel.cancel();
    assert!(!render_frame(&scene, &camera, &adaptive(), &mut scratch, &mut film).completed);
    scratch.cancel.reset();
    assert!(render_frame(&scene, &camera, &adaptive(), &mut scratch, &mut film).completed);
    assert!(colors(&film) == colors(&render(&scene, &camera, &adaptive(), SIZE)));
}
