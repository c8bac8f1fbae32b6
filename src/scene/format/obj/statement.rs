//! Statements: lines, which a backslash at the end continues.

use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::At;
use crate::scene::format::words::{Words, after_mark};

/// A line that is neither blank nor a comment.
#[derive(Clone, Debug)]
pub struct Statement<'t> {
    /// Its first word.
    pub keyword: &'t [u8],
    /// Where it starts.
    pub at: At,
    /// The words after the first.
    pub words: Words<'t>,
    text: &'t [u8],
}

impl Statement<'_> {
    /// All that follows the keyword as one name, which may hold blanks.
    pub fn name(&self) -> String {
        self.name_from(At(self.at.0 + self.keyword.len()))
    }

    /// All from a place on as one name.
    pub fn name_from(&self, at: At) -> String {
        let name = String::from_utf8_lossy(&self.text[at.0..self.words.end().0]);
        // A backslash before the end of a line is none of the name.
        name.replace("\\\r\n", " ").replace("\\\n", " ").trim().to_owned()
    }

    /// The keyword as text for messages.
    pub fn shown(&self) -> String {
        shortened(&String::from_utf8_lossy(self.keyword))
    }
}

/// The statements of a text.
pub fn statements(text: &[u8]) -> impl Iterator<Item = Statement<'_>> {
    let mut next = after_mark(text);
    std::iter::from_fn(move || {
        while next < text.len() {
            let start = next;
            let end = line_end(text, start);
            next = end + 1;
            let mut words = Words::line(text, start..end);
            if let Some(first) = words.next() {
                return Some(Statement { keyword: first.bytes, at: first.at, words, text });
            }
        }
        None
    })
}

/// Where the line that starts at `start` ends, the lines that continue it included.
fn line_end(text: &[u8], start: usize) -> usize {
    let mut from = start;
    loop {
        let Some(newline) = text[from..].iter().position(|byte| *byte == b'\n') else { return text.len() };
        let end = from + newline;
        let line = text[start..end].strip_suffix(b"\r").unwrap_or(&text[start..end]);
        if !line.ends_with(b"\\") {
            return end;
        }
        from = end + 1;
    }
}
