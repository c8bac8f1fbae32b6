//! Watching the files of a scene, on a thread of its own that sleeps until the system has something to tell.
//!
//! Folders are watched and not files: many editors save by putting a new file in place of the old one. Folders come and go
//! as well: what the system watches is not their name but what bore it, so they are watched anew when it may have another
//! bearer, and the nearest folder above stands in for one that is gone. What counts in the end is whether a file is another
//! version than the one that was read.

use crate::scene::progress::{SeenFile, Stamp};
use notify::event::{AccessKind, AccessMode};
use notify::{Event, EventKind, RecursiveMode, Watcher};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// Files are looked at once they were left alone for this long: saving takes several steps, and often several files.
const SETTLED: Duration = Duration::from_millis(150);

/// What a watch has to tell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sight {
    /// A file is another one than what was read.
    Changed,
    /// What it cannot watch, in words.
    Blind(String),
    /// It can watch everything again.
    Watchful,
}

enum Message {
    /// What to watch, and nothing else.
    Files(Vec<SeenFile>),
    /// What to watch besides.
    Also(Vec<SeenFile>),
    Event(notify::Result<Event>),
    Stop,
}

/// The handle to the watching thread. Dropping it ends the thread.
#[derive(Debug)]
pub struct Watch(Sender<Message>);

impl Watch {
    /// Starts to watch, no files yet. `tell` is called on the watching thread.
    pub fn start(tell: impl Fn(Sight) + Send + 'static) -> Self {
        let (sender, receiver) = channel();
        let events = sender.clone();
        let work = move || {
            // An event that nobody waits for any more is no loss.
            let watcher = notify::recommended_watcher(move |event| events.send(Message::Event(event)).unwrap_or(()));
            match watcher {
                Ok(watcher) => Eye::new(watcher, tell).run(&receiver),
                Err(error) => tell(Sight::Blind(format!("changes on disk are not noticed: {error}"))),
            }
        };
        // Without a thread there is no hot reload; the reload key is left.
        let _ = std::thread::Builder::new().name("watch".to_owned()).spawn(work);
        Self(sender)
    }

    /// Watches these files from now on, in place of any others. One that is no longer what was seen has changed.
    pub fn files(&self, files: Vec<SeenFile>) {
        // Where the thread could not start, there is nobody to tell.
        let _ = self.0.send(Message::Files(files));
    }

    /// Watches these files, too; of those that are watched already, another version is known now.
    pub fn also(&self, files: Vec<SeenFile>) {
        let _ = self.0.send(Message::Also(files));
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.0.send(Message::Stop);
    }
}

struct Eye<W, F> {
    watcher: W,
    tell: F,
    /// The version of each file that was last told of.
    files: HashMap<PathBuf, Option<Stamp>>,
    /// The folders that they are in.
    folders: HashSet<PathBuf>,
    /// Those of them that are there, and where the others would come to be.
    watched: HashSet<PathBuf>,
    /// What it told that it cannot watch.
    blind: Option<String>,
}

/// What a message asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Concern {
    Nothing,
    /// A file may be another one now.
    File,
    /// A folder may be.
    Folder,
}

impl<W: Watcher, F: Fn(Sight)> Eye<W, F> {
    fn new(watcher: W, tell: F) -> Self {
        let (files, folders, watched) = (HashMap::new(), HashSet::new(), HashSet::new());
        Self { watcher, tell, files, folders, watched, blind: None }
    }

    fn run(mut self, messages: &Receiver<Message>) {
        let (mut due, mut folders_changed): (Option<Instant>, bool) = (None, false);
        loop {
            let message = match due {
                None => messages.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(due) => messages.recv_timeout(due.saturating_duration_since(Instant::now())),
            };
            match message {
                Ok(Message::Files(files)) => {
                    self.files.clear();
                    self.learn(files);
                    // They may have changed since they were read.
                    due = Some(Instant::now() + SETTLED);
                }
                Ok(Message::Also(files)) => {
                    self.learn(files);
                    due = Some(Instant::now() + SETTLED);
                }
                Ok(Message::Event(event)) => {
                    let concern = event.map_or(Concern::Nothing, |event| self.concern(&event));
                    folders_changed |= concern == Concern::Folder;
                    if concern != Concern::Nothing {
                        due = Some(Instant::now() + SETTLED);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {
                    due = None;
                    // Before the files are looked at, so that no change falls between.
                    if std::mem::take(&mut folders_changed) {
                        self.watch();
                    }
                    if self.notice() {
                        (self.tell)(Sight::Changed);
                    }
                }
                Ok(Message::Stop) | Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    /// Watches more files.
    fn learn(&mut self, files: Vec<SeenFile>) {
        for SeenFile { path, stamp } in files {
            // Where it is a link, the link may be changed as well as what it leads to.
            for place in [name_of(&path), path.canonicalize().ok()].into_iter().flatten() {
                self.files.insert(place, stamp);
            }
        }
        self.watch();
    }

    /// Watches the folders of the files as they are now.
    fn watch(&mut self) {
        for folder in self.watched.drain() {
            // It may be gone.
            let _ = self.watcher.unwatch(&folder);
        }
        self.folders = self.files.keys().filter_map(|file| Some(file.parent()?.to_owned())).collect();
        let mut failed = BTreeMap::new();
        for folder in &self.folders {
            // Looked for again once something is watched: it may have come to be there in between.
            while let Some(there) = folder.ancestors().find(|folder| folder.is_dir())
                && self.watched.insert(there.to_owned())
            {
                if let Err(error) = self.watcher.watch(there, RecursiveMode::NonRecursive)
                    && there.is_dir()
                {
                    failed.insert(there, notify::Error::new(error.kind));
                }
            }
        }
        let blind = failed.first_key_value().map(|(folder, error)| {
            let more = match failed.len() - 1 {
                0 => String::new(),
                1 => " and one more folder".to_owned(),
                more => format!(" and {more} more folders"),
            };
            format!("changes in {}{more} are not noticed: {error}", folder.display())
        });
        if self.blind != blind {
            (self.tell)(blind.clone().map_or(Sight::Watchful, Sight::Blind));
            self.blind = blind;
        }
    }

    /// What may be another one now.
    fn concern(&self, event: &Event) -> Concern {
        let is_change = match event.kind {
            EventKind::Access(AccessKind::Close(AccessMode::Write)) => true,
            EventKind::Access(_) => false,
            _ => true,
        };
        if event.need_rescan() {
            return Concern::Folder;
        }
        let of_path = |path: &PathBuf| match () {
            () if self.folders.iter().any(|folder| folder.starts_with(path)) => Concern::Folder,
            () if self.files.contains_key(path) => Concern::File,
            () => Concern::Nothing,
        };
        let paths = event.paths.iter().filter(|_| is_change);
        paths.map(of_path).max().unwrap_or(Concern::Nothing)
    }

    /// Whether any file is another version than the one known, which is then known.
    fn notice(&mut self) -> bool {
        let mut changed = false;
        for (path, known) in &mut self.files {
            let now = Stamp::of(path);
            changed |= now != *known;
            *known = now;
        }
        changed
    }
}

/// Where a file stands, as the system will call it: in its folder's one path, by its own name. A folder that is not there
/// has no path but the one it was looked for by.
fn name_of(path: &Path) -> Option<PathBuf> {
    let path = std::path::absolute(path).ok()?;
    let folder = path.parent()?;
    Some(folder.canonicalize().unwrap_or_else(|_| folder.to_owned()).join(path.file_name()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temporary::Folder;
    use std::fs;

    const SOON: Duration = Duration::from_secs(20);
    /// Longer than it takes to notice something.
    const LONG: Duration = Duration::from_millis(600);

    fn seen(path: &Path) -> SeenFile {
        SeenFile { path: path.to_owned(), stamp: Stamp::of(path) }
    }

    fn watching(files: &[&Path]) -> (Watch, Receiver<Sight>) {
        let (sender, sights) = channel();
        let watch = Watch::start(move |sight| sender.send(sight).unwrap_or(()));
        watch.files(files.iter().map(|file| seen(file)).collect());
        assert!(sights.recv_timeout(LONG).is_err(), "nothing has changed yet");
        (watch, sights)
    }

    #[test]
    fn a_save_is_noticed_however_it_is_done_and_once() {
        let folder = Folder::new();
        let (scene, texture) = (folder.write("room.json", "1"), folder.write("wood.png", "1"));
        let (_watch, sights) = watching(&[&scene, &texture]);
        folder.write("room.json", "22");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
        let new = folder.write("room.json~", "333");
        fs::rename(new, &scene).expect("saved by renaming");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
        folder.write("wood.png", "22");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
        fs::remove_file(&scene).expect("removed");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
        folder.write("room.json", "4");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
        assert!(sights.recv_timeout(LONG).is_err());
    }

    #[test]
    fn what_is_only_read_or_lies_beside_it_does_not_matter() {
        let folder = Folder::new();
        let scene = folder.write("room.json", "1");
        let (_watch, sights) = watching(&[&scene]);
        folder.write("notes.txt", "22");
        fs::read(&scene).expect("it is there");
        assert!(sights.recv_timeout(LONG).is_err());
    }

    #[test]
    fn a_file_that_was_missing_may_come_and_one_may_have_changed_before_it_was_watched() {
        let folder = Folder::new();
        let scene = folder.write("room.json", "1");
        let missing = folder.path().join("wood.png");
        let (watch, sights) = watching(&[&scene, &missing]);
        folder.write("wood.png", "1");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
        let before = seen(&scene);
        folder.write("room.json", "22");
        watch.files(vec![before]);
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
    }

    #[test]
    fn a_folder_may_be_replaced_again_and_again() {
        let folder = Folder::new();
        let place = folder.path().join("scene");
        let fill = |place: &Path, texture: &str| {
            fs::create_dir_all(place.join("textures")).expect("made");
            fs::write(place.join("room.json"), texture).expect("written");
            fs::write(place.join("textures/wood.png"), texture).expect("written");
        };
        fill(&place, "1");
        let (scene, texture) = (place.join("room.json"), place.join("textures/wood.png"));
        let (_watch, sights) = watching(&[&scene, &texture]);
        let edit = |file: &Path, text: &str| {
            // What is still to be told of the folder is not what is asked about.
            while sights.recv_timeout(LONG).is_ok() {}
            fs::write(file, text).expect("written");
            assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed), "{}", file.display());
        };
        for text in ["22", "333"] {
            fs::remove_dir_all(&place).expect("removed");
            fill(&place, text);
            assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
            edit(&scene, "edited");
            edit(&texture, "edited");
        }
        let (new, old) = (folder.path().join("new"), folder.path().join("old"));
        fill(&new, "4444");
        fs::rename(&place, &old).expect("put away");
        fs::rename(&new, &place).expect("put in place");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
        edit(&scene, "edited");
        edit(&texture, "edited");
        fs::write(old.join("room.json"), "55555").expect("written");
        assert!(sights.recv_timeout(LONG).is_err(), "that is another scene now");
    }

    #[test]
    fn a_folder_that_is_gone_is_waited_for() {
        let folder = Folder::new();
        let place = folder.path().join("a/b");
        fs::create_dir_all(&place).expect("made");
        let texture = place.join("wood.png");
        fs::write(&texture, "1").expect("written");
        let (_watch, sights) = watching(&[&texture]);
        fs::remove_dir_all(folder.path().join("a")).expect("removed");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
        for part in ["a", "a/b"] {
            fs::create_dir(folder.path().join(part)).expect("made");
            assert!(sights.recv_timeout(LONG).is_err(), "there is no texture yet");
        }
        fs::write(&texture, "22").expect("written");
        assert_eq!(sights.recv_timeout(SOON), Ok(Sight::Changed));
    }

    /// A system that watches only so many folders.
    struct Short {
        left: usize,
    }

    impl Watcher for Short {
        fn new<E: notify::EventHandler>(_: E, _: notify::Config) -> notify::Result<Self> {
            Ok(Self { left: 0 })
        }

        fn watch(&mut self, _: &Path, _: RecursiveMode) -> notify::Result<()> {
            let left = self.left.checked_sub(1).ok_or(notify::Error::new(notify::ErrorKind::MaxFilesWatch))?;
            self.left = left;
            Ok(())
        }

        fn unwatch(&mut self, _: &Path) -> notify::Result<()> {
            self.left += 1;
            Ok(())
        }

        fn kind() -> notify::WatcherKind {
            notify::WatcherKind::NullWatcher
        }
    }

    #[test]
    fn what_cannot_be_watched_is_told_once_and_taken_back() {
        let folder = Folder::new();
        let part = folder.path().join("textures");
        fs::create_dir(&part).expect("made");
        let files = || vec![seen(&folder.write("room.json", "1")), seen(&part.join("wood.png"))];
        let (sender, sights) = channel();
        let mut eye = Eye::new(Short { left: 1 }, move |sight| sender.send(sight).unwrap_or(()));
        eye.learn(files());
        let Ok(Sight::Blind(told)) = sights.try_recv() else { panic!("it was told nothing") };
        assert!(
            told.contains("changes in ") && told.contains(" are not noticed: ") && !told.contains("more"),
            "{told}"
        );
        eye.watcher.left = 2;
        eye.watch();
        assert_eq!(sights.try_recv(), Ok(Sight::Watchful));
        eye.watch();
        assert!(sights.try_recv().is_err());
    }
}
