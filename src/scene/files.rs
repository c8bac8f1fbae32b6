//! The files that a scene may read: those of its own folder, or those embedded in the program.

use super::Limits;
use super::limits::exceeded;
use super::names::{self, Folders};
use super::progress::{Progress, Stamp};
use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::fs::File;
use std::io::{self, Read};
use std::mem;
use std::path::{Component, Path, PathBuf};

/// What a load says that was ended early, wherever it was: [`SceneError::Cancelled`](super::SceneError::Cancelled) in the
/// end.
pub const CANCELLED: &str = "loading was cancelled";

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system's reason.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The path leads out of the scene's folder.
    #[error("the path leaves the scene's folder; move the file there and give a relative path")]
    Outside,
    /// A folder, a device, a pipe.
    #[error("it is not a regular file")]
    NotRegular,
    /// More bytes than the limit allows.
    #[error("the scene's files have {}", exceeded("file-bytes", *.0))]
    TooLarge(u64),
    /// The load was ended early.
    #[error("{CANCELLED}")]
    Cancelled,
}

/// Where files come from.
#[derive(Debug)]
enum Source {
    /// A folder, canonicalised.
    Folder(PathBuf),
    /// Names and contents.
    Embedded(&'static [(&'static str, &'static [u8])]),
}

/// The files that a scene may read, and how many bytes it still may.
#[derive(Debug)]
pub struct Files {
    source: Source,
    /// The folder that names are relative to.
    folder: PathBuf,
    bytes_left: u64,
    limit: u64,
    progress: Progress,
    /// How many files were looked for in vain.
    missed: Cell<u32>,
    /// What is in folders where names were looked for.
    folders: RefCell<Folders>,
}

/// Most files looked for in vain that are noted: each takes several questions to the disk.
const MOST_MISSED: u32 = 4096;

impl Files {
    /// The files in the folder of `scene` and in the folders within.
    ///
    /// # Errors
    /// The folder does not exist or cannot be entered.
    pub fn beside(scene: &Path, limits: &Limits) -> Result<Self, FileError> {
        let folder = scene.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = folder.canonicalize()?;
        Ok(Self::new(Source::Folder(folder.clone()), folder, limits))
    }

    /// Files embedded in the program.
    pub fn embedded(files: &'static [(&'static str, &'static [u8])], limits: &Limits) -> Self {
        Self::new(Source::Embedded(files), PathBuf::new(), limits)
    }

    fn new(source: Source, folder: PathBuf, limits: &Limits) -> Self {
        let progress = Progress::default();
        let (bytes_left, folders) = (limits.file_bytes, RefCell::default());
        Self { source, folder, bytes_left, limit: limits.file_bytes, progress, missed: Cell::new(0), folders }
    }

    /// The same, with `progress` told what is looked at.
    pub fn told_to(self, progress: &Progress) -> Self {
        Self { progress: progress.clone(), ..self }
    }

    /// Who is told what is looked at.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// From now on names are relative to `folder`, that of a located file; gives the folder up to now, at first the
    /// scene's.
    pub fn relative_to(&mut self, folder: PathBuf) -> PathBuf {
        mem::replace(&mut self.folder, folder)
    }

    /// The one path of a file that the scene or a model of it names, whatever links and dots the name holds.
    ///
    /// # Errors
    /// There is no such file, or it is not in the scene's folder.
    pub fn locate(&self, name: &str) -> Result<PathBuf, FileError> {
        match &self.source {
            Source::Embedded(_) => Ok(self.folder.join(name)),
            Source::Folder(scene) => {
                // A rooted or drive-relative name would replace the folder instead of extending it.
                let relative = Path::new(name);
                if relative.has_root() || relative.is_absolute() {
                    return Err(FileError::Outside);
                }
                let path = self.folder.join(relative);
                // The link is asked first, since it takes a fraction of the time where there is nothing.
                let path = path.symlink_metadata().and_then(|_| path.canonicalize());
                let path = path.or_else(|error| self.in_latin_1(name).ok_or(error));
                let path = path.inspect_err(|_| self.missed(scene, relative))?;
                if path.starts_with(scene) { Ok(path) } else { Err(FileError::Outside) }
            }
        }
    }

    /// The one path of a file that a model's file names in the way of some other program: with backslashes, by a path on
    /// the machine where it was made, in another letter case or Unicode form. A file of just that name comes first; of
    /// an absolute path, only what lies beside the scene counts.
    ///
    /// # Errors
    /// As for [`locate`](Self::locate).
    pub fn find(&self, name: &str) -> Result<PathBuf, FileError> {
        let error = match self.locate(name) {
            Ok(path) => return Ok(path),
            Err(error) => error,
        };
        let Source::Folder(scene) = &self.source else { return Err(error) };
        let mut folders = self.folders.borrow_mut();
        let found = names::spellings(name).find_map(|parts| {
            let path = folders.find(&self.folder, scene, &parts)?.canonicalize().ok()?;
            path.starts_with(scene).then_some(path)
        });
        found.ok_or(error)
    }

    /// The path of a file whose name on the disk is in Latin-1, or is no text of which the characters of `name` are the bytes.
    #[cfg(unix)]
    fn in_latin_1(&self, name: &str) -> Option<PathBuf> {
        use std::os::unix::ffi::OsStringExt;
        let bytes: Vec<u8> = name.chars().map(|character| u8::try_from(character).ok()).collect::<Option<_>>()?;
        if bytes.is_ascii() {
            return None;
        }
        self.folder.join(std::ffi::OsString::from_vec(bytes)).canonicalize().ok()
    }

    #[cfg(not(unix))]
    fn in_latin_1(&self, _: &str) -> Option<PathBuf> {
        None
    }

    /// Notes what was looked for in vain, if it may yet come to be there; so may the folder that it would be in.
    fn missed(&self, scene: &Path, relative: &Path) {
        if self.missed.replace(self.missed.get().saturating_add(1)) >= MOST_MISSED {
            return;
        }
        let path = self.folder.join(relative);
        let there = path.ancestors().skip(1).find_map(|folder| Some((folder, folder.canonicalize().ok()?)));
        let Some((folder, place)) = there.filter(|(_, place)| place.starts_with(scene)) else { return };
        let Ok(rest) = path.strip_prefix(folder) else { return };
        if rest.components().all(|part| matches!(part, Component::Normal(_))) {
            self.progress.saw(&place.join(rest), None);
        }
    }

    /// The contents of a located file.
    ///
    /// # Errors
    /// It cannot be read, is no regular file, or has more bytes than are left of the limit; or the load was cancelled.
    pub fn read(&mut self, path: &Path) -> Result<Cow<'static, [u8]>, FileError> {
        if self.progress.is_cancelled() {
            return Err(FileError::Cancelled);
        }
        self.progress.begin(format!("reading {}", path.file_name().unwrap_or_default().display()), 0);
        let bytes = match self.source {
            Source::Embedded(files) => {
                let file = files.iter().find(|(name, _)| Path::new(name) == path);
                Cow::Borrowed(file.ok_or(io::Error::from(io::ErrorKind::NotFound))?.1)
            }
            Source::Folder(_) => {
                Cow::Owned(self.read_regular(path).map_err(|error| match self.progress.is_cancelled() {
                    true => FileError::Cancelled,
                    false => error,
                })?)
            }
        };
        let left = self.bytes_left.checked_sub(bytes.len() as u64);
        self.bytes_left = left.ok_or(FileError::TooLarge(self.limit))?;
        Ok(bytes)
    }

    fn read_regular(&self, path: &Path) -> Result<Vec<u8>, FileError> {
        // Asked before opening: opening a pipe would wait for its other end.
        let metadata = path.metadata().inspect_err(|_| self.progress.saw(path, None))?;
        self.progress.saw(path, Some(Stamp::of_metadata(&metadata)));
        if !metadata.is_file() {
            return Err(FileError::NotRegular);
        }
        if metadata.len() > self.bytes_left {
            return Err(FileError::TooLarge(self.limit));
        }
        let mut bytes = Vec::with_capacity(usize::try_from(metadata.len()).unwrap_or(0));
        // The file may have grown since; one byte more than allowed is enough to notice.
        let file = Cancellable { file: File::open(path)?, progress: &self.progress };
        file.take(self.bytes_left.saturating_add(1)).read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}

/// Most bytes read at once: a cancelled load does not wait for a slow disk any longer than that takes.
const CHUNK: usize = 4 << 20;

/// A file that is read until it is cancelled.
struct Cancellable<'a> {
    file: File,
    progress: &'a Progress,
}

impl Read for Cancellable<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.progress.is_cancelled() {
            return Err(io::Error::other(CANCELLED));
        }
        let room = buffer.len().min(CHUNK);
        self.file.read(&mut buffer[..room])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own_sources() -> Files {
        Files::beside(Path::new(file!()), &Limits::default()).unwrap()
    }

    #[test]
    fn reads_files_beside_and_below_the_scene_only() {
        let mut files = own_sources();
        let path = files.locate("format/../format/mod.rs").unwrap();
        assert!(!files.read(&path).unwrap().is_empty());
        for outside in ["../lib.rs", "format/../../lib.rs", "/etc/hostname"] {
            assert!(matches!(files.locate(outside), Err(FileError::Outside | FileError::Io(_))), "{outside}");
        }
        assert!(matches!(files.locate("nowhere.png"), Err(FileError::Io(_))));
        assert!(matches!(files.locate("nul\0byte.png"), Err(FileError::Io(_))));
        let folder = files.locate("format").unwrap();
        assert!(matches!(files.read(&folder), Err(FileError::NotRegular)));
    }

    #[test]
    fn names_in_a_model_are_relative_to_it_and_stay_with_the_scene() {
        let mut files = own_sources();
        let model = files.locate("format/mod.rs").unwrap();
        let scenes = files.relative_to(model.parent().unwrap().to_owned());
        assert_eq!(Some(&*scenes), model.parent().unwrap().parent());
        let sibling = files.locate("json.rs").unwrap();
        assert_eq!(sibling.parent(), model.parent());
        assert_eq!(files.locate("../files.rs").unwrap().parent(), model.parent().unwrap().parent());
        assert!(matches!(files.locate("../../lib.rs"), Err(FileError::Outside)));
    }

    #[test]
    fn all_files_together_hold_the_limit() {
        static EMBEDDED: &[(&str, &[u8])] = &[("a", b"123"), ("b", b"456")];
        let limits = Limits { file_bytes: 5, ..Limits::default() };
        let mut files = Files::embedded(EMBEDDED, &limits);
        assert_eq!(&*files.read(Path::new("a")).unwrap(), b"123");
        assert!(files.read(Path::new("b")).unwrap_err().to_string().contains("file-bytes"));
        assert!(files.read(Path::new("c")).is_err());
    }
}
