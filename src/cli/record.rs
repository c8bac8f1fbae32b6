//! Where `--stats` writes.

use super::{Failure, stdout};
use raywalk::measure::Record;
use raywalk::picture::PendingFile;
use std::path::Path;

/// Where the record of the run goes.
pub enum RecordTarget {
    Stdout,
    File(PendingFile),
}

impl RecordTarget {
    pub fn prepare(name: &str) -> Result<Self, Failure> {
        Ok(if name == "-" { Self::Stdout } else { Self::File(PendingFile::create(Path::new(name))?) })
    }

    pub fn write(self, record: &Record) -> Result<(), Failure> {
        let text = stdout::json(record)?;
        match self {
            Self::Stdout => stdout::print(&text),
            Self::File(file) => Ok(file.commit(|sink| Ok(writeln!(sink, "{text}")?))?),
        }
    }
}
