//! Methods measured in alternation on one view.
//!
//! Each is looked at once for its picture. Then all take turns, round by round, so that what else the machine does
//! meets them alike: a turn is one untimed frame, which fills the caches, and some timed ones.

use super::{Bench, BenchError, film, judge, new_row};
use crate::measure::Run;
use crate::measure::records::{Key, Row, file_name};
use crate::measure::run::timed_frame;
use crate::measure::sweep::{Comparison, Judge, Method};
use crate::picture::{EightBit, Format, PendingFile};
use crate::render::{Film, Planes};
use crate::scene::Camera;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Timed frames of one turn, at most, and the time after which no further one starts.
const FRAMES_A_TURN: usize = 4;
const TURN: Duration = Duration::from_millis(250);

/// Frames that take longer than this, in milliseconds, are so long that none before them has to warm anything up.
const SLOW_MS: f64 = 1000.0;

/// What pictures are held against.
struct Truth {
    picture: EightBit,
    /// The pixels that count, where not all do.
    counts: Vec<bool>,
}

impl Bench<'_> {
    /// Does what is left of `job`.
    pub(super) fn compare(&mut self, job: &Comparison) -> Result<(), BenchError> {
        let start = Instant::now();
        let places: Vec<usize> = job.methods.iter().map(|method| self.place(job, method)).collect();
        if places.iter().all(|&place| self.records.rows[place].complete) {
            return Ok(());
        }
        let mut film = film(job.view.size);
        let mut truths = Vec::new();
        for (method, &place) in job.methods.iter().zip(&places) {
            if !self.is_looked_at(place, job) {
                if truths.is_empty() && job.judge != Judge::Time {
                    truths = self.truths(job)?;
                }
                self.look(job, method, place, &mut film, &truths)?;
            }
            self.step(job.step(method), &job.view.name);
        }
        for round in 0..job.rounds as usize {
            for (method, &place) in job.methods.iter().zip(&places) {
                let row = &self.records.rows[place];
                let is_behind =
                    row.cut_off_ms.is_none() && row.frame_ms.len() <= round * FRAMES_A_TURN && !row.complete;
                // Everything is timed at least once.
                if is_behind && (row.frame_ms.is_empty() || start.elapsed() < job.budget) {
                    self.turn(job, method, place, round, &mut film)?;
                    self.save()?;
                }
                self.step(job.step(method), &job.view.name);
            }
        }
        places.iter().for_each(|&place| self.records.rows[place].complete = true);
        self.save()
    }

    fn step(&mut self, cost: u64, name: &str) {
        self.done += cost;
        self.listener.at(self.done, name);
    }

    /// The place of a method's row.
    fn place(&mut self, job: &Comparison, method: &Method) -> usize {
        let key = Key {
            part: job.part,
            scene: job.view.name.clone(),
            camera: job.view.camera_name.clone(),
            method: method.name.clone(),
            width: job.view.size.0,
            height: job.view.size.1,
            at: job.at,
        };
        self.records.place(&key, || new_row(key.clone(), &job.view, method))
    }

    /// Whether a method's picture was judged, or found to take too long.
    fn is_looked_at(&self, place: usize, job: &Comparison) -> bool {
        let row = &self.records.rows[place];
        let has_pictures =
            !job.keeps_pictures || row.picture.as_ref().is_some_and(|name| self.folder.join(name).exists());
        row.cut_off_ms.is_some()
            || (has_pictures && (!row.error.is_empty() || job.judge == Judge::Time && !row.frame_ms.is_empty()))
    }

    /// Renders the reference of each camera.
    fn truths(&mut self, job: &Comparison) -> Result<Vec<Truth>, BenchError> {
        let still = [job.reference.camera];
        let cameras = if job.view.path.is_empty() { &still[..] } else { &job.view.path };
        cameras.iter().map(|camera| self.truth(job, camera)).collect()
    }

    fn truth(&mut self, job: &Comparison, camera: &Camera) -> Result<Truth, BenchError> {
        let (width, height) = job.view.size;
        let mut film = Film::new(width, height, Planes { object: true, ..Planes::default() });
        let against = &job.reference;
        self.render(&against.scene, camera, &against.settings, &mut film)?;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let counts = match &job.judge {
            Judge::Wrong(Some(subject)) => {
                pixels.map(|(x, y)| film.object(x, y).is_some_and(|object| subject.contains(&object))).collect()
            }
            _ => vec![true; width as usize * height as usize],
        };
        Ok(Truth { picture: EightBit::of_film(&film), counts })
    }

    /// Renders a method's picture from each camera and judges it.
    fn look(
        &mut self,
        job: &Comparison,
        method: &Method,
        place: usize,
        film: &mut Film,
        truths: &[Truth],
    ) -> Result<(), BenchError> {
        let mut errors = Vec::new();
        let mut worst: Option<(f64, usize, EightBit)> = None;
        for (number, camera) in job.view.cameras().iter().enumerate() {
            let mut run = Run::default();
            let longest = (!method.is_measure()).then_some(job.longest_frame);
            if !self.timed(job, method, camera, film, longest, &mut run)? {
                self.records.rows[place].cut_off_ms = Some(job.longest_frame.as_secs_f64() * 1e3);
                return self.save();
            }
            if run.frame_ms().median > SLOW_MS {
                self.records.rows[place].add(&run);
            }
            let Some(truth) = truths.get(number) else { continue };
            let picture = EightBit::of_film(film);
            let error = match job.judge {
                Judge::Time => BTreeMap::new(),
                Judge::Metrics => judge::by_metrics(&truth.picture, &picture),
                Judge::Wrong(_) => judge::by_share(&truth.picture, &picture, &truth.counts),
            };
            let rmse = error.get("rmse").copied().flatten().unwrap_or_default();
            if worst.as_ref().is_none_or(|(greatest, ..)| rmse > *greatest) {
                worst = Some((rmse, number, picture));
            }
            errors.push(error);
        }
        if let Some((_, number, picture)) = worst {
            if job.keeps_pictures {
                self.keep_pictures(place, &picture, &truths[number])?;
            }
            let row = &mut self.records.rows[place];
            (row.shown, row.error) = (number as u32, judge::of_all(&errors));
        }
        self.save()
    }

    /// Writes a method's picture and the map of its errors. An exact picture is written once for all methods.
    fn keep_pictures(&mut self, place: usize, picture: &EightBit, truth: &Truth) -> Result<(), BenchError> {
        let row = &self.records.rows[place];
        let Key { scene, camera, method, .. } = &row.key;
        let map = judge::error_map(&truth.picture, picture);
        let method = if map.is_some() { method } else { "exact" };
        let stem = format!("pictures/{}", file_name(&[scene, camera, method]));
        let (picture_name, map_name) = (format!("{stem}.jpg"), map.is_some().then(|| format!("{stem}-error.png")));
        write_picture(&self.folder.join(&picture_name), picture)?;
        if let (Some(map), Some(name)) = (&map, &map_name) {
            write_picture(&self.folder.join(name), map)?;
        }
        let row = &mut self.records.rows[place];
        (row.picture, row.map) = (Some(picture_name), map_name);
        Ok(())
    }

    /// Adds one frame of a method to `run`; tells whether it was completed within `longest`.
    fn timed(
        &mut self,
        job: &Comparison,
        method: &Method,
        camera: &Camera,
        film: &mut Film,
        longest: Option<Duration>,
        run: &mut Run,
    ) -> Result<bool, BenchError> {
        let scene = &job.view.scene;
        self.guarded(method.settings.threads, longest, |scratch| {
            timed_frame(run, scene, camera, &method.settings, scratch, film)
        })
    }

    /// One turn of a method: an untimed frame, then timed ones, all from the camera whose turn it is.
    fn turn(
        &mut self,
        job: &Comparison,
        method: &Method,
        place: usize,
        round: usize,
        film: &mut Film,
    ) -> Result<(), BenchError> {
        let cameras = job.view.cameras();
        let camera = &cameras[round % cameras.len()];
        if self.records.rows[place].frame_ms.median <= SLOW_MS {
            self.timed(job, method, camera, film, None, &mut Run::default())?;
        }
        let start = Instant::now();
        for _ in 0..FRAMES_A_TURN {
            let mut run = Run::default();
            self.timed(job, method, camera, film, None, &mut run)?;
            self.records.rows[place].add(&run);
            if start.elapsed() > TURN {
                break;
            }
        }
        Ok(())
    }
}

impl Row {
    /// Adds the frame of `run`.
    fn add(&mut self, run: &Run) {
        let (before, total) = (self.frame_ms.len() as f64, run.total());
        self.frame_ms.add(run.frame_ms().median);
        self.cpu_ms.add(run.cpu_ms().median);
        for (means, added) in [
            (&mut self.stages_ms, run.per_frame(&total.stages_ms)),
            (&mut self.rays, run.per_frame(&total.rays)),
            (&mut self.pixels, run.per_frame(&total.pixels)),
        ] {
            let Value::Object(added) = added else { continue };
            for (name, value) in added {
                let mean = means.entry(name).or_default();
                *mean = (*mean * before + value.as_f64().unwrap_or_default()) / (before + 1.0);
            }
        }
    }
}

fn write_picture(path: &Path, picture: &EightBit) -> Result<(), BenchError> {
    if let Some(folder) = path.parent() {
        // Where it cannot be made, the file cannot either, and that is told.
        let _ = fs::create_dir_all(folder);
    }
    let format = Format::of(path)?;
    Ok(PendingFile::create(path)?.commit(|sink| format.write_eight_bit(picture, sink))?)
}
