//! Positions in a text as people count them.

use crate::scene::desc::problem::At;
use crate::scene::error::Place;
use std::path::Path;

/// The places of positions in a text that has lines but no names for its parts.
pub fn by_line(file: &Path, text: &[u8], positions: &[At]) -> Vec<Place> {
    let place =
        |at: &At| Place { file: file.to_owned(), line_column: Some(line_column(text, at.0)), pointer: String::new() };
    positions.iter().map(place).collect()
}

/// 1-based line and column (in characters) of a byte offset.
pub fn line_column(text: &[u8], offset: usize) -> (usize, usize) {
    let before = &text[..offset.min(text.len())];
    let line = 1 + before.iter().filter(|b| **b == b'\n').count();
    let start = before.iter().rposition(|b| *b == b'\n').map_or(0, |newline| newline + 1);
    let is_first_byte = |b: &&u8| **b & 0xC0 != 0x80;
    (line, 1 + before[start..].iter().filter(is_first_byte).count())
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
        assert_eq!(byte_offset(text, 1, 1), 0);
        assert_eq!(byte_offset(text, 2, 4), 5);
        assert_eq!(byte_offset(text, 9, 9), text.len());
    }
}
