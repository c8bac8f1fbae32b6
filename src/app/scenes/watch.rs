//! Watching the files of a scene, on a thread of its own that sleeps until the system has something to tell.
//!
//! Folders are watched and not files: many editors save by putting a new file in place of the old one. What counts in
//! the end is whether a file is another version than the one that was read.

use crate::scene::progress::{SeenFile, Stamp};
use notify::event::{AccessKind, AccessMode};
use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{HashMap, HashSet};
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
    /// It cannot watch, for this reason.
    Blind(String),
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
                Err(error) => tell(Sight::Blind(error.to_string())),
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

struct Eye<F> {
    watcher: RecommendedWatcher,
    tell: F,
    /// The version of each file that was last told of.
    files: HashMap<PathBuf, Option<Stamp>>,
    folders: HashSet<PathBuf>,
}

impl<F: Fn(Sight)> Eye<F> {
    fn new(watcher: RecommendedWatcher, tell: F) -> Self {
        Self { watcher, tell, files: HashMap::new(), folders: HashSet::new() }
    }

    fn run(mut self, messages: &Receiver<Message>) {
        let mut due: Option<Instant> = None;
        loop {
            let message = match due {
                None => messages.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(due) => messages.recv_timeout(due.saturating_duration_since(Instant::now())),
            };
            match message {
                Ok(Message::Files(files)) => {
                    self.files.clear();
                    self.watch(files);
                    // They may have changed since they were read.
                    due = Some(Instant::now() + SETTLED);
                }
                Ok(Message::Also(files)) => {
                    self.watch(files);
                    due = Some(Instant::now() + SETTLED);
                }
                Ok(Message::Event(event)) => {
                    if event.is_ok_and(|event| self.concerns(&event)) {
                        due = Some(Instant::now() + SETTLED);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {
                    due = None;
                    if self.notice() {
                        (self.tell)(Sight::Changed);
                    }
                }
                Ok(Message::Stop) | Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn watch(&mut self, files: Vec<SeenFile>) {
        for SeenFile { path, stamp } in files {
            // Where it is a link, the link may be changed as well as what it leads to.
            for place in [place_of(&path), path.canonicalize().ok()].into_iter().flatten() {
                self.files.insert(place, stamp);
            }
        }
        let wanted: HashSet<PathBuf> = self.files.keys().filter_map(|file| Some(file.parent()?.to_owned())).collect();
        for left in self.folders.difference(&wanted) {
            // It may be gone, and is no longer of interest.
            let _ = self.watcher.unwatch(left);
        }
        for folder in wanted.difference(&self.folders) {
            if let Err(error) = self.watcher.watch(folder, RecursiveMode::NonRecursive) {
                (self.tell)(Sight::Blind(error.to_string()));
            }
        }
        self.folders = wanted;
    }

    /// Whether one of the files may be another one now.
    fn concerns(&self, event: &Event) -> bool {
        let is_change = match event.kind {
            EventKind::Access(AccessKind::Close(AccessMode::Write)) => true,
            EventKind::Access(_) => false,
            _ => true,
        };
        event.need_rescan() || is_change && event.paths.iter().any(|path| self.files.contains_key(path))
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

/// Where a file stands, as the system will call it: in its folder's one path, by its own name.
fn place_of(path: &Path) -> Option<PathBuf> {
    let path = std::path::absolute(path).ok()?;
    Some(path.parent()?.canonicalize().ok()?.join(path.file_name()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::scenes::temporary::Folder;
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
}
