//! The bytes that turn one screen of cells into the next: only what changed, in as few bytes as will do.

use super::cells::{Cell, Cells};
use super::palette::Color;
use std::io::Write;

/// The terminal draws nothing between these two, so that no frame is seen by halves. Terminals that know neither ignore
/// both.
const BEGIN: &str = "\x1b[?2026h";
const END: &str = "\x1b[?2026l";
const RESET_COLORS: &str = "\x1b[m";
const ERASE_SCREEN: &str = "\x1b[2J";
const ERASE_TO_END_OF_LINE: &str = "\x1b[K";

/// Knows what the terminal shows.
#[derive(Debug, Default)]
pub struct Encoder {
    shown: Option<Cells>,
    status: Option<String>,
}

/// Where the terminal's cursor is and in which colours it writes.
#[derive(Default)]
struct Pen {
    /// Column and row from 0, where known.
    at: Option<(usize, usize)>,
    foreground: Option<Color>,
    background: Option<Color>,
}

impl Encoder {
    /// Whatever the terminal shows, it is not known: the next frame is written whole.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// The bytes that show `cells` from the upper left corner and `status` in row `status_row` (from 0). Empty where
    /// nothing changed.
    pub fn encode(&mut self, cells: Cells, status: &str, status_row: usize) -> Vec<u8> {
        let mut out = Vec::new();
        let before = self.shown.take().filter(|shown| shown.fits(&cells));
        let starts_over = before.is_none();
        let mut pen = Pen::default();
        for (row, cells_of_row) in cells.rows().enumerate() {
            let before = before.as_ref().and_then(|before| before.rows().nth(row));
            for (column, cell) in cells_of_row.iter().enumerate() {
                if before.is_none_or(|before| before[column] != *cell) {
                    pen.put(&mut out, (column, row), cell, cells.columns());
                }
            }
        }
        self.shown = Some(cells);
        if starts_over || self.status.as_deref() != Some(status) {
            self.status = Some(status.to_owned());
            write(&mut out, format_args!("{RESET_COLORS}\x1b[{};1H{status}{ERASE_TO_END_OF_LINE}", status_row + 1));
        }
        if out.is_empty() {
            return out;
        }
        let erase = if starts_over { [RESET_COLORS, ERASE_SCREEN].concat() } else { String::new() };
        [BEGIN.as_bytes(), erase.as_bytes(), &out, RESET_COLORS.as_bytes(), END.as_bytes()].concat()
    }
}

impl Pen {
    fn put(&mut self, out: &mut Vec<u8>, place: (usize, usize), cell: &Cell, columns: usize) {
        self.go(out, place);
        // Where both halves are alike the background alone shows them.
        let foreground = (cell.top != cell.bottom).then_some(cell.top);
        let foreground = foreground.filter(|color| self.foreground != Some(*color));
        let background = (self.background != Some(cell.bottom)).then_some(cell.bottom);
        match (foreground, background) {
            (Some(foreground), Some(background)) => write(out, format_args!("\x1b[38;{foreground};48;{background}m")),
            (Some(foreground), None) => write(out, format_args!("\x1b[38;{foreground}m")),
            (None, Some(background)) => write(out, format_args!("\x1b[48;{background}m")),
            (None, None) => {}
        }
        self.foreground = foreground.or(self.foreground);
        self.background = Some(cell.bottom);
        out.extend_from_slice(if cell.top == cell.bottom { b" " } else { "▀".as_bytes() });
        let (column, row) = place;
        // Behind the last column terminals differ on where the cursor is.
        self.at = (column + 1 < columns).then_some((column + 1, row));
    }

    fn go(&self, out: &mut Vec<u8>, (column, row): (usize, usize)) {
        match self.at {
            Some(at) if at == (column, row) => {}
            Some((from, same)) if same == row && from < column => write(out, format_args!("\x1b[{}C", column - from)),
            _ => write(out, format_args!("\x1b[{};{}H", row + 1, column + 1)),
        }
    }
}

fn write(out: &mut Vec<u8>, text: std::fmt::Arguments<'_>) {
    // Memory takes everything.
    let _ = out.write_fmt(text);
}

#[cfg(test)]
mod tests {
    use super::super::palette::Palette;
    use super::*;

    /// Cells of one row each, whose pixels have these levels of grey.
    fn cells(upper: &[u8], lower: &[u8]) -> Cells {
        let rgba: Vec<u8> = upper.iter().chain(lower).flat_map(|&value| [value, value, value, 255]).collect();
        Cells::of_picture(&rgba, upper.len(), Palette::TrueColor)
    }

    fn text(bytes: Vec<u8>) -> String {
        String::from_utf8(bytes).expect("text")
    }

    #[test]
    fn the_first_frame_is_whole() {
        let bytes = Encoder::default().encode(cells(&[1, 1, 3], &[2, 2, 3]), "status", 1);
        let expected = "\x1b[?2026h\x1b[m\x1b[2J\x1b[1;1H\x1b[38;2;1;1;1;48;2;2;2;2m▀▀\x1b[48;2;3;3;3m \
                        \x1b[m\x1b[2;1Hstatus\x1b[K\x1b[m\x1b[?2026l";
        assert_eq!(text(bytes), expected);
    }

    #[test]
    fn then_only_what_changed_is_written() {
        let mut encoder = Encoder::default();
        encoder.encode(cells(&[1, 1, 1, 1], &[2, 2, 2, 2]), "status", 1);
        assert!(encoder.encode(cells(&[1, 1, 1, 1], &[2, 2, 2, 2]), "status", 1).is_empty());
        let bytes = encoder.encode(cells(&[9, 1, 9, 1], &[2, 2, 2, 2]), "status", 1);
        let expected = "\x1b[?2026h\x1b[1;1H\x1b[38;2;9;9;9;48;2;2;2;2m▀\x1b[1C▀\x1b[m\x1b[?2026l";
        assert_eq!(text(bytes), expected);
        let bytes = encoder.encode(cells(&[9, 1, 9, 1], &[2, 2, 2, 2]), "other", 1);
        assert_eq!(text(bytes), "\x1b[?2026h\x1b[m\x1b[2;1Hother\x1b[K\x1b[m\x1b[?2026l");
    }

    #[test]
    fn another_size_or_a_forgotten_screen_starts_over() {
        let mut encoder = Encoder::default();
        encoder.encode(cells(&[1], &[2]), "", 1);
        assert!(text(encoder.encode(cells(&[1, 1], &[2, 2]), "", 1)).contains("\x1b[2J"));
        assert!(!text(encoder.encode(cells(&[1, 3], &[2, 2]), "", 1)).contains("\x1b[2J"));
        encoder.forget();
        assert!(text(encoder.encode(cells(&[1, 3], &[2, 2]), "", 1)).contains("\x1b[2J"));
    }

    #[test]
    fn the_terminal_shows_the_picture() {
        // A terminal of two sequences: enough to read what is written.
        let mut encoder = Encoder::default();
        let mut screen = vec![[0u8; 2]; 8];
        let mut random = 1u32;
        for _ in 0..200 {
            let mut next = || {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (random >> 29) as u8
            };
            let picture: Vec<u8> = (0..16).map(|_| next()).collect();
            let (upper, lower) = picture.split_at(8);
            draw(&text(encoder.encode(cells(upper, lower), "", 1)), &mut screen);
            let expected: Vec<[u8; 2]> = upper.iter().zip(lower).map(|(&top, &bottom)| [top, bottom]).collect();
            assert_eq!(screen, expected);
        }
    }

    /// Draws what is written in row 1 onto `screen`.
    fn draw(written: &str, screen: &mut [[u8; 2]]) {
        let (mut column, mut row, mut colors) = (0, 0, [0u8; 2]);
        let mut rest = written;
        while let Some(character) = rest.chars().next() {
            rest = &rest[character.len_utf8()..];
            if character != '\x1b' {
                if row == 1 {
                    screen[column] = if character == ' ' { [colors[1]; 2] } else { colors };
                }
                column += 1;
                continue;
            }
            let end = rest.find(|c: char| c.is_ascii_alphabetic()).expect("a sequence ends");
            let numbers: Vec<usize> = rest[1..end].split(';').map(|number| number.parse().unwrap_or(0)).collect();
            match rest.as_bytes()[end] {
                b'H' => (row, column) = (numbers[0], numbers[1] - 1),
                b'C' => column += numbers[0],
                b'm' => numbers.chunks_exact(5).for_each(|sgr| colors[usize::from(sgr[0] == 48)] = sgr[2] as u8),
                _ => {}
            }
            rest = &rest[end + 1..];
        }
    }
}
