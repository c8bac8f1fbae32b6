//! Which frames a run has, and where the camera is in each.

use super::Failure;
use super::options::Options;
use raywalk::scene::{Camera, CameraPath, Scene, Warning};
use std::ops::Range;

/// The frames of a run.
#[derive(Clone, Debug)]
pub struct Frames {
    /// Their numbers.
    pub range: Range<u64>,
    /// What the camera moves along.
    path: Option<CameraPath>,
    /// Something odd about the range.
    pub warning: Option<Warning>,
}

impl Frames {
    /// The frames that `options` ask for: those named, else all of the path, else one.
    pub fn of(options: &Options) -> Result<Self, Failure> {
        let path = options.path.as_deref().map(CameraPath::load).transpose()?;
        let all = path.as_ref().map_or(1, CameraPath::frame_count);
        let range = options.frames.clone().unwrap_or(0..all);
        let warning = path.as_ref().zip(options.path.as_deref()).and_then(|(p, file)| p.warning(file, range.end));
        Ok(Self { range, path, warning })
    }

    /// The first of them alone.
    pub fn first(&self) -> Self {
        Self { range: self.range.start..self.range.start + 1, warning: None, ..self.clone() }
    }

    /// Whether each frame shows another view; else they all show the same.
    pub fn differ(&self) -> bool {
        self.path.is_some() && self.range.end - self.range.start > 1
    }

    /// Refuses a path that has a frame without a view, before the first is rendered.
    pub fn check(&self, base: &Camera, scene: &Scene) -> Result<(), Failure> {
        // Frames after the last key are like it.
        let last = self.path.as_ref().map_or(0, CameraPath::frame_count);
        let end = self.range.end.min(self.range.start.saturating_add(1).max(last));
        (self.range.start..end).try_for_each(|frame| self.camera(frame, base, scene).map(drop))
    }

    /// The camera of frame `frame` in `scene`, moving if there is a path, else `base`.
    pub fn camera(&self, frame: u64, base: &Camera, scene: &Scene) -> Result<Camera, Failure> {
        let Some(path) = &self.path else { return Ok(*base) };
        let camera = path.camera(frame, base, scene.origin);
        let message = || {
            format!(
                "frame {frame} of the camera path has no view: it looks at its own position, or along its up as all frames \
                 do; change its keys, or give it another \"up\""
            )
        };
        if camera.is_valid() { Ok(camera) } else { Err(Failure::Run(message())) }
    }
}
