//! What surrounds a scene: a sky that lights it from everywhere and is seen where nothing is in the way.

use super::sky::SkyImage;
use glam::Vec3;
use std::sync::Arc;

/// A sky around the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// What it looks like.
    pub sky: Sky,
    /// Degrees by which it is turned to the left, about +Y.
    pub rotation: f32,
    /// Multiplies its radiance; at least 0.
    pub intensity: f32,
    /// Whether rays from the eye that hit nothing show it; else they show the scene's background.
    pub backdrop: bool,
}

impl Environment {
    /// A sky as it is, shown behind the scene.
    pub fn new(sky: Sky) -> Self {
        Self { sky, rotation: 0.0, intensity: 1.0, backdrop: true }
    }
}

/// The radiance of a sky in every direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// Linear in the sine of the elevation, from the horizon up and down.
    Gradient(Gradient),
    /// A neutral gradient with soft lights in it, for files that say nothing of how they are lit.
    Studio,
    /// A picture of all directions.
    Image(Arc<SkyImage>),
}

/// Radiance in linear colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient {
    /// Straight up.
    pub zenith: Vec3,
    /// Level.
    pub horizon: Vec3,
    /// Straight down.
    pub ground: Vec3,
}
