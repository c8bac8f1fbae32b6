//! What surrounds a scene: a sky that lights it from everywhere and is seen where nothing is in the way.

use super::sky::{Blurred, SkyMap};
use glam::Vec3;
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

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

/// In words, such as `image sky.hdr 2048x1024, rotation 30`.
impl fmt::Display for Environment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.sky {
            Sky::Gradient(_) => f.write_str("gradient")?,
            Sky::Studio => f.write_str("studio")?,
            Sky::Image(image) => {
                let SkyImage { name, width, height, source: (across, down), .. } = &**image;
                write!(f, "image {name} {width}x{height}")?;
                if (*across, *down) != (*width, *height) {
                    write!(f, " (reduced from {across}x{down})")?;
                }
            }
        }
        if self.rotation != 0.0 {
            write!(f, ", rotation {}", self.rotation)?;
        }
        if self.intensity != 1.0 {
            write!(f, ", intensity {}", self.intensity)?;
        }
        f.write_str(if self.backdrop { "" } else { ", not seen behind the scene" })
    }
}

/// The radiance of a sky in every direction.
#[derive(Clone, Debug)]
pub enum Sky {
    /// Linear in the sine of the elevation, from the horizon up and down.
    Gradient(Gradient),
    /// A neutral gradient with soft lights in it, for files that say nothing of how they are lit.
    Studio,
    /// A picture of all directions.
    Image(Arc<SkyImage>),
}

impl PartialEq for Sky {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Gradient(a), Self::Gradient(b)) => a == b,
            (Self::Studio, Self::Studio) => true,
            // The window asks often, and of one picture: its texels are not compared then.
            (Self::Image(a), Self::Image(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => false,
        }
    }
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

/// An equirectangular picture: its middle is seen along -Z, its left and right edges along +Z, its top row straight up; what is
/// right of its middle is seen along +X.
#[derive(Clone, Debug)]
pub struct SkyImage {
    /// Name of its file, for people.
    pub name: String,
    /// In texels, at least 1.
    pub width: u32,
    /// In texels, at least 1.
    pub height: u32,
    /// Width and height in the file: larger where the picture was reduced.
    pub source: (u32, u32),
    /// Linear radiance, finite and at least 0, row by row from the top.
    pub texels: Box<[[f32; 3]]>,
    /// What rough and matte surfaces get of it, once somebody asked.
    pub(in crate::scene) blurred: OnceLock<Blurred>,
}

/// Pictures are equal if they show the same; whether anybody asked for their blurred ones is nothing of theirs.
impl PartialEq for SkyImage {
    fn eq(&self, other: &Self) -> bool {
        let of = |image: &Self| (image.width, image.height, image.source);
        self.name == other.name && of(self) == of(other) && self.texels == other.texels
    }
}

impl SkyImage {
    /// A picture that was not reduced; `None` unless there is at least one texel and as many as the size says.
    pub fn new(name: &str, size: (u32, u32), texels: Box<[[f32; 3]]>) -> Option<Self> {
        let (width, height) = size;
        let count = u64::from(width) * u64::from(height);
        let is_whole = count > 0 && count == texels.len() as u64;
        let blurred = OnceLock::new();
        is_whole.then(|| Self { name: name.to_owned(), width, height, source: size, texels, blurred })
    }

    /// Its texels by direction.
    pub fn map(&self) -> SkyMap<'_> {
        SkyMap { width: self.width, height: self.height, texels: &self.texels }
    }

    /// What rough and matte surfaces get of it.
    pub fn blurred(&self) -> &Blurred {
        self.blurred.get_or_init(|| Blurred::of(self.map()))
    }
}

/// Which environment a scene is loaded with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum EnvironmentChoice {
    /// That of its file.
    #[default]
    Scene,
    /// None.
    None,
    /// The built-in studio.
    Studio,
    /// An image file, wherever it is.
    File(PathBuf),
}

impl EnvironmentChoice {
    /// The choice that `--environment` names: `studio`, `none`, or the path of an image.
    pub fn named(name: &OsStr) -> Self {
        match name.to_str() {
            Some("studio") => Self::Studio,
            Some("none") => Self::None,
            _ => Self::File(name.into()),
        }
    }

    /// The value of `--environment` that names this choice; `None` for the scene's own environment, which has no name.
    pub fn name(&self) -> Option<&OsStr> {
        match self {
            Self::Scene => None,
            Self::None => Some("none".as_ref()),
            Self::Studio => Some("studio".as_ref()),
            Self::File(path) => Some(path.as_os_str()),
        }
    }

    /// Whether a file of this name is an image that can surround a scene.
    pub fn is_image(path: &Path) -> bool {
        path.extension()
            .is_some_and(|extension| SKY_EXTENSIONS.iter().any(|known| extension.eq_ignore_ascii_case(known)))
    }
}

/// Extensions of images that can surround a scene.
pub const SKY_EXTENSIONS: [&str; 2] = ["hdr", "exr"];
