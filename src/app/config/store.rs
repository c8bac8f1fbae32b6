//! The file that a [`Config`] is kept in.

use super::Config;
use super::reading::Faults;
use crate::picture::{PendingFile, PictureError};
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Larger files are none of ours.
const MAX_BYTES: u64 = 1 << 20;
/// How long a folder is waited for that another window writes to, and how long between two looks.
const PATIENCE: Duration = Duration::from_secs(2);
const PAUSE: Duration = Duration::from_millis(2);
/// Names for what cannot be read, beside each other.
const MOST_BROKEN: u32 = 99;

/// Where the configuration is kept.
#[derive(Clone, Debug)]
pub struct Store {
    path: PathBuf,
}

impl Store {
    /// The file in the user's folder for such things; `None` where there is no such folder.
    pub fn usual_path() -> Option<PathBuf> {
        Some(directories::ProjectDirs::from("", "", "raywalk")?.config_dir().join("config.json"))
    }

    /// Reads the file at `path`. A missing one is the default; for one that cannot be read, or not in all of its entries,
    /// there is a warning as well.
    pub fn open(path: PathBuf) -> (Self, Config, Option<String>) {
        let (config, warning) = match read(&path) {
            Contents::Missing => (Config::default(), None),
            Contents::Config(config) => (config, None),
            Contents::Partly(config, faults) => {
                let warning = format!("{}: passing over what cannot be used: {faults}", path.display());
                (config, Some(warning))
            }
            Contents::Broken(reason) => {
                let warning = format!("{}: cannot read it, starting with the defaults: {reason}", path.display());
                (Config::default(), Some(warning))
            }
        };
        (Self { path }, config, warning)
    }

    /// Writes what `change` makes of the configuration in the file now, `None` where there is none, as the whole file; or
    /// leaves the old one. Text that cannot be read is not lost: it is put aside under another name.
    ///
    /// # Errors
    /// The system's reason, naming the file.
    pub fn update(&self, change: impl FnOnce(Option<Config>) -> Config) -> Result<(), PictureError> {
        let _held = self.path.parent().and_then(|folder| {
            // Where it cannot be made, the file cannot be either, and that tells more.
            let _ = fs::create_dir_all(folder);
            // Nobody else changes the file between this reading and this writing. Some systems lock no folders: there the last
            // of those that write in the same moment wins.
            fs::File::open(folder).ok().filter(lock)
        });
        let pending = PendingFile::create(&self.path)?;
        let (current, is_readable) = match read(&self.path) {
            Contents::Missing => (None, true),
            Contents::Config(config) => (Some(config), true),
            Contents::Partly(config, _) => (Some(config), false),
            Contents::Broken(_) => (None, false),
        };
        let config = change(current);
        pending.commit(|sink| {
            let text = serde_json::to_string_pretty(&config).map_err(io::Error::from)? + "\n";
            if text.len() as u64 > MAX_BYTES {
                return Err(PictureError::Encode("there is too much to keep".to_owned()));
            }
            sink.write_all(text.as_bytes())?;
            sink.flush()?;
            if is_readable { Ok(()) } else { Ok(put_aside(&self.path)?) }
        })
    }
}

/// Locks a folder, unless somebody holds it for long: one that was stopped there should stop nobody else.
fn lock(folder: &fs::File) -> bool {
    let deadline = Instant::now() + PATIENCE;
    loop {
        match folder.try_lock() {
            Ok(()) => return true,
            Err(fs::TryLockError::WouldBlock) if Instant::now() < deadline => std::thread::sleep(PAUSE),
            Err(_) => return false,
        }
    }
}

/// What a file holds.
enum Contents {
    Missing,
    Config(Config),
    /// All but some entries, which are named.
    Partly(Config, String),
    /// Nothing to be read, and why.
    Broken(String),
}

fn read(path: &Path) -> Contents {
    let text = match read_text(path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Contents::Missing,
        Err(error) => return Contents::Broken(error.to_string()),
    };
    let mut faults = Faults::default();
    match (Config::read(&text, &mut faults), faults.line()) {
        (Ok(config), None) => Contents::Config(config),
        (Ok(config), Some(faults)) => Contents::Partly(config, faults),
        (Err(error), _) => Contents::Broken(error.to_string()),
    }
}

fn read_text(path: &Path) -> io::Result<String> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() || metadata.len() > MAX_BYTES {
        return Err(io::Error::other("not a file of settings"));
    }
    let mut text = String::new();
    // It may be growing.
    fs::File::open(path)?.take(MAX_BYTES).read_to_string(&mut text)?;
    Ok(text)
}

/// Gives the file at `path` another name as well, one that no file has: the first is about to be taken by another file.
fn put_aside(path: &Path) -> io::Result<()> {
    // A link stays a link: what it leads to is replaced.
    let Ok(file) = fs::canonicalize(path) else { return Ok(()) };
    if !file.is_file() {
        return Ok(());
    }
    for number in 1..=MOST_BROKEN {
        let ending = if number == 1 { "broken".to_owned() } else { format!("broken-{number}") };
        let name = file.with_added_extension(ending);
        match fs::hard_link(&file, &name) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            // Some file systems have no links.
            Err(_) if fs::symlink_metadata(&name).is_err() => return fs::rename(&file, &name),
            result => return result,
        }
    }
    Err(io::Error::new(io::ErrorKind::AlreadyExists, "too many that could not be read lie beside it"))
}

#[cfg(test)]
mod tests {
    use super::super::Keeper;
    use super::*;
    use crate::settings::Settings;
    use crate::temporary::Folder;

    fn scaled(ui_scale: f32) -> Config {
        Config { ui_scale, ..Config::default() }
    }

    #[test]
    fn a_missing_file_is_the_default_and_is_made_with_its_folders() {
        let folder = Folder::new();
        let path = folder.path().join("new/raywalk/config.json");
        let (store, config, warning) = Store::open(path.clone());
        assert_eq!((config, warning), (Config::default(), None));
        store.update(|current| current.map_or(scaled(2.0), |_| scaled(3.0))).expect("writable");
        assert_eq!(Store::open(path).1.ui_scale, 2.0);
    }

    #[test]
    fn a_broken_file_is_one_warning_and_is_not_lost() {
        for broken in ["{ \"ui_scale\": ", "[]", "{ \"ui_scale\": 2, \"panel\": 7 }", "\u{0}"] {
            let folder = Folder::new();
            let path = folder.write("config.json", broken.as_bytes());
            let (store, _, warning) = Store::open(path.clone());
            let warning = warning.expect("a warning");
            assert!(warning.contains("config.json") && !warning.contains('\n'), "{warning}");
            for scale in [2.5, 3.0] {
                // The store is another one at every write, as the errands' are.
                store.clone().update(|_| scaled(scale)).expect("writable");
                assert_eq!(Store::open(path.clone()).1, scaled(scale));
                assert_eq!(folder.names().len(), 2, "{:?}", folder.names());
                assert_eq!(fs::read_to_string(folder.path().join("config.json.broken")).expect("kept"), broken);
            }
            // Broken once more, by hand, while the window is open.
            fs::write(&path, "{").expect("writable");
            store.update(|current| current.unwrap_or(scaled(1.5))).expect("writable");
            assert_eq!(Store::open(path.clone()).1, scaled(1.5));
            assert_eq!(fs::read_to_string(folder.path().join("config.json.broken")).expect("kept"), broken);
            assert_eq!(fs::read_to_string(folder.path().join("config.json.broken-2")).expect("kept"), "{");
        }
    }

    #[test]
    fn what_is_no_text_is_a_warning() {
        let folder = Folder::new();
        let path = folder.write("config.json", [0xff, 0xfe]);
        assert!(Store::open(path.clone()).2.is_some(), "no text at all");
        let (store, _, warning) = Store::open(folder.path().to_owned());
        assert!(warning.is_some() && store.update(|_| scaled(2.0)).is_err(), "a folder");
        fs::write(&path, " ".repeat(MAX_BYTES as usize + 1)).expect("writable");
        assert!(Store::open(path).2.is_some(), "too large");
    }

    #[test]
    fn more_than_could_be_read_again_is_not_written() {
        let folder = Folder::new();
        let (store, ..) = Store::open(folder.path().join("config.json"));
        let screenshots = Some("x".repeat(MAX_BYTES as usize));
        assert!(store.update(|_| Config { screenshots, ..Config::default() }).is_err());
        assert_eq!(folder.names(), [""; 0]);
    }

    #[cfg(unix)]
    #[test]
    fn windows_that_write_at_once_lose_nothing_of_each_other() {
        let folder = Folder::new();
        let path = folder.path().join("raywalk/config.json");
        std::thread::scope(|scope| {
            for _window in 0..8 {
                let (store, ..) = Store::open(path.clone());
                scope.spawn(move || {
                    for _change in 0..8 {
                        let longer = |current: Option<Config>| {
                            let config = current.unwrap_or_default();
                            Config { screenshots: Some(config.screenshots.unwrap_or_default() + "x"), ..config }
                        };
                        store.update(longer).expect("writable");
                    }
                });
            }
        });
        assert_eq!(Store::open(path).1.screenshots, Some("x".repeat(64)));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_one_and_what_it_led_to_is_not_lost() {
        let folder = Folder::new();
        let (real, link) = (folder.write("mine.json", b"{ 1"), folder.path().join("config.json"));
        std::os::unix::fs::symlink(&real, &link).expect("links work");
        let (store, ..) = Store::open(link.clone());
        store.update(|_| scaled(2.0)).expect("writable");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        assert_eq!(Store::open(real).1, scaled(2.0));
        assert_eq!(fs::read(folder.path().join("mine.json.broken")).expect("kept"), b"{ 1");
    }

    #[test]
    fn a_place_that_cannot_be_written_is_told_once() {
        let folder = Folder::new();
        // A file where the folder should be.
        folder.write("raywalk", b"");
        let (store, config, _) = Store::open(folder.path().join("raywalk/config.json"));
        let mut keeper = Keeper::new(Some(store), config, &Settings::balanced());
        let mut told = Vec::new();
        for scale in [2.0, 3.0] {
            keeper.config.ui_scale = scale;
            told.push(keeper.save().map(|errand| errand().is_some()));
        }
        assert_eq!(told, [Some(true), Some(false)]);
    }
}
