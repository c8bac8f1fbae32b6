//! Netpbm's portable pixmap: text (P3) as the thesis wrote it, or raw bytes (P6).

use super::format::{Sink, WriteOptions};
use super::{EightBit, PictureError};
use std::io::Write;

/// Pixels a line of text: the format asks for lines of at most 70 characters.
const PIXELS_PER_LINE: usize = 5;

pub(super) fn ppm(picture: &EightBit, options: WriteOptions, sink: &mut dyn Sink) -> Result<(), PictureError> {
    let EightBit { width, height, rgb } = picture;
    let magic = if options.binary { "P6" } else { "P3" };
    write!(sink, "{magic}\n{width} {height}\n255\n")?;
    if options.binary {
        sink.write_all(rgb)?;
        return Ok(());
    }
    let mut line = Vec::with_capacity(70);
    for group in rgb.chunks(3 * PIXELS_PER_LINE) {
        line.clear();
        for (i, value) in group.iter().enumerate() {
            let separator = if i == 0 { "" } else { " " };
            write!(line, "{separator}{value}")?;
        }
        line.push(b'\n');
        sink.write_all(&line)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn written(picture: &EightBit, binary: bool) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        ppm(picture, WriteOptions { binary }, &mut bytes).expect("memory takes it");
        bytes.into_inner()
    }

    #[test]
    fn text_and_raw_say_the_same() {
        let picture = EightBit { width: 2, height: 1, rgb: vec![0, 128, 255, 7, 8, 9] };
        assert_eq!(written(&picture, false), b"P3\n2 1\n255\n0 128 255 7 8 9\n");
        assert_eq!(written(&picture, true), b"P6\n2 1\n255\n\x00\x80\xff\x07\x08\x09");
    }

    #[test]
    fn lines_of_text_stay_within_70_characters() {
        let picture = EightBit { width: 7, height: 3, rgb: vec![255; 7 * 3 * 3] };
        let text = String::from_utf8(written(&picture, false)).expect("P3 is text");
        assert!(text.lines().all(|line| line.len() <= 70));
        assert_eq!(text.split_whitespace().count(), 4 + 7 * 3 * 3);
    }
}
