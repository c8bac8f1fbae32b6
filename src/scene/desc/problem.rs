//! What is wrong or odd at a position of a scene's text, before it is turned into a line and a pointer.

/// A byte offset into the text of a scene. Readers keep it with every value that can still turn out
/// to be wrong later; the format turns it into a [`Place`](crate::scene::error::Place) when there is something to report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct At(pub usize);

/// Something wrong (or, as a warning, odd) at a position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where.
    pub at: At,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl Problem {
    /// A problem at a position.
    pub fn new(at: At, message: impl Into<String>) -> Self {
        Self { at, message: message.into() }
    }
}

/// The result of reading a value of the scene.
pub type Outcome<T> = Result<T, Problem>;

/// Warnings, in the order in which they were found; beyond [`Warnings::KEPT`] they are only counted,
/// so that a hostile file cannot make the report outgrow the scene.
#[derive(Debug, Default)]
pub struct Warnings {
    kept: Vec<Problem>,
    dropped: usize,
}

impl Warnings {
    /// How many warnings are kept word for word.
    pub const KEPT: usize = 100;

    /// Adds one.
    pub fn push(&mut self, at: At, message: impl Into<String>) {
        if self.kept.len() < Self::KEPT {
            self.kept.push(Problem::new(at, message));
        } else {
            self.dropped += 1;
        }
    }

    /// Adds those of another list.
    pub fn append(&mut self, other: Self) {
        other.kept.into_iter().for_each(|problem| self.push(problem.at, problem.message));
        self.dropped += other.dropped;
    }

    /// Those kept, the last one telling how many more there were.
    pub fn into_problems(mut self) -> Vec<Problem> {
        if self.dropped > 0 {
            self.kept.push(Problem::new(At(0), format!("{} more warnings are not shown", self.dropped)));
        }
        self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flood_of_warnings_is_counted_instead_of_kept() {
        let mut warnings = Warnings::default();
        for i in 0..Warnings::KEPT + 5 {
            warnings.push(At(i), "odd");
        }
        let problems = warnings.into_problems();
        assert_eq!(problems.len(), Warnings::KEPT + 1);
        assert!(problems[Warnings::KEPT].message.starts_with("5 more"));
    }
}
