//! Scene files by format: one row a format, one reader a row.

mod encoding;
mod faults;
mod gltf;
mod json;
mod nff;
mod obj;
mod place;
mod polygon;
mod words;
mod xml;

pub use json::read_camera;

use super::build::{Instancing, SceneBuilder};
use super::desc::SceneDesc;
use super::desc::problem::{At, Outcome, Warnings};
use super::environment::EnvironmentChoice;
use super::error::{Place, SceneError, Warning};
use super::files::{FileError, Files};
use super::guard::guarded;
use super::{Limits, Progress, Scene};
use std::path::Path;

/// How a scene is loaded.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Make warnings errors.
    pub strict: bool,
    /// What the scene may ask of the machine.
    pub limits: Limits,
    /// When meshes that are placed several times are stored once.
    pub instancing: Instancing,
    /// What surrounds the scene.
    pub environment: EnvironmentChoice,
    /// Is told how far the load has come, and may end it.
    pub progress: Progress,
}

/// The scene or model file that a reader is given.
pub struct Input<'a> {
    /// Its path from where the user stands, for messages.
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
    /// Whether its files say how they are lit: without lights and sky, the viewer need not find a light for them.
    pub says_how_it_is_lit: bool,
    /// Reads a file of the format into a scene under construction.
    pub read: fn(&Input, &mut SceneBuilder) -> Result<(), SceneError>,
}

impl Format {
    /// The format of a file, by its name.
    pub fn of(path: &Path) -> Option<&'static Self> {
        find(&path.file_name()?.to_string_lossy())
    }

    /// The extensions of all formats, for messages.
    pub fn known() -> String {
        FORMATS.iter().flat_map(|f| f.extensions).map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ")
    }
}

/// Every format.
pub const FORMATS: &[Format] = &[
    Format { name: "JSON", extensions: &["json"], says_how_it_is_lit: true, read: json::read },
    Format { name: "XML", extensions: &["xml"], says_how_it_is_lit: true, read: xml::read },
    Format { name: "NFF", extensions: &["nff"], says_how_it_is_lit: true, read: nff::read },
    Format { name: "OBJ", extensions: &["obj", "obj.zst"], says_how_it_is_lit: false, read: obj::read },
    Format { name: "glTF", extensions: &["gltf", "glb"], says_how_it_is_lit: false, read: gltf::read },
];

/// Loads a scene from a file; its format is known by its extension.
///
/// # Errors
/// The file cannot be read, is of no known format, or says something wrong; with [`strict`](LoadOptions::strict), also
/// something odd. Or the load was cancelled.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let files = Files::beside(path, &options.limits).map_err(|error| unreadable(path, error))?;
    let mut files = files.told_to(&options.progress);
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
    let mut files = Files::embedded(files, &options.limits).told_to(&options.progress);
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
    read(&input, Files::embedded(&[], &options.limits).told_to(&options.progress), options)
}

fn read(input: &Input, files: Files, options: &LoadOptions) -> Result<Scene, SceneError> {
    let place = || whole(input.path);
    // The readers and the libraries below them are meant never to panic; should one, this scene is all that is lost.
    let built = guarded(|| build(input, files, options))
        .unwrap_or_else(|message| Err(SceneError::Broken { place: place(), message }));
    // Whoever was told to stop may have made a warning or an error of it.
    if options.progress.is_cancelled() {
        return Err(SceneError::Cancelled { place: place() });
    }
    let mut scene = built?;
    if scene.objects.is_empty() {
        let message = "the scene holds no object; the picture is its background".to_owned();
        scene.warnings.push(Warning { place: whole(input.path), message });
    }
    match scene.warnings.first() {
        Some(warning) if options.strict => Err(SceneError::Invalid {
            place: warning.place.clone(),
            message: format!("{} (a warning, which --strict makes an error)", warning.message),
        }),
        _ => Ok(scene),
    }
}

fn build(input: &Input, files: Files, options: &LoadOptions) -> Result<Scene, SceneError> {
    let format = format_of(input.path)?;
    let mut builder = SceneBuilder::new(input.path, format, files, options);
    builder.surround(&options.environment)?;
    (format.read)(input, &mut builder)?;
    builder.finish().ok_or_else(|| SceneError::Cancelled { place: whole(input.path) })
}

/// Reads a file of any format into a scene under construction.
pub(super) fn read_into(builder: &mut SceneBuilder, input: &Input) -> Result<(), SceneError> {
    (format_of(input.path)?.read)(input, builder)
}

/// Adds what a reader has described. `places` finds the places of positions, if there is anything to tell of them.
fn settle(
    described: Outcome<SceneDesc>,
    mut warnings: Warnings,
    builder: &mut SceneBuilder,
    places: impl Fn(&[At]) -> Vec<Place>,
) -> Result<(), SceneError> {
    let added = described.and_then(|scene| builder.add(scene, &mut warnings));
    added
        .map_err(|problem| SceneError::Invalid { place: places(&[problem.at]).remove(0), message: problem.message })?;
    builder.warn(placed(warnings, places));
    Ok(())
}

/// Warnings with their places.
fn placed(warnings: Warnings, places: impl Fn(&[At]) -> Vec<Place>) -> Vec<Warning> {
    let problems = warnings.into_problems();
    if problems.is_empty() {
        return Vec::new();
    }
    let positions: Vec<At> = problems.iter().map(|problem| problem.at).collect();
    let placed = problems.into_iter().zip(places(&positions));
    placed.map(|(problem, place)| Warning { place, message: problem.message }).collect()
}

/// The format of a file, by its name.
fn format_of(path: &Path) -> Result<&'static Format, SceneError> {
    Format::of(path)
        .ok_or_else(|| SceneError::UnknownFormat { file: path.display().to_string(), known: Format::known() })
}

/// The format that a file's name tells.
fn find(file_name: &str) -> Option<&'static Format> {
    let name = file_name.to_lowercase();
    let ends = |extension: &&str| name.strip_suffix(*extension).is_some_and(|rest| rest.ends_with('.'));
    FORMATS.iter().find(|format| format.extensions.iter().any(ends))
}

/// A file as a whole.
fn whole(path: &Path) -> Place {
    Place { file: path.to_owned(), line_column: None, pointer: String::new() }
}

fn unreadable(path: &Path, error: FileError) -> SceneError {
    let place = whole(path);
    match error {
        FileError::Cancelled => SceneError::Cancelled { place },
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
