//! What the frames of a walk cost, for `--stats`.

use super::tracer::{Job, TracedFrame};
use crate::measure::record::{Record, Subject};
use crate::measure::run::{Run, WARM_UP_FRAMES};
use crate::render::FrameStats;

/// The frames since scene, settings or size changed last, the first two aside; what refines a view at rest is not
/// counted. So one record speaks of one thing.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    of: Option<Job>,
    untimed: usize,
    run: Run,
}

impl Tally {
    /// Adds a frame, whose costs, presenting included, are `stats`.
    pub fn add(&mut self, frame: &TracedFrame, stats: &FrameStats) {
        if !self.of.as_ref().is_some_and(|job| frame.job.differs_by_camera_only(job)) {
            *self = Self { of: Some(frame.job.clone()), ..Self::default() };
        }
        if self.untimed < WARM_UP_FRAMES {
            self.untimed += 1;
        } else {
            self.run.add(stats.frame_ms, frame.cpu_ms, stats);
        }
    }

    /// The record of these frames, of a scene that took `load_ms` milliseconds to read and build; `None` where nothing
    /// was traced at all.
    pub fn record(&self, load_ms: f64) -> Option<Record> {
        let Job { scene, settings, width, height, .. } = self.of.as_ref()?;
        Some(Record::new(Subject::new(scene, settings, (*width, *height), load_ms), &self.run, None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::lowering::Lowering;
    use crate::app::methods::Aspect;
    use crate::render::{Film, Planes};
    use crate::scene::{Camera, Scene, nothing};
    use crate::settings::Settings;
    use std::sync::Arc;
    use std::time::Instant;

    fn frame(scene: &Arc<Scene>, x: f32, width: u32) -> TracedFrame {
        let camera = Camera { eye: glam::Vec3::new(x, 0.0, 5.0), ..Camera::default() };
        let (settings, lowering, aspect) = (Settings::exact(), Lowering::NONE, Aspect::default());
        TracedFrame {
            film: Film::new(width, 4, Planes::default()),
            stats: FrameStats { frame_ms: 7.0, ..FrameStats::default() },
            cpu_ms: 13.0,
            whole_ms: 9.0,
            finished: Instant::now(),
            job: Job { scene: Arc::clone(scene), camera, settings, width, height: 4, lowering, aspect },
            samples: None,
            beside: None,
            legend: None,
        }
    }

    #[test]
    fn a_record_is_of_the_last_settings_without_the_first_frames() {
        let scene = Arc::new(nothing().expect("it is built in"));
        let mut tally = Tally::default();
        assert!(tally.record(1.0).is_none());
        let sizes = [[8; 4].as_slice(), &[16; 7]].concat();
        for (i, width) in sizes.into_iter().enumerate() {
            let frame = frame(&scene, i as f32, width);
            tally.add(&frame, &frame.stats);
        }
        let record = serde_json::to_value(tally.record(20.0)).expect("plain data");
        assert_eq!((&record["width"], &record["frames"]), (&16.into(), &(7 - WARM_UP_FRAMES).into()));
        assert_eq!((&record["frame_ms"]["median"], &record["cpu_ms"]["min"]), (&7.0.into(), &13.0.into()));
        assert_eq!(record["settings"]["depth"], scene.render.max_depth);
    }
}
