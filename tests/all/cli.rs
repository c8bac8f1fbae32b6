//! The program as its users meet it: exit codes, files, and what is said where.

use super::temporary::Folder;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder in which the program runs.
pub(super) struct Bench(Folder);

impl Bench {
    pub(super) fn new() -> Self {
        Self(Folder::new())
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program with `line` as its arguments, with no display.
    pub(super) fn program(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_raywalk"));
        command.current_dir(self.0.path()).args(line.split_whitespace());
        for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(display);
        }
        command
    }

    pub(super) fn run(&self, line: &str) -> Output {
        self.program(line).output().expect("the program starts")
    }

    /// Runs `line`, expects success, and returns standard output.
    pub(super) fn done(&self, line: &str) -> String {
        let output = self.run(line);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", text(&output.stderr));
        text(&output.stdout)
    }

    /// Runs `line`, expects `code`, nothing on standard output and no new file, and returns what stderr says.
    pub(super) fn refused(&self, code: i32, line: &str) -> String {
        let before = self.names();
        let output = self.run(line);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line}: {said}");
        assert_eq!(text(&output.stdout), "", "{line}");
        assert_eq!(self.names(), before, "{line}: files were left behind");
        assert!(said.starts_with("error: ") && !said.contains("panicked"), "{line}: {said}");
        if code == 1 {
            assert_eq!(said.lines().count(), 1, "{line}: {said}");
        }
        said
    }

    pub(super) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        self.0.write(name, contents);
    }

    pub(super) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(super) fn json(&self, line: &str) -> Value {
        let out = self.done(line);
        serde_json::from_str(&out).unwrap_or_else(|error| panic!("{line}: {error}: {out}"))
    }

    pub(super) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("it exists");
        let mut names: Vec<_> =
            entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// A picture of one colour, but for its last pixel.
    pub(super) fn picture(&self, name: &str, (width, height): (u32, u32), color: [u8; 3], last: [u8; 3]) {
        let mut picture = image::RgbImage::from_pixel(width, height, image::Rgb(color));
        picture.put_pixel(width - 1, height - 1, image::Rgb(last));
        picture.save(self.path(name)).expect("writable");
    }
}

pub(super) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

pub(super) const SCENE: &str = r#"{ "version": 1, "render": { "width": 24, "height": 16 },
    "cameras": { "front": { "position": [0, 0, 5], "look_at": [0, 0, 0] },
                 "above": { "position": [0, 5, 0.1], "look_at": [0, 0, 0] } },
    "lights": [ { "type": "point", "position": [3, 5, 4] } ],
    "objects": [ { "type": "sphere", "center": [0, 0, 0], "radius": 1 } ] }"#;

const PATH: &str = r#"{ "version": 1, "fps": 4, "keys": [
    { "t": 0, "position": [0, 0, 5], "look_at": [0, 0, 0] }, { "t": 1, "position": [4, 0, 3], "look_at": [0, 0, 0] } ] }"#;

#[test]
fn wrong_usage_is_exit_2() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    for line in [
        "--frobnicate",
        "render --frobnicate",
        "render --bvh maybe",
        "render --stride 3",
        "render --threads many",
        "render --depth 0",
        "render --size 0x0",
        "render --size 64",
        "render --size 100000x100000",
        "render --eye 1,2",
        "render --fov 180",
        "render --frames 3..3",
        "render --preset slow",
        "render --limit speed=1",
        "render --limit objects=none",
        "render --aov depth -o a.png",
        "render --aov depth",
        "bench",
        "bench --stability --thesis -o out",
        "bench --stats - -o out",
        "bench --frames 0..3 -o out",
        "bench --quick --thesis -o out",
        "bench --stability --size 64x36 -o out",
        "bench scene.json --redraw -o out",
        "render --aov colour -o a.exr",
        "--aov depth",
        "--terminal",
        "render scene.json --camera nobody",
        "render scene.json --eye 0,0,0 --look-at 0,0,0",
        "render --path walk.json --eye 1,2,3",
        "render -o a.webp",
        "render -o picture",
        "compare a.png",
        "compare a.png b.png --diff d.exr",
        "info --bvh off",
    ] {
        bench.refused(2, line);
    }
    assert!(bench.refused(2, "render -o a.webp").contains(".png .jpg .bmp .ppm .exr"));
    assert!(bench.refused(2, "render scene.json --camera nobody").contains("front, above"));
}

#[test]
fn wrong_input_is_exit_1_with_one_line() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    bench.write("zero.json", r#"{ "version": 1, "render": { "width": 0, "height": 720 } }"#);
    let ball = r#"{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }"#;
    let huge = r#""render": { "width": 30000, "height": 30000 }"#;
    bench.write("huge.json", format!(r#"{{ "version": 1, {huge}, "objects": [ {ball} ] }}"#));
    bench.write("broken.json", "{ \"version\": 1,\n  \"objects\": [ { \"type\": \"sphere\", ] }");
    bench.write("path.json", r#"{ "version": 1, "keys": [] }"#);
    for (line, expected) in [
        ("no-such.json", "no-such.json"),
        ("render no-such.json", "no-such.json"),
        ("info no-such.json", "no-such.json"),
        ("render scene.txt", "scene.txt"),
        ("render zero.json", "zero.json"),
        ("render huge.json", "30000x30000"),
        ("render broken.json", "broken.json:2:"),
        ("render --path path.json -o a-%d.png", "path.json (/keys)"),
        ("render --path no-such.json -o a-%d.png", "no-such.json"),
        ("render scene.json -o no/such/folder/a.png", "no/such/folder/a.png"),
        ("render scene.json --stats no/such/folder/a.json", "no/such/folder/a.json"),
        ("compare no-such.png no-such.png", "no-such.png"),
        ("compare scene.json scene.json", "scene.json"),
    ] {
        let said = bench.refused(1, line);
        assert!(said.contains(expected), "{line}: {said}");
    }
}

#[test]
fn help_and_version_go_to_stdout() {
    let bench = Bench::new();
    assert!(bench.done("--help").contains("render"));
    assert!(bench.done("render --help").contains("--shadow-cache"));
    assert!(bench.done("--version").starts_with("raywalk "));
}

#[test]
fn every_format_is_written_whole_and_under_its_name_only() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let starts: [(&str, &[u8]); 5] = [
        ("a.png", b"\x89PNG"),
        ("a.jpg", &[0xff, 0xd8]),
        ("a.bmp", b"BM"),
        ("a.ppm", b"P3\n24 16\n255\n"),
        ("a.exr", &[0x76, 0x2f, 0x31, 0x01]),
    ];
    for (name, start) in starts {
        assert_eq!(bench.done(&format!("render scene.json -o {name}")), "");
        assert!(bench.read(name).starts_with(start), "{name}");
    }
    bench.done("render scene.json --binary -o raw.ppm");
    let raw = bench.read("raw.ppm");
    assert!(raw.starts_with(b"P6\n24 16\n255\n"));
    assert_eq!(raw.len(), 13 + 24 * 16 * 3);
    let text = text(&bench.read("a.ppm"));
    let values: Vec<u8> = text.split_whitespace().skip(4).map(|value| value.parse().expect("a byte")).collect();
    assert_eq!(values, raw[13..], "text and raw agree");
    assert_eq!(bench.names(), ["a.bmp", "a.exr", "a.jpg", "a.png", "a.ppm", "raw.ppm", "scene.json"]);

    // PNG and PPM hold the same picture, and the EXR is it before encoding.
    let png = image::open(bench.path("a.png")).expect("a picture").to_rgb8();
    assert_eq!(png.into_raw(), values);
    let scores = bench.json("compare a.png a.exr --json");
    assert!(scores["max_abs"].as_f64().expect("a number") < 0.6 / 255.0, "{scores}");
}

#[test]
fn planes_are_written_where_asked() {
    use exr::prelude::*;
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    bench.done("render scene.json --aov depth,normal,object,primitive -o a.exr");
    let image = read_first_flat_layer_from_file(bench.path("a.exr")).expect("an EXR");
    let channels = image.layer_data.channel_data.list;
    let names: Vec<_> = channels.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(names, ["B", "G", "R", "depth", "normal.X", "normal.Y", "normal.Z", "object", "primitive"]);

    // The scene's only sphere lies in the middle; the corner sees nothing.
    let (corner, middle) = (0, 8 * 24 + 12);
    let floats = |pixel| channels[3..7].iter().map(|c| c.sample_data.value_by_flat_index(pixel).to_f32()).collect();
    let missed: Vec<f32> = floats(corner);
    let seen: Vec<f32> = floats(middle);
    assert_eq!(missed, [f32::INFINITY, 0.0, 0.0, 0.0]);
    assert!((seen[0] - 4.0).abs() < 0.1 && seen[3] > 0.9, "{seen:?}");
    for (channel, hit) in channels[7..].iter().zip([0, 0]) {
        assert_eq!(channel.sample_data.value_by_flat_index(corner), Sample::U32(u32::MAX));
        assert_eq!(channel.sample_data.value_by_flat_index(middle), Sample::U32(hit));
    }
}

#[test]
fn a_path_makes_numbered_frames_and_a_still_view_one() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    bench.write("walk.json", PATH);
    let said = bench.refused(2, "render scene.json --path walk.json -o a.png");
    assert!(said.contains("%04d"), "{said}");

    bench.done("render scene.json --path walk.json -o walk-%04d.png");
    let frames = ["walk-0000.png", "walk-0001.png", "walk-0002.png", "walk-0003.png", "walk-0004.png"];
    assert_eq!(bench.names()[1..6], frames);
    bench.done("render scene.json --path walk.json --frames 2..4 -o part-%d.png");
    assert_eq!(bench.read("part-2.png"), bench.read("walk-0002.png"), "the same frames on every run");
    assert_eq!(bench.read("part-3.png"), bench.read("walk-0003.png"));
    assert_ne!(bench.read("part-2.png"), bench.read("part-3.png"));
    assert!(!bench.path("part-4.png").exists());

    bench.done("render scene.json --frames 0..3 -o still.png");
    bench.done("render scene.json -o once.png");
    assert_eq!(bench.read("still.png"), bench.read("once.png"));
}

#[test]
fn frames_past_the_end_of_a_path_are_warned_of_unless_quiet() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    bench.write("walk.json", PATH);
    let line = "render scene.json --path walk.json --frames 4..7";
    let said = text(&bench.run(line).stderr);
    assert!(said.starts_with("warning: walk.json") && said.contains("5 frames"), "{said}");
    assert_eq!(text(&bench.run(&format!("{line} --quiet")).stderr), "");
}

#[test]
fn cameras_are_named_counted_or_typed() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    for (name, line) in [
        ("named", "--camera above"),
        ("counted", "--camera 1"),
        ("typed", "--eye 0,5,0.1 --look-at 0,0,0"),
        ("first", ""),
        ("moved", "--eye -7,10,-10 --fov 30"),
    ] {
        bench.done(&format!("render scene.json {line} -o {name}.png"));
    }
    assert_eq!(bench.read("named.png"), bench.read("counted.png"));
    assert_eq!(bench.read("named.png"), bench.read("typed.png"));
    assert_ne!(bench.read("named.png"), bench.read("first.png"));
    assert_ne!(bench.read("moved.png"), bench.read("first.png"));
}

#[test]
fn stats_say_everything_promised() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let stats = bench.json("render scene.json --frames 0..3 --stats - --threads 2 --bvh off");
    for key in [
        "scene",
        "width",
        "height",
        "frames",
        "threads",
        "simd",
        "settings",
        "load_ms",
        "build_ms",
        "frame_ms",
        "cpu_ms",
        "rays",
        "pixels",
        "supersampled",
        "stages_ms",
        "shadow_cache",
        "peak_rss_bytes",
        "scene_bytes",
        "triangles",
        "spheres",
        "primitives",
        "lights",
        "objects",
    ] {
        assert!(stats.get(key).is_some(), "{key} is missing");
    }
    for row in raywalk::settings::ROWS {
        assert!(stats["settings"].get(row.name).is_some(), "{} is missing", row.name);
    }
    for (group, keys) in [
        ("frame_ms", &["min", "median", "p95", "p99", "max"][..]),
        ("cpu_ms", &["min", "median"]),
        ("rays", &["primary", "shadow", "reflection", "refraction"]),
        ("pixels", &["traced", "resolved", "certified", "interpolated"]),
        ("stages_ms", &["visibility", "certificate", "shadow", "shade", "secondary", "resolve", "present"]),
        ("shadow_cache", &["queries", "hits"]),
        (
            "certificates",
            &["certified_share", "false_reject_rate", "shadow_rays_lit", "shadow_rays_dark", "mirrored_rays"],
        ),
    ] {
        for key in keys {
            assert!(stats[group][key].is_number(), "{group}.{key}: {}", stats[group]);
        }
    }
    assert_eq!((&stats["width"], &stats["height"], &stats["frames"]), (&24.into(), &16.into(), &3.into()));
    assert_eq!((&stats["threads"], &stats["settings"]["bvh"]), (&2.into(), &"off".into()));
    assert_eq!(
        (&stats["spheres"], &stats["primitives"], &stats["lights"], &stats["objects"]),
        (&1.into(), &1.into(), &1.into(), &1.into())
    );
    let pixels = stats["pixels"].as_object().expect("an object").values();
    assert_eq!(pixels.map(|count| count.as_u64().expect("whole")).sum::<u64>(), 24 * 16);
    assert_eq!(stats["settings"]["depth"], 5, "resolved from the scene");
}

#[test]
fn stats_go_to_a_file_as_well() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    assert_eq!(bench.done("render scene.json --stats run.json -o a.png"), "");
    let stats: Value = serde_json::from_slice(&bench.read("run.json")).expect("JSON");
    assert_eq!(stats["frames"], 1);
    assert_eq!(bench.names(), ["a.png", "run.json", "scene.json"]);
}

#[test]
fn a_reference_tells_what_flickers() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    bench.write("walk.json", PATH);
    let measured = |flags: &str| {
        let line = format!("render scene.json --size 96x64 {flags} --reference full --stats -");
        let stats = bench.json(&line);
        (stats["motion"].clone(), stats["error"].clone())
    };
    let nothing = json!({ "excess_temporal_change": 0.0, "pops_mean": 0.0, "pops_max": 0, "frames": 5 });
    let no_error = json!({ "rmse": 0.0, "max_abs": 0.0, "pixels_off": 0.0 });
    assert_eq!(measured("--path walk.json"), (nothing.clone(), no_error.clone()), "exact");
    let rough = "--render-scale 0.25";
    let (motion, error) = measured(&format!("--path walk.json {rough}"));
    assert!(motion["excess_temporal_change"].as_f64() > Some(0.01), "{motion}");
    assert!(motion["pops_max"].as_f64() >= motion["pops_mean"].as_f64() && motion["pops_max"] != 0, "{motion}");
    assert!(error["rmse"].as_f64() > Some(0.0) && error["max_abs"].as_f64() > Some(2.0 / 255.0), "{error}");
    let (motion, error) = measured(&format!("--frames 0..5 {rough}"));
    assert_eq!(motion, nothing, "a still camera");
    assert_ne!(error, no_error);
    assert_eq!(measured("").0, Value::Null, "one frame does not move");

    let said = bench.refused(2, "render scene.json --reference full");
    assert!(said.contains("--stats"), "{said}");
    assert!(bench.json("render scene.json --stats -").get("motion").is_none());
}

#[test]
fn without_a_display_one_picture_is_written() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let output = bench.run("scene.json");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert_eq!(text(&output.stdout), "");
    assert!(said.lines().count() == 1 && said.contains("raywalk.png"), "{said}");
    assert_eq!(bench.names(), ["raywalk.png", "scene.json"]);
    bench.done("render scene.json -o rendered.png");
    assert_eq!(bench.read("raywalk.png"), bench.read("rendered.png"));
}

#[test]
fn warnings_are_told_silenced_or_made_errors() {
    let bench = Bench::new();
    bench.write("odd.json", SCENE.replacen("\"version\"", "\"colour\": 3, \"version\"", 1));
    let said = text(&bench.run("render odd.json").stderr);
    assert!(said.starts_with("warning: ") && said.contains("colour"), "{said}");
    assert_eq!(text(&bench.run("render odd.json --quiet").stderr), "");
    assert!(bench.refused(1, "render odd.json --strict").contains("colour"));
    assert!(bench.done("info odd.json").contains("colour"));
}

#[test]
fn info_describes_the_scene() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let info = bench.json("info scene.json --json");
    assert_eq!((&info["objects"], &info["objects_by_type"]["sphere"]), (&1.into(), &1.into()));
    assert_eq!(info["cameras"][0]["name"], "front");
    assert_eq!(info["bounds"]["max"], serde_json::json!([1.0, 1.0, 1.0]));
    assert!(info["pipeline"].as_array().is_some_and(|reasons| !reasons.is_empty()));
    let text = bench.done("info scene.json");
    for word in ["objects", "primitives", "materials", "lights", "cameras", "bounds", "memory", "pipeline", "warnings"]
    {
        assert!(text.contains(word), "{word}: {text}");
    }
    assert!(!bench.done("info").is_empty(), "the built-in scene");
    assert_eq!((&info["start"], &info["eye_height"]), (&"the file's camera".into(), &Value::Null));
    // Floor, ceiling and four walls of a room in centimetres.
    let walls = [[-300, -10, -300, 300, 0, 300], [-300, 280, -300, 300, 290, 300], [-300, 0, -310, 300, 280, -300]];
    let others = [[-300, 0, 300, 300, 280, 310], [-310, 0, -300, -300, 280, 300], [300, 0, -300, 310, 280, 300]];
    let wall = |[a, b, c, d, e, f]: [i32; 6]| {
        format!(r#"{{ "type": "box", "min": [{a}, {b}, {c}], "max": [{d}, {e}, {f}] }}"#)
    };
    let objects = walls.into_iter().chain(others).map(wall).collect::<Vec<_>>().join(", ");
    bench.write("room.json", format!(r#"{{ "version": 1, "objects": [{objects}] }}"#));
    let text = bench.done("info room.json");
    for line in ["start       on foot, 1.6 m above the floor (interior)", "unit        centimetres"] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let info = bench.json("info room.json --json");
    assert_eq!((&info["unit"], info["eye_height"].as_f64().map(f64::round)), (&"centimetres".into(), Some(160.0)));
}

#[test]
fn compare_measures_and_shows_differences() {
    let bench = Bench::new();
    bench.picture("a.png", (20, 15), [100, 100, 100], [100, 100, 100]);
    bench.picture("b.png", (20, 15), [100, 100, 100], [100, 151, 100]);
    bench.picture("c.png", (15, 20), [100, 100, 100], [100, 100, 100]);

    let same = bench.json("compare a.png a.png --json");
    assert_eq!(
        same,
        serde_json::json!({ "psnr": null, "rmse": 0.0, "max_abs": 0.0, "p999_abs": 0.0, "ssim": 1.0, "flip": 0.0,
                            "pixels_off": 0 })
    );
    let scores = bench.json("compare a.png b.png --json --diff d.png");
    assert!((scores["max_abs"].as_f64().expect("a number") - 0.2).abs() < 1e-6);
    let mse = 0.2 * 0.2 / (3.0 * 300.0);
    assert!((scores["psnr"].as_f64().expect("a number") + 10.0 * f64::log10(mse)).abs() < 1e-3);
    assert_eq!(scores["pixels_off"], 1);
    assert!(scores["flip"].as_f64().is_some_and(|flip| flip > 0.0));

    let difference = image::open(bench.path("d.png")).expect("a picture").to_rgb8();
    let (dark, bright) = (difference.get_pixel(0, 0), difference.get_pixel(19, 14));
    assert!(bright.0[0] > 200 && dark.0[0] < 80, "{dark:?} {bright:?}");

    assert!(bench.done("compare a.png b.png").contains("pixels_off  1"));
    assert_eq!(bench.json("compare a.png b.png --json --hdr")["flip"], Value::Null);
    let said = bench.refused(1, "compare a.png c.png");
    assert!(said.contains("20x15") && said.contains("15x20"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_failure() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let line = format!("{} info scene.json | true", env!("CARGO_BIN_EXE_raywalk"));
    let shell = Command::new("sh").args(["-c", &line]).current_dir(bench.0.path()).output().expect("a shell");
    assert_eq!(text(&shell.stderr), "");
    if Path::new("/dev/full").exists() {
        let line = format!("{} info scene.json > /dev/full", env!("CARGO_BIN_EXE_raywalk"));
        let shell = Command::new("sh").args(["-c", &line]).current_dir(bench.0.path()).output().expect("a shell");
        assert_eq!(shell.status.code(), Some(1));
        assert!(text(&shell.stderr).starts_with("error: cannot write to standard output"));
    }
}

#[test]
fn maps_are_pictures_of_eight_bits() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let mut pictures = Vec::new();
    for map in ["picture", "decisions", "cost", "depth", "normals", "objects", "error"] {
        bench.done(&format!("render scene.json --size 40x30 --preset balanced --map {map} -o {map}.png"));
        pictures.push(fs::read(bench.path(&format!("{map}.png"))).expect("it was written"));
    }
    assert!((1..pictures.len()).all(|i| !pictures[..i].contains(&pictures[i])), "two maps are alike");
    assert!(bench.refused(2, "render scene.json --map cost -o cost.exr").contains("--aov"));
    assert!(bench.refused(2, "render scene.json --map colour -o cost.png").contains("decisions"));
}
