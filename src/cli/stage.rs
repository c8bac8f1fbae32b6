//! What is rendered: the scene from disk, the camera in it, and what the command line leaves to the scene.

use super::options::{Options, Reading, View, check_size};
use super::progress::Drawing;
use super::values::Size;
use super::{Failure, stdout};
use raywalk::scene::start::Entry;
use raywalk::scene::{self, Camera, LoadOptions, Scene, SceneError};
use raywalk::settings::Settings;
use std::sync::Arc;
use std::time::Instant;

/// The picture's size where neither the command line nor the scene gives one.
pub const DEFAULT_SIZE: Size = Size { width: 1280, height: 720 };

/// A scene that was read.
#[derive(Debug)]
pub struct Loaded {
    pub scene: Arc<Scene>,
    /// Milliseconds that took, building included.
    pub total_ms: f64,
}

/// Everything that is set up before the first frame.
#[derive(Debug)]
pub struct Stage {
    pub loaded: Loaded,
    /// The camera of the first frame; a path may move it.
    pub camera: Camera,
    pub size: Size,
    /// With nothing left to the scene.
    pub settings: Settings,
}

/// Reads the scene and tells its warnings on stderr, unless they were not wanted.
pub fn load(reading: &Reading) -> Result<Loaded, SceneError> {
    let options = LoadOptions {
        strict: reading.strict,
        limits: reading.limits.clone(),
        environment: reading.environment.clone(),
        progress: reading.progress.clone(),
        ..LoadOptions::default()
    };
    let _shown = Drawing::of_load(&reading.progress, reading.quiet);
    let start = Instant::now();
    let scene = match &reading.scene {
        Some(file) => scene::load(file, &options)?,
        None => scene::builtin(&options)?,
    };
    let total_ms = start.elapsed().as_secs_f64() * 1e3;
    Ok(Loaded { scene: Arc::new(scene), total_ms })
}

impl Stage {
    /// Reads the scene and resolves what the command line left to it.
    pub fn set(options: &Options) -> Result<Self, Failure> {
        let loaded = load(&options.reading)?;
        let scene = &loaded.scene;
        if !options.reading.quiet {
            scene.warnings.iter().for_each(|warning| stdout::note(&format!("warning: {warning}")));
        }
        let (_, camera) = camera(scene, &options.view)?;
        let size = match options.view.size {
            Some(size) => size,
            None => size_of(scene, options)?,
        };
        let stage = Self { loaded, camera, size, settings: Settings::default() };
        Ok(stage.with_settings(&options.settings))
    }

    /// The same with other settings, what they leave to the scene filled in.
    pub fn with_settings(mut self, settings: &Settings) -> Self {
        self.settings = self.loaded.scene.resolved(settings);
        self
    }
}

/// The size that the scene asks for; a side it leaves out follows from the other at 16:9.
fn size_of(scene: &Scene, options: &Options) -> Result<Size, Failure> {
    let size = match (scene.render.width, scene.render.height) {
        (Some(width), Some(height)) => Size { width, height },
        (Some(width), None) => Size { width, height: (u64::from(width) * 9 / 16).max(1) as u32 },
        (None, Some(height)) => Size { width: (u64::from(height) * 16 / 9).max(1) as u32, height },
        (None, None) => DEFAULT_SIZE,
    };
    check_size(size, &options.reading.limits).map_err(|message| Failure::Run(format!("{}: {message}", scene.name)))?;
    Ok(size)
}

/// The camera named, with what the command line changes, and its name.
pub fn camera(scene: &Scene, view: &View) -> Result<(String, Camera), Failure> {
    let named = match &view.camera {
        None => scene.cameras.first(),
        Some(wanted) => scene
            .cameras
            .iter()
            .find(|camera| camera.name == *wanted)
            .or_else(|| wanted.parse::<usize>().ok().and_then(|index| scene.cameras.get(index))),
    };
    let named = named.ok_or_else(|| {
        let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
        let wanted = view.camera.as_deref().unwrap_or_default();
        Failure::Usage(format!("--camera: {} has no camera {wanted}; it has {}", scene.name, names.join(", ")))
    })?;
    let base = named.camera;
    // Elsewhere, the lens that framed the scene means nothing.
    let is_elsewhere = view.eye.is_some() && scene.start.entry != Entry::Camera;
    let fov = if is_elsewhere { Camera::default().fov } else { base.fov };
    let camera = Camera {
        eye: view.eye.map_or(base.eye, |eye| (eye - scene.origin).as_vec3()),
        look_at: view.look_at.map_or(base.look_at, |point| (point - scene.origin).as_vec3()),
        up: view.up.map_or(base.up, |up| up.as_vec3()),
        fov: view.fov.unwrap_or(fov),
        ..base
    };
    if camera.is_valid() {
        return Ok((named.name.clone(), camera));
    }
    let Camera { eye, look_at, up, .. } = camera;
    let (eye, look_at) = (scene.in_file(eye), scene.in_file(look_at));
    Err(Failure::Usage(format!(
        "no view from {eye} to {look_at} with {up} up: choose --look-at apart from --eye, and --up across the view"
    )))
}
