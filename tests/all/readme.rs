//! README.md says what the program does: its scene loads and shows, its tables and flags are the program's own.

use super::temporary::Folder;
use raywalk::app::input::HELP;
use raywalk::measure::summary::Summary;
use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::LoadOptions;
use raywalk::settings::{Choice, Kind, PRESETS, Preset, ROWS, Row, Settings};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn readme() -> String {
    fs::read_to_string(root().join("README.md")).unwrap()
}

/// The lines between the first ```` ```json ```` and the end of its block.
fn starting_scene(readme: &str) -> &str {
    let (_, rest) = readme.split_once("```json\n").expect("a scene file to start from");
    rest.split_once("\n```").expect("its end").0
}

#[test]
fn the_scene_to_start_from_loads_without_a_warning_and_shows() {
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let scene = Folder::new().load(starting_scene(&readme()), &strict).unwrap_or_else(|error| panic!("{error}"));
    let mut film = Film::new(64, 36, Planes::default());
    render_frame(&scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::default(), &mut film);
    let colours: BTreeSet<[u8; 3]> = film.rgba().chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect();
    let bright = film.rgba().chunks_exact(4).filter(|p| p[..3].iter().any(|&c| c > 64)).count();
    assert!(bright > 64 * 36 / 2, "{bright} bright pixels");
    assert!(colours.len() > 200, "{} colours", colours.len());
}

/// A row of a table, as the README writes it.
fn line(cells: &[&str]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |", cells.join(" | "))
}

/// Values with what they promise, the default first: `` `on`, `off`: same pixels; `difference`: approximate ``.
fn values(row: &Row) -> String {
    match &row.kind {
        Kind::Choice(choices) => {
            let names =
                |group: &[Choice]| group.iter().map(|c| format!("`{}`", c.value)).collect::<Vec<_>>().join(", ");
            let groups = choices.chunk_by(|a, b| a.promise == b.promise);
            groups.map(|group| format!("{}: {}", names(group), group[0].promise)).collect::<Vec<_>>().join("; ")
        }
        Kind::Number { min, max, promise, .. } => {
            format!("{min} to {max}, `{}` by default: {promise}", (row.get)(&Settings::exact()))
        }
    }
}

/// The flags that make `preset` out of `exact`.
fn flags(preset: &Preset) -> String {
    let (exact, settings) = (Settings::exact(), (preset.settings)());
    let changed = ROWS.iter().filter(|row| (row.get)(&settings) != (row.get)(&exact));
    let flags: Vec<String> = changed.map(|row| format!("`--{} {}`", row.name, (row.get)(&settings))).collect();
    if flags.is_empty() { "every default".to_owned() } else { flags.join(" ") }
}

#[test]
fn its_tables_are_the_programs_own_lists() {
    let readme = readme();
    let settings = ROWS.iter().map(|row| line(&[&format!("`--{}`", row.name), &values(row), row.help]));
    let presets = PRESETS.iter().map(|preset| line(&[&format!("`{}`", preset.name), preset.help, &flags(preset)]));
    let keys = HELP.iter().map(|(keys, what)| line(&[keys, what]));
    let missing: Vec<String> =
        settings.chain(presets).chain(keys).filter(|wanted| !readme.lines().any(|line| line == wanted)).collect();
    assert!(missing.is_empty(), "README.md lacks these lines:\n{}", missing.join("\n"));
}

#[test]
fn what_methods_gain_and_lose_is_what_was_measured() {
    let measured = fs::read_to_string(root().join("scenes/pictures/methods.json")).unwrap();
    let summary: Summary = serde_json::from_str(&measured).unwrap();
    let readme = readme();
    let (begin, end) = Summary::MARKS;
    let (_, rest) = readme.split_once(begin).expect("the beginning of the table");
    let (table, _) = rest.split_once(end).expect("its end");
    assert_eq!(table, format!("\n{}", summary.table().markdown()));
    // What is promised to be the same picture was measured to be it.
    let exact = summary.methods.iter().find(|method| method.name == "exact").expect("measured");
    assert!(exact.pixels_off == 0.0 && exact.max_abs == 0.0 && exact.failures.is_empty(), "{exact:?}");
}

/// Everything in `text` that looks like a long flag.
fn long_flags(text: &str) -> BTreeSet<String> {
    let is_of_flag = |c: char| c.is_ascii_lowercase() || c == '-';
    let words = text.split(|c: char| !is_of_flag(c));
    words
        .filter(|word| word.len() > 3 && word.starts_with("--") && !word.starts_with("---"))
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_flag_it_names_exists() {
    let mut known = long_flags("--release --example --locked");
    for command in ["", "render", "bench", "tune", "info", "compare"] {
        let line = [command, "--help"].into_iter().filter(|word| !word.is_empty());
        let output = Command::new(env!("CARGO_BIN_EXE_raywalk")).args(line).output().unwrap();
        known.extend(long_flags(&String::from_utf8_lossy(&output.stdout)));
    }
    let named = long_flags(&readme());
    assert!(named.len() > ROWS.len(), "{named:?}");
    let unknown: Vec<_> = named.difference(&known).collect();
    assert!(unknown.is_empty(), "README.md names flags that do not exist: {unknown:?}");
}

#[test]
fn what_it_links_to_is_there() {
    let readme = readme();
    let links = readme.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target);
    let files: Vec<_> = links.filter(|target| !target.starts_with("http") && !target.starts_with('#')).collect();
    assert!(files.len() > 5, "{files:?}");
    for file in files {
        assert!(root().join(file).exists(), "{file}");
    }
}
