//! What is wrong or odd at a position of a scene's text, before it is turned into a line and a pointer.

use std::collections::{HashMap, HashSet};

/// A byte offset into the text of a scene. Readers keep it with every value that can still turn out
/// to be wrong later; the format turns it into a [`Place`](crate::scene::error::Place) when there is something to report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
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

/// Warnings, in the order in which they were first found. Equal ones are counted: they become one line. Beyond
/// [`Warnings::KEPT`] lines they are only counted, so that a hostile file cannot make the report outgrow the scene.
#[derive(Debug, Default)]
pub struct Warnings {
    kept: Vec<Line>,
    /// Indices of lines by what makes warnings equal.
    by_kind: HashMap<String, usize>,
    dropped: usize,
}

/// Equal warnings.
#[derive(Debug)]
struct Line {
    /// The first of them.
    first: Problem,
    /// What they have in common, and the name of the first; `None` where their messages are the same.
    kind: Option<(String, String)>,
    count: usize,
    /// Positions that were told of: a position is counted once, however often it is read.
    places: HashSet<At>,
}

impl Line {
    fn into_problem(self) -> Problem {
        let Self { first: Problem { at, message }, kind, count, .. } = self;
        match (count, kind) {
            (1, _) => Problem { at, message },
            (_, None) => Problem { at, message: format!("{message} ({count} times, the first here)") },
            (_, Some((kind, name))) => Problem { at, message: format!("{count} {kind}: first {name}") },
        }
    }
}

impl Warnings {
    /// How many lines are kept.
    pub const KEPT: usize = 100;
    /// How many positions of a line are told apart.
    const PLACES: usize = 1 << 16;

    /// Adds one. Warnings of the same message are counted.
    pub fn push(&mut self, at: At, message: impl Into<String>) {
        let message = message.into();
        let key = message.clone();
        self.add(key, Problem { at, message }, None);
    }

    /// Adds one of a kind: a single one reads as `message`, several as "35 KIND: first NAME", such as
    /// "35 textures missing: first a.png".
    pub fn push_kind(&mut self, at: At, kind: &str, name: impl Into<String>, message: impl Into<String>) {
        self.add(kind.to_owned(), Problem::new(at, message), Some((kind.to_owned(), name.into())));
    }

    fn add(&mut self, key: String, first: Problem, kind: Option<(String, String)>) {
        if let Some(&known) = self.by_kind.get(&key) {
            let line = &mut self.kept[known];
            let is_full = line.places.len() >= Self::PLACES;
            line.count += usize::from(is_full || line.places.insert(first.at));
        } else if self.kept.len() < Self::KEPT {
            self.by_kind.insert(key, self.kept.len());
            let places = HashSet::from([first.at]);
            self.kept.push(Line { first, kind, count: 1, places });
        } else {
            self.dropped += 1;
        }
    }

    /// Adds those of another list.
    pub fn append(&mut self, other: Self) {
        for line in other.kept {
            let key = line.kind.as_ref().map_or(&line.first.message, |(kind, _)| kind).clone();
            match self.by_kind.get(&key) {
                Some(&known) => {
                    let own = &mut self.kept[known];
                    own.count += line.count - line.places.len();
                    own.count += line.places.into_iter().filter(|&at| own.places.insert(at)).count();
                }
                None if self.kept.len() < Self::KEPT => {
                    self.by_kind.insert(key, self.kept.len());
                    self.kept.push(line);
                }
                None => self.dropped += 1,
            }
        }
        self.dropped += other.dropped;
    }

    /// One problem a line, the last one telling how many more warnings there were.
    pub fn into_problems(self) -> Vec<Problem> {
        let mut problems: Vec<Problem> = self.kept.into_iter().map(Line::into_problem).collect();
        if self.dropped > 0 {
            problems.push(Problem::new(At(0), format!("{} more warnings are not shown", self.dropped)));
        }
        problems
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flood_of_warnings_is_counted_instead_of_kept() {
        let mut warnings = Warnings::default();
        for i in 0..Warnings::KEPT + 5 {
            warnings.push(At(i), format!("odd {i}"));
        }
        let problems = warnings.into_problems();
        assert_eq!(problems.len(), Warnings::KEPT + 1);
        assert!(problems[Warnings::KEPT].message.starts_with("5 more"));
    }

    #[test]
    fn equal_warnings_are_one_line() {
        let mut warnings = Warnings::default();
        for i in 0..Warnings::KEPT + 5 {
            warnings.push(At(i / 2), "odd");
            warnings.push_kind(At(i), "textures missing", format!("{i}.png"), format!("{i}.png is missing"));
        }
        warnings.push(At(7), "alone");
        warnings.push_kind(At(8), "names unknown", "a", "a is unknown");
        let count = Warnings::KEPT + 5;
        let lines = [
            (0, format!("odd ({} times, the first here)", count.div_ceil(2))),
            (0, format!("{count} textures missing: first 0.png")),
            (7, "alone".to_owned()),
            (8, "a is unknown".to_owned()),
        ];
        assert_eq!(warnings.into_problems(), lines.map(|(at, message)| Problem::new(At(at), message)));
    }
}
