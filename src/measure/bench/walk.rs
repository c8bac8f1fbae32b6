//! Errors from frame to frame along a path.

use super::judge::Frames;
use super::{Bench, BenchError, film, new_row};
use crate::measure::records::{FrameError, Key, Part};
use crate::measure::sweep::{Method, Walk};
use crate::picture::EightBit;
use crate::scene::Camera;
use std::time::Instant;

impl Bench<'_> {
    /// Does what is left of `job`: method by method, each with the reference of every frame, all of them as far.
    pub(super) fn walk(&mut self, job: &Walk) -> Result<(), BenchError> {
        let places: Vec<usize> = job.methods.iter().map(|method| self.place_of_walk(job, method)).collect();
        let followed = places.iter().map(|&place| self.records.rows[place].frames.len()).max().unwrap_or_default();
        let frames = if followed > 0 { followed } else { self.affordable_frames(job)? };
        let cameras = &job.view.path[..frames.min(job.view.path.len())];
        for (method, place) in job.methods.iter().zip(places) {
            if !self.records.rows[place].complete {
                let errors = self.follow(job, method, cameras)?;
                let row = &mut self.records.rows[place];
                (row.frames, row.complete) = (errors, true);
                self.save()?;
            }
            self.done += job.step();
            self.listener.at(self.done, &job.view.name);
        }
        Ok(())
    }

    /// The place of a method's row.
    fn place_of_walk(&mut self, job: &Walk, method: &Method) -> usize {
        let key = Key {
            part: Part::Walk,
            scene: job.view.name.clone(),
            camera: job.view.camera_name.clone(),
            method: method.name.clone(),
            width: job.view.size.0,
            height: job.view.size.1,
            at: None,
        };
        self.records.place(&key, || new_row(key.clone(), &job.view, method))
    }

    /// How many frames of every method fit into the time that is given, by the cost of the second one; at least two.
    fn affordable_frames(&mut self, job: &Walk) -> Result<usize, BenchError> {
        let (Some(method), [first, second, ..]) = (job.methods.first(), &job.view.path[..]) else {
            return Ok(job.view.path.len());
        };
        self.follow(job, method, &[*first])?;
        let start = Instant::now();
        self.follow(job, method, &[*second])?;
        let all = start.elapsed().as_secs_f64() * job.methods.len() as f64;
        let fitting = job.budget.as_secs_f64() / all;
        Ok((fitting as usize).clamp(2, job.view.path.len()))
    }

    /// Renders the frames of one method and their references.
    fn follow(&mut self, job: &Walk, method: &Method, cameras: &[Camera]) -> Result<Vec<FrameError>, BenchError> {
        let (mut film, mut judge) = (film(job.view.size), Frames::default());
        let mut errors = Vec::with_capacity(cameras.len());
        for camera in cameras {
            self.render(&job.view.scene, camera, &job.reference, &mut film)?;
            let reference = EightBit::of_film(&film);
            self.render(&job.view.scene, camera, &method.settings, &mut film)?;
            errors.push(judge.judge(&reference, &EightBit::of_film(&film)));
        }
        Ok(errors)
    }
}
