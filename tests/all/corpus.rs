//! Files that others made, where they lie beside the project: good ones are drawn, bad ones are told of.

use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::{FORMATS, LoadOptions, Scene, SceneError, load};
use raywalk::settings::Settings;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time that a file may take: on a machine that has nothing else to do it is to be a fourth of that.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// Files that hold nothing but points and lines.
const NOTHING_TO_DRAW: [&str; 3] = ["testline.obj", "testpoints.obj", "omi_physics_shape/"];

/// The scene files in a folder of the data beside the project, if there is one. JSON is everybody's format.
fn files(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(folder);
    let extensions = FORMATS.iter().filter(|format| format.name != "JSON").flat_map(|format| format.extensions);
    let endings: Vec<String> = extensions.map(|extension| format!(".{extension}")).collect();
    let mut waiting = vec![root.clone()];
    let mut files = Vec::new();
    while let Some(folder) = waiting.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let name = path.to_string_lossy().to_lowercase();
            if path.is_dir() {
                waiting.push(path);
            } else if endings.iter().any(|ending| name.ends_with(ending)) {
                files.push(path);
            }
        }
    }
    if files.is_empty() {
        println!("skipped: {} is not there", root.display());
    }
    files.sort();
    files
}

/// How many pixels of a small picture show a surface, be it black.
fn seen(scene: &Scene) -> usize {
    let mut film = Film::new(64, 36, Planes { depth: true, ..Planes::default() });
    render_frame(scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::new(), &mut film);
    let pixels = (0..36).flat_map(|y| (0..64).map(move |x| (x, y)));
    pixels.filter(|&(x, y)| film.depth(x, y).is_some_and(f32::is_finite)).count()
}

/// Whether an error is that of a kind of file that cannot be shown at all, or of one that leaves nothing to show.
fn is_expected(error: &SceneError) -> bool {
    let text = error.to_string();
    text.contains("draco")
        || text.contains("meshopt")
        || text.contains("glTF version 2.1")
        || text.contains("box-incomplete-positions.obj")
}

fn draw_all(folder: &str) {
    for file in files(folder) {
        let (start, name) = (Instant::now(), file.display());
        match load(&file, &LoadOptions::default()) {
            Err(error) => assert!(is_expected(&error), "{error}"),
            Ok(scene) => {
                let is_empty = NOTHING_TO_DRAW.iter().any(|empty| file.to_string_lossy().contains(empty))
                    || scene.warnings.iter().any(|warning| warning.message.contains("points and lines"))
                    || !std::fs::read(&file).unwrap().windows(12).any(|text| text == b"\"primitives\"");
                assert!(seen(&scene) > 0 || (scene.objects.is_empty() && is_empty), "{name} shows nothing");
            }
        }
        assert!(start.elapsed() < PATIENCE, "{name} took {:?}", start.elapsed());
    }
}

#[test]
fn every_good_gltf_file_is_drawn() {
    draw_all("gltf");
}

#[test]
fn every_good_obj_file_is_drawn() {
    draw_all("obj");
}

#[test]
fn the_standard_procedural_databases_are_drawn_whole() {
    draw_all("spd");
    // Spheres, cones and cylinders, polygons, patches, lights.
    let counts = [
        ("balls_s2.nff", [91, 0, 1, 0, 3]),
        ("balls_s4.nff", [7381, 0, 1, 0, 3]),
        ("gears_s1.nff", [0, 0, 147, 0, 5]),
        ("mount_s3.nff", [4, 0, 128, 0, 1]),
        ("mount_s6.nff", [4, 0, 8192, 0, 1]),
        ("rings_s2.nff", [150, 150, 1, 0, 3]),
        ("teapot_s3.nff", [0, 0, 9, 552, 2]),
        ("tetra_s3.nff", [0, 0, 64, 0, 1]),
        ("tree_s4.nff", [31, 31, 1, 0, 7]),
        ("tree_s5_tess.nff", [0, 0, 1, 8316, 7]),
    ];
    for path in files("spd") {
        let scene = load(&path, &LoadOptions::default()).unwrap();
        let Some((name, expected)) = counts.iter().find(|(name, _)| path.ends_with(name)) else { continue };
        let of = |kinds: &[&str]| scene.objects.iter().filter(|object| kinds.contains(&object.kind)).count();
        let found = [of(&["sphere"]), of(&["cone", "cylinder"]), of(&["polygon"]), of(&["patch"]), scene.lights.len()];
        assert_eq!(found, *expected, "{name}");
    }
}

#[test]
fn every_bad_file_gives_a_picture_or_one_clear_error_in_time() {
    for file in files("bad") {
        let (start, name) = (Instant::now(), file.display());
        match load(&file, &LoadOptions::default()) {
            Ok(scene) => drop(seen(&scene)),
            Err(error) => {
                let text = error.to_string();
                assert!(!text.contains('\n') && text.len() < 1000 && text.contains(&*name.to_string()), "{text}");
            }
        }
        assert!(start.elapsed() < PATIENCE, "{name} took {:?}", start.elapsed());
    }
}

/// The program itself on a file, in a gibibyte of memory: it ends by itself, with one line if it fails.
#[cfg(target_os = "linux")]
pub fn told_within_a_gibibyte(file: &Path) -> String {
    let script = "ulimit -v 1048576; exec \"$0\" render --quiet --size 16x16 --threads 1 --stats - \"$1\"";
    let mut shell = std::process::Command::new("sh");
    let output = shell.args(["-c", script, env!("CARGO_BIN_EXE_raywalk")]).arg(file).output().unwrap();
    let (name, told) = (file.display(), String::from_utf8_lossy(&output.stderr).into_owned());
    match output.status.code() {
        Some(0) => assert!(told.is_empty(), "{name}: {told}"),
        Some(1) => assert!(told.starts_with("error: ") && told.trim_end().lines().count() == 1, "{name}: {told}"),
        code => panic!("{name} ends with {code:?}: {told}"),
    }
    told
}

#[cfg(target_os = "linux")]
#[test]
fn the_program_survives_every_bad_file_within_a_gibibyte() {
    for file in files("bad") {
        told_within_a_gibibyte(&file);
    }
}

/// Files that ask for many more vertices than they hold bytes of.
#[cfg(target_os = "linux")]
#[test]
fn what_asks_for_too_many_vertices_is_survived_within_a_gibibyte() {
    let folder = crate::temporary::Folder::new();
    let gltf = |accessors: &[String], primitives: &[String], rest: &str| {
        format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "accessors": [{}], "meshes": [{{ "primitives": [{}] }}],
            "nodes": [{{ "mesh": 0 }}], "scenes": [{{ "nodes": [0] }}], "scene": 0 {rest} }}"#,
            accessors.join(","),
            primitives.join(",")
        )
    };
    let zeros = |_| r#"{ "componentType": 5126, "count": 4194304, "type": "VEC3" }"#.to_owned();
    let zeros: Vec<String> = (0..30).map(zeros).collect();
    let each = |i| format!(r#"{{ "attributes": {{ "POSITION": {i} }} }}"#);
    let of_each: Vec<String> = (0..30).map(each).collect();
    let told = told_within_a_gibibyte(&folder.write("zeros.gltf", gltf(&zeros, &of_each, "")));
    assert!(told.contains("without a bufferView"), "{told}");

    // Nothing but a hole on most disks; as numbers, more than there is memory for.
    let buffer = folder.write("hole.bin", "");
    std::fs::File::options().write(true).open(buffer).unwrap().set_len(180_000_000).unwrap();
    let bytes = r#", "buffers": [{ "uri": "hole.bin", "byteLength": 180000000 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 180000000 }]"#;
    let many = r#"{ "bufferView": 0, "componentType": 5120, "count": 60000000, "type": "VEC3" }"#;
    let told = told_within_a_gibibyte(&folder.write("hole.gltf", gltf(&[many.to_owned()], &[each(0)], bytes)));
    assert!(told.contains("there is no memory for 60000000 vertices"), "{told}");
}
