//! Runs the jobs of a sweep and keeps the records: what was measured before is not measured again.

mod comparison;
mod judge;
mod walk;

use super::records::{Key, Records, RecordsError, Row};
use super::sweep::{Job, Method, View};
use super::watch::Watch;
use crate::picture::PictureError;
use crate::render::{CancelToken, Film, Planes, Scratch, render_frame};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Why a bench ended early. The text is one line.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// It was asked to stop.
    #[error("interrupted; what was measured is kept, and the same command goes on from there")]
    Interrupted,
    /// Records could not be read or written.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// A picture could not be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// Who is told how far a bench has come.
pub trait Listener {
    /// `done` steps of all jobs are behind it, and this is in work.
    fn at(&self, done: u64, what: &str);
}

/// A bench at work.
pub struct Bench<'a> {
    folder: PathBuf,
    /// What was measured so far.
    pub records: Records,
    listener: &'a dyn Listener,
    watch: Watch,
    /// One for each number of threads, so that no pool is made anew at each change of method.
    scratches: BTreeMap<i32, Scratch>,
    done: u64,
}

impl<'a> Bench<'a> {
    /// Goes on with `records` of `folder` until `stop` is cancelled.
    pub fn new(folder: PathBuf, records: Records, stop: CancelToken, listener: &'a dyn Listener) -> Self {
        Self { folder, records, listener, watch: Watch::new(stop), scratches: BTreeMap::new(), done: 0 }
    }

    /// Does what is left of `jobs`.
    ///
    /// # Errors
    /// [`BenchError`]; the records on disk hold all that was measured until then.
    pub fn run(&mut self, jobs: &[Job]) -> Result<(), BenchError> {
        self.records.save(&self.folder)?;
        for job in jobs {
            let end = self.done + job.steps();
            self.listener.at(self.done, job.scene_name());
            match job {
                Job::Compare(job) => self.compare(job)?,
                Job::Walk(job) => self.walk(job)?,
            }
            self.done = end;
            self.listener.at(self.done, job.scene_name());
        }
        Ok(())
    }

    /// Renders one frame that nobody times.
    fn render(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        settings: &Settings,
        film: &mut Film,
    ) -> Result<(), BenchError> {
        self.guarded(settings.threads, None, |scratch| render_frame(scene, camera, settings, scratch, film))?;
        Ok(())
    }

    /// Lets `work` render with the scratch of so many threads, until it takes longer than `longest` or the bench has to
    /// stop.
    fn guarded<T>(
        &mut self,
        threads: i32,
        longest: Option<Duration>,
        work: impl FnOnce(&mut Scratch) -> T,
    ) -> Result<T, BenchError> {
        let scratch = self.scratches.entry(threads).or_default();
        scratch.cancel = self.watch.token();
        self.watch.start(longest.map(|longest| Instant::now() + longest));
        let result = work(scratch);
        self.watch.end();
        if self.watch.stop.is_cancelled() { Err(BenchError::Interrupted) } else { Ok(result) }
    }

    fn save(&self) -> Result<(), BenchError> {
        Ok(self.records.save(&self.folder)?)
    }
}

/// A film without planes.
fn film((width, height): (u32, u32)) -> Film {
    Film::new(width, height, Planes::default())
}

/// A row of which nothing is known yet.
fn new_row(key: Key, view: &View, method: &Method) -> Row {
    Row {
        key,
        family: method.family.to_owned(),
        flags: method.settings.flags(),
        primitives: view.scene.geometry.len() as u64,
        complete: false,
        frame_ms: Default::default(),
        cpu_ms: Default::default(),
        cut_off_ms: None,
        stages_ms: BTreeMap::new(),
        rays: BTreeMap::new(),
        pixels: BTreeMap::new(),
        error: BTreeMap::new(),
        frames: Vec::new(),
        views: view.cameras().len() as u32,
        shown: 0,
        picture: None,
        map: None,
    }
}
