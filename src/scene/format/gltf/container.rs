//! Binary glTF (`.glb`): a header and chunks, the first of JSON, the second of bytes.

use super::fault::{Fault, Read};

/// What every binary glTF file starts with.
const MAGIC: &[u8] = b"glTF";
/// How many bytes the headers of the file and of a chunk have, and what lengths of chunks are multiples of.
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const ALIGNMENT: usize = 4;
/// The version of the container that is known.
const VERSION: u32 = 2;
const JSON: &[u8] = b"JSON";
const BIN: &[u8] = b"BIN\0";

/// The parts of a file.
#[derive(Clone, Copy, Debug)]
pub struct Container<'a> {
    /// The text.
    pub json: &'a [u8],
    /// The bytes of the buffer that names no file.
    pub bin: Option<&'a [u8]>,
}

/// Takes a file apart; one that does not start as binary glTF is text from end to end.
pub fn open(bytes: &[u8]) -> Read<Container<'_>> {
    let Some(header) = bytes.strip_prefix(MAGIC) else {
        return Ok(Container { json: bytes, bin: None });
    };
    let wrong = |message: String| Fault::fatal("", format!("not valid binary glTF: {message}"));
    let (Some(version), Some(length)) = (number(header, 0), number(header, 4)) else {
        return Err(wrong(format!("the file ends after {} bytes, within its header", bytes.len())));
    };
    if version != VERSION {
        return Err(wrong(format!("version {version}; expected {VERSION}")));
    }
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    if length > bytes.len() {
        return Err(wrong(format!("the header says {length} bytes, the file has {}; it was cut off", bytes.len())));
    }
    // Some writers never come back to fill in the length.
    let length = if length < HEADER { bytes.len() } else { length };
    let mut chunks = bytes.get(HEADER..length).unwrap_or_default();
    let Some(Chunk { kind: JSON, contents: json }) = next_chunk(&mut chunks).map_err(wrong)? else {
        return Err(wrong("the first chunk must be of type JSON".to_owned()));
    };
    // Chunks of other types are to be skipped, and what is no chunk at all is left.
    while chunks.len() >= CHUNK_HEADER {
        match next_chunk(&mut chunks) {
            Ok(Some(chunk)) if chunk.kind == BIN => return Ok(Container { json, bin: Some(chunk.contents) }),
            Err(message) if chunks.get(4..8) == Some(BIN) => return Err(wrong(message)),
            Ok(Some(_)) => {}
            Ok(None) | Err(_) => break,
        }
    }
    Ok(Container { json, bin: None })
}

/// A part of a file.
struct Chunk<'a> {
    kind: &'a [u8],
    contents: &'a [u8],
}

/// Splits off the next chunk.
fn next_chunk<'a>(chunks: &mut &'a [u8]) -> Result<Option<Chunk<'a>>, String> {
    if chunks.is_empty() {
        return Ok(None);
    }
    let (Some(length), Some(kind)) = (number(chunks, 0), chunks.get(4..8)) else {
        return Err("the file ends within the header of a chunk".to_owned());
    };
    let contents = &chunks[CHUNK_HEADER..];
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    // The padding at the end is counted, but may be missing.
    let own = match contents.len() {
        left if left < length && length - left < ALIGNMENT => contents,
        left => contents
            .get(..length)
            .ok_or_else(|| format!("a chunk of {length} bytes has only {left} left in the file; it was cut off"))?,
    };
    *chunks = &contents[own.len()..];
    // And padding may be there that is not counted.
    let padding = own.len().next_multiple_of(ALIGNMENT) - own.len();
    let is_next = |start: usize| chunks.get(start + 4..start + 8) == Some(BIN);
    if is_next(padding) && !is_next(0) {
        *chunks = &chunks[padding..];
    }
    Ok(Some(Chunk { kind, contents: own }))
}

fn number(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(chunks: &[(&[u8], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, contents) in chunks {
            body.extend((contents.len() as u32).to_le_bytes());
            body.extend(*kind);
            body.extend(*contents);
        }
        let length = (body.len() as u32 + 12).to_le_bytes();
        [MAGIC, &VERSION.to_le_bytes(), &length, &body].concat()
    }

    #[test]
    fn chunks_are_found_and_unknown_ones_skipped() {
        let bytes = file(&[(JSON, b"{}  "), (BIN, b"abcd"), (b"XTRA", b"?")]);
        let Container { json, bin } = open(&bytes).unwrap();
        assert_eq!((json, bin), (&b"{}  "[..], Some(&b"abcd"[..])));
        assert_eq!(open(&file(&[(JSON, b"{}")])).unwrap().bin, None);
        assert_eq!(open(&file(&[(JSON, b"{}  "), (b"XTRA", b"?"), (BIN, b"abcd")])).unwrap().bin, Some(&b"abcd"[..]));
        assert_eq!(open(b"{}").unwrap().json, b"{}");
    }

    #[test]
    fn lengths_that_are_a_little_wrong_do_no_harm() {
        let plain = file(&[(JSON, b"{}  "), (BIN, b"abcd")]);
        let with = |at: usize, value: u32, rest: &[u8]| {
            let mut bytes = plain.clone();
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            [&bytes, rest].concat()
        };
        let length = plain.len() as u32;
        // Bytes after the end, a chunk cut short, no length at all, padding that is counted but missing or not counted.
        for (bytes, json) in [
            (with(8, length, b"more"), &b"{}  "[..]),
            (with(8, length + 6, b"XTRA\xFF\xFF"), b"{}  "),
            (with(8, length + 12, b"\xFF\xFF\0\0XTRAdata"), b"{}  "),
            (with(8, 0, b""), b"{}  "),
            (with(12, 2, b""), b"{}"),
        ] {
            let Container { json: read, bin } = open(&bytes).unwrap();
            assert_eq!((read, bin), (json, Some(&b"abcd"[..])), "{bytes:?}");
        }
        let bytes = with(24, 6, b"");
        assert_eq!(open(&bytes).unwrap().bin, Some(&b"abcd"[..]));
        for wrong in [with(8, length + 1, b""), with(24, 400, b"")] {
            assert!(open(&wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn every_shortened_file_is_refused_without_a_panic() {
        let bytes = file(&[(JSON, b"{}  "), (BIN, b"abcd")]);
        for length in 4..bytes.len() {
            assert!(open(&bytes[..length]).is_err(), "{length} bytes");
        }
        for wrong in [file(&[(BIN, b"abcd")]), file(&[])] {
            assert!(open(&wrong).unwrap_err().message.contains("first chunk"));
        }
    }
}
