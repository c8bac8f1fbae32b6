//! Files that appear under their name only when they are complete.

use super::PictureError;
use super::format::Sink;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The temporary files of this process, for [`exit`]. Whoever makes, renames or removes one holds the lock meanwhile.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of names is as good after a panic as before.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the process at once from any thread, but leaves no temporary file behind.
///
/// For requests to end that cannot wait for whoever writes a file.
pub fn exit(code: i32) -> ! {
    // Held to the end, so that no other thread begins or completes a file meanwhile.
    let unfinished = unfinished();
    for temporary in unfinished.iter() {
        // Nobody is left to hear of a failure.
        let _ = fs::remove_file(temporary);
    }
    std::process::exit(code)
}

/// A file being written: made under a temporary name beside its target, renamed by [`commit`](Self::commit),
/// removed when dropped before.
///
/// Making one early proves that the place can be written before a long run starts.
#[derive(Debug)]
pub struct PendingFile {
    /// The name as the user gave it, for messages.
    asked: PathBuf,
    /// Where the complete file goes: links resolved, so that a link stays a link.
    target: PathBuf,
    /// `None` for devices and pipes, which are written directly.
    temporary: Option<PathBuf>,
    /// `None` once committed or dropped.
    file: Option<BufWriter<File>>,
}

impl PendingFile {
    /// Starts a file that will be called `path`.
    ///
    /// # Errors
    /// [`PictureError::Io`] when the folder is missing or not writable, or `path` is a folder or write-protected.
    pub fn create(path: &Path) -> Result<Self, PictureError> {
        Self::open(path).map_err(PictureError::io(path, "write"))
    }

    /// Starts a file in the folder of `path`, for [`commit_to_free`](Self::commit_to_free).
    ///
    /// # Errors
    /// [`PictureError::Io`] when the folder is missing or not writable.
    pub fn beside(path: &Path) -> Result<Self, PictureError> {
        let (temporary, file) = create_beside(path, None).map_err(PictureError::io(path, "write"))?;
        let (asked, target) = (path.to_owned(), path.to_owned());
        Ok(Self { asked, target, temporary: Some(temporary), file: Some(BufWriter::new(file)) })
    }

    fn open(path: &Path) -> io::Result<Self> {
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let old = fs::metadata(&target).ok();
        if let Some(metadata) = &old {
            if metadata.is_dir() {
                return Err(io::ErrorKind::IsADirectory.into());
            }
            if !metadata.is_file() {
                let file = OpenOptions::new().write(true).open(&target)?;
                return Ok(Self { asked: path.to_owned(), target, temporary: None, file: Some(BufWriter::new(file)) });
            }
            if metadata.permissions().readonly() {
                return Err(io::ErrorKind::PermissionDenied.into());
            }
        }
        let (temporary, file) = create_beside(&target, old.as_ref())?;
        Ok(Self { asked: path.to_owned(), target, temporary: Some(temporary), file: Some(BufWriter::new(file)) })
    }

    /// Whether a file of this name may be what a killed run had begun to write.
    pub fn is_leftover(name: &str) -> bool {
        let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        let inner = name.strip_prefix('.').and_then(|name| name.strip_suffix(".part"));
        let parts = inner.and_then(|inner| inner.rsplit_once('.'));
        let numbers = parts.filter(|(target, _)| !target.is_empty()).and_then(|(_, numbers)| numbers.split_once('-'));
        numbers.is_some_and(|(process, attempt)| is_number(process) && is_number(attempt))
    }

    /// The name the file will get.
    pub fn path(&self) -> &Path {
        &self.asked
    }

    /// Lets `encode` write the contents, then gives the file its name.
    ///
    /// # Errors
    /// What `encode` reports, with [`PictureError::Encode`] naming the file; [`PictureError::Io`] from the system.
    pub fn commit(
        mut self,
        encode: impl FnOnce(&mut dyn Sink) -> Result<(), PictureError>,
    ) -> Result<(), PictureError> {
        self.write(encode)?;
        if let Some(temporary) = &self.temporary {
            if let Ok(old) = fs::metadata(&self.target) {
                // Again: it may have changed since this file was begun.
                keep_access(&old, temporary);
            }
            let mut unfinished = unfinished();
            fs::rename(temporary, &self.target).map_err(PictureError::io(&self.asked, "write"))?;
            unfinished.retain(|other| other != temporary);
            drop(unfinished);
            self.temporary = None;
        }
        Ok(())
    }

    /// Lets `encode` write the contents, then gives the file the first of `names` that no file has, whoever else makes
    /// some meanwhile. All are to be in the folder of the name that it was made [beside](Self::beside).
    ///
    /// # Errors
    /// As [`commit`](Self::commit); [`PictureError::Io`] also when no name is free.
    pub fn commit_to_free(
        mut self,
        names: impl Iterator<Item = PathBuf>,
        encode: impl FnOnce(&mut dyn Sink) -> Result<(), PictureError>,
    ) -> Result<PathBuf, PictureError> {
        self.write(encode)?;
        let Some(temporary) = &self.temporary else { return Ok(self.asked.clone()) };
        for name in names {
            let unfinished = unfinished();
            let claimed = claim(temporary, &name);
            drop(unfinished);
            match claimed {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                // Dropped after this, the file goes under its temporary name, if it still has that.
                result => return result.map_err(PictureError::io(&name, "write")).map(|()| name),
            }
        }
        Err(PictureError::io(&self.asked, "write")(io::ErrorKind::AlreadyExists.into()))
    }

    fn write(&mut self, encode: impl FnOnce(&mut dyn Sink) -> Result<(), PictureError>) -> Result<(), PictureError> {
        let Some(mut file) = self.file.take() else { return Ok(()) };
        encode(&mut file).map_err(|error| match error {
            PictureError::Encode(message) => {
                PictureError::Io { path: self.asked.clone(), action: "write", source: io::Error::other(message) }
            }
            other => other,
        })?;
        file.flush().map_err(PictureError::io(&self.asked, "write"))
    }
}

impl Drop for PendingFile {
    fn drop(&mut self) {
        self.file = None;
        if let Some(temporary) = &self.temporary {
            let mut unfinished = unfinished();
            // Nobody is left to hear of a failure, and the final name is untouched.
            let _ = fs::remove_file(temporary);
            unfinished.retain(|other| other != temporary);
        }
    }
}

/// Gives a complete file a name that no file has.
fn claim(complete: &Path, name: &Path) -> io::Result<()> {
    match fs::hard_link(complete, name) {
        // Some file systems have no links: there the name is taken first, and then what it names is replaced.
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
            OpenOptions::new().write(true).create_new(true).open(name)?;
            fs::rename(complete, name)
        }
        result => result,
    }
}

/// A new file in the folder of `target`, hidden, and named after it and this process; as accessible as the `old` file that
/// it is to replace.
fn create_beside(target: &Path, old: Option<&Metadata>) -> io::Result<(PathBuf, File)> {
    let name = target.file_name().ok_or(io::ErrorKind::InvalidFilename)?.to_string_lossy();
    let mut unfinished = unfinished();
    // A run that was killed may have left its file under the same process number.
    for attempt in 0..100 {
        let temporary = target.with_file_name(format!(".{name}.{}-{attempt}.part", std::process::id()));
        match new_file(old).open(&temporary) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
            Ok(file) => {
                unfinished.push(temporary.clone());
                if let Some(old) = old {
                    keep_access(old, &temporary);
                }
                return Ok((temporary, file));
            }
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// Opens a new file, from the first moment for nobody who cannot open the `old` one.
fn new_file(old: Option<&Metadata>) -> OpenOptions {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    if let Some(old) = old {
        use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
        options.mode(old.mode() & 0o777);
    }
    #[cfg(not(unix))]
    let _ = old;
    options
}

/// Gives `new` the owner and the mode of the `old` file, as far as the system lets.
fn keep_access(old: &Metadata, new: &Path) {
    #[cfg(unix)]
    if let Ok(metadata) = fs::metadata(new) {
        use std::os::unix::fs::{MetadataExt, chown};
        // One at a time: a user may give a file away to a group of theirs, but not to another user. Before the mode, since
        // some of its bits are lost with the owner.
        if metadata.gid() != old.gid() {
            let _ = chown(new, None, Some(old.gid()));
        }
        if metadata.uid() != old.uid() {
            let _ = chown(new, Some(old.uid()), None);
        }
    }
    // The contents matter more: a file system without modes is no reason to fail.
    let _ = fs::set_permissions(new, old.permissions());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temporary::Folder;

    #[test]
    fn the_name_appears_only_with_the_whole_contents() {
        let folder = Folder::new();
        let target = folder.path().join("a.png");
        let pending = PendingFile::create(&target).expect("writable");
        assert!(!target.exists());
        pending.commit(|sink| Ok(sink.write_all(b"whole")?)).expect("written");
        assert_eq!(fs::read(&target).expect("there"), b"whole");
        assert_eq!(folder.names(), ["a.png"]);
    }

    #[test]
    fn leftovers_are_known_by_their_names() {
        let folder = Folder::new();
        let pending = PendingFile::create(&folder.path().join("a.png")).expect("writable");
        assert!(folder.names().iter().all(|name| PendingFile::is_leftover(name)) && folder.names().len() == 1);
        drop(pending);
        for other in
            ["a.png", ".part", ".a.part", ".film.mkv.part", ".a-1.part", "..7-0.part", ".a.7-.part", "a.7-0.part"]
        {
            assert!(!PendingFile::is_leftover(other), "{other}");
        }
    }

    #[test]
    fn a_failed_or_abandoned_file_leaves_the_old_one() {
        let folder = Folder::new();
        let target = folder.path().join("a.png");
        fs::write(&target, b"old").expect("writable");
        drop(PendingFile::create(&target).expect("writable"));
        let failed = PendingFile::create(&target).expect("writable").commit(|sink| {
            sink.write_all(b"half")?;
            Err(PictureError::Encode("disk full".into()))
        });
        let message = failed.expect_err("the encoder refused").to_string();
        assert!(message.contains("a.png") && message.contains("disk full"), "{message}");
        assert_eq!(fs::read(&target).expect("there"), b"old");
        assert_eq!(folder.names(), ["a.png"]);
    }

    #[test]
    fn many_writers_at_once_never_overwrite_each_other() {
        let folder = Folder::new();
        folder.write("2.png", b"of old");
        let name = |number: u64| folder.path().join(format!("{number}.png"));
        let names: Vec<PathBuf> = std::thread::scope(|scope| {
            let write = |text: String| {
                let pending = PendingFile::beside(&name(1)).expect("writable");
                pending
                    .commit_to_free((1..).map(name), |sink| Ok(sink.write_all(text.as_bytes())?))
                    .expect("some are free")
            };
            let writers: Vec<_> = (0..8).map(|i| scope.spawn(move || write(i.to_string()))).collect();
            writers.into_iter().map(|writer| writer.join().expect("no panic")).collect()
        });
        for (i, name) in names.iter().enumerate() {
            assert_eq!(fs::read_to_string(name).expect("there"), i.to_string());
        }
        assert_eq!(fs::read(name(2)).expect("there"), b"of old");
        assert_eq!(folder.names().len(), 9, "nothing is left over");
        let full = PendingFile::beside(&name(1)).expect("writable").commit_to_free([name(2)].into_iter(), |_| Ok(()));
        assert!(full.expect_err("it is taken").to_string().contains("1.png"));
    }

    #[test]
    fn places_that_cannot_be_written_are_refused_at_once() {
        let folder = Folder::new();
        for bad in [folder.path().join("missing/a.png"), folder.path().to_owned()] {
            let error = PendingFile::create(&bad).expect_err("not writable").to_string();
            assert!(error.contains("cannot write"), "{error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_mode_when_it_is_replaced() {
        use std::os::unix::fs::PermissionsExt;
        let folder = Folder::new();
        for mode in [0o600, 0o644, 0o666, 0o755, 0o200] {
            let target = folder.write("a.png", b"old");
            let mode_of = |path: &Path| fs::metadata(path).expect("there").permissions().mode() & 0o7777;
            let set = |mode| fs::set_permissions(&target, fs::Permissions::from_mode(mode)).expect("ours");
            set(mode);
            let pending = PendingFile::create(&target).expect("writable");
            let name = folder.names().into_iter().find(|name| PendingFile::is_leftover(name)).expect("it was begun");
            assert_eq!(mode_of(&folder.path().join(name)), mode, "{mode:o}: no one else reads it meanwhile");
            pending.commit(|sink| Ok(sink.write_all(b"new")?)).expect("written");
            assert_eq!(mode_of(&target), mode, "{mode:o}");
            let pending = PendingFile::create(&target).expect("writable");
            set(0o640);
            pending.commit(|sink| Ok(sink.write_all(b"new")?)).expect("written");
            assert_eq!(mode_of(&target), 0o640, "changed meanwhile");
        }
    }

    #[test]
    fn files_that_are_not_finished_are_known_until_they_are() {
        let folder = Folder::new();
        let known = || unfinished().iter().filter(|path| path.starts_with(folder.path())).count();
        let [first, second, third] = ["a", "b", "c"].map(|name| folder.path().join(name));
        let pending = [&first, &second].map(|path| PendingFile::create(path).expect("writable"));
        let beside = PendingFile::beside(&third).expect("writable");
        assert_eq!(known(), 3);
        let [committed, dropped] = pending;
        committed.commit(|_| Ok(())).expect("written");
        drop(dropped);
        assert_eq!(known(), 1);
        beside.commit_to_free([third].into_iter(), |_| Ok(())).expect("free");
        assert_eq!(known(), 0);
        assert_eq!(folder.names().len(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_a_device_a_device() {
        let folder = Folder::new();
        let (real, link) = (folder.path().join("real.png"), folder.path().join("link.png"));
        fs::write(&real, b"old").expect("writable");
        std::os::unix::fs::symlink(&real, &link).expect("links work");
        PendingFile::create(&link).expect("writable").commit(|sink| Ok(sink.write_all(b"new")?)).expect("written");
        assert_eq!(fs::read(&real).expect("there"), b"new");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());

        let null = Path::new("/dev/null");
        PendingFile::create(null).expect("writable").commit(|sink| Ok(sink.write_all(b"gone")?)).expect("written");
        assert!(!fs::metadata(null).expect("there").is_file());
    }
}
