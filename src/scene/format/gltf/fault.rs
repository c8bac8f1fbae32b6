//! What is wrong or odd in a glTF file, named by JSON pointers, which all of the format's own tools understand.

use crate::scene::desc::problem::{At, Problem, Warnings};
use crate::scene::error::{Place, SceneError, Warning};
use std::collections::HashSet;
use std::path::Path;

/// Something wrong, and where.
#[derive(Clone, Debug)]
pub struct Fault {
    /// JSON pointer of the value, such as `/accessors/3/count`; empty for the whole file.
    pub pointer: String,
    /// What is wrong, and what would be right.
    pub message: String,
}

/// The result of reading a value of the file.
pub type Read<T> = Result<T, Fault>;

impl Fault {
    /// Something wrong at a pointer.
    pub fn new(pointer: impl Into<String>, message: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), message: message.into() }
    }

    /// The same for the user, who named `file`.
    pub fn in_file(self, file: &Path) -> SceneError {
        SceneError::Invalid { place: place(file, self.pointer), message: self.message }
    }
}

/// What is odd about a file, and the pointers behind the positions that its description carries.
#[derive(Debug)]
pub struct Report {
    /// A position is the number of its pointer; 0 is the whole file.
    pointers: Vec<String>,
    /// What was odd so far.
    pub warnings: Warnings,
}

impl Default for Report {
    fn default() -> Self {
        Self { pointers: vec![String::new()], warnings: Warnings::default() }
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
        let at = self.at(pointer);
        self.warnings.push(at, message);
    }

    /// A problem of the description, found again in the file.
    pub fn fault(&self, problem: Problem) -> Fault {
        let pointer = self.pointers.get(problem.at.0).cloned().unwrap_or_default();
        Fault { pointer, message: problem.message }
    }

    /// The warnings about `file`. What is odd about a mesh is told once, however often it is drawn.
    pub fn into_warnings(mut self, file: &Path) -> Vec<Warning> {
        let problems = std::mem::take(&mut self.warnings).into_problems();
        let mut told = HashSet::new();
        let faults = problems.into_iter().map(|problem| self.fault(problem));
        faults
            .filter(|fault| told.insert((fault.pointer.clone(), fault.message.clone())))
            .map(|fault| Warning { place: place(file, fault.pointer), message: fault.message })
            .collect()
    }
}

fn place(file: &Path, pointer: String) -> Place {
    Place { file: file.to_owned(), line_column: None, pointer }
}
