//! Texts of words: what lies between blanks, each with its place.

use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{At, Outcome, Problem};
use std::ops::Range;

/// A word of a text.
#[derive(Clone, Copy, Debug)]
pub struct Word<'t> {
    /// Its bytes, of which there is at least one.
    pub bytes: &'t [u8],
    /// Where it stands.
    pub at: At,
}

impl Word<'_> {
    /// The word as text for messages.
    pub fn shown(&self) -> String {
        shortened(&String::from_utf8_lossy(self.bytes))
    }

    /// The word as a number that is finite in f32.
    pub fn number(&self) -> Outcome<f64> {
        let value = self.parsed().ok_or_else(|| self.mismatch("a number"))?;
        match (value as f32).is_finite() {
            true => Ok(value),
            false => Err(Problem::new(self.at, "the number is too large; the greatest is 3.4e38")),
        }
    }

    /// The word as a number, unless it spells none; `inf`, `nan` and `-1.#IND` are none. Some programs write exponents as
    /// Fortran does, or marks behind numbers.
    pub fn parsed(&self) -> Option<f64> {
        let text = str::from_utf8(self.bytes).ok()?.trim_end_matches([',', ';']);
        let first = text.trim_start_matches(['+', '-']).bytes().next()?;
        if first != b'.' && !first.is_ascii_digit() {
            return None;
        }
        text.parse().ok().or_else(|| text.replace(['D', 'd'], "e").parse().ok())
    }

    /// The problem of finding this word instead of what was expected.
    pub fn mismatch(&self, expected: &str) -> Problem {
        Problem::new(self.at, format!("expected {expected}, found \"{}\"", self.shown()))
    }
}

/// The words of a text from left to right. What follows a `#` on its line is a comment; a backslash at the end of a line
/// is a blank, and so are the zeros and the end-of-file mark that some programs write behind a text. Lines end with LF, CR
/// or both.
#[derive(Clone, Debug)]
pub struct Words<'t> {
    text: &'t [u8],
    next: usize,
    end: usize,
}

impl<'t> Words<'t> {
    /// The words of a text.
    pub fn of(text: &'t [u8]) -> Self {
        Self::line(text, after_mark(text)..text.len())
    }

    /// The words of a part of a text, which keep their places in the whole.
    pub fn line(text: &'t [u8], part: Range<usize>) -> Self {
        Self { text, next: part.start, end: part.end }
    }

    /// The next word, left where it is.
    pub fn peek(&self) -> Option<Word<'t>> {
        self.clone().next()
    }

    /// Whether a word of this text is the first of its line.
    pub fn starts_line(&self, word: &Word) -> bool {
        let before = self.text[..word.at.0].iter().rev().find(|byte| !matches!(byte, b' ' | b'\t'));
        before.is_none_or(|byte| matches!(byte, b'\n' | b'\r'))
    }

    /// Where the words end.
    pub fn end(&self) -> At {
        At(self.end)
    }

    /// The next word as a number; `what` tells in messages what it is.
    pub fn number(&mut self, what: &str) -> Outcome<f64> {
        let end = self.end();
        let whole = if self.end == self.text.len() { "file" } else { "line" };
        let word = self.next().ok_or_else(|| Problem::new(end, format!("the {whole} ends before {what}")))?;
        match word.parsed() {
            Some(_) => word.number(),
            None => Err(word.mismatch(&format!("a number ({what})"))),
        }
    }

    /// The next words as numbers.
    pub fn numbers<const N: usize>(&mut self, what: &str) -> Outcome<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.number(what)?;
        }
        Ok(numbers)
    }
}

impl<'t> Iterator for Words<'t> {
    type Item = Word<'t>;

    fn next(&mut self) -> Option<Word<'t>> {
        loop {
            let rest = &self.text[self.next..self.end];
            let start = (0..rest.len()).find(|&i| !is_blank(&rest[i..]))?;
            if rest[start] == b'#' {
                let line = rest[start..].iter().position(|byte| matches!(byte, b'\n' | b'\r'))?;
                self.next += start + line;
                continue;
            }
            let end = (start..rest.len())
                .find(|&i| starts_comment(&rest[..=i], rest.get(i + 1)) || is_blank(&rest[i..]))
                .unwrap_or(rest.len());
            let at = self.next + start;
            self.next += end;
            return Some(Word { bytes: &self.text[at..self.next], at: At(at) });
        }
    }
}

/// Whether a text ends with the start of a comment, and not within a number that is none, such as `-1.#IND`.
fn starts_comment(text: &[u8], next: Option<&u8>) -> bool {
    match text {
        [.., b'.', b'#'] => !matches!(next, Some(b'I' | b'Q' | b'S' | b'N')),
        [.., last] => *last == b'#',
        [] => false,
    }
}

/// Whether a text starts with a blank.
fn is_blank(text: &[u8]) -> bool {
    match text[0] {
        b'\\' => matches!(text.get(1), Some(b'\n' | b'\r')),
        byte => byte.is_ascii_whitespace() || matches!(byte, b'\0' | b'\x0B' | b'\x1A'),
    }
}

/// Where a text starts: some programs begin it with a mark of its byte order.
pub fn after_mark(text: &[u8]) -> usize {
    const MARK: &[u8] = b"\xEF\xBB\xBF";
    if text.starts_with(MARK) { MARK.len() } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_have_places_and_comments_end_with_their_line() {
        let words: Vec<(usize, &[u8])> = Words::of(b"s 1#x y\n# z\r\n\t-2.5").map(|w| (w.at.0, w.bytes)).collect();
        assert_eq!(words, [(0, &b"s"[..]), (2, b"1"), (14, b"-2.5")]);
        let line: Vec<(usize, &[u8])> = Words::line(b"ab c\\\nd e", 3..7).map(|w| (w.at.0, w.bytes)).collect();
        assert_eq!(line, [(3, &b"c"[..]), (6, b"d")]);
        assert!(Words::of(b"  # no end").next().is_none() && Words::of(b"").next().is_none());
        let none: Vec<&[u8]> = Words::of(b"-1.#IND 1.#x").map(|word| word.bytes).collect();
        assert_eq!(none, [&b"-1.#IND"[..], b"1."]);
        let old: Vec<&[u8]> = Words::of(b"a # c\rb\0\x1A\0").map(|word| word.bytes).collect();
        assert_eq!(old, [b"a", b"b"]);
    }

    #[test]
    fn numbers_are_finite_and_no_words() {
        let number = |text: &'static [u8]| Words::of(text).number("size").map_err(|problem| problem.message);
        assert_eq!(number(b"+.5e1"), Ok(5.0));
        assert_eq!(number(b"-3."), Ok(-3.0));
        assert_eq!(number(b"-1.5D+01"), Ok(-15.0));
        assert_eq!(number(b"2,"), Ok(2.0));
        assert_eq!(number(b"0;"), Ok(0.0));
        for word in
            [&b"nan"[..], b"inf", b"-infinity", b"1x", b"0x10", b"\xFF", b"--1", b".", b"-1.#IND", b"-nan(ind)", b"1,5"]
        {
            assert!(number(word).is_err_and(|m| m.contains("expected a number (size)")), "{word:?}");
        }
        assert!(number(b"1e39").is_err_and(|m| m.contains("too large")));
        assert!(number(b"").is_err_and(|m| m.contains("ends before size")));
    }
}
