//! The files that were opened last.

use crate::app::config::reading::Faults;
use serde::Serialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// How many are kept.
const MOST: usize = 10;

/// The files that were opened last, the newest first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct RecentFiles {
    files: Vec<PathBuf>,
}

impl RecentFiles {
    /// Puts a file first that was opened, which is given by its one path. One whose name is no text is not kept: it could
    /// not be written down.
    pub fn opened(&mut self, place: &Path) {
        self.files.retain(|known| known != place);
        if place.to_str().is_some() {
            self.files.insert(0, place.to_owned());
            self.files.truncate(MOST);
        }
    }

    /// Out of a configuration: whatever of a list are names of files.
    pub fn read(value: Value, faults: &mut Faults) -> Self {
        let entries = match value {
            Value::Array(entries) => entries,
            Value::Null => Vec::new(),
            _ => {
                faults.note("recent");
                Vec::new()
            }
        };
        let file = |(i, entry): (usize, Value)| match entry {
            Value::String(file) => Some(PathBuf::from(file)),
            _ => {
                faults.note(format_args!("recent[{i}]"));
                None
            }
        };
        let mut files: Vec<PathBuf> = entries.into_iter().enumerate().filter_map(file).collect();
        files.truncate(MOST);
        Self { files }
    }

    /// Takes over what was opened from `before` to `after`.
    pub fn take_changes(&mut self, before: &Self, after: &Self) {
        let (before, after) = (&before.files, &after.files);
        // What was opened stands before all that is still in its old order.
        let is_as_before = |rest: &[PathBuf]| {
            let mut known = before.iter();
            rest.iter().all(|file| known.any(|other| other == file))
        };
        let opened = (0..after.len()).find(|&count| is_as_before(&after[count..])).unwrap_or(after.len());
        after[..opened].iter().rev().for_each(|file| self.opened(file));
    }

    /// The files, the newest first.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_comes_first_and_none_twice() {
        let mut recent = RecentFiles::default();
        for file in ["/a.json", "/b.glb", "/a.json"] {
            recent.opened(Path::new(file));
        }
        assert_eq!(recent.files(), [Path::new("/a.json"), Path::new("/b.glb")]);
        for i in 0..30 {
            recent.opened(Path::new(&format!("/{i}.obj")));
        }
        assert_eq!(recent.files().len(), MOST);
        assert_eq!(recent.files()[0], Path::new("/29.obj"));
    }

    #[test]
    fn it_can_be_written_down() {
        let mut recent = RecentFiles::default();
        recent.opened(Path::new("/scenes/my room.json"));
        let text = serde_json::to_string(&recent).expect("it is text");
        assert_eq!(text, r#"["/scenes/my room.json"]"#);
        let value = serde_json::from_str(&text).expect("it was written");
        assert_eq!(RecentFiles::read(value, &mut Faults::default()), recent);
    }

    #[test]
    fn another_windows_list_takes_over_what_was_opened() {
        let list = |names: &[&str]| RecentFiles { files: names.iter().map(PathBuf::from).collect() };
        let before = list(&["/a", "/b", "/c"]);
        for (after, theirs, expected) in [
            (&["/a", "/b", "/c"][..], &["/x", "/a"][..], &["/x", "/a"][..]),
            (&["/n", "/a", "/b", "/c"], &["/x", "/a", "/b", "/c"], &["/n", "/x", "/a", "/b", "/c"]),
            (&["/c", "/a", "/b"], &["/x", "/a", "/b", "/c"], &["/c", "/x", "/a", "/b"]),
        ] {
            let mut merged = list(theirs);
            merged.take_changes(&before, &list(after));
            assert_eq!(merged, list(expected), "{after:?} over {theirs:?}");
        }
    }
}
