//! What is meant by a path that was dropped, chosen or typed: a scene file, or the one in a folder.

use crate::scene::Format;
use crate::scene::path::CameraPath;
use std::io;
use std::path::{Path, PathBuf};

/// Most scene files of a folder that are listed.
const LISTED: usize = 8;

/// Why there is nothing to open.
#[derive(Debug, thiserror::Error)]
pub enum NoScene {
    /// The folder cannot be read.
    #[error("{}: cannot read the folder: {source}", folder.display())]
    Unreadable {
        /// The folder.
        folder: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// Nothing in it is a scene.
    #[error("{}: there is no scene file in this folder; known: {known}", folder.display())]
    None {
        /// The folder.
        folder: PathBuf,
        /// Extensions that can be read.
        known: String,
    },
    /// There are several.
    #[error("{}: there are {count} scene files in this folder; open one of them: {names}", folder.display())]
    Several {
        /// The folder.
        folder: PathBuf,
        /// How many.
        count: usize,
        /// Their names, as far as there is room for them.
        names: String,
    },
}

/// Whether a file is a walk through a scene, such as those that are recorded beside it.
fn is_camera_path(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) && CameraPath::load(file).is_ok()
}

/// The scene file that `path` is, or that is the only one in it. What is no folder is left for the loader to judge.
///
/// # Errors
/// A folder without a scene file, or with several.
pub fn scene_file(path: &Path) -> Result<PathBuf, NoScene> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let folder = || path.to_owned();
    let unreadable = |source| NoScene::Unreadable { folder: folder(), source };
    let mut names = Vec::new();
    for entry in path.read_dir().map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let file = entry.path();
        if Format::of(Path::new(&entry.file_name())).is_some() && file.is_file() && !is_camera_path(&file) {
            names.push(entry.file_name());
        }
    }
    names.sort();
    match &names[..] {
        [] => Err(NoScene::None { folder: folder(), known: Format::known() }),
        [one] => Ok(path.join(one)),
        many => {
            let mut listed: Vec<_> = many.iter().take(LISTED).map(|name| name.to_string_lossy()).collect();
            if many.len() > LISTED {
                listed.push("...".into());
            }
            Err(NoScene::Several { folder: folder(), count: many.len(), names: listed.join(", ") })
        }
    }
}

/// Of several things dropped at once, the one to open: the first that is a scene or a folder, else the first.
pub fn best(paths: &[PathBuf]) -> Option<&PathBuf> {
    paths.iter().find(|path| Format::of(path).is_some() || path.extension().is_none()).or(paths.first())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temporary::Folder;

    #[test]
    fn a_folder_opens_its_one_scene_or_says_which_there_are() {
        let folder = Folder::new();
        let said = |path: &Path| scene_file(path).expect_err("no scene").to_string();
        assert!(said(folder.path()).contains("no scene file") && said(folder.path()).contains(".gltf"));
        folder.write("notes.txt", "");
        folder.write("room.glb", "");
        assert_eq!(scene_file(folder.path()).expect("one"), folder.path().join("room.glb"));
        let key = r#"{ "t": 0, "position": [0, 0, 0], "look_at": [0, 0, 1] }"#;
        folder.write("raywalk-path-0001.json", format!(r#"{{ "version": 1, "fps": 60, "keys": [{key}] }}"#));
        assert_eq!(scene_file(folder.path()).expect("one"), folder.path().join("room.glb"));
        folder.write("Hall.OBJ", "");
        let several = said(folder.path());
        assert!(several.contains("2 scene files") && several.contains("Hall.OBJ, room.glb"), "{several}");
        let file = folder.path().join("no.such");
        assert_eq!(scene_file(&file).expect("left to the loader"), file);
    }

    #[test]
    fn of_a_model_and_what_belongs_to_it_the_model_is_opened() {
        let paths = ["wood.png", "chair.mtl", "chair.obj"].map(PathBuf::from);
        assert_eq!(best(&paths), Some(&paths[2]));
        assert_eq!(best(&paths[..1]), Some(&paths[0]), "for an error that names it");
        assert_eq!(best(&[]), None);
    }
}
