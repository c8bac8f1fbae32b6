//! `raywalk bench`: how fast and how true every method is.

use super::frames::Frames;
use super::interrupt::Interrupt;
use super::options::Options;
use super::output;
use super::progress::Progress;
use super::stage::Stage;
use super::{Failure, stdout};
use clap::ArgMatches;
use raywalk::measure::bench::{Bench, Listener};
use raywalk::measure::records::{Environment, Records, fingerprint};
use raywalk::measure::sweep::{Effort, Job, View, by_primitives, of_scene};
use raywalk::measure::{page, stability, thesis};
use raywalk::scene::Camera;
use raywalk::settings::Settings;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Measures what `asked` says.
pub fn run(asked: &ArgMatches) -> Result<(), Failure> {
    let options = Options::of(asked, Settings::exact)?;
    output::check_planes(None, options.planes)?;
    if options.stats.is_some() {
        return Err(Failure::Usage("--stats: a bench writes its figures to records.json and records.csv".to_owned()));
    }
    let folder = asked.get_one::<PathBuf>("output").cloned().unwrap_or_default();
    if asked.get_flag("redraw") {
        let records = Records::load(&folder)?;
        let records = records.ok_or_else(|| Failure::Run(format!("{}: no records.json to draw", folder.display())))?;
        return Ok(page::draw(&records, &folder)?);
    }
    let interrupt = Interrupt::listen()?;
    let effort = if asked.get_flag("quick") { Effort::QUICK } else { Effort::DEFAULT };
    let mut environment = Environment::here(&options.settings, effort.name);
    let scenes: Vec<&PathBuf> = asked.get_many("scenes").into_iter().flatten().collect();
    let jobs = if asked.get_flag("stability") {
        stability::jobs(&options.settings, &effort)?
    } else if asked.get_flag("thesis") {
        thesis_jobs(&scenes, &options, &mut environment)?
    } else {
        sweep_jobs(&scenes, &options, &effort, &mut environment)?
    };

    interrupt.careful();
    let records = Records::resume(&folder, environment)?;
    let progress = Progress::over_steps(jobs.iter().map(Job::steps).sum(), options.reading.quiet);
    let teller = Teller(&progress);
    let mut bench = Bench::new(folder.clone(), records, interrupt.token.clone(), &teller);
    bench.run(&jobs)?;
    page::draw(&bench.records, &folder)?;
    drop(progress);
    interrupt.check()
}

struct Teller<'a>(&'a Progress);

impl Listener for Teller<'_> {
    fn at(&self, done: u64, what: &str) {
        self.0.set(done, what);
    }
}

/// The jobs of all scenes, and what needs no scene.
fn sweep_jobs(
    scenes: &[&PathBuf],
    options: &Options,
    effort: &Effort,
    environment: &mut Environment,
) -> Result<Vec<Job>, Failure> {
    let mut jobs = Vec::new();
    for (view, path) in views(scenes, options, environment)? {
        jobs.extend(of_scene(&view, &options.settings, path, effort));
    }
    jobs.extend(by_primitives(&options.settings, effort)?);
    Ok(jobs)
}

/// The jobs of the thesis's table, on its own scenes if none are named.
fn thesis_jobs(scenes: &[&PathBuf], options: &Options, environment: &mut Environment) -> Result<Vec<Job>, Failure> {
    let views = if scenes.is_empty() {
        thesis::views()?
    } else {
        views(scenes, options, environment)?.into_iter().map(|(view, _)| view).collect()
    };
    let size = options.view.size.map_or(thesis::SIZE, |size| (size.width, size.height));
    Ok(views.into_iter().flat_map(|view| thesis::jobs(&View { size, ..view }, &options.settings)).collect())
}

/// What is looked at, and the cameras of a path.
type Subject = (View, Option<Vec<Camera>>);

/// What is looked at in each scene, with the cameras of a path if one is given; notes each scene's fingerprint.
fn views(scenes: &[&PathBuf], options: &Options, environment: &mut Environment) -> Result<Vec<Subject>, Failure> {
    let files = if scenes.is_empty() { vec![None] } else { scenes.iter().map(|file| Some((*file).clone())).collect() };
    let names = names(&files);
    let frames = Frames::of(options)?;
    if let (Some(warning), false) = (&frames.warning, options.reading.quiet) {
        stdout::note(&format!("warning: {warning}"));
    }
    let mut views = Vec::new();
    for (file, name) in files.into_iter().zip(names) {
        if let Some(print) = file.as_deref().and_then(fingerprint) {
            environment.scenes.insert(name.clone(), print);
        }
        let mut options = options.clone();
        options.reading.scene = file;
        let stage = Stage::set(&options)?;
        let path = match &options.path {
            Some(_) => Some(frames.range.clone().map(|n| frames.camera(n, &stage.camera)).collect::<Result<_, _>>()?),
            None => None,
        };
        let view = View {
            name,
            scene: Arc::clone(&stage.loaded.scene),
            camera_name: camera_name(&options, &stage),
            camera: stage.camera,
            size: (stage.size.width, stage.size.height),
        };
        views.push((view, path));
    }
    Ok(views)
}

/// A short name for each file: its stem, or all of its path where two would be called the same.
fn names(files: &[Option<PathBuf>]) -> Vec<String> {
    let stem = |file: &Option<PathBuf>| match file {
        Some(file) => file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        None => "gallery (built in)".to_owned(),
    };
    let mut counts = BTreeMap::<String, usize>::new();
    files.iter().for_each(|file| *counts.entry(stem(file)).or_default() += 1);
    let name = |file: &Option<PathBuf>| match file {
        Some(path) if counts[&stem(file)] > 1 => path.display().to_string(),
        _ => stem(file),
    };
    files.iter().map(name).collect()
}

/// What the camera is called in records: its name, and what the command line makes of it.
fn camera_name(options: &Options, stage: &Stage) -> String {
    let view = &options.view;
    let first = stage.loaded.scene.cameras.first().map(|camera| camera.name.clone());
    let mut name = view.camera.clone().or(first).unwrap_or_default();
    for (flag, vector) in [("eye", view.eye), ("look-at", view.look_at), ("up", view.up)] {
        if let Some(vector) = vector {
            name += &format!(" {flag} {},{},{}", vector.x, vector.y, vector.z);
        }
    }
    if let Some(fov) = view.fov {
        name += &format!(" fov {fov}");
    }
    if let Some(path) = &options.path {
        name += &format!(" path {}", path.display());
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_called_by_their_files_and_never_alike() {
        let files = ["a/room.json", "b/room.json", "hall.json"].map(|file| Some(PathBuf::from(file)));
        assert_eq!(names(&files), ["a/room.json", "b/room.json", "hall"]);
        assert_eq!(names(&[None]), ["gallery (built in)"]);
    }
}
