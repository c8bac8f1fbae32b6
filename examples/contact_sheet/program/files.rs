//! The scene files of a folder.

use anyhow::{Context, ensure};
use raywalk::scene::Format;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// All scene files in `folder` and the folders in it, sorted by path. Links to folders are not followed.
pub fn scenes_in(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut waiting = vec![folder.to_owned()];
    while let Some(folder) = waiting.pop() {
        let named = || format!("{}: cannot read the folder", folder.display());
        for entry in fs::read_dir(&folder).with_context(named)? {
            let entry = entry.with_context(named)?;
            let path = entry.path();
            if entry.file_type().with_context(named)?.is_dir() {
                waiting.push(path);
            } else if Format::of(&path).is_some_and(|format| format.name != "JSON" || is_json_scene(&path))
                && path.is_file()
            {
                files.push(path);
            }
        }
    }
    ensure!(!files.is_empty(), "{}: there is no scene file in it; known: {}", folder.display(), Format::known());
    files.sort();
    Ok(files)
}

/// Whether a JSON file is not plainly something else: a camera path, or what gives no version as scenes do.
fn is_json_scene(path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Keys {
        version: Option<IgnoredAny>,
        keys: Option<IgnoredAny>,
    }
    let Ok(file) = File::open(path) else { return true };
    match serde_json::from_reader::<_, Keys>(BufReader::new(file)) {
        Ok(found) => found.version.is_some() && found.keys.is_none(),
        // A damaged scene is one, too; a list or a text is none.
        Err(error) => !error.is_data(),
    }
}
