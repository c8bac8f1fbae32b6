//! One piece of a bench: methods that are compared on one view, or along one walk.

use super::Method;
use crate::measure::records::Part;
use crate::render::{Film, Planes, Scratch, render_frame};
use crate::scene::{Camera, Scene};
use crate::settings::{Settings, Supersample};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;
use std::slice;
use std::sync::Arc;
use std::time::Duration;

/// What is looked at.
#[derive(Clone, Debug)]
pub struct View {
    /// The scene's name in records.
    pub name: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// What the camera is called, or how it moves.
    pub camera_name: String,
    /// The camera; of a path, that of its first frame.
    pub camera: Camera,
    /// The camera of every frame of a path; none for a still view.
    pub path: Vec<Camera>,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

impl View {
    /// What it is looked at from: one camera, or all of the path.
    pub fn cameras(&self) -> &[Camera] {
        if self.path.is_empty() { slice::from_ref(&self.camera) } else { &self.path }
    }

    /// The same with at most `count` cameras of its path, evenly apart, the first and the last among them.
    pub fn sampled(mut self, count: usize) -> Self {
        let last = self.path.len().saturating_sub(1);
        if count < self.path.len() {
            self.path = (0..count).map(|i| self.path[i * last / count.saturating_sub(1).max(1)]).collect();
        }
        self
    }

    /// The same at rest where a path would begin.
    pub fn still(mut self) -> Self {
        self.path.clear();
        self
    }

    /// Its name among the views of an environment.
    pub fn full_name(&self) -> String {
        format!("{}, {}", self.name, self.camera_name)
    }

    /// A short name for what is to be seen: the size, and a number for every camera and a small picture from the first.
    /// Textures and everything else that a scene's file only names count through the picture.
    pub fn fingerprint(&self, settings: &Settings) -> String {
        let mut hasher = DefaultHasher::new();
        format!("{:?}", self.cameras()).hash(&mut hasher);
        let mut film = Film::new(160, 90, Planes::default());
        render_frame(&self.scene, &self.camera, settings, &mut Scratch::default(), &mut film);
        film.rgba().hash(&mut hasher);
        let (width, height) = self.size;
        format!("{width}x{height} {:08x}", hasher.finish() as u32)
    }
}

/// What a method's picture is held against.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The scene, which may be another than the one measured.
    pub scene: Arc<Scene>,
    /// Its camera. Along a path it is the path's.
    pub camera: Camera,
    /// How it is rendered.
    pub settings: Settings,
}

/// How pictures are judged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Judge {
    /// Not at all: only time counts.
    Time,
    /// By every metric.
    Metrics,
    /// By the share of visibly wrong pixels among those where the reference shows one of these objects, or among all.
    Wrong(Option<Range<u32>>),
}

/// Methods measured against each other, in alternation.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Which chart it feeds.
    pub part: Part,
    /// What is looked at. Each camera of a path is looked at once, and they take turns from round to round.
    pub view: View,
    /// The chart's other axis, such as a wire's width; `None` where it has none.
    pub at: Option<f64>,
    /// What pictures are held against.
    pub reference: Reference,
    /// How they are judged.
    pub judge: Judge,
    /// Whether pictures and maps of their errors are kept.
    pub keeps_pictures: bool,
    /// The methods.
    pub methods: Vec<Method>,
    /// Visits of each method, at most; 0 looks at pictures alone.
    pub rounds: u32,
    /// No new visit starts after this time; each method is looked at once in any case.
    pub budget: Duration,
    /// A frame that takes longer is cut off, and its method left; see [`Method::is_measure`].
    pub longest_frame: Duration,
}

/// Methods along a moving camera: their errors from frame to frame.
#[derive(Clone, Debug)]
pub struct Walk {
    /// What is looked at, along its path.
    pub view: View,
    /// How the reference is rendered.
    pub reference: Settings,
    /// The methods.
    pub methods: Vec<Method>,
    /// As many frames are followed as probably fit into this time.
    pub budget: Duration,
}

/// One piece of a bench.
#[derive(Clone, Debug)]
pub enum Job {
    /// On one view.
    Compare(Comparison),
    /// Along a path.
    Walk(Walk),
}

impl View {
    /// Roughly the milliseconds of one frame, at least 1: what progress is counted in.
    fn frame_cost(&self, settings: &Settings) -> u64 {
        /// Of one ray with all that it leads to, and the primitives that are tested without a tree in the same time.
        const RAY_MS: f64 = 5e-5;
        const TESTS: f64 = 40.0;
        let rays = match settings.supersample {
            Supersample::Off => 1,
            Supersample::Adaptive => 4,
            Supersample::Grid { side } => side * side,
        };
        let tests = if settings.bvh { 0.0 } else { self.scene.geometry.len() as f64 / TESTS };
        let pixels = f64::from(self.size.0) * f64::from(self.size.1);
        (pixels * f64::from(rays) * RAY_MS * (1.0 + tests)).max(1.0) as u64
    }
}

impl Comparison {
    /// What looking at a method's pictures, or one visit of it, counts in progress.
    pub fn step(&self, method: &Method) -> u64 {
        self.view.frame_cost(&method.settings).clamp(1, self.longest_frame.as_millis().max(1) as u64)
    }
}

impl Walk {
    /// What following a method counts in progress.
    pub fn step(&self) -> u64 {
        self.view.frame_cost(&self.reference) * self.view.path.len() as u64
    }
}

impl Job {
    /// All of its steps of progress.
    pub fn steps(&self) -> u64 {
        match self {
            Self::Compare(job) => job.methods.iter().map(|method| job.step(method) * u64::from(1 + job.rounds)).sum(),
            Self::Walk(job) => job.step() * job.methods.len() as u64,
        }
    }

    /// The scene it looks at.
    pub fn scene_name(&self) -> &str {
        match self {
            Self::Compare(job) => &job.view.name,
            Self::Walk(job) => &job.view.name,
        }
    }
}
