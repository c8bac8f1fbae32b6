//! Files that were compressed with Zstandard (RFC 8878).

use crate::scene::guard::guarded;
use crate::scene::limits::{Limits, exceeded};
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

/// What a frame starts with.
const MAGIC: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];

/// The text of a file, which may be compressed; the error tells why there is none.
pub fn expanded<'t>(bytes: &'t [u8], limits: &Limits) -> Result<Cow<'t, [u8]>, String> {
    if !bytes.starts_with(&MAGIC) {
        return Ok(Cow::Borrowed(bytes));
    }
    // The decoder is meant never to panic on damaged files; should it do so, only this file is lost.
    let text = guarded(|| decode(bytes, limits.file_bytes))
        .unwrap_or_else(|_| Err("the decoder gave up; the file is damaged".to_owned()))?;
    Ok(Cow::Owned(text))
}

fn decode(mut frames: &[u8], limit: u64) -> Result<Vec<u8>, String> {
    let damaged = |error: &dyn std::fmt::Display| format!("cannot expand the file: {error}");
    let mut text = Vec::new();
    while !frames.is_empty() {
        let decoder = StreamingDecoder::new(&mut frames).map_err(|error| damaged(&error))?;
        let left = limit.saturating_sub(text.len() as u64);
        // One byte more than allowed is enough to notice.
        decoder.take(left.saturating_add(1)).read_to_end(&mut text).map_err(|error| damaged(&error))?;
        if text.len() as u64 > limit {
            return Err(format!("the scene's files, expanded, have {}", exceeded("file-bytes", limit)));
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame of raw blocks that holds `text`, which is shorter than 256 bytes.
    fn frame(text: &[u8]) -> Vec<u8> {
        let length = text.len() as u8;
        // One segment whose size has a byte; then a last block of raw bytes, whose size starts at its fourth bit.
        let block = (u32::from(length) << 3 | 1).to_le_bytes();
        [&MAGIC[..], &[0x20, length], &block[..3], text].concat()
    }

    #[test]
    fn frames_are_expanded_and_texts_left_as_they_are() {
        let limits = Limits { file_bytes: 10, ..Limits::default() };
        assert_eq!(&*expanded(b"v 1 2 3", &limits).unwrap(), b"v 1 2 3");
        let two = [frame(b"v 1 "), frame(b"2 3\n")].concat();
        assert_eq!(&*expanded(&two, &limits).unwrap(), b"v 1 2 3\n");
        let long = [two, frame(b"...")].concat();
        assert!(expanded(&long, &limits).unwrap_err().contains("limit file-bytes of 10"));
    }

    #[test]
    fn damaged_frames_are_refused() {
        let whole = frame(b"v 1 2 3\n");
        for length in MAGIC.len()..whole.len() {
            assert!(expanded(&whole[..length], &Limits::default()).unwrap_err().contains("cannot expand"), "{length}");
        }
    }
}
