//! Benches: what was measured is never measured again, and what is drawn can be read.

use super::temporary::Folder;
use raywalk::measure::bench::{Bench, BenchError, Listener};
use raywalk::measure::records::{Environment, Part, Records, RecordsError};
use raywalk::measure::summary::Summary;
use raywalk::measure::sweep::{Effort, Job, View, affordable_size, by_primitives, of_scene};
use raywalk::measure::{page, stability, thesis};
use raywalk::render::CancelToken;
use raywalk::scene::{Camera, LoadOptions, load_text};
use raywalk::settings::Settings;
use resvg::usvg;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

const SCENE: &str = r#"{ "version": 1, "camera": { "position": [0, 1, 4], "look_at": [0, 0, 0] },
    "lights": [ { "type": "point", "position": [3, 5, 4] } ],
    "objects": [ { "type": "sphere", "center": [0, 0, 0], "radius": 1 },
                 { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0] } ] }"#;

const TINY: Effort = Effort { name: "tiny", quick: true, rounds: 1, cameras: 2, scene: Duration::from_secs(20) };

/// Stops a bench at a step.
struct StopAt(u64, CancelToken);

impl Listener for StopAt {
    fn at(&self, done: u64, _: &str) {
        if done >= self.0 {
            self.1.cancel();
        }
    }
}

fn environment() -> Environment {
    Environment::here(&Settings::exact(), TINY.name)
}

/// A scene, looked at in pictures of 64x36.
fn view() -> View {
    let scene = Arc::new(load_text("a & <b>.json", SCENE, &LoadOptions::default()).expect("a valid scene"));
    let camera = scene.cameras[0].camera;
    let (name, camera_name) = ("a & <b>".to_owned(), "default".to_owned());
    View { name, scene, camera_name, camera, path: Vec::new(), size: (128, 72) }
}

fn jobs() -> Vec<Job> {
    of_scene(&view(), &Settings::exact(), &TINY)
}

/// Runs `jobs` until step `stop`.
fn run(folder: &Path, jobs: &[Job], stop: u64) -> Result<Records, BenchError> {
    let records = Records::resume(folder, environment())?;
    let token = CancelToken::default();
    let listener = StopAt(stop, token.clone());
    let mut bench = Bench::new(folder.to_owned(), records, token, &listener);
    bench.run(jobs)?;
    Ok(bench.records)
}

fn load(folder: &Path) -> Records {
    Records::load(folder).expect("readable").expect("there are records")
}

#[test]
fn errors_are_held_against_a_picture_without_approximations() {
    let (view, base) = (view(), Settings::fast());
    let jobs = of_scene(&view, &base, &TINY).into_iter().chain(stability::jobs(&base, &TINY).expect("valid scenes"));
    let jobs = jobs.chain(thesis::jobs(&view, &base));
    for job in jobs.chain(by_primitives(&base, &TINY).expect("valid scenes")) {
        let reference = match &job {
            Job::Compare(job) => &job.reference.settings,
            Job::Walk(job) => &job.reference,
        };
        assert_eq!(*reference, reference.reference());
    }
}

#[test]
fn a_bench_that_was_stopped_goes_on_and_measures_nothing_twice() {
    let (folder, jobs) = (Folder::new(), jobs());
    let mut last = 0;
    for stop in [4, 25, 60] {
        let stopped = run(folder.path(), &jobs, stop);
        assert!(matches!(stopped, Err(BenchError::Interrupted)), "step {stop}: {stopped:?}");
        let rows = load(folder.path()).rows.len();
        assert!(rows > last, "{rows} rows at step {stop}, {last} before");
        last = rows;
        // What a killed process leaves behind.
        folder.write(".records.json.7-0.part", "{ \"version\": 1, \"rows\": [");
    }
    let kept: Vec<_> = load(folder.path()).rows.into_iter().filter(|row| row.complete).collect();
    assert!(!kept.is_empty());
    let records = run(folder.path(), &jobs, u64::MAX).expect("nothing stops it");
    for row in kept {
        assert!(records.rows.contains(&row), "{:?} was measured again", row.key);
    }
    assert!(records.rows.iter().all(|row| row.complete));
    assert_eq!(run(folder.path(), &jobs, u64::MAX).expect("nothing is left to do"), load(folder.path()));
    let leftovers = fs::read_dir(folder.path())
        .expect("it exists")
        .filter(|file| file.as_ref().expect("readable").file_name().to_string_lossy().ends_with(".part"));
    assert_eq!(leftovers.count(), 0);
}

#[test]
fn records_of_another_machine_or_program_are_not_mixed() {
    let folder = Folder::new();
    let mut other = environment();
    other.machine = "abacus".to_owned();
    Records::new(other).save(folder.path()).expect("writable");
    let refused = Records::resume(folder.path(), environment()).expect_err("another machine");
    assert!(matches!(refused, RecordsError::Differs { .. }));
    let text = refused.to_string();
    assert!(text.contains("abacus") && text.contains("choose another folder") && text.lines().count() == 1, "{text}");
    let foreign = Folder::new();
    foreign.write("index.html", "a page of somebody's");
    let refused = Records::resume(foreign.path(), environment()).expect_err("a page without records").to_string();
    assert!(refused.contains("index.html") && refused.lines().count() == 1, "{refused}");
    folder.write("records.json", "{ \"version\": 1");
    let damaged = Records::resume(folder.path(), environment()).expect_err("cut off").to_string();
    assert!(damaged.contains("records.json") && damaged.lines().count() == 1, "{damaged}");
}

#[test]
fn what_others_left_in_a_folder_stays() {
    let folder = Folder::new();
    folder.write("index.html", "a page of somebody's");
    let others = [".film.part", ".records.json.7-0.part"].map(|name| folder.write(name, "half"));
    assert!(Records::resume(folder.path(), environment()).is_err());
    assert!(others.iter().all(|file| file.exists()), "a folder that is refused is left alone");
    Records::new(environment()).save(folder.path()).expect("writable");
    assert!(Records::resume(folder.path(), environment()).is_ok());
    assert_eq!(others.map(|file| file.exists()), [true, false], "only our own goes");
}

#[test]
fn slow_methods_are_cut_off_and_never_what_they_are_held_against() {
    let folder = Folder::new();
    let mut jobs = jobs();
    jobs.truncate(1);
    for job in &mut jobs {
        if let Job::Compare(job) = job {
            job.longest_frame = Duration::ZERO;
            job.view.size = (640, 360);
        }
    }
    let records = run(folder.path(), &jobs, u64::MAX).expect("nothing stops it");
    let measures = || records.rows.iter().filter(|row| ["full", "exact"].contains(&row.key.method.as_str()));
    assert_eq!(measures().count(), 2);
    assert!(measures().all(|row| row.cut_off_ms.is_none() && !row.error.is_empty()));
    page::draw(&records, folder.path()).expect("writable");
    assert!(fs::read_to_string(folder.path().join("index.html")).expect("written").contains("Time against error"));
}

#[test]
fn a_view_that_is_slow_is_measured_smaller() {
    let (view, base) = (View { size: (1280, 720), ..view() }, Settings::exact());
    let patient = Effort { scene: Duration::from_secs(3600), ..TINY };
    assert_eq!(affordable_size(&view, &base, &patient), (1280, 720));
    let hasty = Effort { scene: Duration::from_micros(1), ..TINY };
    assert_eq!(affordable_size(&view, &base, &hasty), (80, 45));
}

#[test]
fn the_table_of_records_is_as_new_as_they_are() {
    let (folder, jobs) = (Folder::new(), jobs());
    assert!(matches!(run(folder.path(), &jobs, 25), Err(BenchError::Interrupted)));
    let csv = fs::read_to_string(folder.path().join("records.csv")).expect("written");
    assert_eq!(csv.lines().count(), 1 + load(folder.path()).rows.len());
}

#[test]
fn names_that_no_chart_can_hold_lose_none() {
    let folder = Folder::new();
    let mut jobs = of_scene(&View { name: "a\u{1}\u{fffe}b".to_owned(), ..view() }, &Settings::exact(), &TINY);
    jobs.truncate(1);
    let records = run(folder.path(), &jobs, u64::MAX).expect("nothing stops it");
    page::draw(&records, folder.path()).expect("every chart can be drawn");
}

#[test]
fn records_of_another_picture_are_not_mixed() {
    let folder = Folder::new();
    let print = |view: &View| view.fingerprint(&Settings::exact());
    let mut before = environment();
    before.views.insert("a room, default".to_owned(), print(&view()));
    Records::new(before.clone()).save(folder.path()).expect("writable");
    assert!(Records::resume(folder.path(), before).is_ok());
    let moved = View { camera: Camera { fov: 30.0, ..view().camera }, ..view() };
    let mut now = environment();
    now.views.insert("a room, default".to_owned(), print(&moved));
    let refused = Records::resume(folder.path(), now).expect_err("another view").to_string();
    assert!(refused.contains("version of a room, default"), "{refused}");
    let mut larger = environment();
    larger.views.insert("a room, default".to_owned(), print(&View { size: (256, 144), ..view() }));
    let refused = Records::resume(folder.path(), larger).expect_err("another size").to_string();
    assert!(refused.contains("128x72") && refused.contains("256x144"), "{refused}");
}

#[test]
fn a_path_is_looked_at_from_several_places_and_walked() {
    let folder = Folder::new();
    let start = view().camera;
    let along = |step: u8| Camera { eye: start.eye + 0.2 * f32::from(step), ..start };
    let path: Vec<Camera> = (0..5).map(along).collect();
    let walked = View { path: path.clone(), camera_name: "path".to_owned(), ..view() };
    let records =
        run(folder.path(), &of_scene(&walked, &Settings::exact(), &TINY), u64::MAX).expect("nothing stops it");
    let rows = || records.of(Part::Settings);
    assert!(rows().count() > 5 && rows().all(|row| row.views == TINY.cameras as u32 && row.shown < row.views));
    assert!(rows().all(|row| row.key.method != "exact" || row.is_exact()));
    assert!(rows().any(|row| row.error("flip") > Some(0.0) && row.map.is_some()));
    assert!(records.of(Part::Walk).all(|row| (2..=path.len()).contains(&row.frames.len())));
    assert!(records.of(Part::Pixels).all(|row| row.views == 1));
}

#[test]
fn charts_and_page_are_drawn_from_the_records_alone() {
    let folder = Folder::new();
    let mut records = run(folder.path(), &jobs(), u64::MAX).expect("nothing stops it");
    let effort = Effort { rounds: 0, ..TINY };
    let curves = stability::jobs(&Settings::exact(), &effort).expect("valid scenes");
    records.rows.extend(run(Folder::new().path(), &curves, u64::MAX).expect("nothing stops it").rows);
    records.save(folder.path()).expect("writable");

    let summary = Summary::of(&load(folder.path())).expect("full was swept");
    let fails = |method: &str, kind: &str| {
        let method = summary.methods.iter().find(|summed| summed.name == method).expect("in both");
        method.failures.iter().any(|failure| failure.difficulty == kind)
    };
    assert!(fails("hit 8", "wires") && fails("difference cache", "spheres") && !fails("exact", "wires"));
    assert!(summary.table().rows.iter().all(|row| row.len() == summary.table().head.len()));

    page::draw(&load(folder.path()), folder.path()).expect("writable");
    let mut kinds = BTreeSet::new();
    for file in fs::read_dir(folder.path()).expect("it exists").map(|file| file.expect("readable").path()) {
        let name = file.file_name().expect("a file").to_string_lossy().into_owned();
        match file.extension().and_then(|extension| extension.to_str()) {
            Some("svg") => {
                let text = fs::read_to_string(&file).expect("readable");
                usvg::Tree::from_str(&text, &usvg::Options::default())
                    .unwrap_or_else(|error| panic!("{name}: {error}"));
                kinds.insert(name.split(['-', '.']).next().unwrap_or_default().to_owned());
            }
            Some("png") => {
                let picture = image::open(&file).unwrap_or_else(|error| panic!("{name}: {error}")).to_rgb8();
                let colours: BTreeSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
                assert!(picture.width() > 800 && colours.len() > 50, "{name} shows nothing");
            }
            _ => {}
        }
    }
    let wanted = ["growth", "optimisations", "stability", "stages", "tradeoff", "walk"].map(str::to_owned);
    assert_eq!(kinds, BTreeSet::from(wanted));

    let html = fs::read_to_string(folder.path().join("index.html")).expect("written");
    assert!(html.contains("a &amp; &lt;b&gt;") && !html.contains("<b>"), "names are escaped");
    assert!(!html.contains("http://") && !html.contains("https://"), "it loads something");
    assert!(html.contains("data:image/jpeg;base64,"), "it has no pictures");
    let csv = fs::read_to_string(folder.path().join("records.csv")).expect("written");
    assert_eq!(csv.lines().count(), 1 + records.rows.len());
}

#[test]
fn certified_is_exact_in_every_curve_and_subsampling_loses_wires() {
    let folder = Folder::new();
    let jobs = stability::jobs(&Settings::exact(), &Effort { rounds: 0, ..TINY }).expect("valid scenes");
    let records = run(folder.path(), &jobs, u64::MAX).expect("nothing stops it");
    let wrong = |method: &str, scene: &str| -> Vec<f64> {
        let rows = records.of(Part::Stability).filter(|row| row.key.method == method && row.key.scene == scene);
        rows.filter_map(|row| row.error("wrong_share")).collect()
    };
    for scene in ["wires", "spheres", "scales"] {
        assert!(wrong("exact", scene).len() > 8);
        assert_eq!(wrong("exact", scene), wrong("full", scene), "{scene}");
    }
    assert!(wrong("exact", "wires").iter().all(|share| *share == 0.0));
    assert!(wrong("hit 8", "wires").iter().any(|share| *share > 50.0));
    assert!(wrong("difference cache", "spheres").iter().any(|share| *share > 50.0));
}

#[test]
fn the_thesis_table_has_its_layout() {
    let folder = Folder::new();
    let mut views = thesis::views().expect("valid scenes");
    let names: Vec<String> = views.iter().map(|view| view.name.clone()).collect();
    assert_eq!(names, ["base", "mirrors", "cornell", "gallery"]);
    let view = views.remove(0);
    let jobs: Vec<Job> = thesis::jobs(&View { size: (64, 36), ..view }, &Settings::exact());
    let records = run(folder.path(), &jobs, u64::MAX).expect("nothing stops it");
    let table = thesis::table(&records).expect("there are rows");
    assert_eq!(table.rows.len(), 1 + thesis::PUBLISHED.len());
    assert!(table.rows.iter().all(|row| row.len() == table.head.len()));
    assert_eq!(table.rows[1][1], "87 / 104 / 389 / 526");
    assert!(table.note.contains("the other three, mirrors, cornell and gallery, are ours"), "{}", table.note);
    let errors = &table.rows[0][table.head.len() - 2];
    assert!(errors.starts_with("every method: ") && errors.ends_with("/ 0"), "{errors}");
    assert_eq!(table.rows[0].last().map(String::as_str), Some("none"));

    let mut two = records.clone();
    two.rows.extend(records.rows.iter().cloned().map(|mut row| {
        row.key.camera = "above".to_owned();
        row
    }));
    let table = thesis::table(&two).expect("there are rows");
    assert_eq!(table.rows.len(), 2 + thesis::PUBLISHED.len());
    assert!(table.rows[2][0].contains("above"), "{}", table.rows[2][0]);
}
