//! The tree that a scene's text spells, whatever its syntax: what the description is read from.

use super::problem::{At, Outcome, Problem};
use std::borrow::Cow;
use std::fmt;

/// What a value looks like in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Nothing, spelled out.
    Null,
    /// True or false.
    Boolean,
    /// A number.
    Number,
    /// A string.
    Text,
    /// Values in order.
    List,
    /// Values by name.
    Map,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Null => "null",
            Self::Boolean => "a boolean",
            Self::Number => "a number",
            Self::Text => "a string",
            Self::List => "a list",
            Self::Map => "an object",
        })
    }
}

/// A named value of a map.
#[derive(Clone, Debug)]
pub struct Field<'t, N> {
    /// The name.
    pub key: Cow<'t, str>,
    /// Where the name stands.
    pub at: At,
    /// The value.
    pub value: N,
}

/// A value in the tree of a scene's text. A node is a cheap view; nothing is parsed before it is asked for.
///
/// Every reader of a value asks for the type it wants, so that a syntax without types of its own
/// can answer from the same text with a number, a vector or a string.
pub trait Node<'t>: Copy {
    /// Where the value starts.
    fn at(self) -> At;
    /// What it looks like.
    fn kind(self) -> Kind;
    /// The values of a map, in order. Names that stand twice are a problem.
    fn fields(self) -> Outcome<Vec<Field<'t, Self>>>;
    /// The values of a map whose names are the user's own, such as those of materials.
    fn named_fields(self) -> Outcome<Vec<Field<'t, Self>>> {
        self.fields()
    }
    /// The values of a list.
    fn items(self) -> Outcome<Vec<Self>>;
    /// The values of a list whose values are lists themselves, even if there is only one.
    fn rows(self) -> Outcome<Vec<Self>> {
        self.items()
    }
    /// A number.
    fn number(self) -> Outcome<f64>;
    /// A string.
    fn text(self) -> Outcome<Cow<'t, str>>;
    /// True or false.
    fn boolean(self) -> Outcome<bool>;
    /// A list of number tuples read in one go; `None` when any of it is something else: walk the
    /// [`rows`](Self::rows) then to find out what.
    fn number_rows<const N: usize>(self) -> Option<Vec<[f64; N]>>;
    /// A list of index tuples read in one go; `None` as for [`number_rows`](Self::number_rows).
    fn index_rows<const N: usize>(self) -> Option<Vec<[u32; N]>>;

    /// The problem of finding something else than `expected` here.
    fn mismatch(self, expected: &str) -> Problem {
        Problem::new(self.at(), format!("expected {expected}, found {}", self.kind()))
    }
}
