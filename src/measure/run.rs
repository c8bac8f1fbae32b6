//! Frames, timed.

use super::statistics::Spread;
use crate::render::{Film, FrameStats, Scratch, render_frame};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use cpu_time::ProcessTime;
use serde::Serialize;
use serde_json::Value;
use std::time::Instant;

/// Untimed frames before the first timed one: threads start, caches fill, pages get touched.
pub const WARM_UP_FRAMES: usize = 2;

/// Renders one frame and adds its cost to `run`. Nothing but the call of
/// [`render_frame`] is timed: no loading, building, encoding or writing. Returns whether the frame was completed.
pub fn timed_frame(
    run: &mut Run,
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    scratch: &mut Scratch,
    film: &mut Film,
) -> bool {
    run.time(|| render_frame(scene, camera, settings, scratch, film))
}

/// The cost of a run of frames.
#[derive(Clone, Debug, Default)]
pub struct Run {
    frame_ms: Vec<f64>,
    cpu_ms: Vec<f64>,
    total: FrameStats,
}

/// Process CPU time of all threads around one frame, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CpuTime {
    /// The cheapest frame.
    pub min: f64,
    /// The median frame.
    pub median: f64,
}

impl Run {
    /// Adds the frame that `render` makes, unless it was not completed; returns whether it was.
    pub fn time(&mut self, render: impl FnOnce() -> FrameStats) -> bool {
        let (wall, cpu) = (Instant::now(), ProcessTime::now());
        let stats = render();
        let (cpu, wall) = (cpu.elapsed(), wall.elapsed());
        if stats.completed {
            self.add(wall.as_secs_f64() * 1e3, cpu.as_secs_f64() * 1e3, &stats);
        }
        stats.completed
    }

    /// Adds one frame.
    pub fn add(&mut self, frame_ms: f64, cpu_ms: f64, stats: &FrameStats) {
        self.frame_ms.push(frame_ms);
        self.cpu_ms.push(cpu_ms);
        self.total.add(stats);
    }

    /// Frames so far.
    pub fn frames(&self) -> usize {
        self.frame_ms.len()
    }

    /// Wall time of the frames in milliseconds.
    pub fn frame_ms(&self) -> Spread {
        Spread::of(&self.frame_ms)
    }

    /// CPU time of the frames.
    pub fn cpu_ms(&self) -> CpuTime {
        let Spread { min, median, .. } = Spread::of(&self.cpu_ms);
        CpuTime { min, median }
    }

    /// Sums over all frames.
    pub fn total(&self) -> &FrameStats {
        &self.total
    }

    /// `total`, a number or an object of numbers, divided by the number of frames. A whole number stays one where it
    /// can, as it does for a view traced again and again.
    pub fn per_frame(&self, total: &impl Serialize) -> Value {
        match serde_json::to_value(total) {
            Ok(Value::Object(fields)) => fields.into_iter().map(|(name, sum)| (name, self.mean(&sum))).collect(),
            Ok(sum) => self.mean(&sum),
            Err(_) => Value::Null,
        }
    }

    fn mean(&self, sum: &Value) -> Value {
        let frames = self.frames().max(1);
        match sum.as_u64() {
            Some(sum) if sum.is_multiple_of(frames as u64) => (sum / frames as u64).into(),
            _ => sum.as_f64().map(|sum| sum / frames as f64).into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn run(rays: &[u64]) -> Run {
        let mut run = Run::default();
        for (i, &primary) in rays.iter().enumerate() {
            let mut stats = FrameStats::default();
            stats.rays.primary = primary;
            stats.stages_ms.shade = 0.5;
            run.add(10.0 + i as f64, 20.0, &stats);
        }
        run
    }

    #[test]
    fn counts_and_times_are_means_per_frame() {
        let run = run(&[10, 13]);
        assert_eq!(run.frames(), 2);
        assert_eq!(
            run.per_frame(&run.total().rays),
            json!({ "primary": 11.5, "shadow": 0, "reflection": 0, "refraction": 0 })
        );
        assert_eq!(run.per_frame(&run.total().stages_ms)["shade"], json!(0.5));
        assert_eq!(run.per_frame(&run.total().rays.primary), json!(11.5));
        assert_eq!((run.frame_ms().median, run.cpu_ms().min), (10.5, 20.0));
    }

    #[test]
    fn a_still_view_has_whole_counts() {
        let run = run(&[7, 7, 7]);
        assert_eq!(run.per_frame(&run.total().rays.primary).to_string(), "7");
    }
}
