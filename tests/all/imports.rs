//! Who may import whom: each room only those before it, so that each part can be tested alone.

use std::fs;
use std::path::{Path, PathBuf};

/// The rooms from the ground up. A room may import those before it.
const ROOMS: &[&str] = &["settings", "math", "geometry", "scene", "render", "picture", "measure", "app"];
/// What only the window may know of.
const WINDOW_CRATES: &[&str] =
    &["winit", "wgpu", "egui", "egui_winit", "egui_wgpu", "egui_plot", "notify", "rfd", "termina"];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the sources are there").map(|entry| entry.expect("readable").path());
    entries
        .flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect()
}

/// The sources of each room, with the room's place in the order.
fn rooms() -> Vec<(usize, PathBuf)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    sources(&root)
        .into_iter()
        .filter_map(|path| {
            let inside = path.strip_prefix(&root).expect("it lies there");
            let room = inside.components().next()?.as_os_str().to_str()?.trim_end_matches(".rs").to_owned();
            let place = ROOMS.iter().position(|name| *name == room)?;
            Some((place, path))
        })
        .collect()
}

/// The lines of a file that are code, with their numbers.
fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())).filter(|(_, line)| !line.starts_with("//"))
}

/// The identifiers that follow `prefix` in a line; those in braces one by one.
fn names_after<'a>(line: &'a str, prefix: &str) -> Vec<&'a str> {
    let identifier = |text: &'a str| text.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
    line.split(prefix)
        .skip(1)
        .flat_map(|rest| match rest.strip_prefix('{') {
            Some(list) => list.split(['}', ';']).next().unwrap_or_default().split(',').map(str::trim).collect(),
            None => vec![rest],
        })
        .map(identifier)
        .collect()
}

#[test]
fn no_room_imports_one_above_it() {
    let rooms = rooms();
    assert!(rooms.len() > 20, "the sources were not found");
    let mut wrong = Vec::new();
    for (place, path) in &rooms {
        let text = fs::read_to_string(path).expect("readable");
        for (number, line) in code(&text) {
            for name in names_after(line, "crate::") {
                if ROOMS.iter().position(|room| *room == name).is_some_and(|imported| imported > *place) {
                    wrong.push(format!("{}:{number}: {} imports {name}", path.display(), ROOMS[*place]));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn only_the_window_knows_of_windows() {
    let app = ROOMS.iter().position(|room| *room == "app").expect("it is a room");
    let mut wrong = Vec::new();
    for (place, path) in rooms() {
        let text = fs::read_to_string(&path).expect("readable");
        for (number, line) in code(&text) {
            let mentions =
                |name: &&&str| line.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == **name);
            if let Some(name) = WINDOW_CRATES.iter().find(mentions).filter(|_| place < app) {
                wrong.push(format!("{}:{number}: mentions {name}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn imports_are_found_in_every_form() {
    assert_eq!(names_after("use crate::scene::Scene;", "crate::"), ["scene"]);
    assert_eq!(names_after("use crate::{app::Walker, render};", "crate::"), ["app", "render"]);
    assert_eq!(names_after("let x = crate::math::f(crate::app::y());", "crate::"), ["math", "app"]);
    assert!(names_after("use std::fs;", "crate::").is_empty());
}
