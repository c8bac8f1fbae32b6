//! `full` against a plain tracer in double precision, written from the contract's words alone.
//!
//! Colours and depths must agree. Where they do not, an edge, a shadow's border or the like must pass so close to the
//! pixel's centre that f32 may see the other side of it; how many pixels that concerns is bounded.

mod scenes;

use crate::gltf::sides;
use crate::picture_bits::render;
use crate::stress;
use crate::temporary::{Folder, load_text};
use crate::tracer::{Seen, Tracer};
use glam::{DVec2, DVec3, Vec3};
use raywalk::scene::{Camera, LoadOptions, Scene};
use raywalk::settings::{Settings, Visibility};

const SIZE: (u32, u32) = (64, 48);
/// How far linear colours may be apart, in parts of the larger of 1 and the colour.
const TOLERANCE: f64 = 1e-3;
/// How near, in pixels, a ray that follows another path must pass for a difference to be excused.
const NEAR: f64 = 0.02;

/// What a comparison found.
struct Comparison {
    /// Share of pixels that differ.
    differing: f64,
    /// Of these, the ones that no edge explains.
    wrong: Vec<String>,
}

fn compare(scene: &Scene, camera: Camera, settings: &Settings) -> Comparison {
    let film = render(scene, &camera, settings, SIZE);
    let tracer = Tracer::new(scene, camera, settings);
    let (mut wrong, mut differing) = (Vec::new(), 0);
    for (x, y) in pixels() {
        let center = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let expected = tracer.look(center, SIZE);
        let found = Vec3::from(film.color(x, y)).as_dvec3();
        let depth = f64::from(film.depth(x, y).unwrap());
        let far = expected.depth != depth && (expected.depth - depth).abs() > TOLERANCE * expected.depth.max(1.0);
        let off = (found - expected.color).abs() / expected.color.abs().max(DVec3::ONE);
        if !far && off.max_element() <= TOLERANCE {
            continue;
        }
        differing += 1;
        let around = (0..12).map(|i| DVec2::from_angle(f64::from(i)) * NEAR * f64::from(1 + i % 3) / 3.0);
        if around.map(|by| tracer.look(center + by, SIZE)).all(|near| near.path == expected.path) {
            let Seen { color, depth: expected, .. } = expected;
            wrong.push(format!("({x}, {y}): {found} at {depth} instead of {color} at {expected}"));
        }
    }
    Comparison { differing: f64::from(differing) / pixels().count() as f64, wrong }
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)))
}

/// Compares all cameras of a scene. No more than the share `differing` of the pixels may differ, and all of these for a
/// reason.
fn check(name: &str, scene: &Scene, settings: &Settings, differing: f64) -> Vec<String> {
    let mut problems = Vec::new();
    for camera in &scene.cameras {
        let found = compare(scene, camera.camera, settings);
        let name = format!("{name}, camera {}", camera.name);
        println!("{name}: {:.3} % differ", found.differing * 100.0);
        if let Some(first) = found.wrong.first() {
            problems
                .push(format!("{name}: {} pixels differ without a reason, the first is {first}", found.wrong.len()));
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
        problems.extend(check(name, &scene, &Settings::exact(), 0.004));
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
        problems.extend(check(&format!("depth {depth}"), &scene, &settings, 0.004));
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn crowds_of_everything_agree_but_for_few_pixels() {
    let mut problems = Vec::new();
    for (name, scene) in stress::scenes() {
        if ["crowd", "only a headlight", "many lights"].contains(&name.as_str()) {
            // Glass in glass shows many edges a pixel.
            problems.extend(check(&name, &scene, &Settings::exact(), 0.02));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn one_sided_surfaces_are_seen_where_they_should_be() {
    let scene = sides::matte();
    assert!(scene.geometry.one_sided);
    let problems = check("sides", &scene, &Settings::exact(), 0.02);
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
    let apart = |&(x, y): &(u32, u32)| !Vec3::from(a.color(x, y)).abs_diff_eq(Vec3::from(b.color(x, y)), 1e-4);
    let count = pixels().filter(apart).count();
    assert!(count <= 3, "{count} pixels differ");
}

#[test]
fn the_reference_notices_a_difference() {
    let scene = load_text(scenes::all()[0].1.to_string()).unwrap();
    let settings = Settings { visibility: Visibility::Full, shadows: false, ..Settings::exact() };
    let found = compare(&scene, scene.cameras[0].camera, &settings);
    assert!(!found.wrong.is_empty(), "shadows are missing and nobody saw it");
}
