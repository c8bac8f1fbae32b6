//! Values that stand in one text: numbers, vectors, lists of vectors.

use crate::scene::desc::node::Kind;
use crate::scene::desc::problem::At;
use std::str::FromStr;

/// A text, in an attribute or between tags.
#[derive(Clone, Copy, Debug)]
pub struct Value<'t> {
    /// The text, as the parser hands it out.
    pub text: &'t str,
    /// Where it stands in the file.
    pub at: At,
    /// Whether the file holds it as it is, so that its parts have places of their own.
    pub verbatim: bool,
}

impl<'t> Value<'t> {
    /// What it looks like.
    pub fn kind(self) -> Kind {
        let first = self.text.split([' ', '\t', '\r', '\n', ',']).find(|word| !word.is_empty());
        match self.text.trim() {
            "true" | "false" => Kind::Boolean,
            whole if number(whole).is_some() => Kind::Number,
            whole if whole.contains(',') || Some(whole) != first && first.is_some_and(|f| number(f).is_some()) => {
                Kind::List
            }
            _ => Kind::Text,
        }
    }

    /// It as a number; words such as `inf` are none.
    pub fn number(self) -> Option<f64> {
        number(self.text.trim())
    }

    /// The values between commas, or between blanks where there is no comma.
    pub fn items(self) -> Vec<Self> {
        match self.text.contains(',') {
            true => self.rows(),
            false => self.text.split_ascii_whitespace().map(|word| self.part(word)).collect(),
        }
    }

    /// The values between commas, of which the last may end in one.
    pub fn rows(self) -> Vec<Self> {
        rows(self.text).map(|row| self.part(row.trim())).collect()
    }

    /// Its values between commas as tuples of numbers; `None` when any of them is something else.
    pub fn tuples<T: FromStr + Copy + Default, const N: usize>(self) -> Option<Vec<[T; N]>> {
        rows(self.text).map(tuple).collect()
    }

    fn part(self, text: &'t str) -> Self {
        let at = match self.verbatim {
            true => At(self.at.0 + (text.as_ptr().addr() - self.text.as_ptr().addr())),
            false => self.at,
        };
        Self { text, at, ..self }
    }
}

fn rows(text: &str) -> impl Iterator<Item = &str> {
    let text = text.trim_end();
    let text = text.strip_suffix(',').unwrap_or(text);
    let count = if text.trim().is_empty() { 0 } else { usize::MAX };
    text.split(',').take(count)
}

fn tuple<T: FromStr + Copy + Default, const N: usize>(row: &str) -> Option<[T; N]> {
    let mut words = row.split_ascii_whitespace();
    let mut tuple = [T::default(); N];
    for value in &mut tuple {
        *value = words.next()?.parse().ok()?;
    }
    words.next().is_none().then_some(tuple)
}

fn number(word: &str) -> Option<f64> {
    let first = word.trim_start_matches(['+', '-']).bytes().next()?;
    if first == b'.' || first.is_ascii_digit() { word.parse().ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Value<'_> {
        Value { text, at: At(100), verbatim: true }
    }

    #[test]
    fn a_text_looks_like_what_it_can_be_read_as() {
        let kinds = [
            ("1", Kind::Number),
            (" -.5e3 ", Kind::Number),
            ("1 2 3", Kind::List),
            ("1 x", Kind::List),
            ("#fff000, #000000", Kind::List),
            ("#fff000", Kind::Text),
            ("true", Kind::Boolean),
            ("inf", Kind::Text),
            ("the red one", Kind::Text),
            ("", Kind::Text),
        ];
        for (text, kind) in kinds {
            assert_eq!(value(text).kind(), kind, "{text}");
        }
    }

    #[test]
    fn parts_have_places_of_their_own() {
        let parts = |parts: Vec<Value>| -> Vec<(String, usize)> {
            parts.into_iter().map(|p| (p.text.to_owned(), p.at.0)).collect()
        };
        assert_eq!(parts(value(" 1 2").items()), [("1".to_owned(), 101), ("2".to_owned(), 103)]);
        assert_eq!(parts(value("1 2,\n 3 4,").items()), [("1 2".to_owned(), 100), ("3 4".to_owned(), 106)]);
        assert_eq!(parts(value("1 2").rows()), [("1 2".to_owned(), 100)]);
        assert!(value(" \n").items().is_empty() && value(" \n").rows().is_empty());
        assert_eq!(Value { verbatim: false, ..value("1 2") }.items()[1].at, At(100));
    }

    #[test]
    fn tuples_have_their_length() {
        assert_eq!(value("1 2, 3 4").tuples::<f64, 2>(), Some(vec![[1.0, 2.0], [3.0, 4.0]]));
        assert_eq!(value("").tuples::<u32, 3>(), Some(vec![]));
        for wrong in ["1", "1 2 3", "1 2,,3 4", "1 x", ",1 2"] {
            assert_eq!(value(wrong).tuples::<f64, 2>(), None, "{wrong}");
        }
    }
}
