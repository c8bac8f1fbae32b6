//! Measures the built-in scene and writes what README.md shows of it: the chart of time against error, stability curves,
//! and the table of what each method gains and loses.
//!
//! `cargo run --release --example readme` takes some minutes, and goes on where it was stopped. It writes
//! `scenes/pictures/methods.json`, pictures in `scenes/pictures`, and the lines between the two marks in README.md.

use anyhow::{Context, ensure};
use raywalk::measure::bench::{Bench, Listener};
use raywalk::measure::records::{Environment, Part, Records};
use raywalk::measure::summary::Summary;
use raywalk::measure::sweep::{Effort, Job, View, of_scene};
use raywalk::measure::{chart, stability};
use raywalk::picture::PendingFile;
use raywalk::render::CancelToken;
use raywalk::scene::{LoadOptions, builtin};
use raywalk::settings::Settings;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// What is measured is kept here until the program changes.
const FOLDER: &str = "target/readme";
/// The beginning of the charts that are shown, and the files they become.
const CHARTS: [(&str, &str); 3] =
    [("tradeoff-", "tradeoff"), ("stability-wires", "stability-wires"), ("stability-spheres", "stability-spheres")];

/// More patient than a sweep, for figures that are looked at more often.
const EFFORT: Effort = Effort { name: "for README.md", rounds: 12, scene: Duration::from_secs(600), ..Effort::DEFAULT };

struct Quiet;

impl Listener for Quiet {
    fn at(&self, _: u64, _: &str) {}
}

/// Replaces a file as a whole.
fn write(path: impl AsRef<Path>, text: &str) -> anyhow::Result<()> {
    Ok(PendingFile::create(path.as_ref())?.commit(|sink| Ok(sink.write_all(text.as_bytes())?))?)
}

/// What stands in README.md before and after the table.
fn around_table(readme: &str) -> anyhow::Result<(&str, &str)> {
    let (begin, end) = Summary::MARKS;
    let parts = readme.split_once(begin).zip(readme.split_once(end));
    let ((before, _), (_, after)) = parts.context("README.md has lost its marks")?;
    ensure!(before.len() + after.len() < readme.len(), "README.md has its marks in the wrong order");
    Ok((before, after))
}

fn main() -> anyhow::Result<()> {
    let read = || fs::read_to_string("README.md").context("README.md: run this in the folder that holds it");
    // Before minutes are spent on it.
    around_table(&read()?)?;
    let scene = Arc::new(builtin(&LoadOptions::default())?);
    let (name, camera_name) = ("gallery (built in)".to_owned(), scene.cameras[0].name.clone());
    let camera = scene.cameras[0].camera;
    let view = View { name, scene, camera_name, camera, path: Vec::new(), size: (1280, 720) };
    let base = Settings::exact();
    let of_settings = |job: &Job| matches!(job, Job::Compare(job) if job.part == Part::Settings);
    let mut jobs: Vec<Job> = of_scene(&view, &base, &EFFORT).into_iter().filter(of_settings).collect();
    jobs.extend(stability::jobs(&base, &EFFORT)?);

    let folder = Path::new(FOLDER);
    let records = Records::resume(folder, Environment::here(&base, EFFORT.name))?;
    let mut bench = Bench::new(folder.to_owned(), records, CancelToken::default(), &Quiet);
    bench.run(&jobs)?;

    let summary = Summary::of(&bench.records).context("nothing was measured")?;
    write("scenes/pictures/methods.json", &(serde_json::to_string_pretty(&summary)? + "\n"))?;
    for chart in chart::of(&bench.records) {
        if let Some((_, file)) = CHARTS.iter().find(|(beginning, _)| chart.name.starts_with(beginning)) {
            write(format!("scenes/pictures/{file}.svg"), &chart.document())?;
        }
    }
    let readme = read()?;
    let ((before, after), (begin, end)) = (around_table(&readme)?, Summary::MARKS);
    write("README.md", &format!("{before}{begin}\n{}{end}{after}", summary.table().markdown()))
}
