//! Statements: lines, which a backslash at the end continues.

use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::At;
use crate::scene::format::encoding::{is_wide, name};
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
        self.name_between(at, self.words.end())
    }

    /// What stands between two places as one name.
    pub fn name_between(&self, from: At, to: At) -> String {
        let text = &self.text[from.0..to.0];
        let mut bytes = Vec::with_capacity(text.len());
        let mut at = 0;
        while let Some(byte) = text.get(at) {
            // A backslash before the end of a line is none of the name.
            let is_continued = *byte == b'\\' && matches!(text.get(at + 1), Some(b'\n' | b'\r'));
            bytes.push(if is_continued { b' ' } else { *byte });
            at += match (is_continued, text.get(at + 1..at + 3)) {
                (true, Some(b"\r\n")) => 3,
                (true, _) => 2,
                _ => 1,
            };
        }
        let is_blank = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'\0' | b'\x0B' | b'\x1A');
        let start = bytes.iter().position(|byte| !is_blank(byte)).unwrap_or(bytes.len());
        let end = bytes.iter().rposition(|byte| !is_blank(byte)).map_or(start, |last| last + 1);
        name(&bytes[start..end])
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
        let Some(length) = text[from..].iter().position(|byte| matches!(byte, b'\n' | b'\r')) else {
            return text.len();
        };
        let end = from + length;
        match text[start..end] {
            [.., before, b'\\'] if is_wide(before) => return end,
            [.., b'\\'] => from = end + if text[end..].starts_with(b"\r\n") { 2 } else { 1 },
            _ => return end,
        }
    }
}

/// A name without what some programs put around it: quotes, a comment behind it.
pub fn bare(name: &str) -> &str {
    if let Some((quoted, _)) = name.strip_prefix('"').and_then(|rest| rest.split_once('"')) {
        return quoted;
    }
    let comment = [" #", "\t#"].iter().filter_map(|start| name.find(start)).min();
    name[..comment.unwrap_or(name.len())].trim_end()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<(usize, String)> {
        statements(text).map(|statement| (statement.at.0, statement.name())).collect()
    }

    #[test]
    fn lines_end_in_three_ways_and_are_continued() {
        let all = [(0, "1".to_owned()), (4, "2".to_owned())];
        assert_eq!(lines(b"a 1\rb 2\r"), all);
        assert_eq!(lines(b"a 1\nb 2\n"), all);
        assert_eq!(lines(b"a 1\r\nb 2")[1], (5, "2".to_owned()));
        for end in ["\\\n", "\\\r", "\\\r\n"] {
            assert_eq!(lines(format!("a 1{end}2\nb").as_bytes())[0].1, "1 2");
        }
        assert_eq!(lines(b"# x\ra 1 # y\rb 2").len(), 2);
        // The second byte of a character in Shift-JIS may look like a backslash.
        assert_eq!(lines(b"a \x95\x5C\nb 2").len(), 2);
    }

    #[test]
    fn names_are_stripped_of_quotes_and_comments() {
        for (name, expected) in [
            ("\"my lib.mtl\"", "my lib.mtl"),
            ("\"a #1\" # b", "a #1"),
            ("red # the red", "red"),
            ("red\t#c", "red"),
            ("oak#1", "oak#1"),
            ("\"open", "\"open"),
            ("", ""),
        ] {
            assert_eq!(bare(name), expected);
        }
    }
}
