//! The record of a run: what `--stats` writes, one JSON object.

use super::counts::SceneCounts;
use super::motion::{Motion, MotionMeter, RunError};
use super::run::{CpuTime, Run};
use super::statistics::Spread;
use super::system::peak_rss_bytes;
use crate::math::simd::SimdToken;
use crate::render::{FrameStats, thread_count};
use crate::scene::Scene;
use crate::settings::{ROWS, Settings};
use serde::Serialize;
use serde_json::Value;

/// What was rendered and how long its preparation took.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The settings, resolved: nothing is left to the scene or the machine.
    pub settings: Settings,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Milliseconds to read the scene, textures and models included, without `build_ms`.
    pub load_ms: f64,
    /// Milliseconds to build the kernels' data and the tree.
    pub build_ms: f64,
    /// Worker threads.
    pub threads: usize,
    /// Instruction set of the kernels.
    pub simd: &'static str,
}

/// One run as it is written. Counts and stage times are means per frame.
#[derive(Debug, Serialize)]
pub struct Record {
    scene: String,
    width: u32,
    height: u32,
    frames: usize,
    threads: usize,
    simd: &'static str,
    settings: Value,
    load_ms: f64,
    build_ms: f64,
    frame_ms: Spread,
    cpu_ms: CpuTime,
    rays: Value,
    pixels: Value,
    supersampled: Value,
    stages_ms: Value,
    shadow_cache: Value,
    certificates: Certificates,
    #[serde(flatten)]
    against_reference: Option<AgainstReference>,
    /// `null` where the system does not tell.
    peak_rss_bytes: Option<u64>,
    #[serde(flatten)]
    counts: SceneCounts,
}

/// How the run compares with its reference, where one was traced.
#[derive(Debug, Serialize)]
struct AgainstReference {
    /// `null` for a run of one frame.
    motion: Option<Motion>,
    error: RunError,
}

/// What beams proved.
#[derive(Debug, Serialize)]
struct Certificates {
    /// Share of all pixels whose block was proven to see one thing.
    certified_share: f64,
    /// Of the pixels in blocks with a list of candidates that see one thing, the share for which that was not proven.
    false_reject_rate: f64,
    /// Shadow rays a frame that were known to arrive, or not to, without being traced.
    shadow_rays_lit: Value,
    shadow_rays_dark: Value,
    /// Mirrored rays a frame that were tested against a list of candidates.
    mirrored_rays: Value,
}

impl<'a> Subject<'a> {
    /// Of a scene that took `total_ms` milliseconds to read and build; what `settings` leave to it is filled in.
    pub fn new(scene: &'a Scene, settings: &Settings, (width, height): (u32, u32), total_ms: f64) -> Self {
        Self {
            scene,
            settings: scene.resolved(settings),
            width,
            height,
            load_ms: total_ms - scene.build_ms,
            build_ms: scene.build_ms,
            threads: thread_count(settings.threads),
            simd: SimdToken::new(settings.simd).unwrap_or_else(SimdToken::best).name(),
        }
    }
}

impl Certificates {
    fn of(run: &Run) -> Self {
        let FrameStats { pixels, certificates, .. } = run.total();
        let all = pixels.traced + pixels.resolved + pixels.certified + pixels.interpolated;
        let share = |part: u64, whole: u64| part as f64 / whole.max(1) as f64;
        Self {
            certified_share: share(pixels.certified, all),
            false_reject_rate: share(certificates.refused, certificates.refused + pixels.certified),
            shadow_rays_lit: run.per_frame(&certificates.lit),
            shadow_rays_dark: run.per_frame(&certificates.dark),
            mirrored_rays: run.per_frame(&certificates.mirrored),
        }
    }
}

impl Record {
    /// The record of `run`, and of how it compares with its reference.
    pub fn new(subject: Subject<'_>, run: &Run, reference: Option<&MotionMeter>) -> Self {
        let Subject { scene, settings, width, height, load_ms, build_ms, threads, simd } = subject;
        let total = run.total();
        Self {
            scene: scene.name.clone(),
            width,
            height,
            frames: run.frames(),
            threads,
            simd,
            settings: with_environment(settings_json(&settings), scene),
            load_ms,
            build_ms,
            frame_ms: run.frame_ms(),
            cpu_ms: run.cpu_ms(),
            rays: run.per_frame(&total.rays),
            pixels: run.per_frame(&total.pixels),
            supersampled: run.per_frame(&total.supersampled),
            stages_ms: run.per_frame(&total.stages_ms),
            shadow_cache: run.per_frame(&total.shadow_cache),
            certificates: Certificates::of(run),
            against_reference: reference.map(|meter| AgainstReference { motion: meter.motion(), error: meter.error() }),
            peak_rss_bytes: peak_rss_bytes(),
            counts: SceneCounts::of(scene),
        }
    }
}

/// The settings, and what surrounds the scene.
fn with_environment(mut settings: Value, scene: &Scene) -> Value {
    let environment = scene.environment.as_ref().map_or_else(|| "none".to_owned(), ToString::to_string);
    settings["environment"] = environment.into();
    settings
}

/// Every setting by its name, as it would be typed.
pub(super) fn settings_json(settings: &Settings) -> Value {
    ROWS.iter().map(|row| (row.name.to_owned(), typed((row.get)(settings)))).collect()
}

/// A setting's text as JSON: numbers as numbers, names as strings.
fn typed(text: String) -> Value {
    match text.parse::<i64>() {
        Ok(whole) => whole.into(),
        Err(_) => text.parse::<f64>().map_or_else(|_| Value::String(text), Value::from),
    }
}
