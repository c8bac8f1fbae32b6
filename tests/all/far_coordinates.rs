//! Scenes far from the origin of their files: map coordinates, earth-centred ones, and small things in either.

use crate::cli::Bench;
use crate::picture_bits::render;
use glam::{DVec3, Vec3};
use raywalk::render::Film;
use raywalk::scene::{CameraPath, LoadOptions, Scene, load_text};
use raywalk::settings::Settings;
use std::path::Path;

/// Zone 32 of UTM, in the order east, height, north.
const UTM: DVec3 = DVec3::new(582_143.0, 312.0, 5_340_122.0);
/// Earth-centred, earth-fixed.
const ECEF: DVec3 = DVec3::new(4_207_465.0, 768_034.0, 4_716_583.0);

fn load(name: &str, text: &str) -> Scene {
    load_text(name, text, &LoadOptions { strict: true, ..LoadOptions::default() }).unwrap_or_else(|e| panic!("{e}"))
}

fn picture(scene: &Scene) -> Film {
    render(scene, &scene.cameras[0].camera, &scene.resolved(&Settings::exact()), (96, 64))
}

/// How many of the pixels of two pictures are visibly different.
fn pixels_off(a: &Film, b: &Film) -> usize {
    let pixels = a.rgba().chunks_exact(4).zip(b.rgba().chunks_exact(4));
    pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2)).count()
}

fn expect_alike(what: &str, near: &Scene, far: &Scene) {
    assert_eq!(near.origin, DVec3::ZERO, "{what}");
    assert_ne!(far.origin, DVec3::ZERO, "{what}");
    let (a, b) = (picture(near), picture(far));
    let differ = a.rgba().chunks_exact(4).filter(|pixel| **pixel != a.rgba()[..4]).count();
    assert!(differ > 50, "{what}: it is seen");
    let off = pixels_off(&a, &b);
    assert!(off < 96 * 64 / 100, "{what}: {off} pixels differ");
}

/// A fence of thin bars as an OBJ.
fn fence(at: DVec3, unit: f64) -> String {
    let mut text = String::new();
    for bar in 0..12 {
        let corners = [(0.0, 0.0), (0.05, 0.0), (0.05, 1.0), (0.0, 1.0)];
        for (x, y) in corners {
            let point = at + DVec3::new(f64::from(bar) * 0.1 + x, y, 0.0) * unit;
            text += &format!("v {:.4} {:.4} {:.4}\n", point.x, point.y, point.z);
        }
        text += "f -4 -3 -2 -1\n";
    }
    text
}

#[test]
fn a_small_mesh_looks_far_out_as_it_does_near() {
    for (unit, places) in [(1.0, [UTM, ECEF, DVec3::new(-58_214.0, 0.0, 53_401.0)]), (1000.0, [UTM * 1e3; 3])] {
        let near = load("near.obj", &fence(DVec3::ZERO, unit));
        for place in places {
            expect_alike(&format!("{place}"), &near, &load("far.obj", &fence(place, unit)));
        }
    }
}

#[test]
fn a_node_may_stand_far_out() {
    let gltf = |place: DVec3| {
        // Three corners of a triangle, 0 or 1 each.
        let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
        format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "scenes": [{{ "nodes": [0] }}],
                "nodes": [{{ "translation": [{}, {}, {}], "children": [1] }}, {{ "mesh": 0, "translation": [0.25, 0, 0] }}],
                "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0 }} }}] }}],
                "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }}],
                "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}],
                "buffers": [{{ "byteLength": 36, "uri": "data:application/octet-stream;base64,{data}" }}] }}"#,
            place.x, place.y, place.z
        )
    };
    let near = load("near.gltf", &gltf(DVec3::ZERO));
    expect_alike("glTF", &near, &load("far.gltf", &gltf(DVec3::new(4_207_465.5, 768_034.0, 4_716_583.5))));
}

/// Shapes with textures of their own, a light and a camera, all of them at `at`.
fn shapes(at: DVec3) -> String {
    let p = |x: f64, y: f64, z: f64| format!("[{}, {}, {}]", at.x + x, at.y + y, at.z + z);
    format!(
        r#"{{ "version": 1,
            "camera": {{ "position": {}, "look_at": {}, "fov": 50 }},
            "cameras": {{ "side": {{ "position": {}, "yaw": 90, "pitch": -5 }} }},
            "textures": {{ "squares": {{ "checker": [[0.9, 0.9, 0.9], [0.1, 0.2, 0.6]], "size": 0.25 }} }},
            "materials": {{ "tiled": {{ "color": {{ "texture": "squares" }}, "ambient": 0.3, "specular": 0 }} }},
            "lights": [{{ "type": "point", "position": {} }},
                {{ "type": "spot", "position": {}, "direction": [0, -1, 0] }}],
            "objects": [
                {{ "type": "rectangle", "corner": {}, "edge_u": [0, 0, 8], "edge_v": [8, 0, 0], "material": "tiled" }},
                {{ "type": "sphere", "center": {}, "radius": 0.5, "material": "tiled" }},
                {{ "type": "box", "min": {}, "max": {}, "material": "tiled" }},
                {{ "type": "cylinder", "base": {}, "top": {}, "radius": 0.1, "material": "tiled" }},
                {{ "type": "group", "transform": {{ "translate": {}, "rotate": [0, 0, 0] }}, "children": [
                    {{ "type": "disk", "center": [0, 0, 0], "normal": [0.48, 0.6, 0.64], "radius": 0.4, "material": "tiled" }} ] }} ] }}"#,
        p(1.0, 2.5, 5.0),
        p(0.0, 0.4, 0.0),
        p(3.0, 1.0, 0.5),
        p(2.0, 5.0, 3.0),
        p(-1.0, 4.0, 1.0),
        p(-4.0, 0.0, -4.0),
        p(-1.0, 0.6, 0.0),
        p(0.3, 0.0, -0.3),
        p(0.8, 1.3, 0.4),
        p(1.4, 0.0, 0.5),
        p(1.4, 0.15, 0.5),
        p(0.0, 0.6, 1.2),
    )
}

#[test]
fn shapes_textures_lights_and_cameras_move_together() {
    let near = load("near.json", &shapes(DVec3::ZERO));
    for place in [DVec3::new(582_143.0, 0.0, 5_340_122.0), DVec3::new(582_143.0, 6e6, -5_340_122.0)] {
        let far = load("far.json", &shapes(place));
        expect_alike("shapes", &near, &far);
        let [a, b] = [&near, &far]
            .map(|scene| render(scene, &scene.cameras[1].camera, &scene.resolved(&Settings::exact()), (96, 64)));
        assert!(pixels_off(&a, &b) < 96 * 64 / 100, "{} pixels differ from the side", pixels_off(&a, &b));
    }
}

#[test]
fn what_is_wide_for_its_distance_stays_where_it_is() {
    let scene = load("a.json", &shapes(DVec3::new(300.0, 0.0, -500.0)));
    assert_eq!((scene.origin, scene.objects[0].bounds.min), (DVec3::ZERO, Vec3::new(296.0, 0.0, -504.0)));
    // Something at the origin beside something far away: nothing can be moved.
    let both = shapes(UTM)
        .replace(r#""objects": ["#, r#""objects": [ { "type": "sphere", "center": [0, 0, 0], "radius": 1 }, "#);
    let options = LoadOptions::default();
    assert_eq!(load_text("both.json", &both, &options).map(|scene| scene.origin).ok(), Some(DVec3::ZERO));
}

#[test]
fn models_move_with_the_scene() {
    let bench = Bench::new();
    bench.write("fence.obj", fence(UTM, 1.0));
    bench.write("scene.json", r#"{ "version": 1, "objects": [{ "type": "model", "file": "fence.obj" }] }"#);
    bench.write("near.obj", fence(DVec3::ZERO, 1.0));
    bench.write("near.json", r#"{ "version": 1, "objects": [{ "type": "model", "file": "near.obj" }] }"#);
    for scene in ["scene", "near"] {
        bench.done(&format!("render {scene}.json --strict --size 96x64 -o {scene}.png"));
    }
    let compared = bench.json("compare scene.png near.png --json");
    assert!(compared["pixels_off"].as_u64().is_some_and(|off| off < 60), "{compared}");
}

#[test]
fn cameras_are_read_and_told_in_the_coordinates_of_the_file() {
    let bench = Bench::new();
    let (far, near) = (DVec3::new(582_143.0, 0.0, 5_340_122.0), DVec3::ZERO);
    for (name, place) in [("far", far), ("near", near)] {
        let p = |x: f64, y: f64, z: f64| format!("{},{},{}", place.x + x, place.y + y, place.z + z);
        let (eye, look_at) = (p(2.0, 1.5, 3.5), p(0.0, 0.5, 0.25));
        bench.write(&format!("{name}.json"), shapes(place));
        bench.write(
            &format!("{name}-path.json"),
            format!(
                r#"{{ "version": 1, "keys": [{{ "t": 0, "position": [{eye}], "look_at": [{look_at}], "fov": 50 }}] }}"#
            ),
        );
        bench.done(&format!("render {name}.json --size 96x64 --eye {eye} --look-at {look_at} -o {name}.png"));
        bench.done(&format!("render {name}.json --size 96x64 --path {name}-path.json -o {name}-path.png"));
    }
    for pair in ["far.png near.png", "far-path.png near-path.png", "far.png far-path.png"] {
        let compared = bench.json(&format!("compare {pair} --json"));
        assert!(compared["pixels_off"].as_u64().is_some_and(|off| off < 60), "{pair}: {compared}");
    }
    let info = bench.json("info far.json --json");
    assert_eq!(info["cameras"][0]["eye"], serde_json::json!([582_144.0, 2.5, 5_340_127.0]));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    assert!((number(&info["bounds"]["min"][0]) - 582_139.0).abs() < 1e-3, "{}", info["bounds"]);
    assert!((number(&info["origin"][2]) - 5_340_122.0).abs() < 16.0, "{}", info["origin"]);
    assert!(bench.done("info far.json").contains("far from the file's origin"));
    assert_eq!(bench.json("info near.json --json")["origin"], serde_json::Value::Null);
    assert!(!bench.done("info near.json").contains("origin"));
}

#[test]
fn a_path_is_the_same_wherever_it_is_written_for() {
    let key = |x: f64| format!(r#"{{ "t": {x}, "position": [{x}, 1, 5], "look_at": [0, 1, 0], "fov": 60 }}"#);
    let text = format!(r#"{{ "version": 1, "fps": 10, "keys": [{}, {}, {}] }}"#, key(0.0), key(1.0), key(2.5));
    let path = CameraPath::parse(&text, Path::new("walk.json")).expect("a path");
    let moved = CameraPath::parse(&path.clone().moved(UTM).to_json(), Path::new("walk.json")).expect("a path");
    for frame in 0..25 {
        let base = Default::default();
        let [near, far] = [path.camera(frame, &base, DVec3::ZERO), moved.camera(frame, &base, UTM)];
        assert!(near.eye.abs_diff_eq(far.eye, 1e-6) && near.look_at.abs_diff_eq(far.look_at, 1e-6), "{near:?} {far:?}");
    }
}
