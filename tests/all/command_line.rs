//! What can be typed, and what is said and written then.

use super::cli::{Bench, SCENE, text};

/// A path from one side of the ball to the other, straight above it in the middle.
const OVER: &str = r#"{ "version": 1, "fps": 10, "keys": [
    { "t": 0, "position": [0, 1.5, 5], "look_at": [0, 0.5, 0] }, { "t": 1, "position": [0, 1.5, -5], "look_at": [0, 0.5, 0] } ] }"#;

#[test]
fn a_path_that_looks_along_up_is_rendered_whole_or_refused_at_once() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    bench.write("over.json", OVER);
    bench.done("render scene.json --path over.json -o f%02d.png");
    assert_eq!(bench.names().iter().filter(|name| name.starts_with('f')).count(), 11);
    // One frame alone is the same as among others.
    bench.done("render scene.json --path over.json --frames 5..7 -o again%02d.png");
    assert_eq!(bench.read("f05.png"), bench.read("again05.png"));

    bench.write("down.json", OVER.replace("5],", "0],").replace("-0],", "0],"));
    let said = bench.refused(1, "render scene.json --path down.json -o g%02d.png");
    assert!(said.contains("frame 0"), "{said}");
    // Good at first, and at last at its own position.
    bench.write("into.json", OVER.replace("[0, 1.5, -5]", "[0, 0.5, 0]"));
    let said = bench.refused(1, "render scene.json --path into.json -o g%02d.png");
    assert!(said.contains("frame 10"), "{said}");
}

#[test]
fn from_elsewhere_a_scene_without_a_camera_is_seen_by_the_usual_lens() {
    let bench = Bench::new();
    bench
        .write("ball.json", r#"{ "version": 1, "objects": [{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }] }"#);
    let view = "render ball.json --size 64x36 --eye 0,1,4 --look-at 0,0,0";
    bench.done(&format!("{view} -o as_usual.png"));
    bench.done(&format!("{view} --fov 60 -o sixty.png"));
    bench.done("render ball.json --size 64x36 -o framed.png");
    bench.done("render ball.json --size 64x36 --fov 60 -o wider.png");
    assert_eq!(bench.read("as_usual.png"), bench.read("sixty.png"));
    assert_ne!(bench.read("framed.png"), bench.read("wider.png"), "the lens that frames it is longer");
}

#[test]
fn a_folder_stands_for_the_scene_in_it() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("room")).expect("a folder");
    let said = bench.refused(1, "info room");
    assert!(said.contains("no scene file"), "{said}");
    bench.write("room/scene.json", SCENE);
    bench.write("room/walk.json", OVER);
    bench.done("render room -o a.png");
    bench.done("render room/scene.json -o b.png");
    assert_eq!(bench.read("a.png"), bench.read("b.png"));
    assert_eq!(bench.done("info room"), bench.done("info room/scene.json"));
    assert!(bench.json("render room --stats - --quiet")["scene"].as_str().is_some_and(|name| name.contains("scene")));
    assert_eq!(bench.run("room --quiet").status.code(), Some(0), "as the window would open it");
    assert_eq!(bench.read("raywalk.png"), bench.read("a.png"));
    bench.write("room/other.json", SCENE);
    for line in ["render room", "info room", "room", "tune room --max-error flip=0.1", "bench room -o out"] {
        let said = bench.refused(1, line);
        assert!(said.contains("other.json, scene.json"), "{line}: {said}");
    }
}

#[test]
fn a_word_that_is_no_file_but_like_a_command_is_taken_for_one() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    for (line, meant) in [
        ("rend", "render"),
        ("rend scene.json -o a.png", "render"),
        ("Render scene.json", "render"),
        ("redner", "render"),
        ("rendering", "render"),
        ("benchmark -o out", "bench"),
        ("inof scene.json", "info"),
        ("comp a.png b.png", "compare"),
        ("tuen scene.json", "tune"),
    ] {
        let said = bench.refused(2, line);
        assert!(said.contains(&format!("did you mean raywalk {meant}?")), "{line}: {said}");
    }
    // What is like no command, or has the name of a scene, is a scene that is missing.
    for line in ["kitchen", "rend.json", "x"] {
        assert!(!bench.refused(1, line).contains("did you mean"), "{line}");
    }
    bench.write("rend", "");
    assert!(!bench.refused(1, "rend").contains("did you mean"), "there is such a file");
}

#[test]
fn render_without_an_output_says_what_it_did() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let output = bench.run("render scene.json");
    let said = text(&output.stderr);
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), String::new()));
    assert!(said.lines().count() == 1 && said.starts_with("rendered 1 frame of "), "{said}");
    assert!(["scene", "24x16", " ms", "-o "].iter().all(|part| said.contains(part)), "{said}");
    let said = text(&bench.run("render scene.json --frames 0..3").stderr);
    assert!(said.starts_with("rendered 3 frames of ") && said.contains("median"), "{said}");
    assert_eq!(text(&bench.run("render scene.json --quiet").stderr), "");
    assert_eq!(text(&bench.run("render scene.json -o a.png").stderr), "");
}

#[test]
fn the_largest_picture_is_a_limit() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let said = bench.refused(2, "render scene.json --size 100x50 --limit picture-pixels=4999 -o a.png");
    assert!(said.contains("100x50: more than the limit picture-pixels of 4999; raise it with --limit"), "{said}");
    bench.done("render scene.json --size 100x50 --limit picture-pixels=5000 -o a.png");
    let said = bench.refused(2, "render scene.json --size 9000x9000 -o b.png");
    assert!(said.contains("--limit picture-pixels=N"), "{said}");
    bench.write("large.json", SCENE.replace("\"width\": 24, \"height\": 16", "\"width\": 100, \"height\": 50"));
    let said = bench.refused(1, "render large.json --limit picture-pixels=4999 -o b.png");
    assert!(said.contains("picture-pixels"), "{said}");
    let said = bench.refused(1, "compare a.png a.png --limit picture-pixels=4999");
    assert!(said.contains("a.png") && said.contains("--limit picture-pixels=N"), "{said}");
    bench.done("compare a.png a.png --limit picture-pixels=5000");
}

#[cfg(unix)]
#[test]
fn what_is_overwritten_keeps_its_mode() {
    use std::fs;
    use std::os::unix::fs::PermissionsExt;
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    for line in ["render scene.json -o f", "render scene.json --quiet --stats f", "compare a.png a.png --diff f"] {
        bench.done("render scene.json -o a.png");
        let (file, line) = if line.contains("stats") {
            ("f.json", line.replace(" f", " f.json"))
        } else {
            ("f.png", line.replace(" f", " f.png"))
        };
        for mode in [0o600, 0o640, 0o755] {
            bench.write(file, "");
            fs::set_permissions(bench.path(file), fs::Permissions::from_mode(mode)).expect("ours");
            bench.done(&line);
            let metadata = fs::metadata(bench.path(file)).expect("there");
            assert!(metadata.len() > 0 && metadata.permissions().mode() & 0o7777 == mode, "{line}: {metadata:?}");
        }
    }
}

#[test]
fn the_former_name_of_a_value_still_works() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let stats = bench.json("render scene.json --sphere-cache thesis --stats -");
    assert_eq!(stats["settings"]["sphere-cache"], "difference");
    let said = bench.refused(2, "render scene.json --sphere-cache other");
    assert!(said.contains("difference") && !said.contains("thesis"), "{said}");
}
