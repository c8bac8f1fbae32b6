//! Files that were compressed with Zstandard (RFC 8878).

use crate::scene::guard::guarded;
use crate::scene::limits::{Limits, exceeded};
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

/// What a frame starts with.
const MAGIC: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];

/// What frames start with that are to be skipped, from the second byte on; the first counts from 0x50 to 0x5F. Their length
/// follows.
const SKIPPED: [u8; 3] = [0x2A, 0x4D, 0x18];
/// Text of so many bytes is small, however much smaller the file is.
const ALWAYS_ALLOWED: u64 = 16 << 20;

/// The text of a file, which may be compressed; the error tells why there is none.
pub fn expanded<'t>(bytes: &'t [u8], limits: &Limits) -> Result<Cow<'t, [u8]>, String> {
    if !bytes.starts_with(&MAGIC) && skipped(bytes).is_none() {
        return Ok(Cow::Borrowed(bytes));
    }
    // The decoder is meant never to panic on damaged files; should it do so, only this file is lost.
    let text = guarded(|| decode(bytes, limits))
        .unwrap_or_else(|_| Err("the decoder gave up; the file is damaged".to_owned()))?;
    Ok(Cow::Owned(text))
}

/// The length of a frame to be skipped, if that is what `frames` start with.
fn skipped(frames: &[u8]) -> Option<u64> {
    let (magic, rest) = frames.split_first_chunk::<4>()?;
    let (length, _) = rest.split_first_chunk::<4>()?;
    (magic[0] & 0xF0 == 0x50 && magic[1..] == SKIPPED).then(|| 8 + u64::from(u32::from_le_bytes(*length)))
}

fn decode(mut frames: &[u8], limits: &Limits) -> Result<Vec<u8>, String> {
    let damaged = |error: &dyn std::fmt::Display| format!("cannot expand the file: {error}");
    let usual = limits.expansion.saturating_mul(frames.len() as u64).max(ALWAYS_ALLOWED);
    let limit = usual.min(limits.file_bytes);
    let mut text = Vec::new();
    while !frames.is_empty() {
        if let Some(length) = skipped(frames) {
            let length = usize::try_from(length).ok();
            frames = length.and_then(|length| frames.get(length..)).ok_or_else(|| damaged(&"it is cut off"))?;
            continue;
        }
        let mut decoder = StreamingDecoder::new(&mut frames).map_err(|error| damaged(&error))?;
        let left = limit.saturating_sub(text.len() as u64);
        // One byte more than allowed is enough to notice.
        decoder.by_ref().take(left.saturating_add(1)).read_to_end(&mut text).map_err(|error| damaged(&error))?;
        if text.len() as u64 > limit {
            return Err(match limit == limits.file_bytes {
                true => format!("the scene's files, expanded, have {}", exceeded("file-bytes", limit)),
                false => format!("bytes for each of its own, expanded: {}", exceeded("expansion", limits.expansion)),
            });
        }
        let (said, found) = (decoder.decoder.get_checksum_from_data(), decoder.decoder.get_calculated_checksum());
        if said.is_some() && said != found {
            return Err(damaged(&"its checksum is not that of its text"));
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
        let aside = [&[0x5A, 0x2A, 0x4D, 0x18, 3, 0, 0, 0][..], b"any"].concat();
        for skipping in [[aside.clone(), two.clone()].concat(), [two.clone(), aside.clone()].concat()] {
            assert_eq!(&*expanded(&skipping, &limits).unwrap(), b"v 1 2 3\n");
            assert!(expanded(&[&skipping, &aside[..9]].concat(), &limits).unwrap_err().contains("cut off"));
        }
        let long = [two, frame(b"...")].concat();
        assert!(expanded(&long, &limits).unwrap_err().contains("limit file-bytes of 10"));
    }

    /// Of blocks that stand for 131,072 times one byte each.
    #[test]
    fn texts_much_larger_than_their_files_are_refused() {
        let block = (128_u32 << 10 << 3 | 1 << 1).to_le_bytes();
        let last = (1_u32 << 3 | 1 << 1 | 1).to_le_bytes();
        let blocks = [&block[..3], b"\n"].concat().repeat(160);
        let bomb = [&MAGIC[..], &[0x00, 0x38], &blocks, &last[..3], b"\n"].concat();
        assert!(expanded(&bomb, &Limits::default()).unwrap_err().contains("limit expansion of 100"));
        let limits = Limits { expansion: 100_000, ..Limits::default() };
        assert_eq!(expanded(&bomb, &limits).unwrap().len(), 160 * (128 << 10) + 1);
    }

    #[test]
    fn damaged_frames_are_refused() {
        let whole = frame(b"v 1 2 3\n");
        for length in MAGIC.len()..whole.len() {
            assert!(expanded(&whole[..length], &Limits::default()).unwrap_err().contains("cannot expand"), "{length}");
        }
    }
}
