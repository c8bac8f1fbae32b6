//! One row: what one method cost and how true it was, on one view.

use crate::measure::statistics::percentile;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Which chart a row feeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Settings: time against error, and the stages of a frame.
    Settings,
    /// Optimisations, alone and taken away.
    Optimisations,
    /// Errors from frame to frame along a path.
    Walk,
    /// Time against the number of pixels.
    Pixels,
    /// Time against the number of primitives.
    Primitives,
    /// Error against difficulty.
    Stability,
    /// The thesis's table.
    Thesis,
}

/// What tells a row from all others.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Key {
    /// The chart.
    pub part: Part,
    /// The scene.
    pub scene: String,
    /// The camera, or how it moves.
    pub camera: String,
    /// The method's name.
    pub method: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Where the row stands on the chart's other axis.
    pub at: Option<f64>,
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        // A number that was written and read again may differ in its last digit.
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs();
        let same_place = match (self.at, other.at) {
            (Some(a), Some(b)) => near(a, b),
            (a, b) => a == b,
        };
        let part_and_size = |key: &Self| (key.part, key.width, key.height);
        same_place
            && part_and_size(self) == part_and_size(other)
            && self.method == other.method
            && self.scene == other.scene
            && self.camera == other.camera
    }
}

/// Milliseconds of frames, with their spread.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// Each frame, in the order in which they were measured.
    pub samples: Vec<f64>,
    /// Least.
    pub min: f64,
    /// 5 % lie below.
    pub p5: f64,
    /// Half lie below.
    pub median: f64,
    /// 95 % lie below.
    pub p95: f64,
}

impl Samples {
    /// One more frame.
    pub fn add(&mut self, value: f64) {
        self.samples.push(value);
        let mut sorted = self.samples.clone();
        sorted.sort_by(f64::total_cmp);
        let at = |q| percentile(&sorted, q).unwrap_or_default();
        (self.min, self.p5, self.median, self.p95) = (at(0.0), at(0.05), at(0.5), at(0.95));
    }

    /// Frames so far.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }
}

/// How wrong one frame of a walk is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameError {
    /// Root mean square error of all channels, 0 to 1.
    pub rmse: f64,
    /// 99.9th percentile of all channels' errors, 0 to 1.
    pub p999_abs: f64,
    /// Pixels with any channel off by more than 2/255.
    pub pixels_off: f64,
    /// Pixels that came to be off, or ceased to, since the frame before.
    pub pops: f64,
}

/// One method on one view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// What tells it from all others.
    #[serde(flatten)]
    pub key: Key,
    /// The method's family.
    pub family: String,
    /// The method's flags, beginning from the preset `exact`.
    pub flags: String,
    /// Primitives of the scene.
    pub primitives: u64,
    /// Whether it needs no more measuring.
    pub complete: bool,
    /// Wall time of a frame.
    pub frame_ms: Samples,
    /// CPU time of a frame, all threads together.
    pub cpu_ms: Samples,
    /// The frame was cut off after this time; nothing else is known then.
    pub cut_off_ms: Option<f64>,
    /// CPU milliseconds by stage: the mean of all timed frames.
    pub stages_ms: BTreeMap<String, f64>,
    /// Rays by kind, a frame.
    pub rays: BTreeMap<String, f64>,
    /// Pixels by how they were obtained, a frame.
    pub pixels: BTreeMap<String, f64>,
    /// Errors by metric, `null` where one is undefined; empty where nothing was compared.
    pub error: BTreeMap<String, Option<f64>>,
    /// Errors along a walk, frame by frame.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<FrameError>,
    /// Places along a path that its errors are of: the greatest `max_abs` and `p999_abs`, the mean of all others.
    pub views: u32,
    /// Which of them the picture shows: the one with the greatest `rmse`.
    pub shown: u32,
    /// The picture, a file in the folder.
    pub picture: Option<String>,
    /// The map of its errors, a file in the folder.
    pub map: Option<String>,
}

impl Row {
    /// An error by its metric's name, where it has a value.
    pub fn error(&self, metric: &str) -> Option<f64> {
        self.error.get(metric).copied().flatten()
    }

    /// Whether it was compared with the reference and no pixel differed.
    pub fn is_exact(&self) -> bool {
        self.error("max_abs") == Some(0.0)
    }
}
