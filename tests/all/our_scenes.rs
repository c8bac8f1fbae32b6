//! The scenes that come with the program: they load without a warning, and every camera shows a picture.

use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::{LoadOptions, Scene, load};
use raywalk::settings::Settings;
use std::path::{Path, PathBuf};

/// Every scene file in `scenes/`, loaded so that a warning is an error.
fn scenes() -> impl Iterator<Item = (PathBuf, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    files.filter(|file| file.extension().is_some_and(|e| e == "json")).map(move |file| {
        let scene = load(&file, &strict).unwrap_or_else(|error| panic!("{error}"));
        (file, scene)
    })
}

#[test]
fn no_camera_sees_a_dark_or_burnt_out_picture() {
    const SIZE: (u32, u32) = (64, 36);
    let mut seen = 0;
    for (file, scene) in scenes() {
        for view in &scene.cameras {
            let mut film = Film::new(SIZE.0, SIZE.1, Planes::default());
            render_frame(&scene, &view.camera, &Settings::exact(), &mut Scratch::default(), &mut film);
            let share = |test: fn(u8) -> bool| {
                let pixels = film.rgba().chunks_exact(4);
                pixels.filter(|pixel| pixel[..3].iter().all(|&c| test(c))).count() as f64 / f64::from(SIZE.0 * SIZE.1)
            };
            let (black, white) = (share(|c| c < 8), share(|c| c == 255));
            let place = format!("{}, camera {}", file.display(), view.name);
            // The thesis's base scene has a black sky; nothing else is dark for the most part.
            assert!(black < 0.5, "{place}: {:.0} % black", black * 100.0);
            assert!(white < 0.05, "{place}: {:.0} % white", white * 100.0);
            seen += 1;
        }
    }
    assert!(seen >= 5, "only {seen} cameras: are the scenes there?");
}

#[test]
fn the_sphereflake_has_all_its_spheres() {
    let (_, flake) = scenes().find(|(file, _)| file.ends_with("sphereflake.json")).unwrap();
    let spheres: Vec<_> = flake.objects.iter().filter(|object| object.kind == "sphere").collect();
    assert_eq!(spheres.len(), 7381);
    // The whole series fits a ball of radius 0.5 (1 + 2/3 + 2/9 + 2/27 + 2/81).
    let reach = 0.5 * (1.0 + 2.0 * (1.0 / 3.0 + 1.0 / 9.0 + 1.0 / 27.0 + 1.0 / 81.0));
    for sphere in spheres {
        assert!(sphere.bounds.center().length() + 0.5 * sphere.bounds.size().x < reach + 1e-4, "{:?}", sphere.bounds);
    }
}
