//! The file that a [`Config`] is kept in.

use super::Config;
use crate::picture::{PendingFile, PictureError};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Larger files are none of ours.
const MAX_BYTES: u64 = 1 << 20;

/// Where the configuration is kept.
#[derive(Clone, Debug)]
pub struct Store {
    path: PathBuf,
    /// The file there cannot be read as a configuration: it makes way, but is not lost.
    broken: bool,
}

impl Store {
    /// The file in the user's folder for such things; `None` where there is no such folder.
    pub fn usual_path() -> Option<PathBuf> {
        Some(directories::ProjectDirs::from("", "", "raywalk")?.config_dir().join("config.json"))
    }

    /// Reads the file at `path`. A missing one is the default; for one that cannot be read there is a warning as well.
    pub fn open(path: PathBuf) -> (Self, Config, Option<String>) {
        let read = match read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Config::default()),
            Err(error) => Err(error.to_string()),
            Ok(text) => serde_json::from_str::<Config>(&text).map_err(|error| error.to_string()),
        };
        let (config, warning) = match read {
            Ok(config) => (config.within_ranges(), None),
            Err(reason) => {
                let warning = format!("{}: cannot read it, starting with the defaults: {reason}", path.display());
                (Config::default(), Some(warning))
            }
        };
        (Self { path, broken: warning.is_some() }, config, warning)
    }

    /// Writes `text` as the whole file, or leaves the old one.
    ///
    /// # Errors
    /// The system's reason, naming the file.
    pub fn write(&self, text: &str) -> Result<(), PictureError> {
        if let Some(folder) = self.path.parent() {
            // Where it cannot be made, the file cannot be either, and that tells more.
            let _ = fs::create_dir_all(folder);
        }
        if self.broken {
            // Should this fail, so will the rest, or the file was not there.
            let _ = fs::rename(&self.path, self.path.with_extension("json.broken"));
        }
        PendingFile::create(&self.path)?.commit(|sink| Ok(sink.write_all(text.as_bytes())?))
    }
}

fn read(path: &Path) -> io::Result<String> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() || metadata.len() > MAX_BYTES {
        return Err(io::Error::other("not a file of settings"));
    }
    fs::read_to_string(path)
}

#[cfg(test)]
mod tests {
    use super::super::Keeper;
    use super::*;
    use crate::picture::temporary::Folder;
    use crate::settings::Settings;

    #[test]
    fn a_missing_file_is_the_default_and_is_made_with_its_folders() {
        let folder = Folder::new();
        let path = folder.0.join("new/raywalk/config.json");
        let (store, config, warning) = Store::open(path.clone());
        assert_eq!((config, warning), (Config::default(), None));
        store.write("{ \"ui_scale\": 2 }").expect("writable");
        assert_eq!(Store::open(path).1.ui_scale, 2.0);
    }

    #[test]
    fn a_broken_file_is_one_warning_and_is_not_lost() {
        let folder = Folder::new();
        for broken in ["{ \"ui_scale\": ", "[]", "{ \"panel\": 7 }", "\u{0}"] {
            let path = folder.write("config.json", broken.as_bytes());
            let (store, config, warning) = Store::open(path.clone());
            assert_eq!(config, Config::default());
            let warning = warning.expect("a warning");
            assert!(warning.contains("config.json") && !warning.contains('\n'), "{warning}");
            store.write("{}").expect("writable");
            assert_eq!(fs::read_to_string(&path).expect("there"), "{}");
            assert_eq!(fs::read_to_string(folder.0.join("config.json.broken")).expect("kept"), broken);
        }
        fs::write(folder.0.join("config.json"), [0xff, 0xfe]).expect("writable");
        assert!(Store::open(folder.0.join("config.json")).2.is_some(), "no text at all");
        assert!(Store::open(folder.0.clone()).2.is_some(), "a folder");
    }

    #[test]
    fn a_place_that_cannot_be_written_is_told_once() {
        let folder = Folder::new();
        // A file where the folder should be.
        folder.write("raywalk", b"");
        let (store, config, _) = Store::open(folder.0.join("raywalk/config.json"));
        let mut keeper = Keeper::new(Some(store), config, &Settings::balanced());
        let mut told = Vec::new();
        for scale in [2.0, 3.0] {
            keeper.config.ui_scale = scale;
            told.push(keeper.save().map(|errand| errand().is_some()));
        }
        assert_eq!(told, [Some(true), Some(false)]);
    }
}
