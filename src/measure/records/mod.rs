//! What a bench has measured, on disk: `records.json` for going on and drawing, `records.csv` for spreadsheets.
//!
//! The file is replaced as a whole after every row, so that a run that is killed loses the row in work and no more.

mod csv;
mod environment;
mod row;

pub use csv::WRONG_SHARE;
pub use environment::Environment;
pub use row::{FrameError, Key, Part, Row, Samples};

use crate::picture::{PendingFile, PictureError};
use serde::{Deserialize, Serialize};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::{Path, PathBuf};

/// Version of the file's layout.
const VERSION: u32 = 1;

/// Why records could not be read or written. The text is one line.
#[derive(Debug, thiserror::Error)]
pub enum RecordsError {
    /// The folder or a file in it.
    #[error("{}: cannot be made or read: {source}; choose another folder", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] PictureError),
    /// The file is none of ours.
    #[error("{}: not the records of a bench: {message}; choose another folder", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// The folder holds a file that would be replaced, and that no bench wrote.
    #[error("{}: is there, but no records beside it, so it is none of ours; choose another folder", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// Measured under other conditions.
    #[error("{}: was measured with another {what} ({before}, now {now}); choose another folder, or delete this one", path.display())]
    Differs {
        /// The file.
        path: PathBuf,
        /// What differs.
        what: String,
        /// What it was.
        before: String,
        /// What it is.
        now: String,
    },
}

/// The records of one folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Records {
    version: u32,
    /// Where and with what it was measured.
    pub environment: Environment,
    /// In the order in which they were begun.
    pub rows: Vec<Row>,
}

impl Records {
    /// No rows yet.
    pub fn new(environment: Environment) -> Self {
        Self { version: VERSION, environment, rows: Vec::new() }
    }

    /// The file in `folder`.
    pub fn file(folder: &Path) -> PathBuf {
        folder.join("records.json")
    }

    /// Reads the records in `folder`; `None` where there are none.
    ///
    /// # Errors
    /// [`RecordsError::Io`], [`RecordsError::Invalid`].
    pub fn load(folder: &Path) -> Result<Option<Self>, RecordsError> {
        let path = Self::file(folder);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(RecordsError::Io { path, source }),
        };
        let records: Self = serde_json::from_str(&text)
            .map_err(|error| RecordsError::Invalid { path: path.clone(), message: error.to_string() })?;
        if records.version == VERSION {
            return Ok(Some(records));
        }
        Err(RecordsError::Invalid { path, message: format!("version {}, known is {VERSION}", records.version) })
    }

    /// The records to go on with in `folder`, which is made if it is not there: those it holds, or none.
    ///
    /// # Errors
    /// As for [`load`](Self::load); [`RecordsError::Foreign`]; [`RecordsError::Differs`] where they were made elsewhere or with something else.
    pub fn resume(folder: &Path, environment: Environment) -> Result<Self, RecordsError> {
        let io = |source| RecordsError::Io { path: folder.to_owned(), source };
        fs::create_dir_all(folder).map_err(io)?;
        let Some(mut records) = Self::load(folder)? else {
            let foreign = ["index.html", "records.csv", "pictures"].map(|name| folder.join(name));
            return match foreign.into_iter().find(|path| path.exists()) {
                Some(path) => Err(RecordsError::Foreign { path }),
                None => Ok(Self::new(environment)),
            };
        };
        if let Some((what, before, now)) = records.environment.difference(&environment) {
            return Err(RecordsError::Differs { path: Self::file(folder), what, before, now });
        }
        // Now the folder is known to be ours.
        for folder in [folder.to_owned(), folder.join("pictures")] {
            if folder.is_dir() {
                remove_leftovers(&folder).map_err(io)?;
            }
        }
        records.environment.views.extend(environment.views);
        Ok(records)
    }

    /// Replaces `records.json` in `folder`, and `records.csv`; whoever reads them meets the old file or the new one.
    ///
    /// # Errors
    /// [`RecordsError::Write`].
    pub fn save(&self, folder: &Path) -> Result<(), RecordsError> {
        let file = PendingFile::create(&Self::file(folder))?;
        let encode_error = |error: serde_json::Error| PictureError::Encode(error.to_string());
        file.commit(|sink| {
            serde_json::to_writer_pretty(&mut *sink, self).map_err(encode_error)?;
            Ok(writeln!(sink)?)
        })?;
        self.save_csv(folder)
    }

    /// Writes `records.csv` in `folder`, a line a row under one line of names.
    ///
    /// # Errors
    /// [`RecordsError::Write`].
    pub fn save_csv(&self, folder: &Path) -> Result<(), RecordsError> {
        let file = PendingFile::create(&folder.join("records.csv"))?;
        Ok(file.commit(|sink| Ok(sink.write_all(csv::table(self).as_bytes())?))?)
    }

    /// The place of the row with this key, which is added if it is new.
    pub fn place(&mut self, key: &Key, new: impl FnOnce() -> Row) -> usize {
        self.rows.iter().position(|row| row.key == *key).unwrap_or_else(|| {
            self.rows.push(new());
            self.rows.len() - 1
        })
    }

    /// How many rows were cut off, because a frame took too long.
    pub fn cut_off(&self) -> usize {
        self.rows.iter().filter(|row| row.cut_off_ms.is_some()).count()
    }

    /// The rows of one part.
    pub fn of(&self, part: Part) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.key.part == part)
    }
}

/// A file name made of parts, with nothing in it that a file system or a page could stumble over. Parts that lose more by
/// that than spaces and brackets end in a number of their own, so that no two share a file.
pub fn file_name(parts: &[&str]) -> String {
    let is_safe = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_');
    let part = |part: &&str| {
        let safe: String = part.chars().map(|c| if is_safe(c) { c } else { '_' }).collect();
        if part.chars().all(|c| is_safe(c) || matches!(c, ' ' | '(' | ')')) {
            return safe;
        }
        let mut hasher = DefaultHasher::new();
        part.hash(&mut hasher);
        let short: String = safe.chars().take(60).collect();
        format!("{short}_{:08x}", hasher.finish() as u32)
    };
    parts.iter().map(part).collect::<Vec<_>>().join("-")
}

/// Removes what a killed run had begun to write.
fn remove_leftovers(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if PendingFile::is_leftover(name) && path.is_file() {
            fs::remove_file(path)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_are_plain_and_differ_where_names_do() {
        assert_eq!(file_name(&["tradeoff", "gallery (built in)"]), "tradeoff-gallery__built_in_");
        let names =
            ["\u{421}\u{446}\u{435}\u{43d}\u{430}", "\u{421}\u{442}\u{435}\u{43d}\u{430}", "a/b", "a:b", "../x"];
        let names = names.map(|name| file_name(&[name]));
        for (i, name) in names.iter().enumerate() {
            assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || "._-".contains(c)), "{name}");
            assert!(!names[..i].contains(name), "{name} twice");
        }
    }
}
