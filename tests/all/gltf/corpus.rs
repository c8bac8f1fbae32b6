//! Files that others made, where they lie beside the project: good ones are drawn, bad ones are told of.

use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::{LoadOptions, Scene, SceneError, load};
use raywalk::settings::Settings;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time that a bad file may take.
const PATIENCE: Duration = Duration::from_secs(5);

/// The glTF files in a folder of the data beside the project, if there is one.
fn files(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(folder);
    let mut waiting = vec![root.clone()];
    let mut files = Vec::new();
    while let Some(folder) = waiting.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let name = path.to_string_lossy().to_lowercase();
            if path.is_dir() {
                waiting.push(path);
            } else if name.ends_with(".gltf") || name.ends_with(".glb") {
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

/// How many pixels of a small picture show anything.
fn seen(scene: &Scene) -> usize {
    let mut film = Film::new(64, 36, Planes { depth: true, ..Planes::default() });
    render_frame(scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::new(), &mut film);
    let lit = film.rgba().chunks_exact(4).filter(|pixel| pixel[..3] != [0; 3]);
    lit.count()
}

/// Whether an error is that of a kind of file that cannot be shown at all.
fn is_expected(error: &SceneError) -> bool {
    let text = error.to_string();
    text.contains("draco") || text.contains("glTF version 2.1")
}

#[test]
fn every_good_file_is_drawn() {
    for file in files("gltf") {
        let name = file.display();
        match load(&file, &LoadOptions::default()) {
            Err(error) => assert!(is_expected(&error), "{error}"),
            Ok(scene) => {
                let only_lines = || scene.warnings.iter().any(|warning| warning.message.contains("points and lines"));
                assert!(seen(&scene) > 0 || (scene.objects.is_empty() && only_lines()), "{name} shows nothing");
            }
        }
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
