//! What is wrong or odd in a glTF file, named by JSON pointers, which all of the format's own tools understand.
//!
//! A [`Fault`] costs the smallest part of the file that holds it: whoever can do without that part turns it into a note
//! by [`Notes::attempt`]. Only faults that exceed a limit end the load.

use crate::scene::desc::problem::{At, Problem, Warnings};
use crate::scene::error::{Place, SceneError, Warning};
use std::collections::HashMap;
use std::mem;
use std::path::Path;

/// Something wrong, and where.
#[derive(Clone, Debug)]
pub struct Fault {
    /// JSON pointer of the value, such as `/accessors/3/count`; empty for the whole file.
    pub pointer: String,
    /// What is wrong, and what would be right.
    pub message: String,
    /// Whether the file is refused for it, whatever part of it is wrong: a limit is exceeded, or the load was cancelled.
    is_fatal: bool,
}

/// The result of reading a value of the file.
pub type Read<T> = Result<T, Fault>;

impl Fault {
    /// Something wrong at a pointer.
    pub fn new(pointer: impl Into<String>, message: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), message: message.into(), is_fatal: false }
    }

    /// Something for which the file is refused.
    pub fn fatal(pointer: impl Into<String>, message: impl Into<String>) -> Self {
        Self { is_fatal: true, ..Self::new(pointer, message) }
    }

    /// The same for the user, who named `file`.
    pub fn in_file(self, file: &Path) -> SceneError {
        SceneError::Invalid { place: place(file, self.pointer), message: self.message }
    }
}

/// Something odd, and what was done about it.
#[derive(Debug)]
struct Note {
    pointer: String,
    message: String,
    /// What several of the kind are called, and the name of the first.
    kind: Option<(&'static str, String)>,
}

/// What is odd about a part of the file.
#[derive(Debug, Default)]
pub struct Notes {
    notes: Vec<Note>,
    dropped: usize,
}

impl Notes {
    /// How many notes are kept.
    const KEPT: usize = 1 << 16;

    /// Adds a note. Notes of the same message are counted.
    pub fn add(&mut self, pointer: impl Into<String>, message: impl Into<String>) {
        self.push(Note { pointer: pointer.into(), message: message.into(), kind: None });
    }

    /// Adds one of a kind: several become "3 KIND: first NAME".
    pub fn add_kind(
        &mut self,
        pointer: impl Into<String>,
        kind: &'static str,
        name: impl Into<String>,
        message: impl Into<String>,
    ) {
        self.push(Note { pointer: pointer.into(), message: message.into(), kind: Some((kind, name.into())) });
    }

    /// What was read; `None` where there is a fault, which is noted: it costs no more than what was to be read. `kind`
    /// names several such, as in "attributes left out".
    ///
    /// # Errors
    /// A fault for which the whole file is refused.
    pub fn attempt<T>(&mut self, read: Read<T>, kind: &'static str) -> Read<Option<T>> {
        match read {
            Ok(value) => Ok(Some(value)),
            Err(fault) if fault.is_fatal => Err(fault),
            Err(Fault { pointer, message, .. }) => {
                let single = format!("{message}; left out");
                self.add_kind(pointer, kind, message, single);
                Ok(None)
            }
        }
    }

    fn push(&mut self, note: Note) {
        match self.notes.len() < Self::KEPT {
            true => self.notes.push(note),
            false => self.dropped += 1,
        }
    }
}

/// What is odd about a file, and the pointers behind the positions that its description carries.
#[derive(Debug)]
pub struct Report {
    /// A position is the number of its pointer; 0 is the whole file.
    pointers: Vec<String>,
    /// Positions of pointers that were warned of.
    positions: HashMap<String, At>,
    /// What was odd so far.
    pub warnings: Warnings,
}

impl Default for Report {
    fn default() -> Self {
        Self { pointers: vec![String::new()], positions: HashMap::new(), warnings: Warnings::default() }
    }
}

impl Report {
    /// A position for a pointer.
    pub fn at(&mut self, pointer: impl Into<String>) -> At {
        self.pointers.push(pointer.into());
        At(self.pointers.len() - 1)
    }

    /// Adds a warning.
    pub fn warn(&mut self, pointer: impl Into<String>, message: impl Into<String>) {
        let at = self.position(pointer.into());
        self.warnings.push(at, message);
    }

    /// Adds the notes about a part of the file.
    pub fn take(&mut self, notes: Notes) {
        for Note { pointer, message, kind } in notes.notes {
            let at = self.position(pointer);
            match kind {
                None => self.warnings.push(at, message),
                Some((kind, name)) => self.warnings.push_kind(at, kind, name, message),
            }
        }
        if notes.dropped > 0 {
            self.warnings.push(At(0), format!("{} more faults are not listed", notes.dropped));
        }
    }

    /// As [`Notes::attempt`].
    ///
    /// # Errors
    /// A fault for which the whole file is refused.
    pub fn attempt<T>(&mut self, read: Read<T>, kind: &'static str) -> Read<Option<T>> {
        let mut notes = Notes::default();
        let read = notes.attempt(read, kind);
        self.take(notes);
        read
    }

    /// The one position of a pointer that is warned of, so that what is odd at one place is counted once.
    fn position(&mut self, pointer: String) -> At {
        if let Some(&known) = self.positions.get(&pointer) {
            return known;
        }
        let at = self.at(pointer.clone());
        self.positions.insert(pointer, at);
        at
    }

    /// A problem of the description, found again in the file.
    pub fn fault(&self, problem: Problem) -> Fault {
        let pointer = self.pointers.get(problem.at.0).cloned().unwrap_or_default();
        Fault::new(pointer, problem.message)
    }

    /// The warnings about `file`.
    pub fn into_warnings(mut self, file: &Path) -> Vec<Warning> {
        let problems = mem::take(&mut self.warnings).into_problems();
        let faults = problems.into_iter().map(|problem| self.fault(problem));
        faults.map(|fault| Warning { place: place(file, fault.pointer), message: fault.message }).collect()
    }
}

fn place(file: &Path, pointer: String) -> Place {
    Place { file: file.to_owned(), line_column: None, pointer }
}
