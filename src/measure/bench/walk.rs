//! Errors from frame to frame along a path.

use super::judge::Frames;
use super::{Bench, BenchError, film, new_row};
use crate::measure::records::{Key, Part};
use crate::measure::sweep::{Method, Walk};
use crate::picture::EightBit;
use std::time::Instant;

impl Bench<'_> {
    /// Does what is left of `job`: method by method, each with the reference of every frame.
    pub(super) fn walk(&mut self, job: &Walk) -> Result<(), BenchError> {
        let start = Instant::now();
        for (number, method) in job.methods.iter().enumerate() {
            let key = Key {
                part: Part::Walk,
                scene: job.view.name.clone(),
                camera: job.view.camera_name.clone(),
                method: method.name.clone(),
                width: job.view.size.0,
                height: job.view.size.1,
                at: None,
            };
            let place = self.records.place(&key, || new_row(key.clone(), &job.view, method));
            if !self.records.rows[place].complete {
                // Each method gets as much of the time that is left as each of the methods that are left.
                let left = job.budget.saturating_sub(start.elapsed()) / (job.methods.len() - number) as u32;
                self.follow(job, method, place, Instant::now() + left)?;
                self.save()?;
            }
            self.done += job.cameras.len() as u64;
            self.listener.at(self.done, &job.view.name);
        }
        Ok(())
    }

    /// Renders the frames of one method and their references until `deadline`, at least two.
    fn follow(&mut self, job: &Walk, method: &Method, place: usize, deadline: Instant) -> Result<(), BenchError> {
        let (mut film, mut judge, mut errors) = (film(job.view.size), Frames::default(), Vec::new());
        for camera in &job.cameras {
            if errors.len() > 1 && Instant::now() > deadline {
                break;
            }
            self.render(&job.view.scene, camera, &job.reference, &mut film, None)?;
            let reference = EightBit::of_film(&film);
            self.render(&job.view.scene, camera, &method.settings, &mut film, None)?;
            errors.push(judge.judge(&reference, &EightBit::of_film(&film)));
        }
        let row = &mut self.records.rows[place];
        (row.frames, row.complete) = (errors, true);
        Ok(())
    }
}
