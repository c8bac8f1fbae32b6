//! The files that were opened last.

use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// How many are kept.
const MOST: usize = 10;

/// The files that were opened last, the newest first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
        assert_eq!(serde_json::from_str::<RecentFiles>(&text).expect("it was written"), recent);
    }
}
