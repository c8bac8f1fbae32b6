//! Positions in a text as people count them.

use crate::scene::desc::problem::At;
use crate::scene::error::Place;
use std::path::Path;

/// The places of positions in a text, but for the names that a format may have for its parts.
pub fn by_line(file: &Path, text: &[u8], positions: &[At]) -> Vec<Place> {
    let place = |found| Place { file: file.to_owned(), line_column: Some(found), pointer: String::new() };
    line_columns(text, positions).into_iter().map(place).collect()
}

/// 1-based line and column (in characters) of a byte offset.
pub fn line_column(text: &[u8], offset: usize) -> (usize, usize) {
    line_columns(text, &[At(offset)])[0]
}

/// 1-based lines and columns (in characters) of positions, found in one walk over the text.
pub fn line_columns(text: &[u8], positions: &[At]) -> Vec<(usize, usize)> {
    let mut sorted: Vec<(At, usize)> = positions.iter().copied().zip(0..).collect();
    sorted.sort_unstable();
    let is_first_byte = |byte: &&u8| **byte & 0xC0 != 0x80;
    let (mut line, mut column, mut walked) = (1, 1, 0);
    let mut found = vec![(1, 1); positions.len()];
    for (at, i) in sorted {
        let start = walked;
        walked = at.0.clamp(walked, text.len());
        // LF ends a line, and so does a CR before anything else.
        let ends_line = |i: &usize| match text[*i] {
            b'\n' => true,
            b'\r' => text.get(i + 1) != Some(&b'\n'),
            _ => false,
        };
        let lines = (start..walked).filter(ends_line).count();
        match (start..walked).rfind(ends_line) {
            None => column += text[start..walked].iter().filter(is_first_byte).count(),
            Some(end) => {
                line += lines;
                column = 1 + text[end + 1..walked].iter().filter(is_first_byte).count();
            }
        }
        found[i] = (line, column);
    }
    found
}

/// Byte offset of a 1-based line and column in bytes.
pub fn byte_offset(text: &[u8], line: usize, column: usize) -> usize {
    let newlines = text.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(i, _)| i + 1);
    let start = std::iter::once(0).chain(newlines).nth(line.saturating_sub(1)).unwrap_or(text.len());
    (start + column.saturating_sub(1)).min(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_lines_and_characters_from_one() {
        let text = "a\nbö c".as_bytes();
        assert_eq!(line_column(text, 0), (1, 1));
        assert_eq!(line_column(text, 2), (2, 1));
        assert_eq!(line_column(text, 5), (2, 3));
        assert_eq!(line_column(text, 99), (2, 5));
        assert_eq!(line_columns(text, &[5, 0, 99, 2].map(At)), [(2, 3), (1, 1), (2, 5), (2, 1)]);
        assert_eq!(line_columns(b"a\rb\r\nc\r", &[2, 5, 7].map(At)), [(2, 1), (3, 1), (4, 1)]);
        assert_eq!(byte_offset(text, 1, 1), 0);
        assert_eq!(byte_offset(text, 2, 4), 5);
        assert_eq!(byte_offset(text, 9, 9), text.len());
    }
}
