//! Scene files by format: one row a format, one reader a row.

mod gltf;
mod json;
mod place;

use super::build::SceneBuilder;
use super::error::{Place, SceneError};
use super::files::{FileError, Files};
use super::{Limits, Scene};
use std::path::Path;

/// How a scene is loaded.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Make warnings errors.
    pub strict: bool,
    /// What the scene may ask of the machine.
    pub limits: Limits,
}

/// The scene file that a reader is given.
pub struct Input<'a> {
    /// Its path as the user gave it, for messages.
    pub path: &'a Path,
    /// Its contents.
    pub bytes: &'a [u8],
}

/// A scene format.
pub struct Format {
    /// What it is called.
    pub name: &'static str,
    /// How names of its files end, without the dot, in lower case.
    pub extensions: &'static [&'static str],
    /// Reads a file of the format into a scene under construction.
    pub read: fn(&Input, &mut SceneBuilder) -> Result<(), SceneError>,
}

/// Every format.
pub const FORMATS: &[Format] = &[
    Format { name: "JSON", extensions: &["json"], read: json::read },
    Format { name: "glTF", extensions: &["gltf", "glb"], read: gltf::read },
];

/// Loads a scene from a file; its format is known by its extension.
///
/// # Errors
/// The file cannot be read, is of no known format, or says something wrong; with
/// [`strict`](LoadOptions::strict), also something odd.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let mut files = Files::beside(path, &options.limits).map_err(|error| unreadable(path, error))?;
    let bytes = files.read(path).map_err(|error| unreadable(path, error))?;
    read(&Input { path, bytes: &bytes }, files, options)
}

/// Loads a scene from `files` in memory, the scene being the file called `name`.
///
/// # Errors
/// As for [`load`].
pub fn load_embedded(
    name: &str,
    files: &'static [(&'static str, &'static [u8])],
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let mut files = Files::embedded(files, &options.limits);
    let path = Path::new(name);
    let bytes = files.read(path).map_err(|error| unreadable(path, error))?;
    read(&Input { path, bytes: &bytes }, files, options)
}

/// Loads a scene from text that was made rather than read; `name` tells its format, and it can name no other file.
///
/// # Errors
/// As for [`load`].
pub fn load_text(name: &str, text: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    let input = Input { path: Path::new(name), bytes: text.as_bytes() };
    read(&input, Files::embedded(&[], &options.limits), options)
}

fn read(input: &Input, files: Files, options: &LoadOptions) -> Result<Scene, SceneError> {
    let file_name = input.path.file_name().unwrap_or_default().to_string_lossy();
    let format = find(&file_name).ok_or_else(|| SceneError::UnknownFormat {
        file: input.path.display().to_string(),
        known: FORMATS.iter().flat_map(|f| f.extensions).map(|e| format!(".{e}")).collect::<Vec<_>>().join(", "),
    })?;
    let mut builder = SceneBuilder::new(&file_name, files, options.limits.clone());
    (format.read)(input, &mut builder)?;
    let scene = builder.finish();
    match scene.warnings.first() {
        Some(warning) if options.strict => Err(SceneError::Invalid {
            place: warning.place.clone(),
            message: format!("{} (a warning, which --strict makes an error)", warning.message),
        }),
        _ => Ok(scene),
    }
}

/// The format that a file's name tells.
fn find(file_name: &str) -> Option<&'static Format> {
    let name = file_name.to_lowercase();
    let ends = |extension: &&str| name.strip_suffix(*extension).is_some_and(|rest| rest.ends_with('.'));
    FORMATS.iter().find(|format| format.extensions.iter().any(ends))
}

fn unreadable(path: &Path, error: FileError) -> SceneError {
    let place = Place { file: path.to_owned(), line_column: None, pointer: String::new() };
    match error {
        FileError::Io(source) => SceneError::Io { place, what: "the scene".to_owned(), source },
        other => SceneError::Invalid { place, message: format!("cannot read the scene: {other}") },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_format_is_known_by_its_extension_in_any_case() {
        for format in FORMATS {
            for extension in format.extensions {
                assert_eq!(find(&format!("a.{extension}")).map(|f| f.name), Some(format.name));
                assert_eq!(find(&format!("A.{}", extension.to_uppercase())).map(|f| f.name), Some(format.name));
                assert!(find(extension).is_none());
            }
        }
        assert!(find("scene.txt").is_none() && find("").is_none());
    }
}
