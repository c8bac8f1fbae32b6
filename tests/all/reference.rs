//! `full` against a plain tracer in double precision, written from the contract's words alone.
//!
//! Where a pixel and its neighbours two pixels around follow the same path (the same objects, lights and bodies met), the
//! colours must agree. Elsewhere an edge may fall on either side of a pixel's centre; how many pixels that concerns is bounded.

mod scenes;
mod shapes;
mod surface_color;
mod tracer;

use crate::picture_bits::render;
use crate::stress;
use crate::temporary::{Folder, load_text};
use glam::{DVec3, Vec3};
use raywalk::scene::{Camera, LoadOptions, Scene};
use raywalk::settings::{Settings, Visibility};
use tracer::{Seen, Tracer};

const SIZE: (u32, u32) = (64, 48);
/// How far linear colours may be apart, in parts of the larger of 1 and the colour.
const TOLERANCE: f64 = 1e-3;
/// How far a pixel's neighbours lie that must follow the same path.
const AWAY: u32 = 2;

/// What a comparison found.
#[derive(Debug)]
struct Comparison {
    /// Share of pixels whose neighbourhood follows one path.
    calm: f64,
    /// Of these, pixels that differ.
    wrong: Vec<String>,
    /// Share of all pixels that differ.
    differing: f64,
}

fn compare(scene: &Scene, camera: Camera, settings: &Settings) -> Comparison {
    let (width, height) = SIZE;
    let film = render(scene, &camera, settings, SIZE);
    let tracer = Tracer::new(scene, camera, settings);
    let pixels: Vec<(u32, u32)> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
    let expected: Vec<Seen> = pixels.iter().map(|&pixel| tracer.pixel(pixel, SIZE)).collect();
    let seen = |x: u32, y: u32| &expected[(y * width + x) as usize];
    let (mut calm, mut wrong, mut differing) = (0, Vec::new(), 0);
    for &(x, y) in &pixels {
        let own = seen(x, y);
        let found = Vec3::from(film.color(x, y)).as_dvec3();
        let scale = own.color.abs().max(DVec3::ONE);
        let depth = f64::from(film.depth(x, y).unwrap());
        let far = own.depth != depth && (own.depth - depth).abs() > TOLERANCE * own.depth.max(1.0);
        let differs = far || ((found - own.color) / scale).abs().max_element() > TOLERANCE || !found.is_finite();
        differing += usize::from(differs);
        let columns = x.saturating_sub(AWAY)..(x + AWAY + 1).min(width);
        let is_calm = columns
            .flat_map(|x| (y.saturating_sub(AWAY)..(y + AWAY + 1).min(height)).map(move |y| (x, y)))
            .all(|(x, y)| seen(x, y).path == own.path);
        if is_calm {
            calm += 1;
            if differs {
                wrong.push(format!("({x}, {y}): {found} at {depth} instead of {} at {}", own.color, own.depth));
            }
        }
    }
    let share = |count: usize| count as f64 / pixels.len() as f64;
    Comparison { calm: share(calm), wrong, differing: share(differing) }
}

/// Compares all cameras of a scene. Of the calm pixels none may differ; `calm` of them there must be, and of all pixels
/// no more than `differing` may differ.
fn check(name: &str, scene: &Scene, settings: &Settings, calm: f64, differing: f64) -> Vec<String> {
    let mut problems = Vec::new();
    for camera in &scene.cameras {
        let found = compare(scene, camera.camera, settings);
        let name = format!("{name}, camera {}", camera.name);
        println!("{name}: {:.1} % calm, {:.3} % differ", found.calm * 100.0, found.differing * 100.0);
        if let Some(first) = found.wrong.first() {
            problems.push(format!("{name}: {} calm pixels differ, the first is {first}", found.wrong.len()));
        }
        if found.calm < calm {
            problems.push(format!("{name}: only {:.1} % of the pixels are calm", found.calm * 100.0));
        }
        if found.differing > differing {
            problems.push(format!("{name}: {:.2} % of the pixels differ", found.differing * 100.0));
        }
    }
    problems
}

/// A small picture whose texels all differ.
fn write_picture(folder: &Folder) {
    let texels: Vec<u8> = (0..6 * 4 * 3).map(|i: u32| (i * 67 % 251) as u8).collect();
    let path = folder.write("picture.png", "");
    image::save_buffer_with_format(path, &texels, 6, 4, image::ExtendedColorType::Rgb8, image::ImageFormat::Png)
        .unwrap();
}

#[test]
fn full_draws_what_the_contract_says() {
    let folder = Folder::new();
    write_picture(&folder);
    let mut problems = Vec::new();
    for (name, text) in scenes::all() {
        let scene = folder.load(text.to_string(), &LoadOptions { strict: true, ..LoadOptions::default() });
        let scene = scene.unwrap_or_else(|error| panic!("{name}: {error}"));
        problems.extend(check(name, &scene, &Settings::exact(), 0.25, 0.01));
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn switches_and_the_depth_limit_do_what_they_say() {
    let folder = Folder::new();
    write_picture(&folder);
    let mut problems = Vec::new();
    let text = scenes::all().into_iter().find(|(name, _)| *name == "nested glass").unwrap().1;
    let scene = folder.load(text.to_string(), &LoadOptions::default()).unwrap();
    for depth in [1, 2, 3, 8] {
        let settings = Settings { depth: Some(depth), ..Settings::exact() };
        problems.extend(check(&format!("depth {depth}"), &scene, &settings, 0.25, 0.01));
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn crowds_of_everything_agree_but_for_few_pixels() {
    let mut problems = Vec::new();
    for (name, scene) in stress::scenes() {
        if ["crowd", "only a headlight", "many lights"].contains(&name.as_str()) {
            problems.extend(check(&name, &scene, &Settings::exact(), 0.0, 0.02));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn a_group_draws_what_its_objects_draw_in_their_places() {
    // Turned by 90 degrees about y (x goes to -z), doubled, moved.
    let grouped = r#"{ "version": 1, "camera": { "position": [0, 3, 9], "look_at": [0, 1, 0] },
        "lights": [ { "type": "point", "position": [5, 8, 7] } ],
        "objects": [ { "type": "group", "transform": { "translate": [1, 0, 0], "rotate": [0, 90, 0], "scale": 2 }, "children": [
            { "type": "sphere", "center": [1, 0, 0], "radius": 0.5 },
            { "type": "cone", "base": [0, 0, 0], "top": [0, 1, 0], "radius": 0.4 },
            { "type": "box", "min": [-1, 0, 0], "max": [-0.5, 0.5, 1] },
            { "type": "disk", "center": [0, 0, -1], "normal": [1, 0, 0], "radius": 0.5 } ] } ] }"#;
    let written_out = r#"{ "version": 1, "camera": { "position": [0, 3, 9], "look_at": [0, 1, 0] },
        "lights": [ { "type": "point", "position": [5, 8, 7] } ],
        "objects": [ { "type": "sphere", "center": [1, 0, -2], "radius": 1 },
            { "type": "cone", "base": [1, 0, 0], "top": [1, 2, 0], "radius": 0.8 },
            { "type": "box", "min": [1, 0, 1], "max": [3, 1, 2] },
            { "type": "disk", "center": [-1, 0, 0], "normal": [0, 0, -1], "radius": 1 } ] }"#;
    let [a, b] = [grouped, written_out].map(|text| {
        let scene = load_text(text).unwrap();
        render(&scene, &scene.cameras[0].camera, &Settings::exact(), SIZE)
    });
    let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
    let apart = |&(x, y): &(u32, u32)| !Vec3::from(a.color(x, y)).abs_diff_eq(Vec3::from(b.color(x, y)), 1e-4);
    let count = pixels.filter(apart).count();
    assert!(count <= 3, "{count} pixels differ");
}

#[test]
fn the_reference_notices_a_difference() {
    let scene = load_text(scenes::all()[0].1.to_string()).unwrap();
    let settings = Settings { visibility: Visibility::Full, shadows: false, ..Settings::exact() };
    let found = compare(&scene, scene.cameras[0].camera, &settings);
    assert!(!found.wrong.is_empty(), "shadows are missing and nobody saw it");
}
