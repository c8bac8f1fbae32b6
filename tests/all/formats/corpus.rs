//! The scenes of others, where they are at hand: all must draw something.

use super::picture;
use raywalk::scene::{LoadOptions, Scene, SceneError, load};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The files of a folder beside this project's whose names end in `extension`, folders within included; none where
/// that folder is not there.
fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    fn collect(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
        for path in std::fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                collect(&path, extension, found);
            } else if path.to_string_lossy().ends_with(extension) {
                found.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(folder);
    let mut found = Vec::new();
    collect(&root, extension, &mut found);
    found.sort();
    if found.is_empty() {
        eprintln!("skipped: {} is not there", root.display());
    }
    found
}

/// Loads a scene and draws it: there is more to see than its background.
fn drawn(path: &Path) -> Scene {
    let start = Instant::now();
    let scene = load(path, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let colours = picture(&scene, 64, 64).into_iter().collect::<BTreeSet<_>>().len();
    assert!(colours > 3, "{}: {colours} colours", path.display());
    assert!(start.elapsed() < Duration::from_secs(5), "{}: {:?}", path.display(), start.elapsed());
    scene
}

/// Files that hold points or lines only.
const NOTHING_TO_DRAW: [&str; 2] = ["testline.obj", "testpoints.obj"];

#[test]
fn obj_files_are_drawn() {
    for path in files("obj", ".obj").into_iter().chain(files("obj", ".obj.zst")) {
        if NOTHING_TO_DRAW.iter().any(|name| path.ends_with(name)) {
            let scene = load(&path, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
            assert!(scene.warnings.iter().any(|warning| warning.message.contains("no object")), "{}", path.display());
        } else {
            drawn(&path);
        }
    }
}

#[test]
fn damaged_obj_files_give_a_picture_or_one_clear_error() {
    for path in files("bad", ".obj") {
        let start = Instant::now();
        match load(&path, &LoadOptions::default()) {
            Ok(scene) => drop(picture(&scene, 64, 64)),
            Err(error) => {
                let SceneError::Invalid { place, message } = &error else { panic!("{error}") };
                assert!(place.line_column.is_some() && !message.contains('\n'), "{error}");
            }
        }
        assert!(start.elapsed() < Duration::from_secs(5), "{}: {:?}", path.display(), start.elapsed());
    }
}

#[test]
fn the_standard_procedural_databases_are_drawn_whole() {
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
    for path in files("spd", ".nff") {
        let scene = drawn(&path);
        let name = path.file_name().unwrap().to_str().unwrap();
        let (_, expected) = counts.iter().find(|(known, _)| *known == name).unwrap_or_else(|| panic!("{name}"));
        let of = |kinds: &[&str]| scene.objects.iter().filter(|object| kinds.contains(&object.kind)).count();
        let found = [of(&["sphere"]), of(&["cone", "cylinder"]), of(&["polygon"]), of(&["patch"]), scene.lights.len()];
        assert_eq!(found, *expected, "{name}");
    }
}
