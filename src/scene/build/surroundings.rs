//! What surrounds a scene: its file's own environment, or the one that the load asks for in its place.

use super::refused::Refused;
use super::sky::{self, Allowed, Decoded, SkyError};
use super::{ImageStore, SceneBuilder};
use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{Outcome, Problem, Warnings};
use crate::scene::desc::{EnvironmentDesc, NameRef, SkyDesc};
use crate::scene::environment::{Environment, EnvironmentChoice, Sky, SkyImage};
use crate::scene::error::{Place, SceneError, Warning};
use crate::scene::files::{FileError, Files};
use crate::scene::limits::Limits;
use crate::scene::progress::Progress;
use std::path::Path;
use std::sync::Arc;

impl SceneBuilder {
    /// Takes the environment that the load asks for; before the scene is read, so that a file that is missing is told of soon.
    ///
    /// # Errors
    /// Its image cannot be read.
    pub fn surround(&mut self, choice: &EnvironmentChoice) -> Result<(), SceneError> {
        self.environment_choice = choice.clone();
        self.environment = match choice {
            EnvironmentChoice::Scene | EnvironmentChoice::None => None,
            EnvironmentChoice::Studio => Some(Environment::new(Sky::Studio)),
            EnvironmentChoice::File(path) => {
                let (image, warnings) = read_sky(path, &self.limits, self.images.bytes_left(), &self.progress)?;
                self.images.take(sky::size_of(&image));
                self.warn(warnings);
                Some(Environment::new(Sky::Image(Arc::new(image))))
            }
        };
        Ok(())
    }

    /// Takes the environment that the scene's file gives, unless another was asked for.
    pub(super) fn surround_as_described(
        &mut self,
        described: Option<EnvironmentDesc>,
        warnings: &mut Warnings,
    ) -> Outcome<()> {
        let Some(described) = described.filter(|_| self.environment_choice == EnvironmentChoice::Scene) else {
            return Ok(());
        };
        let EnvironmentDesc { sky, rotation, intensity, backdrop } = described;
        let sky = match sky {
            SkyDesc::Gradient(gradient) => Sky::Gradient(gradient),
            SkyDesc::Studio => Sky::Studio,
            SkyDesc::Image(name) => {
                let image = image(&name, &mut self.images, &self.limits, &self.progress, warnings)?;
                Sky::Image(Arc::new(image))
            }
        };
        self.environment = Some(Environment { sky, rotation, intensity, backdrop });
        Ok(())
    }
}

/// The image that a scene file names.
fn image(
    name: &NameRef,
    images: &mut ImageStore,
    limits: &Limits,
    progress: &Progress,
    warnings: &mut Warnings,
) -> Outcome<SkyImage> {
    let shown = shortened(&name.name);
    let bytes = images.files().locate(&name.name).and_then(|path| images.files().read(&path));
    let bytes =
        bytes.map_err(|error| Problem::new(name.at, format!("cannot read the environment \"{shown}\": {error}")))?;
    let decoded = decode(Path::new(&name.name), &bytes, limits, images.bytes_left(), progress);
    let Decoded { image, odd } = decoded
        .map_err(|error| Problem::new(name.at, format!("cannot decode the environment \"{shown}\": {error}")))?;
    images.take(sky::size_of(&image));
    odd.into_iter().for_each(|odd| warnings.push(name.at, format!("the environment \"{shown}\": {odd}")));
    Ok(image)
}

/// Reads an image of the sky that the user names, wherever it is. It may take `bytes_left` bytes.
///
/// # Errors
/// It cannot be read, is no such image, is damaged or breaks a limit; or the load was cancelled.
pub fn read_sky(
    path: &Path,
    limits: &Limits,
    bytes_left: u64,
    progress: &Progress,
) -> Result<(SkyImage, Vec<Warning>), SceneError> {
    let place = || Place { file: path.to_owned(), line_column: None, pointer: String::new() };
    let read = || Files::beside(path, limits)?.told_to(progress).read(path);
    let bytes = read().map_err(|error| match error {
        FileError::Cancelled => SceneError::Cancelled { place: place() },
        FileError::Io(source) => SceneError::Io { place: place(), what: "the environment".to_owned(), source },
        other => SceneError::Invalid { place: place(), message: format!("cannot read the environment: {other}") },
    })?;
    let Decoded { image, odd } = decode(path, &bytes, limits, bytes_left, progress).map_err(|error| match error {
        SkyError::Refused(Refused::Cancelled) => SceneError::Cancelled { place: place() },
        other => SceneError::Invalid { place: place(), message: format!("cannot decode the environment: {other}") },
    })?;
    let odd = odd.into_iter().map(|odd| Warning { place: place(), message: format!("the environment: {odd}") });
    Ok((image, odd.collect()))
}

/// Decodes an image, which is called as its file.
fn decode(
    path: &Path,
    bytes: &[u8],
    limits: &Limits,
    bytes_left: u64,
    progress: &Progress,
) -> Result<Decoded, SkyError> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    progress.begin(format!("decoding {name}"), 0);
    sky::decode(&name, bytes, Allowed { limits, bytes: bytes_left, progress })
}
