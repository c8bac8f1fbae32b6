//! Loads as others see them: what they tell, what they looked at, and how they end early.

use crate::temporary::Folder;
use raywalk::scene::progress::Stamp;
use raywalk::scene::{LoadOptions, Progress, SceneError, load};
use std::path::Path;
use std::time::{Duration, Instant};

fn told(progress: &Progress) -> LoadOptions {
    LoadOptions { progress: progress.clone(), ..LoadOptions::default() }
}

/// A heightfield of `side` x `side` quads as an OBJ file.
fn hills(side: usize) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for i in 0..=side {
        for j in 0..=side {
            writeln!(text, "v {i} {} {j}", (i * 7 + j * 13) % 17).expect("a string grows");
        }
    }
    for i in 0..side {
        for j in 1..=side {
            let corner = i * (side + 1) + j;
            writeln!(text, "f {corner} {} {} {}", corner + 1, corner + side + 2, corner + side + 1)
                .expect("a string grows");
        }
    }
    text
}

#[test]
fn a_load_tells_which_files_it_looked_at_found_or_not() {
    let folder = Folder::new();
    let scene = folder.write("room.obj", "mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    folder.write("room.mtl", "newmtl m\nmap_Kd missing.png\n");
    let progress = Progress::default();
    load(&scene, &told(&progress)).expect("a texture may be missing");
    let files = progress.files();
    let stamp = |name: &str| {
        let path = folder.path().join(name);
        let found = files.iter().find(|file| file.path == path || file.path == path.canonicalize().unwrap_or_default());
        found.map(|file| file.stamp)
    };
    for name in ["room.obj", "room.mtl"] {
        let now = Stamp::of(&folder.path().join(name));
        assert!(now.is_some() && stamp(name) == Some(now), "{name}: {files:?}");
    }
    assert!(files.iter().any(|file| file.path.ends_with("missing.png") && file.stamp.is_none()), "{files:?}");
}

#[test]
fn a_load_that_was_cancelled_before_it_began_is_cancelled_in_every_format() {
    let folder = Folder::new();
    let bad = folder.write("a.json", "nonsense");
    let objects = folder.write("b.json", r#"{ "version": 1, "objects": [{ "type": "box", "min": 0, "max": 1 }] }"#);
    let obj = folder.write("c.obj", hills(2));
    for file in [bad, objects, obj] {
        let progress = Progress::default();
        progress.cancel();
        let error = load(&file, &told(&progress)).expect_err("it was cancelled");
        assert!(matches!(error, SceneError::Cancelled { .. }), "{error}");
        assert!(error.to_string().ends_with("loading was cancelled"), "{error}");
    }
}

/// How long a load of `file` goes on after it is cancelled while it says that it is busy with `step`.
fn seconds_after_cancel(file: &Path, step: &str) -> f64 {
    // A load may be past that before it is noticed.
    let seconds = (0..100).find_map(|_| {
        let progress = Progress::default();
        std::thread::scope(|threads| {
            let loading = threads.spawn(|| load(file, &told(&progress)).map(|scene| scene.objects.len()));
            while !progress.step().what.starts_with(step) && !loading.is_finished() {
                std::thread::sleep(Duration::from_millis(1));
            }
            let start = Instant::now();
            progress.cancel();
            match loading.join().expect("a load does not panic") {
                Err(SceneError::Cancelled { .. }) => Some(start.elapsed().as_secs_f64()),
                Ok(_) => None,
                Err(error) => panic!("{step}: {error}"),
            }
        })
    });
    seconds.unwrap_or_else(|| panic!("{step}: no load can be cancelled"))
}

#[test]
fn a_load_ends_soon_after_it_is_cancelled() {
    let folder = Folder::new();
    let file = folder.write("hills.obj", hills(300));
    let start = Instant::now();
    load(&file, &LoadOptions::default()).expect("it loads");
    let whole = start.elapsed().as_secs_f64();
    for step in ["reading hills.obj", "building the tree"] {
        let seconds = seconds_after_cancel(&file, step);
        assert!(
            seconds < 2.0 * whole + 1.0,
            "{step}: {seconds:.2} s after the cancel; the whole load takes {whole:.2} s"
        );
    }
}
