//! The example that draws the first views of a folder's scenes.

#[path = "../../examples/contact_sheet/program/mod.rs"]
mod program;

use crate::cli::{Bench, SCENE};
use program::figures::Figures;
use program::sheet::{Layout, shortened, within};
use raywalk::measure::chart::text_width;
use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::settings::Settings;
use serde_json::Value;
use std::path::Path;
use std::sync::mpsc::channel;
use std::time::Duration;

/// Runs the example on a folder; the error is what it would end with.
fn run(folder: &Path, rest: &[&str]) -> Result<(), String> {
    let line = ["contact_sheet", folder.to_str().unwrap()].into_iter().chain(rest.iter().copied());
    let asked = program::command().try_get_matches_from(line).map_err(|error| error.to_string())?;
    program::run(&asked).map_err(|error| format!("{error:#}"))
}

/// Figures of a scene's first view.
fn figures(text: &str, (width, height): (u32, u32)) -> Figures {
    let scene = crate::temporary::load_text(text).unwrap();
    let mut film = Film::new(width, height, Planes { object: true, ..Planes::default() });
    render_frame(&scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::new(), &mut film);
    Figures::of(&scene, &film)
}

#[test]
fn a_sheet_shows_what_render_draws_and_why_a_file_cannot_be_drawn() {
    let bench = Bench::new();
    bench.write("scenes/ball.json", SCENE);
    bench.write("scenes/broken.gltf", "{");
    bench.write("scenes/models/tent.obj", "v -1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
    bench.write("scenes/notes.txt", "no scene");
    bench.write("scenes/package.json", r#"{ "name": "no scene" }"#);
    bench.write("scenes/walk.json", r#"{ "version": 1, "fps": 4, "keys": [] }"#);
    let (sheet, figures) = (bench.path("sheet.png"), bench.path("figures.json"));
    let (sheet, figures) = (sheet.to_str().unwrap(), figures.to_str().unwrap());
    run(&bench.path("scenes"), &["-o", sheet, "--size", "100x60", "--columns", "2", "--figures", figures]).unwrap();

    let layout = Layout { thumbnail: (100, 60), columns: 2, limit: Duration::ZERO };
    let picture = image::open(sheet).unwrap().to_rgb8();
    assert_eq!((picture.width(), picture.height()), (2 * 108 + 8, 2 * 88 + 8));
    let thumbnail = |index| {
        let (left, top) = layout.place(index);
        image::imageops::crop_imm(&picture, left, top, 100, 60).to_image()
    };
    for (index, file) in [(0, "scenes/ball.json"), (2, "scenes/models/tent.obj")] {
        bench.done(&format!("render {file} --size 100x60 -o one.png --quiet"));
        let one = image::open(bench.path("one.png")).unwrap().to_rgb8();
        assert!(thumbnail(index) == one, "{file}");
        assert!(one.pixels().any(|pixel| *pixel != *one.get_pixel(0, 0)), "{file} shows something");
    }
    let grey = thumbnail(1);
    assert_eq!(grey.get_pixel(0, 0).0, [0x77; 3]);
    assert!(grey.pixels().any(|pixel| pixel.0[0] > 0xc0), "it says why");
    for index in 0..3 {
        let (left, top) = layout.place(index);
        let name = image::imageops::crop_imm(&picture, left, top + 60, 100, 20).to_image();
        assert!(name.pixels().any(|pixel| pixel.0[0] < 0x80), "a name under {index}");
    }
    assert!(thumbnail(3).pixels().all(|pixel| pixel.0 == [255; 3]), "nothing more");

    let entries: Value = serde_json::from_slice(&bench.read("figures.json")).unwrap();
    let files: Vec<_> = entries.as_array().unwrap().iter().map(|entry| entry["file"].as_str().unwrap()).collect();
    assert_eq!(files, ["ball.json", "broken.gltf", "models/tent.obj"]);
    let own = [0, 1, 2].map(|index| entries[index]["figures"]["own_camera"].as_bool());
    assert_eq!(own, [Some(true), None, Some(false)]);
    let error = entries[1]["error"].as_str().unwrap();
    assert!(error.starts_with("1:") && !error.contains("broken.gltf"), "{error}");
}

#[test]
fn what_cannot_be_done_is_one_clear_error_and_no_file() {
    let bench = Bench::new();
    bench.write("empty/notes.txt", "");
    bench.write("one/ball.json", SCENE);
    let of = |folder: &str, output: &str, rest: &[&str]| {
        let output = bench.path(output);
        let error = run(&bench.path(folder), &[&["-o", output.to_str().unwrap()], rest].concat()).unwrap_err();
        assert!(!output.exists(), "{error}");
        error
    };
    assert!(of("empty", "a.png", &[]).contains("there is no scene file in it; known: .json"));
    assert!(of("nowhere", "a.png", &[]).contains("cannot read the folder"));
    assert!(of("one", "a.exr", &[]).contains("choose .png"));
    assert!(of("one", "a.webp", &[]).contains("unknown picture format"));
    assert!(of("one", "a.png", &["--size", "0x9"]).contains("expected width x height"));
    assert!(of("one", "a.png", &["--columns", "0"]).contains("--columns"));
    let layout = Layout { thumbnail: (4096, 4096), columns: 8, limit: Duration::ZERO };
    assert!(layout.size(9).unwrap_err().to_string().contains("choose a smaller --size"));
}

#[test]
fn figures_are_those_of_what_is_seen() {
    // A quarter of the picture: the left half of its width, half of its height.
    let scene = |emission: f32| {
        format!(
            r#"{{ "version": 1, "camera": {{ "position": [0, 0, 5], "look_at": [0, 0, 0], "fov": 90 }},
            "render": {{ "background": [0, 0, 0] }},
            "materials": {{ "lamp": {{ "ambient": 0, "diffuse": 0, "specular": 0, "emission": {emission} }} }},
            "objects": [ {{ "type": "rectangle", "corner": [-7.5, -2.5, 0], "edge_u": [7.5, 0, 0], "edge_v": [0, 5, 0],
            "material": "lamp" }} ] }}"#
        )
    };
    let seen = figures(&scene(0.25), (48, 32));
    assert_eq!((seen.dark, seen.width, seen.height), (0.75, 0.5, 0.5));
    assert!((seen.mean - 137.0 / 255.0).abs() < 1e-9 && seen.spread < 1e-6, "{seen:?}");
    assert_eq!((seen.own_camera, seen.on_foot, seen.eye_height), (true, false, None));
    assert_eq!((seen.ok, &seen.faults[..]), (false, &["black", "flat"][..]));
    assert_eq!(figures(&scene(0.0), (48, 32)).faults, ["black", "dark", "flat"]);
    assert_eq!(figures(&scene(1.0), (48, 32)).faults, ["black", "bright", "flat"]);
    assert_eq!(figures(r#"{ "version": 1 }"#, (48, 32)).faults, ["empty"]);
    let away = scene(1.0).replace("[0, 0, 0], \"fov", "[0, 0, 9], \"fov");
    let unseen = figures(&away, (48, 32));
    assert_eq!((unseen.width, unseen.height, &unseen.faults[..]), (0.0, 0.0, &["unseen"][..]));
}

#[test]
fn on_foot_the_eye_is_measured_from_the_floor() {
    let wall = |corner: [f32; 3], u: [f32; 3], v: [f32; 3]| {
        format!(r#"{{ "type": "rectangle", "corner": {corner:?}, "edge_u": {u:?}, "edge_v": {v:?} }}"#)
    };
    let ([x, y, z], corner, opposite) =
        ([[6.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 9.0]], [0.0; 3], [6.0, 3.0, 9.0]);
    let back = |edge: [f32; 3]| edge.map(|side| -side);
    let walls = [
        wall(corner, z, x),
        wall(corner, x, y),
        wall(corner, y, z),
        wall(opposite, back(x), back(z)),
        wall(opposite, back(y), back(x)),
        wall(opposite, back(z), back(y)),
    ];
    let seen = figures(&format!(r#"{{ "version": 1, "objects": [{}] }}"#, walls.join(",")), (48, 32));
    assert!(seen.on_foot && !seen.own_camera, "{seen:?}");
    assert!(seen.eye_height.is_some_and(|height| (height - 1.6).abs() < 0.01), "{seen:?}");
    assert!(!seen.faults.contains(&"eye") && seen.width == 1.0 && seen.height == 1.0, "{seen:?}");
}

#[test]
fn long_names_keep_both_ends() {
    assert_eq!(shortened("room.glb", 100.0), "room.glb");
    let name = "a/folder/with/a/long/name/Material_07.gltf";
    let short = shortened(name, 100.0);
    let (head, tail) = short.split_once('…').unwrap();
    assert!(name.starts_with(head) && name.ends_with(tail) && tail.len() >= head.len() && !head.is_empty(), "{short}");
    assert!(text_width(&short, 13.0) <= 100.0 && text_width(&short, 13.0) > 80.0, "{short}");
    assert_eq!(shortened(name, 1.0), "");
}

#[test]
fn what_takes_too_long_is_given_up_and_nothing_else() {
    let (give_up, given_up) = channel();
    let told = within(Duration::from_millis(1), move || give_up.send(()).unwrap(), || given_up.recv());
    assert_eq!(told, Ok(()));
    let (give_up, given_up) = channel();
    assert_eq!(within(Duration::from_secs(600), move || give_up.send(()).unwrap(), || 7), 7);
    assert!(given_up.recv().is_err(), "it was not called");
}
