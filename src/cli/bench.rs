//! `raywalk bench`: how fast and how true every method is.

use super::frames::Frames;
use super::interrupt::Interrupt;
use super::options::{self, Options};
use super::output;
use super::progress::Progress;
use super::stage::{self, Stage};
use super::{Failure, stdout};
use clap::ArgMatches;
use raywalk::app::scenes::scene_file;
use raywalk::measure::bench::{Bench, BenchError, Listener};
use raywalk::measure::records::{Environment, Records};
use raywalk::measure::sweep::{Effort, Job, View, affordable_size, by_primitives, of_scene};
use raywalk::measure::{page, stability, thesis};
use raywalk::scene::Camera;
use raywalk::settings::Settings;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Measures what `asked` says.
pub fn run(asked: &ArgMatches, interrupt: &Interrupt) -> Result<(), Failure> {
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
    let effort = if asked.get_flag("quick") { Effort::QUICK } else { Effort::DEFAULT };
    let mut environment = Environment::here(&options.settings, effort.name);
    let scenes = asked.get_many::<PathBuf>("scenes").into_iter().flatten();
    let scenes: Vec<PathBuf> = scenes.map(|path| scene_file(path)).collect::<Result<_, _>>()?;
    let is_thesis = asked.get_flag("thesis");
    let mut views = match () {
        () if asked.get_flag("stability") => Vec::new(),
        () if is_thesis && scenes.is_empty() => thesis::views()?,
        () => views(&scenes, asked, &options)?,
    };
    if is_thesis {
        let size = options.view.size.map_or(thesis::SIZE, |size| (size.width, size.height));
        views.iter_mut().for_each(|view| view.size = size);
    }
    for view in &views {
        // The table's pictures have another size than those of a sweep, and may stand beside them.
        let name = if is_thesis { format!("{} in the thesis's table", view.full_name()) } else { view.full_name() };
        environment.views.insert(name, view.fingerprint(&options.settings));
    }
    let mut records = Records::resume(&folder, environment)?;
    let jobs = if asked.get_flag("stability") {
        stability::jobs(&options.settings, &effort)?
    } else if is_thesis {
        views.iter().flat_map(|view| thesis::jobs(view, &options.settings)).collect()
    } else {
        reduce(&mut views, &mut records.environment, &options, &effort);
        sweep_jobs(&views, &options, &effort)?
    };

    interrupt.careful();
    let progress = Progress::over_steps(jobs.iter().map(Job::steps).sum(), options.reading.quiet);
    let teller = Teller(&progress);
    let mut bench = Bench::new(folder.clone(), records, interrupt.token.clone(), &teller);
    let ended = bench.run(&jobs);
    let records = bench.records;
    if let Ok(()) | Err(BenchError::Interrupted) = ended {
        page::draw(&records, &folder)?;
    }
    drop(progress);
    let (rows, cut_off) = (records.rows.len(), records.cut_off());
    if cut_off > 0 && !options.reading.quiet {
        stdout::note(&format!(
            "warning: {cut_off} of {rows} rows were cut off, since a frame took too long for a bench"
        ));
    }
    ended?;
    interrupt.check()
}

/// Makes views smaller whose frames would take too long, as they were when their records were begun.
fn reduce(views: &mut [View], environment: &mut Environment, options: &Options, effort: &Effort) {
    for view in views {
        let known = environment.sizes.get(&view.full_name()).copied();
        let size = known.unwrap_or_else(|| affordable_size(view, &options.settings, effort));
        if size != view.size && !options.reading.quiet {
            let ((width, height), (less_wide, less_high)) = (view.size, size);
            stdout::note(&format!(
                "warning: {}: frames of {width}x{height} take too long for a bench; measured at {less_wide}x{less_high}",
                view.full_name()
            ));
        }
        environment.sizes.insert(view.full_name(), size);
        view.size = size;
    }
}

struct Teller<'a>(&'a Progress);

impl Listener for Teller<'_> {
    fn at(&self, done: u64, what: &str) {
        self.0.set(done, what);
    }
}

/// The jobs of all views, and what needs no scene.
fn sweep_jobs(views: &[View], options: &Options, effort: &Effort) -> Result<Vec<Job>, Failure> {
    let mut jobs: Vec<Job> = views.iter().flat_map(|view| of_scene(view, &options.settings, effort)).collect();
    jobs.extend(by_primitives(&options.settings, effort)?);
    Ok(jobs)
}

/// What is looked at: in each scene, from every camera and along every path that were named.
fn views(scenes: &[PathBuf], asked: &ArgMatches, options: &Options) -> Result<Vec<View>, Failure> {
    let files = if scenes.is_empty() { vec![None] } else { scenes.iter().cloned().map(Some).collect() };
    let cameras: Vec<String> = asked.get_many("camera").into_iter().flatten().cloned().collect();
    let paths: Vec<PathBuf> = asked.get_many("path").into_iter().flatten().cloned().collect();
    let mut views = Vec::new();
    for (file, name) in files.iter().zip(names(&files)) {
        let mut options = options.clone();
        options.reading.scene = file.clone();
        // Paths move the first camera.
        options.view.camera = None;
        let stage = Stage::set(&options)?;
        let scene = &stage.loaded.scene;
        let mut add = |camera_name, camera, path| {
            let (name, size) = (name.clone(), (stage.size.width, stage.size.height));
            views.push(View { name, scene: Arc::clone(scene), camera_name, camera, path, size });
        };
        let all = (0..scene.cameras.len()).map(|index| index.to_string());
        let wanted: Vec<Option<String>> = match &cameras[..] {
            [] if paths.is_empty() => vec![None],
            [only] if only == "all" && scene.cameras.iter().all(|camera| camera.name != "all") => {
                all.map(Some).collect()
            }
            named => named.iter().cloned().map(Some).collect(),
        };
        for camera in wanted {
            let view = options::View { camera, ..options.view.clone() };
            let (name, camera) = stage::camera(scene, &view)?;
            add(with_changes(name, &view), camera, Vec::new());
        }
        for (path, path_name) in paths.iter().zip(names(&paths.iter().cloned().map(Some).collect::<Vec<_>>())) {
            options.path = Some(path.clone());
            let frames = Frames::of(&options)?;
            if let (Some(warning), false) = (&frames.warning, options.reading.quiet) {
                stdout::note(&format!("warning: {warning}"));
            }
            let along: Vec<Camera> = frames
                .range
                .clone()
                .map(|n| frames.camera(n, &stage.camera, &stage.loaded.scene))
                .collect::<Result<_, _>>()?;
            let first = *along.first().ok_or_else(|| Failure::Usage("--frames: no frame is left".to_owned()))?;
            let mut name = format!("path {path_name}");
            if let Some(range) = &options.frames {
                name += &format!(" frames {}..{}", range.start, range.end);
            }
            add(with_changes(name, &options.view), first, along);
        }
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

/// What a camera is called in records: its name, and what the command line makes of it.
fn with_changes(mut name: String, view: &options::View) -> String {
    for (flag, vector) in [("eye", view.eye), ("look-at", view.look_at), ("up", view.up)] {
        if let Some(vector) = vector {
            name += &format!(" {flag} {},{},{}", vector.x, vector.y, vector.z);
        }
    }
    if let Some(fov) = view.fov {
        name += &format!(" fov {fov}");
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
