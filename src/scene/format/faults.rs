//! Faults of texts of which the rest is shown.

use crate::scene::desc::problem::{At, Problem, Warnings};

/// What is odd about a text: a warning for each fault, and the first fault, which is the error where nothing is left to
/// show.
#[derive(Debug, Default)]
pub struct Faults {
    /// What users are told, what is no fault included.
    pub warnings: Warnings,
    first: Option<Problem>,
}

impl Faults {
    /// Adds a fault; `done` says what it was and what became of it, in the same words for all of its kind.
    pub fn add(&mut self, problem: Problem, done: impl Into<String>) {
        self.warnings.push(problem.at, done);
        self.note(problem);
    }

    /// Adds a fault that another warning tells of.
    pub fn note(&mut self, problem: Problem) {
        self.first.get_or_insert(problem);
    }

    /// Adds a fault of which its warning says all.
    pub fn add_plain(&mut self, at: At, done: &str) {
        self.add(Problem::new(at, done), done);
    }

    /// The first fault, if there was one.
    pub fn first(&self) -> Option<Problem> {
        self.first.clone()
    }
}
